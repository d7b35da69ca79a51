//! `glossmith render`: every option, by what it does to the picture.

use std::collections::HashSet;

use exr::meta::MetaData;
use exr::meta::attribute::SampleType;
use glossmith::document::PARAMETERS;
use glossmith::optics::tone::ToneCurve;
use glossmith::store::{PRESETS, preset::command_line_name};
use serde_json::Value;

use crate::cli_support::{Picture, Workplace, channels, read_exr, write_exr, write_hdr};
use crate::gltf_builder::{glb, square};

/// The sRGB colour #336699, linear.
const BLUE: [f32; 3] = [0.033_104_77, 0.132_868_33, 0.318_546_78];

fn assert_near(found: &[f32], expected: &[f32], tolerance: f32) {
    for (x, y) in found.iter().zip(expected) {
        assert!(
            (x - y).abs() <= tolerance * y.abs().max(1.0),
            "{found:?} is not {expected:?}"
        );
    }
}

#[test]
fn pictures_have_their_size_and_linear_values() {
    let place = Workplace::new();
    // Exposure and tone curve must only show in the PNG.
    place.done(
        "render --model sphere --environment furnace --environment-strength 2 --size 40x24 --samples 2 --engine cpu \
         --exposure 3 --tone-map aces --output a.png --output a.exr --output a.hdr",
    );
    let exr = read_exr(&place.path("a.exr"));
    assert_eq!((exr.width, exr.height), (40, 24));
    assert_near(&exr.at(0, 0), &[2.0, 2.0, 2.0, 1.0], 1e-6);
    let meta = MetaData::read_from_file(place.path("a.exr"), true).unwrap();
    let channels = &meta.headers[0].channels.list;
    assert_eq!(channels.len(), 4);
    assert!(channels.iter().all(|channel| channel.sample_type == SampleType::F32));
    let hdr = image::open(place.path("a.hdr")).unwrap().into_rgb32f();
    assert_eq!(hdr.dimensions(), (40, 24));
    assert_near(&hdr.get_pixel(0, 0).0, &[2.0; 3], 1e-6);
    let png = image::open(place.path("a.png")).unwrap();
    assert_eq!((png.width(), png.height()), (40, 24));
    assert_eq!(png.color(), image::ColorType::Rgba8);
}

#[test]
fn backgrounds_are_seen_as_asked_for() {
    let place = Workplace::new();
    let render = |background: &str| {
        place.done(&format!(
            "render --model sphere --environment furnace --size 16x16 --samples 4 --engine cpu --tone-map none \
             --background {background} --output b.png --output b.exr"
        ));
        let png = image::open(place.path("b.png")).unwrap().into_rgba8();
        (png, read_exr(&place.path("b.exr")))
    };
    let (png, exr) = render("#336699");
    assert_eq!(png.get_pixel(0, 0).0, [0x33, 0x66, 0x99, 0xff]);
    assert_near(&exr.at(0, 0)[..3], &BLUE, 1e-5);
    let (png, exr) = render("transparent");
    assert_eq!(png.get_pixel(0, 0).0[3], 0);
    assert_eq!(exr.at(0, 0), [0.0; 4]);
    assert_eq!(png.get_pixel(8, 8).0[3], 255);
    let (_, exr) = render("environment");
    assert_near(&exr.at(0, 0), &[1.0; 4], 1e-6);
}

