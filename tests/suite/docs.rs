//! Files and headings that the pages of the book name exist.

use std::path::{Path, PathBuf};

use glossmith::app::book::anchor;

pub fn root() -> &'static Path {
    Path::new(crate::ROOT)
}

/// The pages: README, contributing, changelog, and the book in `docs`. Paths are relative to the root.
pub fn pages() -> Vec<PathBuf> {
    let mut found: Vec<PathBuf> = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"]
        .map(PathBuf::from)
        .into();
    let mut folders = vec![PathBuf::from("docs")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(root().join(&folder)).unwrap() {
            let entry = entry.unwrap();
            let path = folder.join(entry.file_name());
            if entry.file_type().unwrap().is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "md") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// The text of a page.
pub fn text_of(page: &Path) -> String {
    std::fs::read_to_string(root().join(page)).unwrap()
}

#[test]
fn files_and_headings_that_the_pages_link_to_exist() {
    for page in pages() {
        let text = text_of(&page);
        let links = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
        for link in links.filter(|link| !link.contains("://")) {
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            let target = if file.is_empty() {
                page.clone()
            } else {
                page.parent().unwrap().join(file)
            };
            let is_there = root().join(&target).exists()
                && (heading.is_empty() || {
                    let text = text_of(&target);
                    let mut headings = text.lines().filter(|line| line.starts_with('#'));
                    headings.any(|line| anchor(line.trim_start_matches('#').trim()) == heading)
                });
            assert!(is_there, "{} refers to {link}, which is not there", page.display());
        }
    }
}

#[test]
fn each_page_is_in_the_book_or_for_contributors() {
    let summary = text_of(Path::new("docs/SUMMARY.md"));
    let contributing = text_of(Path::new("CONTRIBUTING.md"));
    for page in pages() {
        let Ok(path) = page.strip_prefix("docs") else { continue };
        let path = path.display().to_string().replace('\\', "/");
        assert!(
            path == "SUMMARY.md"
                || summary.contains(&format!("({path})"))
                || contributing.contains(&format!("(docs/{path})")),
            "neither docs/SUMMARY.md nor CONTRIBUTING.md names {path}"
        );
    }
}
