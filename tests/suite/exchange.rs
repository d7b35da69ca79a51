//! Materials to other programs' formats and back, through the command line.

use std::process::Command;

use glossmith::document::match_look::lobe_of_material;
use glossmith::document::{CustomCurve, MaterialSettings};
use glossmith::optics::curve::Curve;
use glossmith::optics::frame::frame_from_normal;
use glossmith::optics::lobe::raw_sample;
use glossmith::optics::vector::vec3;
use glossmith::store::exchange::FORMATS;
use glossmith::store::preset::{command_line_name, load_material, material_text};
use glossmith::store::{PRESETS, save_material};
use serde_json::Value as Json;

use crate::cli_support::Workplace;

/// What a material looks like: all but what its file had beside it.
fn text(material: &MaterialSettings) -> String {
    material_text(material)
}

/// Formats that hold the exact parameters, and can be opened again.
fn both_ways() -> impl Iterator<Item = (&'static str, &'static str)> {
    let ways = FORMATS.iter().filter(|format| format.is_read && format.is_written);
    ways.map(|format| (format.name, format.extensions[0]))
}

#[test]
fn every_preset_comes_back_from_every_format_as_it_was() {
    let place = Workplace::new();
    let names: Vec<String> = PRESETS
        .iter()
        .map(|material| command_line_name(&material.name))
        .collect();
    for (format, ending) in both_ways() {
        // Mirrors and other lobes have no table, no function.
        let is_for_lobes = ["table", "glsl", "wgsl", "hlsl", "osl", "c"].contains(&format);
        let chosen = PRESETS.iter().zip(&names).filter(|(material, _)| {
            !is_for_lobes || (lobe_of_material(material).has_density() && material.lobe.name() == "geometric")
        });
        let (materials, names): (Vec<_>, Vec<_>) = chosen.unzip();
        let listed: Vec<&str> = names.iter().map(|name| name.as_str()).collect();
        place.done(&format!("convert {} {format} --to {format}", listed.join(" ")));
        let files: Vec<String> = names.iter().map(|name| format!("{format}/{name}.{ending}")).collect();
        place.done(&format!("convert {} {format}-back --to glossmith", files.join(" ")));
        for (material, name) in materials.iter().zip(&names) {
            let back = load_material(&place.path(&format!("{format}-back/{name}.json")))
                .unwrap()
                .value;
            assert_eq!(text(&back), text(material), "{name} by way of {format}");
        }
    }
}

#[test]
fn the_report_says_what_is_exact_and_how_far_off_the_highlight_is() {
    let place = Workplace::new();
    let run = place.done("convert gold gold.mtlx --report -");
    let report: Json = serde_json::from_str(&run.stdout).unwrap();
    let material = &report[0]["materials"][0];
    assert_eq!(report[0]["format"], "materialx");
    assert_eq!(material["carries_exact_parameters"], true);
    let entries = material["entries"].as_array().unwrap();
    let highlight = entries.iter().find(|entry| entry["what"] == "highlight").unwrap();
    assert_eq!(highlight["outcome"], "approximated");
    let residual = highlight["residual"].as_f64().unwrap();
    // The table of section 5 of docs/MATHEMATICS.md: 0.15 to 0.17 for the smooth curve.
    assert!((0.02..0.3).contains(&residual), "{residual}");
    assert!(run.stderr.contains("total variation"), "{}", run.stderr);
    assert!(entries.iter().any(|entry| entry["outcome"] == "exact"));
    // GGX itself is exact.
    let ggx = MaterialSettings {
        lobe: glossmith::optics::lobe::Lobe::Ggx,
        ..MaterialSettings::default()
    };
    save_material(&place.path("ggx.json"), &ggx).unwrap();
    let run = place.done("convert ggx.json ggx.mtlx --report -");
    let report: Json = serde_json::from_str(&run.stdout).unwrap();
    let entries = report[0]["materials"][0]["entries"].as_array().unwrap();
    let highlight = entries.iter().find(|entry| entry["what"] == "highlight").unwrap();
    assert_eq!(highlight["outcome"], "exact");
}

