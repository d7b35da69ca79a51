//! A panic leaves the unsaved document and a report, and the next start says so.

use std::{path::Path, path::PathBuf, process::Command, process::Stdio, time::Duration};

use egui::accesskit::Role;
use glossmith::app::{Options, actions::Command as Choice, report_panics};

use super::{
    cli_support::Workplace,
    nothing_lost::{edit, keeping_editor},
    ui::{editor_of, options},
};

/// The data folder of the child.
const DATA: &str = "GLOSSMITH_TEST_DATA";
/// Where the child panics: `window` or `thread`.
const PLACE: &str = "GLOSSMITH_TEST_PANICS_IN";
/// The roughness that is lost but for the panic's own copy.
const LOST: f32 = 0.43;

#[test]
#[ignore = "the child of the tests below: edits, and panics"]
fn edits_and_panics() {
    let data = PathBuf::from(std::env::var_os(DATA).expect("only the tests below start this"));
    report_panics();
    let mut harness = editor_of(Options {
        data: Some(data.clone()),
        autosave_interval: Some(Duration::from_secs(3600)),
        ..options()
    });
    harness.wait("an engine", |app| app.snapshot().engine.is_some());
    harness.command(Choice::ToggleTheme);
    // The first edit is put aside at once, the second one an hour later.
    edit(&mut harness, 0.9);
    harness.wait("the first copy", |_| holds_a_copy(&data));
    edit(&mut harness, LOST);
    if std::env::var(PLACE).as_deref() == Ok("window") {
        panic!("the window breaks on purpose");
    }
    let thread = std::thread::Builder::new().name("poor thing".to_owned());
    let thread = thread.spawn(|| panic!("a thread breaks on purpose")).expect("a thread");
    assert!(thread.join().is_err());
    harness.wait("the words", |app| {
        let is_told = |text: &String| text.contains("\"poor thing\": a thread breaks on purpose");
        app.messages().iter().any(is_told)
    });
    // The power goes: nothing is closed as it should be.
    std::process::abort();
}

/// Whether a document has been put aside.
fn holds_a_copy(data: &Path) -> bool {
    let entries = std::fs::read_dir(data.join("recovery")).into_iter().flatten();
    let mut paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    paths.any(|path| path.extension().is_some_and(|ending| ending == "json"))
}

/// Runs the child to its end.
fn crash(data: &Path, place: &str) {
    let status = Command::new(std::env::current_exe().expect("a path"))
        .args(["--ignored", "--exact", "crashed::edits_and_panics"])
        .env(DATA, data)
        .env(PLACE, place)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .expect("this very program");
    assert!(!status.success());
}

#[test]
fn a_panic_leaves_the_document_and_a_report_and_the_next_start_says_so() {
    for (place, message) in [
        ("window", "the window breaks on purpose"),
        ("thread", "a thread breaks on purpose"),
    ] {
        let folder = Workplace::new();
        crash(folder.root(), place);
        let mut harness = keeping_editor(folder.root());
        harness.see("the offer", |harness| harness.tells(message));
        harness.check_accessibility();
        harness.click(Role::Button, "Restore untitled");
        assert_eq!(harness.material().roughness, LOST, "{place}");
        let report = report(folder.root());
        for words in [
            message,
            "cpu on ",
            "Do(ToggleTheme)",
            "Specular roughness × 2",
            "crashed.rs",
            env!("CARGO_PKG_VERSION"),
        ] {
            assert!(report.contains(words), "{words} is not in the report:\n{report}");
        }
    }
}

/// The report in a data folder, which stays when the document has been restored.
fn report(data: &Path) -> String {
    let entries = std::fs::read_dir(data.join("recovery")).expect("it is there");
    let mut paths = entries.map(|entry| entry.expect("an entry").path());
    let path = paths.find(|path| path.extension().is_some_and(|ending| ending == "txt"));
    std::fs::read_to_string(path.expect("a report")).expect("text")
}
