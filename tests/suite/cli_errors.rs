//! What a user can get wrong, from the command line: one clear line, the right exit code, no panic.

use crate::cli_support::Workplace;
use crate::gltf_builder::{glb, square};

const QUICK: &str = "render --engine cpu --size 4x4 --samples 1 --output p.png";

#[test]
fn bad_models_are_refused() {
    let place = Workplace::new();
    let (buffer, mut document) = square();
    let whole = glb(&document, &buffer.bytes);
    place.write("cut.glb", &whole[..whole.len() * 2 / 3]);
    place.write("text.glb", b"This is a shopping list: milk, bread, two lemons.\n");
    place.write("empty.glb", b"");
    document["extensionsRequired"] = serde_json::json!(["ACME_mesh"]);
    document["extensionsUsed"] = document["extensionsRequired"].clone();
    document["scenes"] = serde_json::json!([{"nodes": []}]);
    place.write("acme.glb", &glb(&document, &buffer.bytes));
    for (file, words) in [
        ("cut.glb", ["cut short", "download the file again"]),
        ("text.glb", ["not a glTF 2.0 file", "export the model as .glb"]),
        ("empty.glb", ["not a glTF 2.0 file", "export the model as .glb"]),
        ("acme.glb", ["ACME_mesh", "not supported"]),
        ("missing.glb", ["cannot read", "check the path"]),
    ] {
        place.refused(1, &format!("{QUICK} --model {file}"), &[file, words[0], words[1]]);
        // The same where the window would open it.
        place.refused(1, &format!("--engine cpu {file}"), &[file, words[0], words[1]]);
    }
    assert!(!place.path("p.png").exists(), "a picture of nothing was written");
}

#[test]
fn bad_materials_are_refused() {
    let place = Workplace::new();
    place.write("broken.json", b"{\"glossmith\": 1, \"material\": ");
    place.write(
        "rough.json",
        b"{\"glossmith\": 1, \"material\": {\"specular.roughness\": 7}}",
    );
    place.write("other.json", b"{\"colour\": \"blue\"}");
    for (material, words) in [
        ("broken.json", ["not valid JSON", "save the file again"]),
        ("rough.json", ["specular.roughness does not take 7", "from 0 to 1"]),
        ("other.json", ["not a Glossmith material", "choose a file"]),
        ("missing.json", ["cannot be read", "check the path"]),
        ("unobtainium", ["no material is called", "porcelain"]),
        (
            "lacquered-walnuts",
            ["no material is called", "did you mean lacquered-walnut?"],
        ),
    ] {
        place.refused(
            1,
            &format!("{QUICK} --model sphere --material {material}"),
            &[material, words[0], words[1]],
        );
    }
}

#[test]
fn places_that_cannot_be_written_are_refused_before_the_work() {
    let place = Workplace::new();
    place.write("file", b"");
    // A billion samples: only an early refusal ends this test.
    let long = "render --engine cpu --model sphere --samples 1000000000";
    for output in ["nowhere/p.png", "file/p.exr"] {
        place.refused(
            1,
            &format!("{long} --output {output}"),
            &[output, "cannot be written", "check the folder"],
        );
    }
    place.refused(
        1,
        &format!("{long} --report nowhere/r.json"),
        &["nowhere/r.json", "check the folder"],
    );
    std::fs::create_dir(place.path("folder.png")).unwrap();
    place.refused(
        1,
        &format!("{long} --output folder.png"),
        &["folder.png", "cannot be saved", "a directory"],
    );
    place.refused(
        1,
        "scatter --lobe ggx --output nowhere/s.csv",
        &["nowhere/s.csv", "check the folder"],
    );
}

#[test]
fn words_that_are_no_commands_are_refused() {
    let place = Workplace::new();
    for (arguments, near) in [
        ("race", "`glossmith study accuracy`"),
        ("export gold a.glb", "`glossmith convert`"),
        ("rendr a.glb", "`glossmith render`"),
        ("--engine cpu Turntabel", "`glossmith turntable`"),
        ("convergence", "`glossmith study convergence`"),
    ] {
        place.refused(2, arguments, &["no such command", near]);
    }
    place.refused(1, "manual race", &["race", "`glossmith study accuracy`"]);
    std::fs::create_dir(place.path("race")).unwrap();
    place.refused(1, "race", &["race", "no model"]);
}

#[test]
fn hard_cases_of_no_such_name_are_refused() {
    let place = Workplace::new();
    place.refused(
        2,
        "check --hard --only nosuchcase",
        &["nosuchcase", "white-box-lambert"],
    );
    place.refused(2, "check --hard --only fresnl", &["did you mean fresnel-"]);
    let run = place.done("check --hard --engine cpu --only fresnel-grazing");
    assert!(run.stdout.contains("limit 2.5e-7"), "{}", run.stdout);
}

