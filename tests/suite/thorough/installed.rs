//! `make install` and `make uninstall`: what lands where, and that nothing is left.

use crate::cli_support::Workplace;
use std::{path::Path, path::PathBuf, process::Command, process::Output};

const ROOT: &str = crate::ROOT;

fn script(prefix: &Path, binary: &str, arguments: &[&str]) -> Output {
    Command::new(Path::new(ROOT).join("scripts/install"))
        .args(arguments)
        .env("PREFIX", prefix)
        .env("BINARY", binary)
        .output()
        .expect("a shell")
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    let paths = entries.flatten().map(|entry| entry.path());
    paths
        .flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] })
        .collect()
}

#[test]
fn it_is_installed_for_the_user_and_taken_away_again() {
    let home = Workplace::new();
    let prefix = home.path("with a space");
    let output = script(&prefix, crate::program(), &[]);
    assert!(output.status.success(), "{output:?}");
    let program = prefix.join("bin/glossmith");
    let version = Command::new(&program)
        .arg("--version")
        .output()
        .expect("it is installed");
    assert!(
        String::from_utf8_lossy(&version.stdout).starts_with("glossmith "),
        "{version:?}"
    );
    let entry = std::fs::read_to_string(prefix.join("share/applications/glossmith.desktop")).expect("a menu entry");
    assert!(
        entry.contains(&format!("Exec=\"{}\" %F\n", program.display())),
        "{entry}"
    );
    assert!(prefix.join("share/icons/hicolor/256x256/apps/glossmith.png").is_file());
    // Every kind of file that the entry opens is known by its ending.
    let kinds = std::fs::read_to_string(prefix.join("share/mime/packages/glossmith.xml")).expect("kinds of files");
    let opened = entry
        .lines()
        .find_map(|line| line.strip_prefix("MimeType="))
        .expect("kinds of files");
    let opened: Vec<_> = opened.split(';').filter(|kind| !kind.is_empty()).collect();
    assert!(opened.len() > 5);
    for kind in opened {
        assert!(kinds.contains(&format!("type=\"{kind}\"")), "{kind} is not declared");
    }
    for ending in glossmith::import::endings::MODELS
        .iter()
        .filter(|ending| !ending.ends_with("zip"))
    {
        let ending = ending.trim_start_matches('.');
        assert!(
            kinds.contains(&format!("\"*.{ending}\"")),
            "models that end in {ending} do not open"
        );
    }
    let about = std::fs::read_to_string(prefix.join("share/metainfo/glossmith.metainfo.xml")).expect("a description");
    let about = roxmltree::Document::parse(&about).expect("XML");
    let release = about.descendants().find(|node| node.has_tag_name("release"));
    let version = release.and_then(|release| release.attribute("version"));
    assert_eq!(version, Some(env!("CARGO_PKG_VERSION")), "what software centres show");
    let output = script(&prefix, "none", &["--remove"]);
    assert!(output.status.success(), "{output:?}");
    let left: Vec<_> = files(&prefix)
        .into_iter()
        .filter(|path| path.to_string_lossy().contains("glossmith"))
        .collect();
    assert!(left.is_empty(), "{left:?}");
}

/// Not built here, which needs flatpak-builder and its runtime: that every crate of the lock file is there to build from,
/// and that what is renamed is what is installed.
#[test]
fn a_flatpak_has_all_that_it_is_built_from_without_a_network() {
    let home = Workplace::new();
    let index = home.path("registry/index/some");
    std::fs::create_dir_all(&index).expect("a folder");
    let config = r#"{"dl": "https://crates.example/{prefix}/{crate}/{version}"}"#;
    std::fs::write(index.join("config.json"), config).expect("a file");
    let output = Command::new("python3")
        .arg(Path::new(ROOT).join("scripts/flatpak"))
        .arg("--output")
        .arg(home.root())
        .env("CARGO_HOME", home.root())
        .output()
        .expect("python3");
    assert!(output.status.success(), "{output:?}");
    let text = std::fs::read_to_string(home.path("io.github.glossmith.Glossmith.json")).expect("a manifest");
    let manifest: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let sources = manifest["modules"][0]["sources"].as_array().expect("sources");
    let lock = std::fs::read_to_string(Path::new(ROOT).join("Cargo.lock")).expect("the lock file");
    let checksums: Vec<&str> = lock
        .lines()
        .filter_map(|line| line.strip_prefix("checksum = "))
        .collect();
    assert!(checksums.len() > 300);
    for checksum in checksums {
        let checksum = checksum.trim_matches('"');
        let is_it = |source: &&serde_json::Value| source["sha256"] == checksum;
        let source = sources.iter().find(is_it).expect("a crate of the lock file");
        let address = source["url"].as_str().expect("where it is");
        assert!(
            address.starts_with("https://crates.example/") && !address.contains('{'),
            "{address}"
        );
    }
    let config = sources.last().expect("cargo's configuration");
    assert!(
        config["contents"]
            .as_str()
            .is_some_and(|text| text.contains("replace-with = \"vendored\""))
    );
    let prefix = home.path("installed");
    assert!(script(&prefix, crate::program(), &[]).status.success());
    for kind in ["desktop-file", "mime-file", "icon", "appdata-file"] {
        let renamed = manifest[format!("rename-{kind}")].as_str().expect("a name");
        let is_installed =
            |path: &PathBuf| path.file_stem().is_some_and(|stem| stem == renamed) || path.ends_with(renamed);
        assert!(files(&prefix).iter().any(is_installed), "{renamed} is not installed");
    }
}

#[test]
fn without_a_program_it_says_what_to_build() {
    let home = Workplace::new();
    let output = script(home.root(), "not/there", &[]);
    assert_eq!(output.status.code(), Some(1));
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(
        told.contains("not/there") && told.contains("cargo build --release"),
        "{told}"
    );
    assert!(files(home.root()).is_empty());
}
