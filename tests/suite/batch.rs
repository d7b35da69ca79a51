//! Batches: all combinations of lists as pictures, whole or in parts, and what happens when something goes wrong.

use crate::cli_support::{Run, Workplace};
use glossmith::store::PRESETS;
use serde_json::Value as Json;
use std::{collections::HashMap, io::BufRead as _, io::BufReader, process::Command, process::Stdio};

const SMALL: &str = "\n[common]\nsize = \"16x16\"\nsamples = 4\nmodel = \"sphere\"\n";

/// The lines of standard output.
fn lines(run: &Run) -> Vec<Json> {
    let line = |line: &str| serde_json::from_str(line).unwrap();
    run.stdout.lines().map(line).collect()
}

/// What became of each picture, by its name.
fn outcomes(run: &Run) -> HashMap<String, String> {
    let text = |row: &Json, key: &str| row[key].as_str().unwrap().to_owned();
    let rows = lines(run);
    rows.iter()
        .map(|row| (text(row, "picture"), text(row, "status")))
        .collect()
}

fn bytes(place: &Workplace, name: &str) -> Vec<u8> {
    std::fs::read(place.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

#[test]
fn all_combinations_are_rendered_once() {
    let place = Workplace::new();
    let text = |samples: u32| {
        format!(
            "materials = [\"gold\", \"mine.json\"]\nformats = [\"png\", \"exr\"]\n\
             [[settings]]\nname = \"few\"\nsamples = 2\n[[settings]]\nname = \"more\"\nsamples = {samples}\n{SMALL}"
        )
    };
    glossmith::store::save_material(&place.path("mine.json"), &PRESETS[2]).unwrap();
    place.write("a.toml", text(3));
    let run = place.done("batch a.toml --engine cpu");
    let rows = lines(&run);
    let names: Vec<&str> = rows.iter().map(|row| row["picture"].as_str().unwrap()).collect();
    assert_eq!(names, ["gold-few", "gold-more", "mine-few", "mine-more"]);
    for (row, number) in rows.iter().zip(1..) {
        assert_eq!(row["status"], "rendered");
        assert_eq!(row["number"], number);
        assert_eq!(row["hash"].as_str().unwrap().len(), 32);
        for file in row["files"].as_array().unwrap() {
            assert!(place.path(file.as_str().unwrap()).is_file(), "{file}");
        }
    }
    assert_eq!(rows[1]["samples_per_pixel"], 3);
    // Nothing is rendered twice.
    let again = outcomes(&place.done("batch a.toml --engine cpu"));
    assert!(again.values().all(|status| status == "kept"), "{again:?}");
    // What one setting changes concerns its pictures alone.
    place.write("a.toml", text(4));
    let changed = outcomes(&place.done("batch a.toml --engine cpu"));
    assert_eq!(
        (changed["gold-few"].as_str(), changed["gold-more"].as_str()),
        ("kept", "rendered")
    );
    // So does another file behind the same name, or a picture that is gone.
    glossmith::store::save_material(&place.path("mine.json"), &PRESETS[3]).unwrap();
    std::fs::remove_file(place.path("pictures/gold-few.exr")).unwrap();
    let changed = outcomes(&place.done("batch a.toml --engine cpu --json told.json"));
    assert!(changed.is_empty(), "lines go to the file");
    let told = place.read("told.json");
    let rows: Vec<Json> = told.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let states: Vec<&str> = rows.iter().map(|row| row["status"].as_str().unwrap()).collect();
    assert_eq!(states, ["rendered", "kept", "rendered", "rendered"]);
    // The picture is the one of `glossmith render`.
    place.done("render --engine cpu --size 16x16 --samples 2 --model sphere --material gold --output one.exr");
    assert!(bytes(&place, "one.exr") == bytes(&place, "pictures/gold-few.exr"));
    let page = place.read("pictures/contact-sheet.html");
    assert!(!page.contains("://"), "the page needs no network");
    for name in names {
        assert!(page.contains(&format!("thumbnails/{name}.png")), "{page}");
    }
    let sheet = image::open(place.path("pictures/contact-sheet.png")).unwrap();
    assert!(sheet.width() > 4 * 190 && sheet.height() > 190);
}

#[test]
fn a_batch_that_was_killed_goes_on_where_it_was() {
    let place = Workplace::new();
    let text =
        format!("materials = [\"gold\", \"silver\", \"car-paint-red\"]\nframes = 2\nformats = [\"exr\"]\n{SMALL}");
    place.write("a.toml", text);
    place.done("batch a.toml --engine cpu --folder whole");
    let mut child = Command::new(crate::program())
        .args(["batch", "a.toml", "--engine", "cpu"])
        .current_dir(place.path(""))
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut first = String::new();
    BufReader::new(child.stdout.take().unwrap())
        .read_line(&mut first)
        .unwrap();
    child.kill().unwrap();
    child.wait().unwrap();
    // As a kill in the middle of writing leaves it; what another worker is writing is locked.
    let [left, held] = ["silver-0001.exr", "silver-0002.exr"].map(|name| {
        let name = format!("pictures/.{name}.1-0.glossmith-part");
        place.write(&name, b"half of a picture");
        place.path(&name)
    });
    let other = std::fs::OpenOptions::new().write(true).open(&held).unwrap();
    other.lock().unwrap();
    assert!(first.contains("gold-0001"), "{first}");
    assert!(
        !place.path("pictures/contact-sheet.png").exists(),
        "it was not in the middle"
    );
    let outcomes = outcomes(&place.done("batch a.toml --engine cpu"));
    assert_eq!(outcomes.len(), 6);
    assert_eq!(outcomes["gold-0001"], "kept");
    assert_eq!(outcomes["car-paint-red-0002"], "rendered");
    assert!(!left.exists() && held.exists());
    for name in outcomes.keys() {
        let [whole, resumed] = ["whole", "pictures"].map(|folder| bytes(&place, &format!("{folder}/{name}.exr")));
        assert!(whole == resumed, "{name}");
    }
}

#[test]
fn what_cannot_be_rendered_leaves_the_others_and_an_exit_code() {
    let place = Workplace::new();
    place.write("broken.json", b"{");
    place.write("a.toml", format!("materials = [\"gold\", \"broken.json\"]{SMALL}"));
    let run = place.run("batch a.toml --engine cpu");
    assert_eq!(run.code, Some(3), "{}", run.stderr);
    assert!(run.stderr.contains("1 of 2 images"), "{}", run.stderr);
    let rows = lines(&run);
    assert_eq!(
        (&rows[0]["status"], &rows[1]["status"]),
        (&"rendered".into(), &"failed".into())
    );
    assert!(rows[1]["error"].as_str().unwrap().contains("broken.json"));
    assert!(place.read("pictures/contact-sheet.html").contains("missing"));
    place.write("b.toml", format!("materials = [\"broken.json\"]{SMALL}"));
    let run = place.run("batch b.toml --engine cpu");
    assert_eq!(run.code, Some(1), "{}", run.stderr);
    place.refused(1, "batch none.toml", &["none.toml"]);
    place.refused(1, "batch a.toml --pictures 2-3", &["--pictures 2-3", "2 only"]);
    place.refused(1, "batch a.toml --frame-range 2", &["a.toml", "frames"]);
    place.refused(2, "batch a.toml --slice 3/2", &["2/5"]);
    place.write("d.toml", format!("materials = [\"gold\"]\nframes = 2{SMALL}"));
    place.refused(1, "batch d.toml --pictures 1 --frame-range 2", &["in common"]);
}

#[test]
fn what_is_wrong_in_a_batch_is_told_with_its_line() {
    let place = Workplace::new();
    for (text, line, words) in [
        ("materials = [", 1, "correct the TOML"),
        ("\n\nmaterial = []", 3, "materials"),
        ("materials = []", 1, "no list with entries"),
        ("materials = [\n\"gold\",\n\"gold\"]", 3, "another name"),
        ("[[settings]]\nname = \"a\"\n\nsampels = 4", 1, "--sampels"),
        ("[[settings]]\nname = \"a\"\nsamples = -4", 1, "-4"),
        ("[[settings]]\nsamples = 4", 1, "name"),
        ("[[cameras]]\nname = \"a\"\ncamera.fof = 4", 1, "camera.fof"),
        ("cameras = [\"a\"]", 1, "table"),
        ("frames = 0", 1, "1 to 9999"),
        ("frames = 2\nturn = \"all\"", 2, "`camera`, `model`"),
        ("materials = [\"gold\"]\nformats = [\"gif\"]", 2, "png, exr and hdr"),
    ] {
        place.write("a.toml", text);
        place.refused(1, "batch a.toml", &[&format!("a.toml, line {line}: "), words]);
    }
    place.write("a.toml", b"[common]\nsamples = 4");
    place.refused(1, "batch a.toml", &["nothing to render"]);
}