#[test]
fn without_the_exact_parameters_what_is_shown_comes_back() {
    let place = Workplace::new();
    let material = MaterialSettings {
        name: "Öl & \"Lack\" <-->".to_owned(),
        lobe: glossmith::optics::lobe::Lobe::Ggx,
        metalness: 0.0,
        base_weight: 0.5,
        base_color: [0.25, 0.5, 0.125],
        roughness: 0.4,
        anisotropy: 0.5,
        rotation_deg: 30.0,
        ior: 1.625,
        specular_weight: 0.75,
        coat_weight: 0.5,
        coat_ior: 1.5,
        coat_roughness: 0.25,
        opacity: 0.5,
        emission_color: [1.0, 0.5, 0.25],
        emission_strength: 4.0,
        fresnel: glossmith::optics::fresnel::Fresnel::Dielectric,
        ..MaterialSettings::default()
    };
    save_material(&place.path("a.json"), &material).unwrap();
    for (format, ending) in [("materialx", "mtlx"), ("standard-surface", "mtlx"), ("gltf", "glb")] {
        place.done(&format!("convert a.json a.{ending} --to {format}"));
        place.done(&format!("convert a.{ending} b.json --without-exact --import-lobe ggx"));
        let back = load_material(&place.path("b.json")).unwrap().value;
        assert_eq!(back.name, material.name, "{format}");
        let numbers = |m: &MaterialSettings| {
            [
                m.base_weight * m.base_color[0],
                m.base_weight * m.base_color[1],
                m.base_weight * m.base_color[2],
                m.coat_roughness,
                m.metalness,
                m.roughness,
                m.anisotropy,
                m.ior,
                m.specular_weight,
                m.coat_weight,
                m.opacity,
                m.emission_strength,
                m.emission_color[1],
                m.rotation_deg,
            ]
        };
        for (i, (a, b)) in numbers(&material).into_iter().zip(numbers(&back)).enumerate() {
            assert!(
                (a - b).abs() < 2e-3 * (1.0 + a.abs()),
                "{format}, number {i}: {a} came back as {b}"
            );
        }
    }
}

#[test]
fn widths_that_a_format_does_not_reach_are_no_exact_ones() {
    let place = Workplace::new();
    let mut material = MaterialSettings {
        lobe: glossmith::optics::lobe::Lobe::Ggx,
        fresnel: glossmith::optics::fresnel::Fresnel::Conductor,
        metalness: 1.0,
        roughness: 0.3,
        anisotropy: 0.5,
        ..MaterialSettings::default()
    };
    let formats = [
        ("materialx", "mtlx"),
        ("standard-surface", "mtlx"),
        ("gltf", "glb"),
        ("mitsuba", "xml"),
        ("blender", "py"),
    ];
    let mut outcomes = |roughness: f32, anisotropy: f32| {
        (material.roughness, material.anisotropy) = (roughness, anisotropy);
        save_material(&place.path("a.json"), &material).unwrap();
        formats.map(|(format, ending)| {
            let run = place.done(&format!("convert a.json a.{ending} --to {format} --report -"));
            let report: Json = serde_json::from_str(&run.stdout).unwrap();
            let entries = report[0]["materials"][0]["entries"].as_array().unwrap();
            let entry = entries.iter().find(|entry| entry["what"] == "anisotropy").unwrap();
            entry["outcome"] == "exact"
        })
    };
    assert_eq!(outcomes(0.3, 0.5), [true; 5]);
    // Disney's surface is not stretched more than 10 : 1; Mitsuba's conductor has both widths as they are.
    assert_eq!(outcomes(0.3, 1.0), [true, true, true, true, false]);
    // α is 1 at most.
    assert_eq!(outcomes(0.95, 0.9), [false, false, false, true, true]);
}

#[test]
fn a_file_that_was_edited_elsewhere_is_taken_as_it_is() {
    let place = Workplace::new();
    for (format, ending, from, to) in [
        (
            "materialx",
            "mtlx",
            "name=\"base_metalness\" type=\"float\" value=\"1\"",
            "name=\"base_metalness\" type=\"float\" value=\"0.25\"",
        ),
        ("gltf", "gltf", "\"metallicFactor\": 1.0", "\"metallicFactor\": 0.25"),
    ] {
        let name = format!("gold.{ending}");
        place.done(&format!("convert gold {name} --to {format}"));
        let text = place.read(&name);
        assert!(text.contains(from), "{text}");
        place.write(&name, text.replace(from, to).as_bytes());
        let run = place.done(&format!("convert {name} gold.json"));
        assert!(run.stderr.contains("changed since"), "{}", run.stderr);
        assert_eq!(load_material(&place.path("gold.json")).unwrap().value.metalness, 0.25);
    }
}