#[test]
fn the_report_has_its_keys_and_their_types() {
    let place = Workplace::new();
    let report = place.report("--model sphere --seed 7 --size 20x10 --samples 3");
    let object = report.as_object().unwrap();
    let keys: Vec<_> = object.keys().map(String::as_str).collect();
    let expected = [
        "version",
        "engine",
        "adapter",
        "driver",
        "traversal",
        "width",
        "height",
        "samples_per_pixel",
        "mean_samples_per_pixel",
        "noise",
        "noise_low",
        "noise_high",
        "converged",
        "stopped_by",
        "setup_seconds",
        "render_seconds",
        "samples_per_second",
        "rays",
        "rays_per_second",
        "dropped_samples",
        "clamped_energy",
        "cut_energy",
        "effects",
        "seed",
        "denoised",
        "denoise_seconds",
        "denoised_error",
        "denoised_error_low",
        "denoised_error_high",
        "files",
    ];
    assert_eq!(keys, expected);
    assert_eq!(report["files"].as_array().map(Vec::len), Some(1), "the picture");
    assert_eq!(report["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(report["engine"], "cpu");
    assert!(!report["adapter"].as_str().unwrap().is_empty());
    assert!(report["driver"].is_string());
    let whole = |key: &str| report[key].as_u64().unwrap();
    assert_eq!(
        ["width", "height", "samples_per_pixel", "dropped_samples", "seed"].map(whole),
        [20, 10, 3, 0, 7]
    );
    let number = |key: &str| report[key].as_f64().unwrap();
    assert!(number("setup_seconds") > 0.0 && number("render_seconds") > 0.0);
    assert!(whole("rays") >= 600, "at least a ray a sample");
    let (seconds, near) = (number("render_seconds"), |a: f64, b: f64| (a / b - 1.0).abs() < 1e-6);
    assert!(near(number("samples_per_second"), 600.0 / seconds));
    assert!(near(number("rays_per_second"), number("rays") / seconds));
    let effects = report["effects"].as_array().unwrap();
    assert!(effects.iter().all(Value::is_string) && !effects.is_empty());
}

/// `--noise` ends the render at that error, with samples where they help; without it the report still tells the error.
#[test]
fn noise_ends_the_render_and_is_reported() {
    let place = Workplace::new();
    let arguments = "--model teapot --environment studio --size 32x32 --samples 100000";
    let report = place.report(&format!("{arguments} --noise 0.05"));
    assert_eq!(
        (&report["stopped_by"], &report["converged"]),
        (&"noise".into(), &true.into())
    );
    let number = |report: &Value, key: &str| report[key].as_f64().unwrap();
    let noise = number(&report, "noise");
    assert!(noise <= 0.05 && noise > 0.03, "{report}");
    assert!(number(&report, "noise_low") < noise && noise < number(&report, "noise_high"));
    assert!(
        number(&report, "mean_samples_per_pixel") < number(&report, "samples_per_pixel"),
        "{report}"
    );
    let even = place.report(&format!("{arguments} --noise 0.05 --adaptive off"));
    assert_eq!(
        number(&even, "mean_samples_per_pixel"),
        number(&even, "samples_per_pixel")
    );
    let least = place.report(&format!("{arguments} --noise 0.9 --min-samples 40"));
    assert_eq!(number(&least, "samples_per_pixel"), 40.0);
    let short = place.report("--model sphere --samples 3");
    assert_eq!(
        (&short["stopped_by"], &short["converged"]),
        (&"samples".into(), &false.into())
    );
    assert!(number(&short, "noise") > 0.0);
    assert!(place.report("--model sphere --samples 1")["noise"].is_null());
    assert_eq!(place.report(&format!("{arguments} --time 0.3"))["stopped_by"], "time");
    place.done("render --model sphere --engine cpu --size 8x8 --noise 0.01 --report n.json");
    let report: Value = serde_json::from_str(&place.read("n.json")).unwrap();
    assert_eq!(
        report["stopped_by"], "noise",
        "without --samples only the noise limits: {report}"
    );
}

#[test]
fn tone_maps_and_exposure_change_the_png() {
    let place = Workplace::new();
    let render = |arguments: &str| {
        place.done(&format!(
            "render --model sphere --environment studio --size 12x12 --samples 4 --engine cpu --output t.png {arguments}"
        ));
        image::open(place.path("t.png")).unwrap().into_rgba8().into_raw()
    };
    let pictures: HashSet<_> = ToneCurve::ALL
        .iter()
        .map(|tone| render(&format!("--tone-map {}", tone.name())))
        .collect();
    assert_eq!(pictures.len(), ToneCurve::ALL.len());
    let brightness = |picture: Vec<u8>| picture.iter().map(|x| u32::from(*x)).sum::<u32>();
    let [dark, normal, bright] = ["-2", "0", "1.5"].map(|stops| brightness(render(&format!("--exposure {stops}"))));
    assert!(dark < normal && normal < bright, "{dark} {normal} {bright}");
}

#[test]
fn models_and_the_ground_cover_what_they_should() {
    let place = Workplace::new();
    let (buffer, document) = square();
    place.write("square.glb", &glb(&document, &buffer.bytes));
    let covered = |model: &str| {
        place
            .picture(&format!(
                "--environment furnace --background transparent --model {model}"
            ))
            .mean(3)
    };
    let shares = ["teapot", "sphere", "plane", "shaderball", "square.glb"].map(covered);
    for (index, share) in shares.iter().enumerate() {
        assert!((0.03..0.9).contains(share), "{shares:?}");
        assert!(
            shares[..index].iter().all(|other| (share - other).abs() > 1e-4),
            "{shares:?}"
        );
    }
    // From 20° above, the ground fills all but a strip at most.
    assert!(covered("sphere --ground") > 0.9);
}

/// Four colours at the azimuths of −Z, +X, +Z and −X: the map's columns begin at −Z and go towards +X.
fn compass(column: usize, _row: usize) -> [f32; 3] {
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0]][(column + 4) / 8 % 4]
}

