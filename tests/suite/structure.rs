//! The order of the folders, read from the code's own paths: who may use whom (docs/ARCHITECTURE.md).

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Each folder of `src/` with all others that it may use.
const MAY_USE: &[(&str, &str)] = &[
    ("named", ""),
    ("instructions", "named"),
    ("panics", ""),
    ("parallel", ""),
    ("console", "panics"),
    ("optics", "parallel named instructions"),
    ("scene", "parallel named panics instructions optics"),
    ("import", "parallel panics optics scene"),
    ("job", "parallel named optics scene"),
    ("cpu", "parallel named panics instructions optics scene job"),
    ("gpu", "parallel named panics optics scene job"),
    ("analysis", "parallel named panics optics scene job"),
    ("plot", "parallel named optics job analysis"),
    ("document", "named panics optics scene import job"),
    ("compile", "panics optics scene import job document"),
    ("matching", "optics analysis plot document"),
    (
        "store",
        "parallel named panics optics scene import analysis document compile matching",
    ),
    (
        "render",
        "parallel named panics optics scene job cpu gpu analysis plot document compile matching store import",
    ),
    (
        "study",
        "parallel named optics scene import job cpu gpu analysis plot document compile matching store render",
    ),
    (
        "cli",
        "named console instructions optics scene import job analysis plot document matching store render study",
    ),
    (
        "app",
        "named panics optics scene import job analysis plot document matching store render study",
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
                .filter(|name| name != folder && !allowed.split(' ').any(|other| other == *name));
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
