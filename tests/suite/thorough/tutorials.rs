//! Tutorials of the book: each command is run by the program. A page that names what is not there any more fails.

use std::path::Path;

use glossmith::document::Denoise;
use serde_json::Value;

use super::{
    cli_support::{Workplace, write_hdr},
    docs::text_of,
    docs_commands::{arguments, commands},
    gltf_builder::{glb, square},
};

fn tutorial(name: &str) -> String {
    text_of(&Path::new("docs/tutorials").join(name))
}

#[test]
fn the_commands_of_your_model_under_your_light() {
    let place = Workplace::new();
    let (buffer, document) = square();
    place.write("chair.glb", &glb(&document, &buffer.bytes));
    write_hdr(&place.path("loft.hdr"), 8, 4, |_, _| [1.0; 3]);
    follow(
        &place,
        &tutorial("your-model.md"),
        &[("--engine", "cpu"), ("--size", "16x12"), ("--noise", "0.5")],
    );
    for file in ["chair.png", "chair.exr"] {
        assert!(place.path(file).exists(), "{file}");
    }
}

/// Runs the commands of a tutorial with values of options in place of its own, or added: small images, little time. The
/// answers in JSON.
fn follow(place: &Workplace, page: &str, small: &[(&str, &str)]) -> Vec<Value> {
    let mut answers = Vec::new();
    for command in commands(page) {
        let mut words = arguments(&command).split_off(1);
        for (option, value) in small {
            match words.iter().position(|word| word == option) {
                Some(at) => words[at + 1] = (*value).to_owned(),
                None if words[0] == "render" => words.extend([(*option).to_owned(), (*value).to_owned()]),
                None => {}
            }
        }
        let run = place.done(&words.join(" "));
        answers.extend(serde_json::from_str::<Value>(&run.stdout).ok());
    }
    answers
}

#[test]
fn the_commands_of_the_geometric_lobe() {
    let place = Workplace::new();
    follow(&place, &tutorial("geometric-lobe.md"), &[]);
    for file in ["samples.png", "polar.png"] {
        assert!(place.path(file).exists(), "{file}");
    }
}

#[test]
fn automate_it() {
    let page = tutorial("automate.md");
    let place = Workplace::new();
    // The calls of the Python blocks, as arguments.
    let calls = page
        .split("glossmith(\"")
        .skip(1)
        .filter_map(|rest| rest.split(')').next());
    let calls: Vec<String> = calls.map(|call| call.replace("\", \"", " ").replace('"', "")).collect();
    assert!(calls.len() >= 5, "{calls:?}");
    // As the window saves it.
    let mut scene = super::worker::small_document();
    scene.view.denoise = Denoise::Fast;
    place.save_document("scene.json", &scene);
    place.write(
        "scene.toml",
        b"materials = [\"gold\", \"chrome\"]\n[common]\nsize = \"16x16\"\nsamples = 2\nengine = \"cpu\"\n",
    );
    for call in calls {
        let run = place.done(&call);
        let says_so = run.stderr.contains("a part of the samples is not denoised");
        assert_eq!(says_so, call.contains("--samples-from"), "{call}: {}", run.stderr);
        let answers = call.starts_with("batch") || call.contains("--json");
        if !answers {
            continue;
        }
        let lines: Vec<Value> = match call.starts_with("batch") {
            true => run
                .stdout
                .lines()
                .map(|line| serde_json::from_str(line).unwrap())
                .collect(),
            false => vec![serde_json::from_str(&run.stdout).unwrap()],
        };
        let key = match call.split(' ').next() {
            Some("render") => "noise",
            Some("batch") => "status",
            Some("merge") => "samples_per_pixel",
            Some("plan") => "effects",
            _ => "materials",
        };
        let answer = if lines[0].is_array() { &lines[0][0] } else { &lines[0] };
        assert!(!answer[key].is_null(), "{call}: {answer}");
    }
    // The batch of the page, without the files that are the reader's own.
    let batch = page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next());
    let mut batch = batch.expect("a batch").to_owned();
    for (own, instead) in [
        (r#", { name = "chair", model = "chair.glb", variant = "red" }"#, ""),
        (r#""mine.json", "#, ""),
        (r#", "loft.hdr""#, ""),
        ("frames = 36 ", "frames = 1 "),
        ("samples = 64", "samples = 1"),
        ("640x480", "16x12"),
    ] {
        assert!(batch.contains(own), "{own} in {batch}");
        batch = batch.replace(own, instead);
    }
    place.write("page.toml", batch);
    let run = place.done("batch page.toml --pictures 1-1");
    assert!(run.stdout.contains("rendered"), "{}", run.stdout);
}