#[test]
fn environments_come_from_names_and_files_and_can_be_turned() {
    let place = Workplace::new();
    write_hdr(&place.path("compass.hdr"), 32, 16, compass);
    write_exr(&place.path("compass.exr"), 32, 16, compass);
    // The model is a speck: all else is background, seen along −Z.
    let look = |arguments: &str| {
        let picture = place.picture(&format!(
            "--model sphere --camera-distance 1000 --fov 20 --filter box {arguments}"
        ));
        picture.at(4, 12)
    };
    for file in ["compass.hdr", "compass.exr"] {
        let east = format!("--environment {file} --camera-orbit -90,0");
        let file = format!("--environment {file} --camera-orbit 0,0");
        assert_near(&look(&file)[..3], &[1.0, 0.0, 0.0], 1e-3);
        // A quarter turn anticlockwise seen from above brings what was at +X to −Z.
        assert_near(
            &look(&format!("{file} --environment-rotation 90"))[..3],
            &[0.0, 1.0, 0.0],
            1e-3,
        );
        assert_near(
            &look(&format!("{file} --environment-rotation -90"))[..3],
            &[1.0, 1.0, 0.0],
            1e-3,
        );
        assert_near(
            &look(&format!("{file} --environment-strength 2.5"))[..3],
            &[2.5, 0.0, 0.0],
            1e-3,
        );
        // The camera goes round the same way as the map turns.
        assert_near(&look(&east)[..3], &[0.0, 1.0, 0.0], 1e-3);
    }
    let pictures =
        ["studio", "sky", "furnace"].map(|name| place.picture(&format!("--model sphere --environment {name}")));
    assert!(pictures[0].difference(&pictures[1]) > 0.05 && pictures[1].difference(&pictures[2]) > 0.05);
}

#[test]
fn materials_come_from_names_and_files() {
    let place = Workplace::new();
    let mut seen: Vec<Picture> = Vec::new();
    for material in PRESETS.iter() {
        let name = command_line_name(&material.name);
        let picture = place.picture(&format!("--model sphere --material {name}"));
        let sound = picture.pixels.iter().flatten().all(|x| x.is_finite() && *x >= 0.0);
        assert!(sound, "{name}");
        assert!(
            seen.iter().all(|other| other.difference(&picture) > 1e-3),
            "{name} looks like another"
        );
        seen.push(picture);
    }
    place.write(
        "mine.json",
        br#"{"glossmith": 1, "name": "Mine", "material": {"base.color": [0, 1, 0], "specular.weight": 0, "base.metalness": 0}}"#,
    );
    let [red, green, _, _] = place
        .picture("--model sphere --environment furnace --material mine.json")
        .at(12, 12);
    assert!(red < 1e-6 && green > 0.5, "{red} {green}");
    // Later settings win over the file.
    let set = "--material mine.json --set base.color=#ff0000";
    let [red, green, _, _] = place
        .picture(&format!("--model sphere --environment furnace {set}"))
        .at(12, 12);
    assert!(green < 1e-6 && red > 0.5, "{red} {green}");
}

