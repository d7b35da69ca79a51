//! What pictures carry besides their colours: the document in a .png, layers in an .exr; and turntables.

use std::collections::HashMap;

use glossmith::store::{opened, opened::Opened, picture::load_picture_document};
use serde_json::Value;

use crate::cli_support::{Workplace, channels};

const SIZE: usize = 33;

/// A coloured Lambertian sphere of radius 1 seen from 5 along +Z, 33 × 33 pixels, nothing behind it.
fn layers(place: &Workplace, engine: &str) -> HashMap<String, Vec<f32>> {
    place.done(&format!(
        "render --model sphere --environment studio --background transparent --size {SIZE}x{SIZE} --samples 8 --engine {engine} --camera-orbit 0,0 \
         --camera-distance 5 --fov 30 --filter box --set specular.weight=0 --set base.metalness=0 \
         --set base.color=0.5,0.25,0.125 --aovs --output {engine}.exr"
    ));
    channels(&place.path(format!("{engine}.exr")))
}

#[test]
fn what_is_behind_lights_nothing() {
    let place = Workplace::new();
    let middle = |background: &str| {
        place
            .picture(&format!("--model sphere --background {background}"))
            .at(12, 12)
    };
    assert_eq!(middle("#336699"), middle("environment"));
}

#[test]
fn layers_hold_the_spheres_depth_normals_and_albedo() {
    let place = Workplace::new();
    let layers = layers(&place, "cpu");
    let mut names: Vec<_> = layers.keys().map(String::as_str).collect();
    names.sort_unstable();
    let expected = "A B G R albedo.B albedo.G albedo.R depth.Z normal.X normal.Y normal.Z samples.Y variance.Y";
    assert_eq!(names.join(" "), expected);
    let at = |name: &str, x: usize, y: usize| layers[name][y * SIZE + x];
    let half_px = (15.0_f64).to_radians().tan() / (0.5 * SIZE as f64);
    let mut seen = 0;
    for y in 0..SIZE {
        for x in 0..SIZE {
            // The ray through the pixel's middle, from (0, 0, 5) along −Z, and where it meets the sphere.
            let [across, up] = [(x as f64 - 16.0) * half_px, (16.0 - y as f64) * half_px];
            let square = across * across + up * up;
            let discriminant = 25.0 - 24.0 * (1.0 + square);
            let radius = square.sqrt() / (1.0_f64 / 24.0).sqrt();
            if radius > 1.1 {
                assert_eq!(at("depth.Z", x, y), f32::INFINITY);
                assert_eq!(
                    [at("normal.X", x, y), at("normal.Z", x, y), at("albedo.R", x, y)],
                    [0.0; 3]
                );
            }
            // Towards the edge the mean over the pixel bends away from its middle.
            if radius > 0.7 {
                continue;
            }
            seen += 1;
            let depth = (5.0 - discriminant.sqrt()) / (1.0 + square);
            let normal = [across * depth, up * depth, 5.0 - depth];
            let found = ["normal.X", "normal.Y", "normal.Z"].map(|name| f64::from(at(name, x, y)));
            near!(f64::from(at("depth.Z", x, y)), depth, 0.01);
            for (found, expected) in std::iter::zip(found, normal) {
                near!(found, expected, 0.02, "{found} is not {expected} at {x}, {y}");
            }
            let albedo = ["albedo.R", "albedo.G", "albedo.B"].map(|name| at(name, x, y));
            for (found, expected) in std::iter::zip(albedo, [0.5, 0.25, 0.125]) {
                near!(found, expected, 0.0001, "{albedo:?} at {x}, {y}");
            }
        }
    }
    assert!(seen > 200, "{seen} pixels were compared");
    assert!(layers["samples.Y"].iter().all(|samples| *samples == 8.0));
}

