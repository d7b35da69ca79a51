//! Material and project files: round trips, other versions, damage, saving.

use std::{fs, path::Path, path::PathBuf};

use glossmith::{
    document::{AreaLight, Background, Bookmark, Document, MaterialSettings, PARAMETERS},
    scene::ModelSource,
    scene::environment::EnvironmentSource,
    store::{FileError, opened, opened::Opened, preset, preset::PRESETS, preset::SHIPPED, project},
};
use proptest::prelude::*;
use serde_json::{Map, Value as Json, json};

use crate::{cli_support::Workplace, parameters::is_in_range};

#[test]
fn shipped_materials_are_in_the_format_that_is_saved() {
    assert!(PRESETS.len() >= 12);
    for (material, text) in PRESETS.iter().zip(SHIPPED.iter().flat_map(|(_, files)| *files)) {
        let loaded = preset::parse_material("x.json".as_ref(), text.as_bytes()).expect("valid");
        assert_eq!(loaded.warnings, Vec::<String>::new());
        let written = preset::material_text(std::path::Path::new(""), &loaded.value);
        assert_eq!(written, *text, "{}", material.name);
        let source = preset::source_of_values(&material.name).expect("a source");
        assert!(text.contains(source) && source.ends_with('.'), "{}", material.name);
        assert!(is_in_range(material), "{}", material.name);
        let name = preset::command_line_name(&material.name);
        assert_eq!(
            preset::material_by_name(&name).map(|found| &found.name),
            Some(&material.name)
        );
    }
}

#[test]
fn shipped_materials_are_found_by_name_and_files_by_path() {
    for name in [
        "GOLD",
        "brushed steel",
        "Brushed-Steel",
        "lambert_white",
        "chrome",
        "porcelain",
        "rubber",
    ] {
        assert_eq!(preset::find(name).expect(name).warnings, Vec::<String>::new());
    }
    assert!(preset::material_by_name("unobtainium").is_none());
    let error = preset::find("unobtainium").expect_err("no such material").to_string();
    assert!(
        error.contains("unobtainium") && error.contains("brushed-steel"),
        "{error}"
    );
    let error = preset::find("no/such.json").expect_err("no such file").to_string();
    assert!(error.starts_with("no/such.json: cannot be read"), "{error}");
    let folder = Workplace::new();
    let path = folder.path("mine");
    let mine = MaterialSettings {
        roughness: 0.77,
        ..MaterialSettings::default()
    };
    preset::save_material(&path, &mine).expect("saved");
    assert_eq!(preset::find(&path.to_string_lossy()).expect("found").value, mine);
}

#[test]
fn material_files_keep_what_is_unknown_and_warn() {
    let text = json!({
        "glossmith": 1,
        "name": "odd",
        "author": {"name": "someone"},
        "material": {"specular.roughnes": 0.5, "specular.roughness": 0.25, "flakes.size": [1, 2]},
    });
    let loaded = preset::parse_material("a/b.json".as_ref(), text.to_string().as_bytes()).expect("valid");
    assert_eq!(loaded.value.roughness, 0.25);
    assert_eq!(loaded.warnings.len(), 2);
    assert!(
        loaded.warnings[0].starts_with("a/b.json: specular.roughnes is no parameter"),
        "{:?}",
        loaded.warnings
    );
    assert!(
        loaded.warnings[0].ends_with("did you mean specular.roughness?"),
        "{:?}",
        loaded.warnings
    );
    let saved: Json =
        serde_json::from_str(&preset::material_text(std::path::Path::new(""), &loaded.value)).expect("JSON");
    assert_eq!(saved["author"], text["author"]);
    assert_eq!(saved["material"]["flakes.size"], text["material"]["flakes.size"]);
    assert_eq!(saved["material"]["specular.roughnes"], json!(0.5));
    assert_eq!(saved["material"]["specular.lobe"], json!("geometric"));
}