#[test]
fn every_parameter_can_be_set() {
    let place = Workplace::new();
    let defaults: Vec<_> = PARAMETERS
        .iter()
        .map(|parameter| format!("--set {}={}", parameter.key, parameter.text(&parameter.default_value())))
        .collect();
    let picture = place.picture(&format!("--model sphere {}", defaults.join(" ")));
    assert!(
        picture == place.picture("--model sphere"),
        "the defaults written out change the picture"
    );
}

#[test]
fn parameters_change_the_picture() {
    let place = Workplace::new();
    let pairs = [
        ("base.color=#ff8000", "base.color=0.1,0.9,0.2", ""),
        ("base.metalness=0", "base.metalness=1", ""),
        ("specular.lobe=geometric", "specular.lobe=phong", ""),
        ("specular.lobe=ggx", "specular.lobe=lambert", ""),
        ("specular.roughness=0.1", "specular.roughness=0.8", ""),
        ("specular.curve=linear", "specular.curve=long-tail", ""),
        (
            "specular.horizon=mirror",
            "specular.horizon=absorb",
            "--environment furnace --set specular.roughness=0.6 --set specular.curve=long-tail",
        ),
        ("specular.fresnel=none", "specular.fresnel=conductor", ""),
        (
            "specular.ior=1.2",
            "specular.ior=2.4",
            "--set base.metalness=0 --set specular.fresnel=dielectric",
        ),
        (
            "specular.color=#ffffff",
            "specular.color=1,0,0",
            "--set base.metalness=0",
        ),
        (
            "specular.conductor=gold",
            "specular.conductor=silver",
            "--set specular.fresnel=conductor",
        ),
    ];
    for (first, second, common) in pairs {
        let render = |set: &str| place.picture(&format!("--model sphere --samples 16 {common} --set {set}"));
        let difference = render(first).difference(&render(second));
        assert!(difference > 0.002, "{first} and {second} differ by {difference}");
    }
    // sRGB is taken for sRGB, and three numbers for linear light.
    let [hex, linear] = ["#336699", "0.03310477,0.13286833,0.31854678"]
        .map(|color| place.picture(&format!("--model sphere --set base.color={color}")));
    assert!(hex.difference(&linear) < 1e-5);
}

#[test]
fn cameras_stand_where_they_are_put() {
    let place = Workplace::new();
    let render = |arguments: &str| place.picture(&format!("--environment sky {arguments}"));
    let orbit = render("--camera-orbit 90,0 --camera-distance 9 --camera-target 1,2,3");
    let position = render("--camera-position 10,2,3 --camera-target 1,2,3");
    assert!(orbit.difference(&position) < 1e-4, "{}", orbit.difference(&position));
    let other = [
        "--camera-orbit -90,0 --camera-distance 9 --camera-target 1,2,3",
        "--camera-orbit 90,30 --camera-distance 9 --camera-target 1,2,3",
        "--camera-orbit 90,0 --camera-distance 12 --camera-target 1,2,3",
        "--camera-orbit 90,0 --camera-distance 9 --camera-target 1,1,3",
        "--camera-orbit 90,0 --camera-distance 9 --camera-target 1,2,3 --fov 40",
    ];
    for arguments in other {
        assert!(orbit.difference(&render(arguments)) > 0.01, "{arguments}");
    }
}

