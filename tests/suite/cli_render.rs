//! `glossmith render`: every option, by what it does to the picture.

use serde_json::Value;

use crate::cli_support::{Workplace, read_exr, write_hdr};

/// The sRGB colour #336699, linear.
const BLUE: [f32; 3] = [0.033_104_77, 0.132_868_33, 0.318_546_78];

fn assert_near(found: &[f32], expected: &[f32], tolerance: f32) {
    for (x, y) in found.iter().zip(expected) {
        near!(x, y, tolerance * y.abs().max(1.0), "{found:?} is not {expected:?}");
    }
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
    let expected = "version engine adapter driver traversal width height samples_per_pixel mean_samples_per_pixel \
        mean_luminance noise noise_low noise_high converged stopped_by setup_seconds render_seconds \
        samples_per_second rays rays_per_second dropped_samples clamped_energy cut_energy effects seed \
        denoised denoise_seconds denoised_error denoised_error_low denoised_error_high files";
    assert_eq!(keys.join(" "), expected);
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

#[test]
fn cameras_stand_where_they_are_put() {
    let place = Workplace::new();
    let render = |arguments: &str| place.picture(&format!("--environment sky {arguments}"));
    let orbit = render("--camera-orbit 90,0 --camera-distance 9 --camera-target 1,2,3");
    let position = render("--camera-position 10,2,3 --camera-target 1,2,3");
    assert!(orbit.difference(&position) < 0.0001, "{}", orbit.difference(&position));
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

/// Light beyond 4096 sheets along a ray is reported as cut; of hundreds of sheets each takes its share.
#[test]
fn sheets_beyond_the_last_that_a_ray_passes_are_told() {
    let place = Workplace::new();
    for (sheets, opacity, size, seen, cut) in [(300, 0.001, 32, 0.7407, 0.0), (4500, 1e-5, 8, 0.9599, 0.9599)] {
        let sheet = |i: u32| {
            let y = 0.5 * f64::from(i) / f64::from(sheets);
            format!("v -1 {y} -1\nv -1 {y} 1\nv 1 {y} 1\nv 1 {y} -1\nf -4 -3 -2 -1\n")
        };
        place.write("sheets.obj", (0..sheets).map(sheet).collect::<String>());
        let report = place.report(&format!(
            "--model sheets.obj --environment furnace --camera-orbit 0,90 --camera-distance 1 --fov 5 \
             --size {size}x{size} --samples 4 --set base.metalness=0 --set base.color=0,0,0 --set specular.weight=0 --set geometry.opacity={opacity}"
        ));
        for (key, right) in [("mean_luminance", seen), ("cut_energy", cut)] {
            let found = report[key].as_f64().unwrap();
            near!(found, right, 0.04, "{sheets} sheets, {key}");
        }
    }
}

/// A pixel of 1e30 is finite. Its samples are left out, and the message says which such are.
#[test]
fn samples_of_a_pixel_of_1e30_are_left_out_and_told() {
    let place = Workplace::new();
    let path = place.path("bright.hdr");
    write_hdr(&path, 16, 8, |x, y| [if (x, y) == (4, 2) { 1e30 } else { 0.5 }; 3]);
    let scene = "render --model sphere --environment bright.hdr --size 16x16 --samples 4 --engine cpu -o b.exr";
    let stderr = place.done(&format!("{scene} --report b.json")).stderr;
    let report: Value = place.json("b.json");
    let dropped = report["dropped_samples"].as_u64().unwrap();
    let message = format!("{dropped} samples were left out: not finite, negative, or above 1e18");
    assert!(dropped > 0 && stderr.contains(&message), "{message}: {stderr}");
}

#[test]
fn without_a_display_there_is_a_picture() {
    let place = Workplace::new();
    let run = place.done("--engine cpu");
    let picture = image::open(place.path("glossmith.png")).unwrap();
    assert_eq!((picture.width(), picture.height()), (512, 512));
    for words in ["no display", "glossmith.png", "make run ARGS="] {
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
    let short = place.done("render -h").stdout;
    assert!(short.lines().count() < 60, "{short}");
    for (arguments, has, lacks) in [
        ("render -h", "Light:", "--ray-queries"),
        ("render --help", "--ray-queries", "Options of"),
        ("convert --help", "--allow-outside", "--ray-queries"),
        ("convert --help", "<IN>... <OUT>", "--denoise-device"),
        ("manual render", "[OPTIONS]", "aovs\\fR] ["),
    ] {
        let text = place.done(arguments).stdout;
        assert!(text.contains(has) && !text.contains(lacks), "{arguments}: {text}");
    }
    // An answer of - goes to standard output.
    let scene = "render --model sphere --engine cpu --size 8x8 --samples 1 -o o.png --import-report -";
    assert!(place.done(scene).stdout.contains("entries"));
    assert!(place.path("o.png").is_file() && !place.path("-").exists());
}
