//! `make install` and `make uninstall`: what lands where, and that nothing is left.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

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
    let home = tempfile::tempdir().expect("a temporary folder");
    let prefix = home.path().join("with a space");
    let output = script(&prefix, env!("CARGO_BIN_EXE_glossmith"), &[]);
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
    for ending in glossmith::scene::MODEL_ENDINGS
        .iter()
        .filter(|ending| !ending.ends_with("zip"))
    {
        let ending = ending.trim_start_matches('.');
        assert!(
            kinds.contains(&format!("\"*.{ending}\"")),
            "models that end in {ending} do not open"
        );
    }
    let output = script(&prefix, "none", &["--remove"]);
    assert!(output.status.success(), "{output:?}");
    let left: Vec<_> = files(&prefix)
        .into_iter()
        .filter(|path| path.to_string_lossy().contains("glossmith"))
        .collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn without_a_program_it_says_what_to_build() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let output = script(home.path(), "not/there", &[]);
    assert_eq!(output.status.code(), Some(1));
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(
        told.contains("not/there") && told.contains("cargo build --release"),
        "{told}"
    );
    assert!(files(home.path()).is_empty());
}