#[test]
fn sampling_is_as_asked_for() {
    let place = Workplace::new();
    let count = |arguments: &str, key: &str| {
        place.report(&format!("--model shaderball {arguments}"))[key]
            .as_f64()
            .unwrap()
    };
    assert_eq!(count("--samples 5", "samples_per_pixel"), 5.0);
    assert!(count("--bounces 8", "rays") > 1.02 * count("--bounces 1", "rays"));
    let seconds = count("--samples 1000000 --time 0.4", "render_seconds");
    assert!((0.4..5.0).contains(&seconds), "{seconds}");
    // Without --samples, only the time limits: beyond the default number.
    place.done("render --model sphere --engine cpu --size 2x2 --time 0.5 --report t.json");
    let report: Value = serde_json::from_str(&place.read("t.json")).unwrap();
    assert!(report["samples_per_pixel"].as_u64().unwrap() > 256, "{report}");

    let render = |arguments: &str| place.picture(&format!("--model shaderball {arguments}"));
    let first = render("--seed 1");
    assert!(first == render("--seed 1"), "the same seed, another picture");
    assert!(first != render("--seed 2"), "another seed, the same picture");
    // The sum of the luminance, and its variance.
    let sums = |option: &str| -> [f64; 2] {
        let picture = render(&format!(
            "{option} --samples 256 --set specular.roughness=0.8 --set base.metalness=0 --aovs"
        ));
        let variances = &channels(&place.path("quick.exr"))["variance.Y"];
        let [r, g, b] = [0, 1, 2].map(|channel| picture.mean(channel) * picture.pixels.len() as f64);
        let variance = variances.iter().map(|variance| f64::from(*variance)).sum();
        [0.2126 * r + 0.7152 * g + 0.0722 * b, variance]
    };
    for options in [
        ["--sequence sobol", "--sequence independent"],
        ["--filter box", "--filter gaussian"],
        ["--strategy lobe", "--strategy light"],
    ] {
        let [[a, variance_a], [b, variance_b]] = options.map(sums);
        assert!(a != b, "{options:?} make no difference");
        let sigma = (variance_a + variance_b).sqrt();
        assert!(sigma < 0.01 * a, "{options:?}: too noisy to tell: {sigma} of {a}");
        assert!(
            (a - b).abs() < 4.0 * sigma,
            "{options:?} change the light: {a} and {b}, sigma {sigma}"
        );
    }
}

#[test]
fn area_lights_shine_from_where_they_are_put() {
    let place = Workplace::new();
    let dark = "--model sphere --environment-strength 0 --background transparent --samples 16";
    let render = |arguments: &str| place.picture(&format!("{dark} {arguments} --camera-orbit 0,0"));
    assert_eq!(render("").mean(1), 0.0);
    let halves = |picture: &Picture| {
        let half = |first: usize| -> f32 {
            let columns = first..first + picture.width / 2;
            let rows = 0..picture.height;
            rows.flat_map(|y| columns.clone().map(move |x| (x, y)))
                .map(|(x, y)| picture.at(x, y)[1])
                .sum()
        };
        [half(0), half(picture.width / 2)]
    };
    let [left, right] = halves(&render("--area-light 80,0,3,1,1,10"));
    assert!(right > 4.0 * left, "from the right: {left} {right}");
    let [left, right] = halves(&render("--area-light -80,0,3,1,1,10"));
    assert!(left > 4.0 * right, "from the left: {left} {right}");
    let red = render("--area-light 0,45,3,1,1,10,#ff0000");
    assert!(red.mean(0) > 0.01 && red.mean(1) == 0.0 && red.mean(2) == 0.0);
    let warm = render("--area-light 0,45,3,1,1,10,2700K");
    let white = render("--area-light 0,45,3,1,1,10");
    let ratio = |picture: &Picture, channel: usize| picture.mean(channel) / picture.mean(0);
    assert!(ratio(&warm, 2) < 0.25 * ratio(&white, 2) && ratio(&warm, 1) < 0.8 * ratio(&white, 1));
    let both = render("--area-light 0,45,3,1,1,10,#ff0000 --area-light 60,45,3,1,1,10,#0000ff");
    assert!(both.mean(0) > 0.01 && both.mean(2) > 0.0);
    let effects = place.report(&format!("{dark} --area-light 0,45,3,1,1,10"))["effects"].clone();
    let effects: Vec<_> = effects.as_array().unwrap().iter().filter_map(Value::as_str).collect();
    assert!(
        effects.contains(&"emitter-sampling") && !effects.contains(&"light-sampling"),
        "{effects:?}"
    );
    let too_many = "--area-light 0,45,3,1,1,10 ".repeat(65);
    place.refused(
        1,
        &format!("render {too_many}"),
        &["lighting.area_lights", "between 0 and 64"],
    );
}

