//! What a user can get wrong, from the command line: one clear line, the right exit code, no panic.

use crate::cli_support::Workplace;

const QUICK: &str = "render --engine cpu --size 4x4 --samples 1 --output p.png";

#[test]
fn bad_models_are_refused() {
    let place = Workplace::new();
    place.write("text.glb", b"This is a shopping list: milk, bread, two lemons.\n");
    for (file, words) in [
        ("text.glb", ["not a glTF 2.0 file", "export the model as .glb"]),
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
    for (material, words) in [
        ("broken.json", ["not valid JSON", "save the file again"]),
        ("rough.json", ["specular.roughness does not take 7", "from 0 to 1"]),
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
        ("--set base.color=reddish", ["base.color", "#rrggbb"]),
        ("--set roughness", ["--set", "KEY=VALUE"]),
        ("--size 0x0", ["--size", "640x480"]),
        ("--samples 0", ["--samples", "1"]),
        ("--noise 0", ["--noise", "0.00001 to 1"]),
        ("--adaptive maybe", ["--adaptive", "on or off, or auto"]),
        ("--fov 180", ["--fov", "0.1 to 170"]),
        ("--camera-orbit 0,91", ["--camera-orbit", "-90 to 90"]),
        (
            "--camera-position 1,2,3 --camera-orbit 1,2",
            ["--camera-orbit", "--camera-position"],
        ),
        ("--area-light 1,2,3,4,5", ["--area-light", "6 numbers"]),
        ("--area-light 1,2,3,4,5,-6", ["--area-light", "from 0 to 1000000"]),
        ("--area-light 1,2,3,4,5,6,red", ["--area-light", "triangle"]),
        ("--area-light 1,2,3,4,5,6,100K", ["--area-light", "from 2000 to 20000"]),
        ("--background plaid", ["--background", "transparent"]),
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
        (
            "--lobe ggx --roughness nan --output s.csv",
            ["--roughness", "from 0 to 1"],
        ),
        ("--lobe ggx --count 0 --output s.csv", ["--count", "1"]),
    ] {
        place.refused(2, &format!("scatter {arguments}"), &words);
    }
    place.refused(2, "paint", &["paint", "no such command", "--help"]);
    place.write("notes.txt", b"milk, bread");
    place.refused(1, "render --texture coat=notes.txt", &["notes.txt", "can't be had"]);
    place.refused(1, "--engine cpu notes.txt", &["notes.txt", ".glb"]);
}
