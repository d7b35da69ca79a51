//! What the user is told about a file that was opened, and the pictures that follow from what is chosen of it.

use std::time::{Duration, Instant};

use egui::accesskit::Role;
use egui_kittest::kittest::Queryable as _;
use glossmith::app::actions::{Action, Command};
use glossmith::scene::ModelSource;
use serde_json::{Value, json};

use super::{
    cli_support::Workplace,
    gltf_builder::{Buffer, glb, square},
    ui::editor,
};

/// A square in two variants, one with a texture that is not there.
fn variants() -> (Buffer, Value) {
    let (buffer, mut document) = square();
    document["images"] = json!([{"uri": "gone.png", "name": "bark"}]);
    document["textures"] = json!([{"source": 0}]);
    document["materials"] = json!([
        {"name": "Day", "doubleSided": true, "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}},
        {"name": "Night", "doubleSided": true, "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0.5, 1], "metallicFactor": 0}},
    ]);
    let primitive = &mut document["meshes"][0]["primitives"][0];
    primitive["material"] = json!(0);
    let mapping = json!([{"material": 1, "variants": [0]}]);
    primitive["extensions"] = json!({"KHR_materials_variants": {"mappings": mapping}});
    document["extensions"] = json!({"KHR_materials_variants": {"variants": [{"name": "night"}]}});
    (buffer, document)
}

#[test]
fn the_command_line_tells_one_line_and_writes_the_rest() {
    let place = Workplace::new();
    let (buffer, document) = variants();
    place.write("tree.glb", glb(&document, &buffer.bytes));
    let render = "render --engine cpu --size 8x8 --samples 1 --output a.exr --model tree.glb --import-report told.json";
    let run = place.done(render);
    let told: Vec<&str> = run.stderr.lines().filter(|line| line.contains("tree.glb")).collect();
    assert_eq!(told.len(), 1, "{}", run.stderr);
    assert!(told[0].contains("1 missing") && told[0].contains("bark"), "{told:?}");
    let report: Value = place.json("told.json");
    let entries = report["entries"].as_array().unwrap();
    let missing: Vec<&Value> = entries.iter().filter(|entry| entry["fate"] == "missing").collect();
    assert_eq!(
        (missing.len(), &missing[0]["names"], &missing[0]["count"]),
        (1, &json!(["bark"]), &json!(1))
    );
    let triangles = entries
        .iter()
        .find(|entry| entry["what"] == "triangles")
        .expect("counted");
    assert_eq!((&triangles["count"], &triangles["fate"]), (&json!(2), &json!("used")));
    assert_eq!(report["variants"], json!(["night"]));
    // The variant has no such texture.
    let run = place.done(&format!("{render} --variant night"));
    assert!(!run.stderr.contains("tree.glb"), "{}", run.stderr);
    place.refused(
        1,
        &format!("{render} --variant nigth"),
        &["--variant nigth", "it has night"],
    );
    place.refused(1, &format!("{render} --scene 7"), &["--scene 7", "0 to 0"]);
    place.refused(2, "render --model tree.glb --time-of-pose -1", &["-1"]);
}

#[test]
fn the_sheet_tells_what_became_of_the_file_and_changes_the_variant() {
    let folder = Workplace::new();
    let path = folder.path("tree.glb");
    let (buffer, document) = variants();
    std::fs::write(&path, glb(&document, &buffer.bytes)).unwrap();
    let mut harness = editor();
    harness.request(Action::Open(path.clone()));
    harness.wait("the model", |app| {
        app.document().model == ModelSource::File(path.clone())
    });
    harness.command(Command::ModelFile);
    harness.see_label("missing");
    let named = harness.query_all_by_label_contains("bark").count();
    assert!(named > 0, "the texture is named");
    harness.tap(Role::ComboBox, "Variant");
    harness.get_by_role_and_label(Role::Button, "night").click_accesskit();
    // Another material has other rows: nothing else is clicked meanwhile.
    let begun = Instant::now();
    while harness.document().import.variant.as_deref() != Some("night") {
        assert!(begun.elapsed() < Duration::from_secs(120), "the variant does not come");
        harness.step();
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(harness.material().name, "Night");
}