#[test]
fn spots_and_suns_are_told_in_words() {
    let place = Workplace::new();
    let dark = "--model sphere --environment-strength 0 --background transparent --samples 16 --camera-orbit 0,0";
    let mean = |arguments: &str| place.picture(&format!("{dark} {arguments}")).mean(1);
    // Of a matt ball: twice the irradiance is twice the light, whichever way it is said.
    let matt = "--set specular.weight=0 --set base.metalness=0";
    let [one, two, lux] =
        ["strength=2", "strength=4", "power=4"].map(|said| mean(&format!("{matt} --sun yaw=0,pitch=20,{said}")));
    assert!(one > 0.01 && (two / one - 2.0).abs() < 1e-3, "{one} {two}");
    assert_eq!(two, lux);
    // The same lumens over an area half as large each way are four times as bright.
    let spot = "--spot yaw=0,pitch=0,distance=2,cone=120,power=100";
    let near = mean(&format!("{matt} {spot},temperature=3000K"));
    let far = mean(&format!("{matt} {spot},temperature=3000K --scene-unit 2"));
    assert!((near / far - 4.0).abs() < 0.01, "{near} {far}");
    // Beside the ball nothing is lit.
    assert_eq!(mean(&format!("{matt} --spot target=9,0,0,cone=10,strength=5")), 0.0);
    let effects = place.report(&format!("{dark} {spot}"))["effects"].to_string();
    assert!(effects.contains("\"spot\""), "{effects}");
    let disc = mean(&format!("{matt} --area-light 0,45,3,1,1,10,disc,turn=20"));
    let square = mean(&format!("{matt} --area-light 0,45,3,1,1,10"));
    assert!((disc / square - 0.785).abs() < 0.02, "{disc} {square}");
    for (wrong, said) in [
        ("--sun distance=3", "distance: give #rrggbb"),
        ("--spot cone=500", "cone_deg does not take 500"),
        ("--area-light 0,45,3,1,1,10,oval", "oval: give triangle"),
        ("--spot power=bright", "power=bright: give a number"),
    ] {
        place.refused(2, &format!("render {wrong}"), &[said]);
    }
}

#[test]
fn both_engines_render_the_same_scene() {
    let place = Workplace::new();
    let render = |engine: &str| {
        let report = place.report(&format!("--model shaderball --samples 64 --engine {engine}"));
        assert_eq!(report["engine"], engine);
        assert_eq!(report["driver"].as_str().unwrap().is_empty(), engine == "cpu");
        read_exr(&place.path("quick.exr"))
    };
    let [cpu, gpu] = ["cpu", "gpu"].map(render);
    // The same paths: but for rounding, after which a path may part.
    let difference = cpu.difference(&gpu);
    assert!(difference < 1e-3, "the engines' pictures differ by {difference}");
    // And the choice is made by itself, and said.
    let run = place.done("render --model sphere --size 8x8 --samples 1");
    assert!(
        run.stderr.contains("cpu on ") || run.stderr.contains("gpu on "),
        "{}",
        run.stderr
    );
    assert!(place.path("glossmith.png").exists());
}

#[test]
fn without_a_display_there_is_a_picture() {
    let place = Workplace::new();
    let run = place.done("--engine cpu");
    let picture = image::open(place.path("glossmith.png")).unwrap();
    assert_eq!((picture.width(), picture.height()), (512, 512));
    for words in ["no display", "glossmith.png", "glossmith render --help"] {
        assert!(run.stderr.contains(words), "'{words}' is not in: {}", run.stderr);
    }
}

#[test]
fn help_and_version_are_no_errors() {
    let place = Workplace::new();
    let version = place.done("--version").stdout;
    assert_eq!(version.trim(), format!("glossmith {}", env!("CARGO_PKG_VERSION")));
    for arguments in ["--help", "render --help", "scatter --help"] {
        assert!(place.done(arguments).stdout.contains("Usage: glossmith"), "{arguments}");
    }
}

/// One long name of an option once pressed all help into a column a word wide.
#[test]
fn help_is_not_pressed_into_a_narrow_column() {
    let place = Workplace::new();
    let verbs = [
        "render",
        "plan",
        "explain",
        "turntable",
        "batch",
        "convert",
        "scatter",
        "lobe",
        "study accuracy",
        "study ledger",
    ];
    for verb in verbs {
        let help = place.done(&format!("{verb} --help")).stdout;
        let words = help.split_whitespace().count();
        assert!(
            words > 3 * help.lines().count(),
            "{verb}: {words} words in {} lines",
            help.lines().count()
        );
    }
}
