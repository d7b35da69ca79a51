//! The order of the folders, read from the code's own paths: who may use whom (docs/ARCHITECTURE.md).

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Each folder of `src/` with all others that it may use.
const MAY_USE: &[(&str, &[&str])] = &[
    ("named", &[]),
    ("panics", &[]),
    ("optics", &["named"]),
    ("scene", &["named", "panics", "optics"]),
    ("job", &["named", "optics", "scene"]),
    ("cpu", &["named", "optics", "scene", "job"]),
    ("gpu", &["named", "optics", "scene", "job"]),
    ("analysis", &["named", "panics", "optics", "scene", "job"]),
    ("plot", &["named", "optics", "job", "analysis"]),
    ("document", &["named", "optics", "scene", "job", "analysis", "plot"]),
    ("store", &["named", "optics", "scene", "document"]),
    (
        "render",
        &[
            "named", "panics", "optics", "scene", "job", "cpu", "gpu", "analysis", "plot", "document", "store",
        ],
    ),
    (
        "cli",
        &[
            "named", "optics", "scene", "job", "analysis", "plot", "document", "store", "render",
        ],
    ),
    (
        "app",
        &[
            "named", "panics", "optics", "scene", "job", "analysis", "plot", "document", "store", "render",
        ],
    ),
];

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
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
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut wrong = Vec::new();
    for (folder, allowed) in MAY_USE {
        let mut files = Vec::new();
        let path = src.join(folder);
        if path.is_dir() {
            sources(&path, &mut files);
        } else {
            files.push(path.with_extension("rs"));
        }
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
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    for entry in fs::read_dir(src).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        let is_known = MAY_USE.iter().any(|(folder, _)| *folder == name) || ["lib", "main"].contains(&name);
        assert!(is_known, "src/{name} has no place in the order of the folders");
    }
}

#[test]
fn the_reader_of_paths_sees_a_use_and_no_comment() {
    let text = "use crate::app::Editor;\n// crate::cli\n    let x = crate::store::file::read(crate::gpu::open());\n";
    assert_eq!(used(text), BTreeSet::from(["app", "gpu", "store"]));
}
