//! Files, headings, options and keys that the pages of the book name exist.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use glossmith::app::book::anchor;
use glossmith::document::{PARAMETERS, SETTINGS};

use super::docs_tables::written;

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
fn files_that_the_pages_link_to_exist() {
    for page in pages() {
        let folder = page.parent().unwrap();
        for link in text_of(&page)
            .split("](")
            .skip(1)
            .filter_map(|rest| rest.split(')').next())
        {
            let is_local = !link.contains("://") && !link.starts_with('#');
            let target = root().join(folder).join(link.split('#').next().unwrap_or_default());
            assert!(
                !is_local || target.exists(),
                "{} refers to {link}, which is not there",
                page.display()
            );
        }
    }
}

#[test]
fn headings_that_the_pages_link_to_exist() {
    for page in pages() {
        let text = text_of(&page);
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let Some((file, wanted)) = link.split_once('#').filter(|_| !link.contains("://")) else {
                continue;
            };
            let target = if file.is_empty() {
                page.clone()
            } else {
                page.parent().unwrap().join(file)
            };
            let text = text_of(&target);
            let headings = text.lines().filter(|line| line.starts_with('#'));
            let is_there = headings
                .map(|line| anchor(line.trim_start_matches('#').trim()))
                .any(|found| found == wanted);
            assert!(
                is_there,
                "{} refers to {link}, which has no such heading",
                page.display()
            );
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

#[test]
fn keys_that_the_pages_name_exist() {
    let groups = [
        "base.",
        "specular.",
        "coat.",
        "fuzz.",
        "thin_film.",
        "transmission.",
        "emission.",
        "geometry.",
        "lighting.",
        "scene.",
        "camera.",
        "view.",
        "render.",
    ];
    let materials = PARAMETERS.iter().map(|parameter| parameter.key);
    let known: BTreeSet<&str> = materials.chain(SETTINGS.iter().map(|setting| setting.key)).collect();
    for page in pages() {
        for name in written(&text_of(&page)).split('`').skip(1).step_by(2) {
            let key = name.split('=').next().unwrap_or_default();
            let is_key = groups.iter().any(|group| key.starts_with(group))
                && key.chars().all(|c| c.is_ascii_lowercase() || c == '_' || c == '.');
            let is_file = [".exr", ".json", ".md", ".rs", ".png", ".toml"]
                .iter()
                .any(|ending| key.ends_with(ending));
            let is_map = key.split('.').nth(1).is_some_and(|part| part.ends_with("_map"));
            assert!(
                !is_key || is_file || is_map || known.contains(key),
                "{} names the key {key}, which is not there",
                page.display()
            );
        }
    }
}