#[test]
fn wrong_arguments_are_refused() {
    let place = Workplace::new();
    place.refused(1, "render nowhere.json", &["nowhere.json", "check the path"]);
    // No wrong argument, but more than this machine has memory for.
    place.refused(1, "render --size 65535x65535", &["memory", "smaller"]);
    for (arguments, words) in [
        ("--output p.jpg", ["p.jpg", ".png, .exr or .hdr"]),
        ("--output picture", ["picture", ".png, .exr or .hdr"]),
        (
            "--set specular.roughnes=0.3",
            ["specular.roughnes", "did you mean specular.roughness"],
        ),
        ("--set specular.roughness=1.5", ["specular.roughness", "from 0 to 1"]),
        ("--set specular.roughness=nan", ["specular.roughness", "from 0 to 1"]),
        ("--set specular.roughness=", ["specular.roughness", "from 0 to 1"]),
        ("--set specular.lobe=gloss", ["specular.lobe", "geometric"]),
        ("--set base.color=reddish", ["base.color", "#rrggbb"]),
        ("--set roughness", ["--set", "KEY=VALUE"]),
        ("--size 0x0", ["--size", "640x480"]),
        ("--size 640", ["--size", "640x480"]),
        ("--size 70000x10", ["--size", "640x480"]),
        ("--samples 0", ["--samples", "1"]),
        ("--time nan", ["--time", "0.001"]),
        ("--time -3", ["--time", "0.001"]),
        ("--noise 0", ["--noise", "0.00001 to 1"]),
        ("--noise nan", ["--noise", "0.00001 to 1"]),
        ("--noise 2%", ["--noise", "0.00001 to 1"]),
        ("--min-samples 1", ["--min-samples", "2"]),
        ("--adaptive maybe", ["--adaptive", "on or off, or auto"]),
        ("--bounces 65", ["--bounces", "64"]),
        ("--fov nan", ["--fov", "0.1 to 170"]),
        ("--fov 180", ["--fov", "0.1 to 170"]),
        ("--exposure inf", ["--exposure", "-32 to 32"]),
        ("--environment-strength -1", ["--environment-strength", "from 0"]),
        (
            "--environment-rotation nan",
            ["--environment-rotation", "-3600 to 3600"],
        ),
        ("--camera-orbit nan,0", ["--camera-orbit", "give a number"]),
        ("--camera-orbit 10", ["--camera-orbit", "2 numbers"]),
        ("--camera-orbit 0,91", ["--camera-orbit", "-90 to 90"]),
        ("--camera-target 0,0,inf", ["--camera-target", "three numbers"]),
        ("--camera-position 1,2", ["--camera-position", "three numbers"]),
        ("--camera-distance 0", ["--camera-distance", "give a number"]),
        (
            "--camera-position 1,2,3 --camera-orbit 1,2",
            ["--camera-orbit", "--camera-position"],
        ),
        ("--area-light 1,2,3,4,5", ["--area-light", "6 numbers"]),
        ("--area-light 1,2,3,4,5,-6", ["--area-light", "from 0 to 1000000"]),
        ("--area-light 1,2,0,4,5,6", ["--area-light", "from 0.001 to 1000"]),
        ("--area-light 1,2,3,4,5,6,red", ["--area-light", "triangle"]),
        ("--area-light 1,2,3,4,5,6,#ff", ["--area-light", "#rrggbb"]),
        ("--area-light 1,2,3,4,5,6,100K", ["--area-light", "from 2000 to 20000"]),
        ("--background plaid", ["--background", "transparent"]),
        ("--filter tent", ["--filter", "gaussian"]),
        ("--tone-map gamma", ["--tone-map", "agx"]),
        ("--sequence halton", ["--sequence", "sobol"]),
        ("--engine abacus", ["--engine", "auto, gpu, cpu"]),
        ("--seed -1", ["--seed", "-1"]),
        ("--ground=perhaps", ["--ground", "on or off"]),
        (
            "--camera-position 1,2,3 --camera-distance 2",
            ["--camera-position", "--camera-distance"],
        ),
        ("--firefly-clamp 0", ["--firefly-clamp", "or off"]),
    ] {
        place.refused(2, &format!("render {arguments}"), &words);
    }
    for (arguments, words) in [
        ("--lobe gloss --output s.csv", ["--lobe", "geometric"]),
        ("--lobe ggx --output s.txt", ["s.txt", ".csv or .png"]),
        (
            "--lobe geometric --curve custom --output s.csv",
            ["--curve", "named curve"],
        ),
        ("--lobe geometric --curve round --output s.csv", ["--curve", "smooth"]),
        (
            "--lobe ggx --roughness nan --output s.csv",
            ["--roughness", "from 0 to 1"],
        ),
        (
            "--lobe ggx --roughness -0.1 --output s.csv",
            ["--roughness", "from 0 to 1"],
        ),
        (
            "--lobe ggx --view-angle 91 --output s.csv",
            ["--view-angle", "from 0 to 90"],
        ),
        ("--lobe ggx --count 0 --output s.csv", ["--count", "1"]),
        ("--lobe ggx --horizon bounce --output s.csv", ["--horizon", "absorb"]),
    ] {
        place.refused(2, &format!("scatter {arguments}"), &words);
    }
    place.refused(2, "paint", &["paint", "no such command", "--help"]);
    place.write("notes.txt", b"milk, bread");
    place.refused(1, "--engine cpu notes.txt", &["notes.txt", ".glb"]);
}
