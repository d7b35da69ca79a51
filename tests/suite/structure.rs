//! The order of the folders, read from the code's own paths: who may use whom (docs/ARCHITECTURE.md).

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Each folder of `src/` with all others that it may use.
const MAY_USE: &[(&str, &[&str])] = &[
    ("named", &[]),
    ("instructions", &["named"]),
    ("panics", &[]),
    ("parallel", &[]),
    ("console", &["panics"]),
    ("optics", &["parallel", "named", "instructions"]),
    ("scene", &["parallel", "named", "panics", "instructions", "optics"]),
    ("import", &["parallel", "panics", "optics", "scene"]),
    ("job", &["parallel", "named", "optics", "scene"]),
    (
        "cpu",
        &["parallel", "named", "panics", "instructions", "optics", "scene", "job"],
    ),
    ("gpu", &["named", "panics", "optics", "scene", "job"]),
    ("analysis", &["parallel", "named", "panics", "optics", "scene", "job"]),
    ("plot", &["parallel", "named", "optics", "job", "analysis"]),
    ("document", &["named", "panics", "optics", "scene", "import", "job"]),
    ("compile", &["panics", "optics", "scene", "import", "job", "document"]),
    ("matching", &["optics", "analysis", "plot", "document"]),
    (
        "store",
        &[
            "parallel", "named", "panics", "optics", "scene", "import", "analysis", "document", "compile", "matching",
        ],
    ),
    (
        "render",
        &[
            "parallel", "named", "panics", "optics", "scene", "job", "cpu", "gpu", "analysis", "plot", "document",
            "compile", "matching", "store", "import",
        ],
    ),
    (
        "study",
        &[
            "parallel", "named", "optics", "scene", "import", "job", "cpu", "gpu", "analysis", "plot", "document",
            "compile", "matching", "store", "render",
        ],
    ),
    (
        "cli",
        &[
            "named",
            "console",
            "instructions",
            "optics",
            "scene",
            "import",
            "job",
            "analysis",
            "plot",
            "document",
            "matching",
            "store",
            "render",
            "study",
        ],
    ),
    (
        "app",
        &[
            "named", "panics", "optics", "scene", "import", "job", "analysis", "plot", "document", "matching", "store",
            "render", "study",
        ],
    ),
];

fn collect(ending: &str, folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(ending, &path, found);
        } else if path.extension().is_some_and(|its| its == ending) {
            found.push(path);
        }
    }
}

/// The files of a folder, and of those in it, with this ending.
pub(crate) fn files_with(ending: &str, folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    collect(ending, folder, &mut found);
    found
}

/// The folders that a file names by `crate::`, other than in comments.
fn used(text: &str) -> BTreeSet<&str> {
    let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    code.flat_map(|line| line.split("crate::").skip(1))
        .map(|rest| {
            rest.split(|c: char| !c.is_alphanumeric() && c != '_')
                .next()
                .unwrap_or("")
        })
        .filter(|name| MAY_USE.iter().any(|(folder, _)| folder == name))
        .collect()
}

#[test]
fn folders_use_only_what_is_below_them() {
    let src = Path::new(crate::ROOT).join("src");
    let mut wrong = Vec::new();
    for (folder, allowed) in MAY_USE {
        let files = match src.join(folder) {
            path if path.is_dir() => files_with("rs", &path),
            path => vec![path.with_extension("rs")],
        };
        assert!(
            !files.is_empty(),
            "src/{folder} is gone: bring the table here up to date"
        );
        for file in files {
            let text = fs::read_to_string(&file).unwrap();
            let beyond = used(&text)
                .into_iter()
                .filter(|name| name != folder && !allowed.contains(name));
            wrong.extend(beyond.map(|name| format!("{} uses {name}", file.display())));
        }
    }
    assert!(
        wrong.is_empty(),
        "against the order of docs/ARCHITECTURE.md:\n{}",
        wrong.join("\n")
    );
}

#[test]
fn every_folder_has_its_place_in_the_order() {
    let src = Path::new(crate::ROOT).join("src");
    for entry in fs::read_dir(src).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        let is_known = MAY_USE.iter().any(|(folder, _)| *folder == name)
            || ["lib", "main", "book_pages", "engine"].contains(&name);
        assert!(is_known, "src/{name} has no place in the order of the folders");
    }
}

/// The parts of the window, each after those that it may use.
const LAYERS_OF_APP: &[&[&str]] = &[
    &["kit", "lights"],
    &["services"],
    &["pane"],
    &["actions"],
    &["desk"],
    &["study"],
    &["panels", "viewport", "sheets"],
    &["layout"],
    &["settings"],
];

/// The parts of the window that a file of it names, other than in comments: `crate::app::part` from anywhere, and
/// `super::part` from files that stand directly in the folder or are the root of a part.
fn used_of_app(text: &str, is_near: bool) -> BTreeSet<String> {
    let code: Vec<&str> = text
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .collect();
    let code = code.join("\n");
    let far = code.split("crate::app::").skip(1);
    let near = code.split("super::").skip(1).filter(|_| is_near);
    let first = |path: &str| {
        path.split(|c: char| !c.is_alphanumeric() && c != '_')
            .next()
            .unwrap_or("")
            .to_owned()
    };
    far.chain(near).map(first).collect()
}

#[test]
fn the_window_is_built_in_layers() {
    let app = Path::new(crate::ROOT).join("src/app");
    let mut wrong = Vec::new();
    for (height, parts) in LAYERS_OF_APP.iter().enumerate() {
        for part in *parts {
            let files = match app.join(part) {
                folder if folder.is_dir() => files_with("rs", &folder),
                file => vec![file.with_extension("rs")],
            };
            for file in files {
                let is_near = file.parent() == Some(&app) || file.ends_with("mod.rs");
                let used = used_of_app(&fs::read_to_string(&file).unwrap(), is_near);
                let may = |name: &String| {
                    let is_below = LAYERS_OF_APP[..height]
                        .iter()
                        .any(|layer| layer.contains(&name.as_str()));
                    is_below || name == part
                };
                let is_part = |name: &&String| {
                    ["App", "handlers"].contains(&name.as_str())
                        || LAYERS_OF_APP.iter().any(|layer| layer.contains(&name.as_str()))
                };
                let beyond = used.iter().filter(is_part).filter(|name| !may(name));
                wrong.extend(beyond.map(|name| format!("{} uses {name}", file.display())));
            }
        }
    }
    assert!(wrong.is_empty(), "against the layers of src/app:\n{}", wrong.join("\n"));
}
