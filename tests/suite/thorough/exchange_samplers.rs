//! Functions that sample the geometric lobe, in other languages.

use std::process::Command;

use glossmith::{
    document::{CustomCurve, MaterialSettings},
    matching::lobe_of_material,
    optics::{curve::Curve, frame::frame_from_normal, lobe::raw_sample, vector::vec3},
};

use crate::cli_support::Workplace;

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
        place.save_material("m.json", &material);
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
        place.write("main.c", main);
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
                near!(a, b, 2e-5, "{}: {expected:?} and {line}", curve.name());
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
        place.save_material("m.json", &material);
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
                    .replace("float[130](", "{")
                    .replace(");\n", if text.contains("float[130]") { "};\n" } else { ");\n" });
                text = restored(&text);
            }
            let head = format!(
                "#include <tgmath.h>\ntypedef struct {{ float x, y, z; }} vec3;\n{shim}#define max fmax\n#define min fmin\n#define abs fabs\n"
            );
            place.write("shim.c", format!("{head}{text}"));
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