#[test]
fn documents_of_materialx_are_read_and_graphs_are_named() {
    let place = Workplace::new();
    let picture = image::RgbImage::from_fn(4, 4, |x, _| image::Rgb([if x < 2 { 255 } else { 0 }, 255, 0]));
    picture.save(place.path("checker.png")).unwrap();
    let document = r#"<?xml version="1.0"?>
<materialx version="1.39" colorspace="lin_rec709">
  <nodegraph name="graph">
    <input name="file" type="filename" value="checker.png" colorspace="srgb_texture" />
    <image name="picture" type="color3"><input name="file" type="filename" interfacename="file" /></image>
    <noise3d name="noise" type="float" />
    <output name="color" type="color3" nodename="picture" />
    <output name="rough" type="float" nodename="noise" />
  </nodegraph>
  <standard_surface name="s" type="surfaceshader">
    <input name="base_color" type="color3" nodegraph="graph" output="color" />
    <input name="specular_roughness" type="float" nodegraph="graph" output="rough" />
    <input name="specular_color" type="color3" value="0.5, 0.5, 0.5" colorspace="srgb_texture" />
    <input name="sheen" type="float" value="0.3" />
    <input name="metalness" type="float" value="0" />
  </standard_surface>
  <surfacematerial name="Fabric" type="material"><input name="surfaceshader" type="surfaceshader" nodename="s" /></surfacematerial>
</materialx>"#;
    place.write("fabric.mtlx", document.as_bytes());
    let run = place.done("convert fabric.mtlx fabric.json --import-lobe ggx");
    for words in ["the mean of checker.png", "noise3d", "sheen"] {
        assert!(run.stderr.contains(words), "{words}: {}", run.stderr);
    }
    let material = load_material(&place.path("fabric.json")).unwrap().value;
    assert_eq!(material.name, "Fabric");
    assert_eq!(material.base_color, [0.5, 1.0, 0.0]);
    assert!(
        (material.specular_color[0] - 0.214).abs() < 1e-3,
        "{:?}",
        material.specular_color
    );
    assert_eq!(material.roughness, 0.2, "the default stands in");
}

#[test]
fn a_report_in_a_file_has_pictures_beside_it() {
    let place = Workplace::new();
    let ggx = MaterialSettings {
        lobe: glossmith::optics::lobe::Lobe::Ggx,
        ..MaterialSettings::default()
    };
    save_material(&place.path("ggx.json"), &ggx).unwrap();
    let difference = |name: &str| {
        place.done(&format!("convert {name} out.mtlx --report loss.json"));
        let report: Json = serde_json::from_str(&place.read("loss.json")).unwrap();
        let picture = image::open(place.path("loss-out.png")).unwrap();
        assert!(picture.width() > 3 * 64, "three pictures in a row");
        report[0]["materials"][0]["difference"].as_f64().unwrap()
    };
    // GGX is GGX there; the geometric lobe is not.
    let (exact, off) = (difference("ggx.json"), difference("gold"));
    assert!(exact < 0.02 && off > 2.0 * exact, "{exact} and {off}");
}

#[test]
fn materials_of_other_programs_are_rendered_as_they_are() {
    let place = Workplace::new();
    place.done("convert gold gold.mtlx");
    place.done("convert gold gold.py");
    let scene = "--model sphere --size 12x12 --samples 2";
    let gold = place.picture(&format!("{scene} --material gold"));
    for file in ["gold.mtlx", "gold.py"] {
        assert!(place.picture(&format!("{scene} --material {file}")) == gold, "{file}");
        assert!(place.picture(&format!("{scene} {file}")) == gold, "{file}");
    }
}

#[test]
fn surfaces_of_materialx_have_the_widths_that_their_nodes_define() {
    let place = Workplace::new();
    let read = |node: &str, inputs: &str| {
        let document = format!(
            "<materialx version=\"1.39\"><{node} name=\"s\" type=\"surfaceshader\">{inputs}</{node}><surfacematerial \
             name=\"M\" type=\"material\"><input name=\"surfaceshader\" type=\"surfaceshader\" nodename=\"s\"/>\
             </surfacematerial></materialx>"
        );
        place.write("s.mtlx", document.as_bytes());
        place.done("convert s.mtlx s.json --import-lobe ggx");
        load_material(&place.path("s.json")).unwrap().value
    };
    let number = |name: &str, value: f32| format!("<input name=\"{name}\" type=\"float\" value=\"{value}\"/>");
    let widths = |material: &MaterialSettings| {
        let mean = f64::from(material.roughness).powi(2);
        let stretch = glossmith::optics::lobe::stretch_from_anisotropy(f64::from(material.anisotropy));
        [mean * stretch, mean / stretch]
    };
    // α = roughness², aspect = √(1 − anisotropy): α over the aspect, and times it.
    let inputs = number("roughness", 0.4) + &number("anisotropic", 0.5) + &number("clearcoat", 1.0);
    let material = read("disney_principled", &inputs);
    let aspect = 0.5_f64.sqrt();
    for (found, wanted) in widths(&material).into_iter().zip([0.16 / aspect, 0.16 * aspect]) {
        assert!((found / wanted - 1.0).abs() < 1e-4, "{found} and {wanted}");
    }
    assert_eq!((material.coat_weight, material.specular_weight), (1.0, 1.0));
    // glTF's: α is mix(roughness², 1, strength²) along, roughness² across.
    let inputs = number("roughness", 0.4) + &number("anisotropy_strength", 0.5);
    let material = read("gltf_pbr", &inputs);
    for (found, wanted) in widths(&material).into_iter().zip([0.16 + 0.84 * 0.25, 0.16]) {
        assert!((found / wanted - 1.0).abs() < 1e-4, "{found} and {wanted}");
    }
}