#[test]
fn a_png_brings_its_document_back() {
    let place = Workplace::new();
    place.done(
        "render --model sphere --environment sky --environment-rotation 40 --material gold --set specular.roughness=0.15 \
         --camera-orbit 20,30 --exposure 0.5 --size 24x16 --samples 2 --engine cpu --output a.png --output a.exr",
    );
    let loaded = load_picture_document(&place.path("a.png")).unwrap();
    assert!(loaded.warnings.is_empty());
    let document = loaded.value;
    assert_eq!(
        (document.materials[0].name.as_str(), document.materials[0].roughness),
        ("Gold", 0.15)
    );
    assert_eq!((document.camera.yaw_deg, document.camera.pitch_deg), (20.0, 30.0));
    assert_eq!((document.lighting.rotation_deg, document.view.exposure_ev), (40.0, 0.5));
    assert_eq!(
        (document.render.width, document.render.height, document.render.samples),
        (24, 16, 2)
    );
    assert!(matches!(opened::open(&place.path("a.png")).unwrap(), Opened::Picture(opened) if opened.value == document));
}

#[test]
fn a_turntable_is_numbered_frames_of_a_turn() {
    let place = Workplace::new();
    place.done(
        "turntable --frames 4 --turn camera --output turn --report report.json --model shaderball --size 24x24 --samples 8 \
         --camera-orbit 30,20 --environment furnace --engine cpu",
    );
    let mut names: Vec<_> = std::fs::read_dir(place.path("turn"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort_unstable();
    assert_eq!(
        names,
        ["frame-0001.png", "frame-0002.png", "frame-0003.png", "frame-0004.png"]
    );
    let yaws: Vec<f64> = names
        .iter()
        .map(|name| {
            load_picture_document(&place.path("turn").join(name))
                .unwrap()
                .value
                .camera
                .yaw_deg
        })
        .collect();
    assert_eq!(yaws, [30.0, 120.0, -150.0, -60.0]);
    let report: Value = place.json("report.json");
    assert_eq!(
        (&report["frames"], &report["turn"], &report["engine"]),
        (&4.into(), &"camera".into(), &"cpu".into())
    );
    // Frame 1 is what `render` makes of the same arguments.
    place.done(
        "render --model shaderball --size 24x24 --samples 8 --camera-orbit 30,20 --environment furnace --engine cpu \
         --output same.png",
    );
    let pixels = |name: &str| image::open(place.path(name)).unwrap().into_rgba8();
    assert_eq!(pixels("turn/frame-0001.png"), pixels("same.png"));
    assert_ne!(pixels("turn/frame-0002.png"), pixels("same.png"));
}

#[test]
fn a_turntable_is_a_video_where_that_is_asked_for() {
    let place = Workplace::new();
    let scene = "--frames 3 --size 24x16 --samples 1 --environment furnace --engine cpu";
    place.done(&format!(
        "turntable {scene} --video turn.gif --fps 10 --report report.json"
    ));
    assert!(!place.path("turntable").exists(), "pictures were not asked for");
    let report: Value = place.json("report.json");
    assert_eq!((&report["video"], &report["fps"]), (&"turn.gif".into(), &10.0.into()));
    assert_eq!(report["files"], serde_json::json!(["turn.gif"]));
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let file = std::fs::File::open(place.path("turn.gif")).unwrap();
    let mut video = options.read_info(file).unwrap();
    place.done(&format!("turntable {scene} --video turn.mp4 --output turn"));
    assert_eq!(&place.bytes("turn.mp4")[4..8], b"ftyp");
    for number in 1..=3 {
        // The pictures of the same turn, but for what 256 colours leave.
        let frame = video.read_next_frame().unwrap().unwrap();
        assert_eq!(frame.delay, 10, "hundredths of a second");
        let picture = image::open(place.path(format!("turn/frame-000{number}.png"))).unwrap();
        let pairs = std::iter::zip(&frame.buffer[..], picture.into_rgba8().into_raw());
        let error = pairs.map(|(a, b)| u64::from(a.abs_diff(b))).sum::<u64>() as f64 / frame.buffer.len() as f64;
        assert!(error < 2.0, "frame {number} is off by {error} codes");
    }
    place.refused(2, "turntable --video turn.avi", &["turn.avi", ".mp4 or .gif"]);
    place.refused(2, "turntable --video turn.mp4 --fps 0", &["--fps", "from 1 to 120"]);
    place.refused(
        1,
        &format!("turntable {scene} --video nowhere/turn.mp4"),
        &["nowhere/turn.mp4"],
    );
}
