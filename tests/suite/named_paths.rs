//! Files and folders that documents, comments and messages name are there.

use std::fs;
use std::path::{Path, PathBuf};

use crate::structure::files_with;

/// Folders at the top of the repository whose contents are named by their paths.
const FOLDERS: &[&str] = &[
    "assets", "benches", "docs", "fuzz", "scripts", "shaders", "src", "tests",
];

/// Paths that are not there: what a program writes, or a place for a name that the reader fills in.
const OTHERS: &[&str] = &["docs/pictures/layers", "fuzz/failures", "src/mutants.rs"];

/// All files in which paths are looked for.
fn readable(root: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = [
        ("rs", "src"),
        ("rs", "tests"),
        ("rs", "benches"),
        ("rs", "fuzz"),
        ("wgsl", "shaders"),
        ("md", "docs"),
    ]
    .into_iter()
    .flat_map(|(ending, folder)| files_with(ending, &root.join(folder)))
    .collect();
    let beside = |folder: &str| {
        let entries = fs::read_dir(root.join(folder))
            .unwrap()
            .map(|entry| entry.unwrap().path());
        entries.filter(|path| path.is_file()).collect::<Vec<_>>()
    };
    files.extend(beside("scripts"));
    files.extend(beside(".").into_iter().filter(|file| !file.ends_with("Cargo.lock")));
    files
}

/// The paths from the top of the repository that a line names.
fn paths(line: &str) -> impl Iterator<Item = &str> {
    let of_path = |c: char| c.is_alphanumeric() || "_-./{}*<>$".contains(c);
    line.split(move |c: char| !of_path(c)).filter_map(|word| {
        let path = word.trim_start_matches("../").trim_end_matches(['.', '/']);
        let (first, _) = path.split_once('/')?;
        FOLDERS.contains(&first).then_some(path)
    })
}

/// True for a pattern: `src/*.rs`, `src/{folder}`, or a name in capitals that is to be filled in.
fn is_pattern(path: &str) -> bool {
    let is_blank = |part: &str| {
        let name = part.split('.').next().unwrap_or("");
        name.len() > 2 && name.chars().all(|c| c.is_ascii_uppercase()) && name != "README"
    };
    path.contains(['*', '{', '}', '<', '>', '$']) || path.split('/').any(is_blank)
}

#[test]
fn named_files_are_there() {
    let root = Path::new(crate::ROOT);
    let mut wrong = Vec::new();
    for file in readable(root) {
        let Ok(text) = fs::read_to_string(&file) else { continue };
        for (number, line) in text.lines().enumerate() {
            let named = paths(line).filter(|path| !is_pattern(path) && !OTHERS.contains(path));
            let missing =
                named.filter(|path| !root.join(path).exists() && !root.join(path).with_extension("rs").exists());
            wrong.extend(missing.map(|path| format!("{}:{}: {path}", file.display(), number + 1)));
        }
    }
    assert!(
        wrong.is_empty(),
        "files that are named and not there:\n{}",
        wrong.join("\n")
    );
}

#[test]
fn the_reader_of_named_paths_sees_links_and_sentences() {
    // Written so that the test above does not look for these files.
    let line =
        "As in `src~a/b.rs`, [x](../docs~B.md) and shaders~c/. Not /src~d, x/src~e or src~f/*.rs.".replace('~', "/");
    let found: Vec<String> = paths(&line)
        .filter(|path| !is_pattern(path))
        .map(|path| path.replacen('/', " ", 1))
        .collect();
    assert_eq!(found, ["src a/b.rs", "docs B.md", "shaders c"]);
}
