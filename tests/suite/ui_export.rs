//! Files for other programs, made and opened in the window.

use crate::{cli_support::Workplace, ui::Editor, ui::editor};
use egui::accesskit::Role;
use egui_kittest::kittest::Queryable as _;
use glossmith::{
    app::actions::{Action, Command},
    store::PRESETS,
    store::preset::material_text,
};

/// Chooses *Export…* and types a path.
fn ask_for(harness: &mut Editor, path: &std::path::Path) {
    harness.command(Command::Export);
    harness.type_path(path, "Save");
}

#[test]
fn what_an_export_loses_is_shown_before_it_is_written() {
    let folder = Workplace::new();
    let mut harness = editor();
    harness.request(Action::UseMaterial(Box::new(PRESETS[0].clone())));
    harness.run_steps(2);
    let material = harness.material().clone();
    let path = folder.path("out.mtlx");
    ask_for(&mut harness, &path);
    assert!(harness.has("Export format"), "the sheet is there before the balls");
    harness.see_label("Write the file");
    harness.check_accessibility();
    assert!(!path.exists(), "it was written before anybody agreed");
    for words in ["approximated", "Difference", "As the file shows it"] {
        assert!(harness.tells(words), "{words}");
    }
    assert!(harness.tells("two balls differ"));
    harness.click(Role::Button, "Cancel");
    harness.run_steps(3);
    assert!(harness.query_by_label("Write the file").is_none() && !path.exists());
    ask_for(&mut harness, &path);
    harness.see_label("Write the file");
    harness.click(Role::Button, "Write the file");
    harness.wait("the file", |app| {
        app.messages().iter().any(|text| text.contains("Exported"))
    });
    // It comes back as it was.
    harness.request(Action::UseMaterial(Box::new(PRESETS[5].clone())));
    harness.run_steps(2);
    harness.request(Action::Open(path.clone()));
    let text = material_text(std::path::Path::new(""), &material);
    harness.wait("the material", |app| {
        material_text(std::path::Path::new(""), &app.document().materials[0]) == text
    });
    // The exact parameters are those of the command line.
    let place = crate::cli_support::Workplace::new();
    place.done(&format!("convert {} back.json", path.display()));
    let back = place.material("back.json");
    assert_eq!(material_text(std::path::Path::new(""), &back), text);
}
