//! What was saved is rendered by the command line: projects, pictures with their document inside, with options on top.

use glossmith::{
    document::{Background, Document, MaterialSettings, SETTINGS},
    scene::ModelSource,
    store::save_material,
};

use crate::cli_support::{Picture, Workplace};

/// A document that differs from the default one in every part, quick to render.
fn saved() -> Document {
    let mut document = Document {
        model: ModelSource::Sphere,
        materials: vec![MaterialSettings::diffuse("red", [0.8, 0.1, 0.1])],
        ground: true,
        ..Document::default()
    };
    document.lighting.background = Background::Color([0.1, 0.5, 0.2]);
    document.lighting.strength = 2.0;
    (document.camera.yaw_deg, document.camera.pitch_deg) = (100.0, 35.0);
    document.camera.fov_deg = 50.0;
    let render = &mut document.render;
    (render.width, render.height, render.samples, render.seed) = (20, 12, 3, 7);
    document
}

fn rendered(place: &Workplace, arguments: &str) -> Picture {
    place.done(&format!("render --engine cpu --output a.exr {arguments}"));
    crate::cli_support::read_exr(&place.path("a.exr"))
}

#[test]
fn every_command_answers_in_json_on_standard_output() {
    let place = Workplace::new();
    let scene = "--engine cpu --model sphere --size 8x8 --samples 2";
    place.done(&format!("render {scene} --keep-sums --output a.exr"));
    for (command, key) in [
        (format!("render {scene} --output b.png"), "files"),
        (format!("turntable {scene} --frames 2 --output turn"), "files"),
        (format!("plan {scene}"), "effects"),
        (format!("explain {scene} --pixel 4,4"), "pixel"),
        ("merge a.exr --output c.exr".to_owned(), "samples_per_pixel"),
        (
            "scatter --lobe ggx --engine cpu --count 9 --output s.csv".to_owned(),
            "samples",
        ),
        ("lobe --plot polar --material gold --output l.csv".to_owned(), "lobes"),
        ("fit --target ggx:0.3 --output f.json".to_owned(), "after"),
        (format!("study convergence {scene} --quick"), "points"),
        (format!("study ledger {scene} --quick"), "entries"),
        (
            format!("study accuracy {scene} --quick --technique strategy=lobe --noise 0.5"),
            "runners",
        ),
    ] {
        let run = place.done(&format!("{command} --json -"));
        let answer: serde_json::Value =
            serde_json::from_str(&run.stdout).unwrap_or_else(|error| panic!("{command}: {error}\n{}", run.stdout));
        assert!(!answer[key].is_null(), "{command}: {answer}");
    }
    let run = place.done("convert gold gold.mtlx --json -");
    let losses: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(losses[0]["materials"][0]["material"], "Gold");
    // The same to a file, beside the words.
    let run = place.done(&format!("plan {scene} --json plan.json"));
    assert!(run.stdout.contains("features active"));
    assert!(place.read("plan.json").contains("\"effects\""));
}

#[test]
fn a_project_is_rendered_as_it_was_saved_and_options_stand_over_it() {
    let place = Workplace::new();
    place.save_document("saved.json", &saved());
    let by_file = rendered(&place, "saved.json");
    assert_eq!((by_file.width, by_file.height), (20, 12));
    // The same by options alone.
    save_material(&place.path("red.json"), &saved().materials[0]).unwrap();
    let by_options = rendered(
        &place,
        "--model sphere --material red.json --ground --background 0.1,0.5,0.2 --environment-strength 2 \
         --camera-orbit 100,35 --fov 50 --size 20x12 --samples 3 --seed 7",
    );
    assert_eq!(by_file.pixels, by_options.pixels);
    let other = rendered(&place, "saved.json --fov 20 --ground=off");
    assert!(by_file.difference(&other) > 0.1, "{}", by_file.difference(&other));
    let again = rendered(&place, "saved.json --size 10x6");
    assert_eq!((again.width, again.height), (10, 6));
    // What is not given stays: a limit of time lets samples go on, another seed does not.
    place.done("render saved.json --engine cpu --output a.exr --seed 3 --report r.json");
    let report: serde_json::Value = place.json("r.json");
    assert_eq!((&report["seed"], &report["samples_per_pixel"]), (&3.into(), &3.into()));
}

/// Every setting with a flag has its option, with the table's default, and the option sets it.
#[test]
fn options_are_the_table_of_settings() {
    let place = Workplace::new();
    let help = place.done("render --help").stdout;
    for setting in SETTINGS.iter() {
        let Some(flag) = setting.flag else { continue };
        let default = setting.text(&setting.default_value());
        let at = [" ", "[="]
            .iter()
            .find_map(|end| help.find(&format!("--{flag}{end}")))
            .unwrap_or_else(|| panic!("--{flag} is missing"));
        let text: String = help[at..].split_whitespace().collect::<Vec<_>>().join(" ");
        let until = text[2..].find(" --").map_or(text.len(), |end| end + 2);
        assert!(
            text[..until].contains(&format!("[default: {default}]")),
            "{}: {}",
            setting.key,
            &text[..until]
        );
    }
}
