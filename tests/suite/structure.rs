//! The order of the folders within a package, read from the code's own paths (docs/ARCHITECTURE.md). Cargo keeps that of
//! the packages.

use std::{fs, path::Path, path::PathBuf};

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

#[test]
fn modules_use_only_those_declared_before_them() {
    let src = Path::new(crate::ROOT).join("src");
    for package in ["engine", "files", "session"] {
        let root = fs::read_to_string(src.join(package).with_extension("rs")).unwrap();
        let modules: Vec<&str> = root
            .lines()
            .filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'))
            .collect();
        assert!(modules.len() > 1, "{package}: {root}");
        for (place, module) in modules.iter().enumerate() {
            let files = match src.join(module) {
                path if path.is_dir() => files_with("rs", &path),
                path => vec![path.with_extension("rs")],
            };
            for file in files {
                let text = fs::read_to_string(&file).unwrap();
                for line in text.lines().filter(|line| !line.trim_start().starts_with("//")) {
                    // From the package's root, or imported from there.
                    let uses = |later: &str| {
                        line.match_indices(&format!("{later}::")).any(|(at, _)| {
                            let before = &line[..at];
                            let is_path = before.ends_with(|c: char| c.is_alphanumeric() || "_:".contains(c));
                            !is_path || before.ends_with("crate::")
                        })
                    };
                    let later = modules[place + 1..].iter().find(|later| uses(later));
                    assert_eq!(later, None, "{}: {line}", file.display());
                }
            }
        }
    }
}

/// An operation on lanes in a function that was not compiled for their instructions is a call of this name, and ten times slower.
#[test]
fn nothing_falls_out_of_lanes() {
    let program = fs::read(crate::program()).unwrap();
    let program = String::from_utf8_lossy(&program);
    // As symbols of both manglings begin with the name's length, and the book in the program does not.
    let has_calls =
        ["22__fearless_simd_kernel", "22___fearless_simd_kernel"].map(|name| program.contains(name)) != [false; 2];
    assert!(
        !has_calls || cfg!(debug_assertions),
        "objdump -dC names what calls them"
    );
}