#[test]
fn what_is_no_document_is_refused_with_the_files_name() {
    let place = Workplace::new();
    place.write("a.mtlx", b"<materialx");
    place.refused(1, "convert a.mtlx b.json", &["a.mtlx", "MaterialX"]);
    place.write("a.mtlx", b"<materialx version=\"1.39\"/>");
    place.refused(1, "convert a.mtlx b.json", &["a.mtlx", "no <surfacematerial>"]);
    place.refused(1, "convert gold b.xyz", &["b.xyz", ".mtlx"]);
    place.refused(1, "convert gold silver all", &["all", "--to"]);
    place.refused(1, "convert gilt b.mtlx", &["gilt"]);
    let ggx = MaterialSettings {
        lobe: glossmith::optics::lobe::Lobe::Ggx,
        ..MaterialSettings::default()
    };
    save_material(&place.path("ggx.json"), &ggx).unwrap();
    place.refused(1, "convert ggx.json b.glsl", &["GGX", "specular.lobe=geometric"]);
    place.refused(2, "convert gold b.mtlx --to nothing", &["nothing"]);
    place.write("a.py", b"import bpy");
    place.refused(1, "convert a.py b.json", &["a.py", "exact parameters"]);
    let mirror = MaterialSettings {
        roughness: 0.0,
        ..MaterialSettings::default()
    };
    save_material(&place.path("mirror.json"), &mirror).unwrap();
    place.refused(1, "convert mirror.json b.binary", &["b.binary", "roughness"]);
    place.refused(1, "convert mirror.json b.csv", &["b.csv", "roughness"]);
}

#[test]
fn a_measurement_looks_like_the_material_that_it_was_made_of() {
    let place = Workplace::new();
    place.done("convert gold gold.binary");
    let run = place.done("fit --target gold.binary --output like.json");
    let like = load_material(&place.path("like.json")).unwrap().value;
    // nearest  TV 0.0340  Geometric 0.16097, smooth
    let nearest = run.stdout.lines().find(|line| line.starts_with("nearest")).unwrap();
    let numbers: Vec<f64> = nearest.split([' ', ',']).filter_map(|word| word.parse().ok()).collect();
    let gold = PRESETS.iter().find(|material| material.name == "Gold").unwrap();
    assert!(numbers[0] < 0.06, "{}", run.stdout);
    assert!(
        (numbers[1] / f64::from(gold.roughness) - 1.0).abs() < 0.03,
        "{}",
        run.stdout
    );
    // What η and k reflect head-on.
    for (like, gold) in like.base_color.into_iter().zip([0.967, 0.802, 0.324]) {
        assert!((like - gold).abs() < 0.03, "{}", run.stdout);
    }
    assert_eq!(like.metalness, 1.0);
}

