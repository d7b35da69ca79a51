//! Files from strangers: what they may name, and what becomes of what they may not.

use glossmith::{document::Document, scene::ModelSource};
use serde_json::{Value as Json, json};

use super::{cli_support::Workplace, gltf_builder::glb, gltf_builder::png, textures::textured_square};

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl far\nf 1 2 3\n";
const FAR: &[u8] = b"newmtl far\nKd 0.125 0.25 0.5\n";
const QUICK: &str = "--engine cpu --size 8x8 --samples 1 --output a.exr";

/// A folder with a model two folders down.
fn place(library: &str) -> Workplace {
    let place = Workplace::new();
    std::fs::create_dir_all(place.path("a/b")).unwrap();
    place.write("a/b/m.obj", format!("mtllib {library}\n{TRIANGLE}"));
    place.write("far.mtl", FAR);
    place.write("a/near.mtl", FAR);
    place
}

/// The entries of the import's report with this fate.
fn entries(place: &Workplace, arguments: &str, fate: &str) -> String {
    place.done(&format!(
        "render a/b/m.obj {QUICK} --import-report report.json {arguments}"
    ));
    let report: Json = place.json("report.json");
    let entries = report["entries"].as_array().unwrap();
    let of_fate: Vec<&Json> = entries.iter().filter(|entry| entry["fate"] == fate).collect();
    json!(of_fate).to_string()
}

#[test]
fn a_model_reads_its_surroundings_and_more_where_that_is_allowed() {
    let near = place("../near.mtl");
    assert_eq!(entries(&near, "", "missing"), "[]");
    assert!(!entries(&near, "", "used").contains("files from outside"));
    let far = place("../../far.mtl");
    let absolute = place("far.mtl");
    let library = absolute.path("far.mtl");
    absolute.write(
        "a/b/m.obj",
        format!("mtllib {}\n{TRIANGLE}", library.display()).as_bytes(),
    );
    for place in [far, absolute] {
        let missing = entries(&place, "", "missing");
        assert!(
            missing.contains("outside") && missing.contains("--allow-outside"),
            "{missing}"
        );
        assert_eq!(entries(&place, "--allow-outside", "missing"), "[]");
        let used = entries(&place, "--allow-outside", "used");
        assert!(used.contains("files from outside"), "{used}");
    }
}

/// A file that was exported must not carry what a stranger's model had read.
#[test]
fn what_lies_elsewhere_is_not_in_an_export() {
    let place = place("../near.mtl");
    place.write("far.png", png());
    let material = json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    let (buffer, mut document) = textured_square(&material, &[], &json!({}));
    document["images"] = json!([{"uri": "../../far.png"}]);
    document["textures"] = json!([{"source": 0}]);
    place.write("a/b/m.glb", glb(&document, &buffer.bytes));
    // The pictures of the export, decoded.
    let pictures = |options: &str| -> Vec<image::RgbaImage> {
        place.done(&format!("convert a/b/m.glb out.gltf {options}"));
        let json: Json = place.json("out.gltf");
        let binary = place.bytes("out.bin");
        let images = json["images"].as_array().into_iter().flatten();
        let decoded = images.map(|entry| {
            let view = &json["bufferViews"][entry["bufferView"].as_u64().unwrap() as usize];
            let from = view["byteOffset"].as_u64().unwrap_or(0) as usize;
            let bytes = &binary[from..][..view["byteLength"].as_u64().unwrap() as usize];
            image::load_from_memory(bytes).unwrap().to_rgba8()
        });
        decoded.collect()
    };
    assert!(pictures("").is_empty());
    let allowed = pictures("--allow-outside");
    assert_eq!(allowed.len(), 1);
    assert_eq!(allowed[0].get_pixel(0, 0).0, [10, 20, 30, 255]);
}

#[cfg(unix)]
#[test]
fn devices_and_pipes_are_told_and_not_waited_for() {
    let place = place("pipe.mtl");
    let pipe = place.path("a/b/pipe.mtl");
    assert!(
        std::process::Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    let missing = entries(&place, "", "missing");
    assert!(missing.contains("no regular file"), "{missing}");
    std::fs::remove_file(&pipe).unwrap();
    std::os::unix::fs::symlink("/dev/zero", &pipe).unwrap();
    let missing = entries(&place, "--allow-outside", "missing");
    assert!(missing.contains("no regular file"), "{missing}");
    for (name, text, why) in [
        (
            "p.json",
            json!({"glossmith-document": 1, "model": "/dev/zero"}),
            "no regular file",
        ),
        (
            "q.json",
            json!({"glossmith-document": 1, "lighting": {"environment": {"file": "/dev/zero"}}}),
            // Of environments the ending says what they are, before they are opened.
            "neither a .hdr",
        ),
    ] {
        place.write(name, text.to_string());
        place.refused(
            1,
            &format!("render {name} {QUICK} --allow-outside"),
            &["/dev/zero", why],
        );
    }
}

#[test]
fn a_project_names_what_its_maker_may_read() {
    let place = place("../near.mtl");
    let model = place.path("far.obj");
    std::fs::copy(place.path("a/b/m.obj"), &model).unwrap();
    let render = |name: &str| format!("render a/b/{name} {QUICK}");
    let document = Document {
        model: ModelSource::File(model.clone()),
        ..Document::default()
    };
    // The user's own.
    place.save_document("a/b/own.json", &document);
    place.done(&render("own.json"));
    // From elsewhere: without the mark, or with one that was made for other names.
    let mut text: Json = place.json("a/b/own.json");
    assert_eq!(text["saved-by"].as_str().map(str::len), Some(32));
    std::fs::copy(&model, place.path("other.obj")).unwrap();
    text["model"] = json!(place.path("other.obj"));
    place.write("a/b/forged.json", text.to_string());
    text["model"] = json!("../../far.obj");
    place.write("a/b/upwards.json", text.to_string());
    for name in ["forged.json", "upwards.json"] {
        place.refused(
            1,
            &render(name),
            &[name, "outside of its surroundings", ".obj", "--allow-outside"],
        );
        place.done(&format!("{} --allow-outside", render(name)));
    }
    // What stays in its folder has no mark: the file is the same whoever saves it.
    let inside = Document {
        model: place.model("a/b/m.obj"),
        ..Document::default()
    };
    place.save_document("a/b/inside.json", &inside);
    assert!(!place.read("a/b/inside.json").contains("saved-by"));
    place.done(&render("inside.json"));
}