#[test]
fn material_files_of_other_versions() {
    let parse = |text: &str| preset::parse_material("m.json".as_ref(), text.as_bytes());
    let old =
        parse(r#"{"name": "old", "roughness": 0.5, "base.color": [1, 0, 0], "note": "kept"}"#).expect("version 0");
    assert_eq!((old.value.roughness, old.value.base_color), (0.5, [1.0, 0.0, 0.0]));
    assert_eq!(old.value.file_extra.get("note"), Some(&json!("kept")));
    let old = parse(r#"{"material": {"specular.roughness": 0.5}}"#).expect("version 0");
    assert_eq!(old.value.roughness, 0.5);
    // "color" could be meant for three parameters: not guessed.
    let old = parse(r#"{"roughness": 0.5, "color": [1, 0, 0]}"#).expect("version 0");
    assert_eq!(old.value.base_color, MaterialSettings::default().base_color);
    let new = parse(r#"{"glossmith": 7, "material": {"specular.roughness": 0.5}}"#).expect("a newer version");
    assert_eq!(new.value.roughness, 0.5);
    assert!(
        new.warnings.len() == 1 && new.warnings[0].contains("newer"),
        "{:?}",
        new.warnings
    );
}

#[test]
fn broken_material_files_are_named_with_a_remedy() {
    let cases: [(&[u8], &str); 10] = [
        (b"", "not valid JSON"),
        (b"{\"glossmith\": 1, \"material\": {", "not valid JSON"),
        (b"\xff\xfe\x00", "not valid JSON"),
        (b"[1]", "not valid JSON"),
        (b"{}", "not a Glossmith material"),
        (b"{\"asset\": {\"version\": \"2.0\"}}", "not a Glossmith material"),
        (b"{\"glossmith\": \"one\", \"material\": {}}", "whole number"),
        (b"{\"glossmith\": 1, \"name\": 3, \"material\": {}}", "must be text"),
        (b"{\"glossmith\": 1, \"material\": []}", "must be an object"),
        (
            b"{\"glossmith\": 1, \"material\": {\"base.color\": [0.5, 2, 0]}}",
            "base.color does not take 0.5,2,0; give",
        ),
    ];
    for (bytes, part) in cases {
        let error = preset::parse_material("dir/m.json".as_ref(), bytes)
            .expect_err(part)
            .to_string();
        assert!(error.starts_with("dir/m.json: ") && error.contains(part), "{error}");
    }
    let deep = "[".repeat(100_000);
    assert!(preset::parse_material("m.json".as_ref(), deep.as_bytes()).is_err());
}

#[test]
fn saving_replaces_a_file_at_once_and_leaves_nothing_beside_it() {
    let folder = Workplace::new();
    let path = folder.path("m.json");
    let gold = preset::material_by_name("gold").expect("shipped");
    preset::save_material(&path, gold).expect("saved");
    preset::save_material(&path, &PRESETS[0]).expect("saved over");
    assert_eq!(preset::load_material(&path).expect("read").value, PRESETS[0]);
    assert_eq!(fs::read_dir(folder.root()).expect("listed").count(), 1);

    // Who has opened the file before keeps seeing the whole old contents: the file is replaced, not written over.
    let old = fs::File::open(&path).expect("opened");
    preset::save_material(&path, gold).expect("saved again");
    let old_text = std::io::read_to_string(old).expect("still whole");
    assert_eq!(old_text, preset::material_text(std::path::Path::new(""), &PRESETS[0]));

    // Where saving fails, nothing is left behind.
    let blocked = folder.path("folder.json");
    fs::create_dir_all(blocked.join("full")).expect("a folder in the way");
    let error = preset::save_material(&blocked, gold).expect_err("a folder cannot be replaced");
    assert!(matches!(error, FileError::Write { .. }), "{error}");
    assert_eq!(
        fs::read_dir(folder.root()).expect("listed").count(),
        2,
        "no temporary file is left"
    );
    assert!(preset::save_material(&folder.path("missing/m.json"), gold).is_err());
    assert!(preset::save_material(Path::new("/"), gold).is_err());
    // A file of a program that was killed, which had the same number.
    fs::write(
        folder.path(format!(".m.json.{}-0.glossmith-part", std::process::id())),
        "",
    )
    .expect("written");
    preset::save_material(&path, gold).expect("saved beside it");
}

#[cfg(unix)]
#[test]
fn saving_follows_links_and_keeps_permissions() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = Workplace::new();
    let (path, link) = (folder.path("m.json"), folder.path("link.json"));
    preset::save_material(&path, &PRESETS[0]).expect("saved");
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).expect("set");
    symlink(&path, &link).expect("a link");
    preset::save_material(&link, &PRESETS[1]).expect("saved through the link");
    assert!(fs::symlink_metadata(&link).expect("there").is_symlink());
    assert_eq!(preset::load_material(&path).expect("read").value, PRESETS[1]);
    assert_eq!(fs::metadata(&path).expect("there").permissions().mode() & 0o777, 0o640);
}

/// A document with files, lights, a bookmark and numbers that are not round.
fn unusual_document(folder: &Path) -> Document {
    let mut document = Document {
        model: ModelSource::File(folder.join("models/teapot")),
        ground: true,
        materials: vec![PRESETS[3].clone(), PRESETS[10].clone()],
        ..Document::default()
    };
    document.lighting.environment = EnvironmentSource::File(PathBuf::from("/elsewhere/sky.hdr"));
    document.lighting.rotation_deg = 12.3;
    document.lighting.background = Background::Color([0.1, 0.2, 0.3]);
    document.lighting.area_lights = vec![AreaLight::default(), AreaLight::spot()];
    document.camera.target = Some([0.1, -2.0, 0.001]);
    document.camera.distance = Some(3.3);
    document.bookmarks = vec![Bookmark {
        name: "Side".to_owned(),
        camera: document.camera,
    }];
    document
}

#[test]
fn documents_survive_their_files() {
    let folder = Workplace::new();
    let path = folder.path("p.json");
    for document in [Document::default(), unusual_document(folder.root())] {
        project::save_document(&path, &document).expect("saved");
        let loaded = project::load_document(&path).expect("read");
        assert_eq!(loaded.value, document);
        assert_eq!(loaded.warnings, Vec::<String>::new());
    }
    let text = fs::read_to_string(&path).expect("read");
    assert!(
        text.contains("\"model\": \"models/teapot\"") && text.contains("\"/elsewhere/sky.hdr\""),
        "{text}"
    );
    assert!(
        text.contains("12.3,"),
        "an f32 has no more digits than it needs: {text}"
    );
    // The folder can be moved.
    let moved = project::parse_document("/moved/p.json".as_ref(), text.as_bytes())
        .expect("read")
        .value;
    assert_eq!(moved.model, ModelSource::File(PathBuf::from("/moved/models/teapot")));
    // A file called like a built-in model stays a file.
    let model = folder.model("teapot");
    project::save_document(
        &path,
        &Document {
            model,
            ..Document::default()
        },
    )
    .expect("saved");
    let loaded = project::load_document(&path).expect("read").value.model;
    assert!(
        matches!(&loaded, ModelSource::File(file) if file.is_absolute() && file.ends_with("teapot")),
        "{loaded}"
    );
}

#[test]
fn documents_keep_what_is_unknown() {
    let text = json!({
        "glossmith-document": 2,
        "light tree": [1, 2],
        "camera": {"fov_deg": 40.0, "shutter": {"open_s": 0.5}},
        "materials": [{"name": "a", "material": {"sheen.weight": 1}, "by": "x"}],
    });
    let loaded = project::parse_document("p.json".as_ref(), text.to_string().as_bytes()).expect("valid");
    assert_eq!(loaded.value.camera.fov_deg, 40.0);
    assert_eq!(loaded.value.materials.len(), 1);
    let warnings = &loaded.warnings;
    assert!(
        warnings[0].contains("newer") && warnings[1].contains("sheen.weight"),
        "{warnings:?}"
    );
    let saved = project::document_text("p.json".as_ref(), &loaded.value).expect("saved");
    let saved: Json = serde_json::from_str(&saved).expect("JSON");
    assert_eq!(saved["light tree"], text["light tree"]);
    assert_eq!(saved["camera"]["shutter"], text["camera"]["shutter"]);
    assert_eq!(saved["materials"][0]["material"]["sheen.weight"], json!(1));
    assert_eq!(saved["materials"][0]["by"], json!("x"));
    assert_eq!(saved["glossmith-document"], json!(1));
}

#[test]
fn broken_documents_are_named_with_the_part_that_is_wrong() {
    for (json, part) in [
        ("{}", "not a Glossmith project"),
        (r#"{"glossmith": 1, "material": {}}"#, "not a Glossmith project"),
        (
            r#"{"glossmith-document": 1, "render": {"width": 0}}"#,
            "render.width does not take 0",
        ),
        (r#"{"glossmith-document": 1, "render": {"width": -4}}"#, "\"render\": "),
        (
            r#"{"glossmith-document": 1, "render": {"bounces": 65}}"#,
            "from 1 to 64",
        ),
        (
            r#"{"glossmith-document": 1, "camera": {"fov_deg": "wide"}}"#,
            "\"camera\": ",
        ),
        (
            r#"{"glossmith-document": 1, "camera": {"fov_deg": 180}}"#,
            "camera.fov does not take 180",
        ),
        (
            r#"{"glossmith-document": 1, "view": {"tone_map": "sepia"}}"#,
            "pbr-neutral",
        ),
        (
            r#"{"glossmith-document": 1, "lighting": {"strength": -1}}"#,
            "lighting.strength does not take -1",
        ),
        (
            r#"{"glossmith-document": 1, "materials": [{"material": {"specular.roughness": 2}}]}"#,
            "specular.roughness does not take 2",
        ),
    ] {
        let error = project::parse_document("d/p.json".as_ref(), json.as_bytes())
            .expect_err(part)
            .to_string();
        assert!(error.starts_with("d/p.json: ") && error.contains(part), "{error}");
    }
}

#[test]
fn either_kind_of_file_is_told_from_the_other() {
    let folder = Workplace::new();
    let path = folder.path("x.json");
    project::save_document(&path, &Document::default()).expect("saved");
    assert!(matches!(opened::open(&path), Ok(Opened::Document(_))));
    preset::save_material(&path, &PRESETS[0]).expect("saved");
    assert!(matches!(opened::open(&path), Ok(Opened::Material(_))));
    fs::write(&path, vec![b' '; (16 << 20) + 1]).expect("written");
    assert!(matches!(opened::open(&path), Err(FileError::TooLarge { .. })));
}

fn any_json() -> impl Strategy<Value = Json> {
    let name = prop_oneof![Just("geometric"), Just("gold"), Just("custom"), Just("sky"), Just("")];
    let leaf = prop_oneof![
        Just(Json::Null),
        any::<bool>().prop_map(Json::from),
        any::<f64>().prop_map(Json::from),
        (0.0..2.0).prop_map(|x: f64| Json::from(x)),
        any::<i64>().prop_map(Json::from),
        name.prop_map(Json::from),
    ];
    leaf.prop_recursive(3, 24, 4, |inner| {
        let list = prop::collection::vec(inner.clone(), 0..5).prop_map(Json::from);
        let triple = prop::collection::vec(inner, 3).prop_map(Json::from);
        prop_oneof![list, triple]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_files_are_an_error_or_a_material_in_range(
        file in any::<prop::sample::Index>(),
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..8_u8), 1..5),
    ) {
        let (_, group) = file.get(SHIPPED);
        let mut bytes = file.get(group).as_bytes().to_vec();
        for (place, byte, edit) in edits {
            let place = place.index(bytes.len());
            match edit {
                0 => bytes.truncate(place.max(1)),
                1 => bytes[place] = byte,
                _ => bytes.insert(place, b"0123456789-.e"[usize::from(byte) % 13]),
            }
        }
        if let Ok(loaded) = preset::parse_material("m.json".as_ref(), &bytes) {
            prop_assert!(is_in_range(&loaded.value));
        }
    }

    #[test]
    fn any_value_under_any_key_is_an_error_or_in_range(index in any::<prop::sample::Index>(), value in any_json()) {
        let parameter = index.get(&PARAMETERS);
        let mut values = Map::new();
        values.insert(parameter.key.to_owned(), value.clone());
        let text = json!({"glossmith": 1, "material": values}).to_string();
        match preset::parse_material("m.json".as_ref(), text.as_bytes()) {
            Ok(loaded) => prop_assert!(is_in_range(&loaded.value), "{}", value),
            Err(error) => prop_assert!(error.to_string().contains(parameter.key), "{}", error),
        }
    }

    #[test]
    fn any_value_in_a_document_is_an_error_or_in_range(part in 0..8_usize, key in 0..10_usize, value in any_json()) {
        let part = ["model", "ground", "materials", "lighting", "camera", "view", "render", "bookmarks"][part];
        let key = [
            "strength", "rotation_deg", "background", "fov_deg", "position", "exposure_ev", "width", "time_s", "seed",
            "area_lights",
        ][key];
        for inner in [value.clone(), json!({ key: value }), json!([{ "camera": { key: value } }])] {
            let text = json!({"glossmith-document": 1, part: inner}).to_string();
            if let Ok(loaded) = project::parse_document("p.json".as_ref(), text.as_bytes()) {
                prop_assert!(loaded.value.check().is_ok());
                prop_assert!(loaded.value.materials.iter().all(is_in_range));
            }
        }
    }
}