/// Every curve with roughness, anisotropy and policy in the language C, compiled and run beside the lobe.
#[test]
fn the_function_in_c_draws_the_lobes_own_directions() {
    let place = Workplace::new();
    let points = vec![[0.0, 0.1], [0.3, 0.25], [0.7, 1.2], [1.0, 2.0]];
    for curve in Curve::ALL.iter().copied() {
        let material = MaterialSettings {
            curve,
            custom_curve: CustomCurve::try_from(points.clone()).unwrap(),
            roughness: 0.37,
            anisotropy: 0.6,
            ..MaterialSettings::default()
        };
        save_material(&place.path("m.json"), &material).unwrap();
        place.done("convert m.json lobe.h --to c");
        let main = r#"#include <stdio.h>
#include "lobe.h"
int main(void) {
    for (int i = 0; i < 200; i++) {
        float a = (i + 0.5f) / 200.0f, b = fmodf(a * 37.3f, 1.0f), c = fmodf(a * 91.7f, 1.0f);
        vec3 wi = glossmith_sample((vec3){-0.6f, 0.0f, 0.8f}, (vec3){a, b, c});
        printf("%.9g %.9g %.9g %.9g %.9g %.9g\n", a, b, c, wi.x, wi.y, wi.z);
    }
}
"#;
        place.write("main.c", main.as_bytes());
        let gcc = |arguments: &[&str]| {
            let output = Command::new("gcc")
                .args(arguments)
                .current_dir(place.path(""))
                .output()
                .unwrap();
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        };
        gcc(&["-std=c99", "-Wall", "-Werror", "-O1", "main.c", "-o", "main", "-lm"]);
        let output = Command::new(place.path("main")).output().unwrap();
        let lines = String::from_utf8(output.stdout).unwrap();
        let model = lobe_of_material(&material);
        let frame = frame_from_normal(vec3(0.0, 0.0, 1.0));
        assert_eq!(lines.lines().count(), 200);
        for line in lines.lines() {
            let x: Vec<f64> = line.split(' ').map(|x| x.parse().unwrap()).collect();
            let local = |v: glossmith::optics::vector::Vec3<f64>| [frame.tangent.dot(v), frame.bitangent.dot(v), v.z];
            let wo = frame.tangent * -0.6 + frame.normal * 0.8;
            let drawn = local(raw_sample(&model.shape(), &frame, wo, [x[0], x[1], x[2]]));
            let expected = [drawn[0], drawn[1], drawn[2].abs()];
            for (a, b) in expected.iter().zip(&x[3..]) {
                assert!((a - b).abs() < 2e-5, "{}: {expected:?} and {line}", curve.name());
            }
        }
    }
}

#[test]
fn the_functions_in_shaders_languages_are_valid() {
    let place = Workplace::new();
    let names: Vec<_> = Curve::ALL.iter().map(|curve| curve.name()).collect();
    for (curve, name) in Curve::ALL.iter().copied().zip(names) {
        let material = MaterialSettings {
            curve,
            anisotropy: 0.5,
            rotation_deg: 20.0,
            ..MaterialSettings::default()
        };
        save_material(&place.path("m.json"), &material).unwrap();
        place.done("convert m.json m.wgsl");
        let module = naga::front::wgsl::parse_str(&place.read("m.wgsl")).unwrap_or_else(|error| {
            panic!("{name}: {}", error.emit_to_string(&place.read("m.wgsl")));
        });
        let flags = naga::valid::ValidationFlags::all();
        naga::valid::Validator::new(flags, naga::valid::Capabilities::empty())
            .validate(&module)
            .unwrap();
        // The others are C but for the names of types and functions.
        let shims = [
            ("glsl", "#define vec3(...) ((vec3){__VA_ARGS__})\n"),
            (
                "hlsl",
                "#define float3(...) ((vec3){__VA_ARGS__})\ntypedef vec3 float3;\n",
            ),
            (
                "osl",
                "#define vector(...) ((vec3){__VA_ARGS__})\ntypedef vec3 vector;\n",
            ),
        ];
        for (language, shim) in shims {
            place.done(&format!("convert m.json m.{language}"));
            let mut text = place.read(&format!("m.{language}"));
            if language == "glsl" {
                text = text
                    .replace("float[131](", "{")
                    .replace(");\n", if text.contains("float[131]") { "};\n" } else { ");\n" });
                text = restored(&text);
            }
            let head = format!(
                "#include <tgmath.h>\ntypedef struct {{ float x, y, z; }} vec3;\n{shim}#define max fmax\n#define min fmin\n#define abs fabs\n"
            );
            place.write("shim.c", format!("{head}{text}").as_bytes());
            let output = Command::new("gcc")
                .args(["-std=c99", "-c", "shim.c"])
                .current_dir(place.path(""))
                .output()
                .unwrap();
            assert!(
                output.status.success(),
                "{language} {name}: {}",
                String::from_utf8_lossy(&output.stderr)
            );
        }
    }
}

/// GLSL's list as C's: only the line of the list ends with a brace.
fn restored(text: &str) -> String {
    let line = |line: &str| {
        if line.starts_with("const float glossmith_curve") {
            line.to_owned()
        } else {
            line.replace("};", ");")
        }
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}
