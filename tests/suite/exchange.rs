//! Materials to other programs' formats and back, through the command line.

use glossmith::{
    compile::compile,
    document::MaterialSettings,
    import::load,
    matching::lobe_of_material,
    optics::{fresnel::fresnel, lobe::model::LobeModel, vector::vec3},
    scene::{ModelSource, texture::TextureTarget, texture::UserTexture},
    store::{
        PRESETS,
        exchange::{FORMATS, Subject, by_name, endings_written, prepare, report::Outcome},
        preset::{command_line_name, load_material, material_text},
    },
};
use serde_json::Value as Json;

use crate::{cli_support::Workplace, renders::material};

/// What a material looks like: all but what its file had beside it.
fn text(material: &MaterialSettings) -> String {
    material_text(std::path::Path::new(""), material)
}

/// Formats that hold the exact parameters, and can be opened again.
fn both_ways() -> impl Iterator<Item = (&'static str, &'static str)> {
    let ways = FORMATS.iter().filter(|format| format.is_read());
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
            let back = load_material(&place.path(format!("{format}-back/{name}.json")))
                .unwrap()
                .value;
            assert_eq!(text(&back), text(material), "{name} by way of {format}");
        }
    }
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
    place.save_material("a.json", &material);
    for (format, ending) in [("materialx", "mtlx"), ("standard-surface", "mtlx"), ("gltf", "glb")] {
        place.done(&format!("convert a.json a.{ending} --to {format}"));
        place.done(&format!("convert a.{ending} b.json --without-exact --import-lobe ggx"));
        let back = place.material("b.json");
        assert_eq!(back.name, material.name, "{format}");
        let numbers = |m: &MaterialSettings| {
            [
                m.base_weight * m.base_color[0],
                m.base_weight * m.base_color[1],
                m.base_weight * m.base_color[2],
                m.coat_ggx_roughness(),
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
            near!(a, b, 0.002 * (1.0 + a.abs()), "{format}, number {i}");
        }
    }
}

/// The share of the light that goes elsewhere, seen along the normal; by a grid of its own.
fn total_variation(a: &LobeModel, b: &LobeModel) -> f64 {
    const RINGS: usize = 400;
    const TURNS: usize = 24;
    let wo = vec3(0.0, 0.0, 1.0);
    let mut values = [Vec::new(), Vec::new()];
    for ring in 0..RINGS {
        // Finer towards the middle, where narrow highlights lie.
        let t = (ring as f64 + 0.5) / RINGS as f64;
        let (sin, cos) = (std::f64::consts::FRAC_PI_2 * t.powi(3)).sin_cos();
        for turn in 0..TURNS {
            let (sin_turn, cos_turn) = (std::f64::consts::TAU * (turn as f64 + 0.5) / TURNS as f64).sin_cos();
            let wi = vec3(sin * cos_turn, sin * sin_turn, cos);
            let weight = sin * t * t;
            values[0].push(weight * a.evaluate(wo, wi)[0]);
            values[1].push(weight * b.evaluate(wo, wi)[0]);
        }
    }
    let [a_sum, b_sum] = [0, 1].map(|i| values[i].iter().sum::<f64>());
    let pairs = values[0].iter().zip(&values[1]);
    0.5 * pairs.map(|(a, b)| (a / a_sum - b / b_sum).abs()).sum::<f64>()
}

/// The largest difference of the reflectances by the angle at the half vector; what a coat changes is a loss of its own.
fn reflectance_apart(a: &MaterialSettings, b: &MaterialSettings) -> f64 {
    let [a, b] = [a, b].map(|material| {
        let bare = MaterialSettings {
            coat_weight: 0.0,
            film_weight: 0.0,
            ..material.clone()
        };
        compile(&[bare]).0[0].cast::<f64>().fresnel_terms(false)
    });
    let apart = (0..=64).map(|i| {
        let cosine = f64::from(i) / 64.0;
        (fresnel(&a, cosine) - fresnel(&b, cosine))
            .map(f64::abs)
            .max_component()
    });
    apart.fold(0.0, f64::max)
}

#[test]
fn every_preset_comes_back_within_the_stated_loss_from_what_a_file_shows() {
    let place = Workplace::new();
    let names: Vec<String> = PRESETS
        .iter()
        .map(|material| command_line_name(&material.name))
        .collect();
    for (format, ending) in [("materialx", "mtlx"), ("standard-surface", "mtlx"), ("gltf", "glb")] {
        let told = place.done(&format!("convert {} {format} --to {format} --json -", names.join(" ")));
        let told: Json = serde_json::from_str(&told.stdout).unwrap();
        let files: Vec<String> = names.iter().map(|name| format!("{format}/{name}.{ending}")).collect();
        place.done(&format!(
            "convert {} {format}-back --to glossmith --without-exact --import-lobe ggx",
            files.join(" ")
        ));
        for (index, (material, name)) in PRESETS.iter().zip(&names).enumerate() {
            let back = load_material(&place.path(format!("{format}-back/{name}.json")))
                .unwrap()
                .value;
            let entries = told[index]["materials"][0]["entries"].as_array().unwrap();
            let stated = |what: &str| {
                let entry = entries.iter().find(|entry| entry["what"] == what);
                entry.and_then(|entry| entry["residual"].as_f64())
            };
            let [own, shown] = [material, &back].map(lobe_of_material);
            if let Some(stated) = stated("highlight") {
                let found = total_variation(&own, &shown);
                near!(found, stated, 0.02, "{format}, {name}");
            }
            let is_specular = material.specular_weight > 0.0 || material.transmission_weight > 0.0;
            if is_specular {
                let found = reflectance_apart(material, &back);
                let stated = stated("reflectance by angle").unwrap_or(0.0);
                assert!(found < stated + 0.005, "{format}, {name}: {found} and {stated} stated");
            }
            for (a, b) in [
                (material.coat_weight, back.coat_weight),
                (material.transmission_weight, back.transmission_weight),
                (material.anisotropy, back.anisotropy),
                (material.opacity, back.opacity),
            ] {
                near!(a, b, 0.002, "{format}, {name}");
            }
        }
    }
}

#[test]
fn what_is_lost_is_reported_and_shown() {
    for (format, assignments, part, outcome) in [
        ("blender", "specular.anisotropy=0.5", "anisotropy", Outcome::Exact),
        (
            "blender",
            "thin_film.weight=0.5",
            "the thin film's weight",
            Outcome::Dropped,
        ),
        ("materialx", "base.metalness=0", "reflectance by angle", Outcome::Exact),
        (
            "mitsuba",
            "specular.multiple_scattering=on",
            "multiple scattering between facets",
            Outcome::Dropped,
        ),
    ] {
        let subject = Subject::of(material(&format!(
            "specular.lobe=ggx specular.fresnel=dielectric {assignments}"
        )));
        let report = prepare(&subject, "a", "a".as_ref(), by_name(format).unwrap())
            .unwrap()
            .report;
        let report = &report.materials[0];
        let found = report.entries.iter().find(|entry| entry.what == part);
        assert_eq!(
            found.map(|entry| entry.outcome),
            Some(outcome),
            "{assignments}: {found:?}"
        );
        let [_, shown] = &**report.looks.as_ref().unwrap();
        assert_eq!(shown.film_weight, f32::from(part.contains("film")), "{assignments}");
    }
}

#[test]
fn own_roughness_and_metalness_are_channels_of_one_texture_in_gltf() {
    let place = Workplace::new();
    let mut material = material("specular.lobe=ggx");
    for (target, code) in [(TextureTarget::Roughness, 51), (TextureTarget::Metalness, 204)] {
        let file = place.path(format!("{code}.png"));
        image::GrayImage::from_pixel(1, 1, image::Luma([code]))
            .save(&file)
            .unwrap();
        material.put_texture(target, UserTexture::of(file));
    }
    place.save_material("a.json", &material);
    place.done("convert a.json a.glb");
    let model = load(&ModelSource::File(place.path("a.glb"))).unwrap();
    let texture = model.slots[0].texture(TextureTarget::Roughness).expect("is there");
    assert_eq!(model.textures[texture.texture].rgba8[1..3], [51, 204]);
}

#[test]
fn what_is_only_written_is_what_the_material_is() {
    let place = Workplace::new();
    place.done("convert gold a.csv");
    let table = place.read("a.csv");
    // Seen from above, the highlight is round.
    let lines = table.lines().filter(|line| line.starts_with("0,3,"));
    let values: Vec<f64> = lines
        .map(|line| line.split(',').nth(3).unwrap().parse().unwrap())
        .collect();
    assert!(
        values.len() > 1 && values.iter().all(|value| (value / values[0] - 1.0).abs() < 1e-6),
        "{values:?}"
    );
    place.done("convert gold a.py");
    assert!(!place.read("a.py").contains("Thin Film"), "gold has none");
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
        ("usd", "usda", "inputs:metallic = 1", "inputs:metallic = 0.25"),
    ] {
        let name = format!("gold.{ending}");
        place.done(&format!("convert gold {name} --to {format}"));
        let text = place.read(&name);
        assert!(text.contains(from), "{text}");
        place.write(&name, text.replace(from, to));
        let run = place.done(&format!("convert {name} gold.json"));
        assert!(run.stderr.contains("changed since"), "{}", run.stderr);
        assert_eq!(place.material("gold.json").metalness, 0.25);
    }
}

#[test]
fn documents_that_include_others_are_read_whole() {
    let place = Workplace::new();
    std::fs::create_dir_all(place.path("parts/maps")).unwrap();
    image::RgbImage::from_pixel(2, 2, image::Rgb([51, 102, 153]))
        .save(place.path("parts/maps/a.png"))
        .unwrap();
    let bumps = image::RgbImage::from_fn(2, 1, |x, _| image::Rgb([128 + x as u8, 128, 255]));
    bumps.save(place.path("parts/maps/b.png")).unwrap();
    let include = |name: &str| {
        format!(
            "<?xml version=\"1.0\"?>\n<materialx version=\"1.39\" xmlns:xi=\"http://www.w3.org/2001/XInclude\">\n  \
             <xi:include href=\"{name}\" />\n  <look name=\"l\"/>\n</materialx>"
        )
    };
    let part = r#"<materialx version="1.39" colorspace="srgb_texture" fileprefix="maps/" xmlns:xi="http://www.w3.org/2001/XInclude">
  <xi:include href="colours.mtlx" />
  <standard_surface name="s" type="surfaceshader">
    <input name="base_color" type="color3" nodename="picture" />
    <input name="specular_color" type="color3" nodename="grey" />
    <input name="metalness" type="float" value="1" />
    <input name="coat_normal" type="vector3" nodename="bumps" />
  </standard_surface>
  <normalmap name="bumps" type="vector3"><input name="in" type="vector3" nodename="codes" /><input name="scale" type="float" value="0.25" /></normalmap>
  <image name="codes" type="vector3"><input name="file" type="filename" value="b.png" /></image>
  <image name="picture" type="color3"><input name="file" type="filename" value="a.png" colorspace="lin_rec709" /></image>
  <surfacematerial name="M" type="material"><input name="surfaceshader" type="surfaceshader" nodename="s" /></surfacematerial>
</materialx>"#;
    let colours = r#"<materialx><constant name="grey" type="color3" colorspace="lin_rec709"><input name="value" type="color3" value="0.5, 0.5, 0.5" /></constant></materialx>"#;
    place.write("whole.mtlx", include("parts/part.mtlx"));
    place.write("parts/part.mtlx", part);
    place.write("parts/colours.mtlx", colours);
    place.done("convert whole.mtlx m.json --import-lobe ggx");
    let material = place.material("m.json");
    assert_eq!(material.base_color, [0.2, 0.4, 0.6]);
    // Gulbrandsen's index and absorption of 0.4 and 0.5.
    assert!(
        (material.edge_tint[1] - 0.83361).abs() < 1e-4,
        "{:?}",
        material.edge_tint
    );
    assert_eq!(material.coat_normal_strength, 0.25);
    // What cannot be had is named; nothing is fetched from elsewhere.
    for (name, words) in [
        ("none.mtlx", "none.mtlx"),
        ("/etc/hostname", "from the document's folder"),
        ("http://x.y/z.mtlx", "from the document's folder"),
    ] {
        place.write("whole.mtlx", include(name));
        place.refused(1, "convert whole.mtlx m.json", &["whole.mtlx", words]);
    }
    // A document that includes itself is read once.
    place.write("whole.mtlx", include("whole.mtlx"));
    place.refused(1, "convert whole.mtlx m.json", &["whole.mtlx", "no <surfacematerial>"]);
}

/// The material of a MaterialX document of one surface with these numbers.
pub fn read_surface(place: &Workplace, node: &str, numbers: &[(&str, f32)]) -> MaterialSettings {
    let input = |(name, value): &(&str, f32)| format!("<input name=\"{name}\" type=\"float\" value=\"{value}\"/>");
    let inputs: String = numbers.iter().map(input).collect();
    let document = format!(
        "<materialx version=\"1.39\"><{node} name=\"s\" type=\"surfaceshader\">{inputs}</{node}><surfacematerial \
         name=\"M\" type=\"material\"><input name=\"surfaceshader\" type=\"surfaceshader\" nodename=\"s\"/>\
         </surfacematerial></materialx>"
    );
    place.write("s.mtlx", document);
    place.done("convert s.mtlx s.json --import-lobe ggx");
    place.material("s.json")
}

#[test]
fn the_opacity_of_a_preview_surface_is_glass_a_cutout_or_presence() {
    let place = Workplace::new();
    for (numbers, opacity, transmission) in [
        (&[("opacity", 0.25)][..], 1.0, 0.75),
        (&[("opacity", 0.25), ("opacityThreshold", 0.5)][..], 0.0, 0.0),
        (&[("opacity", 0.75), ("opacityThreshold", 0.5)][..], 1.0, 0.0),
        (&[("opacity", 0.25), ("opacityMode", 1.0)][..], 0.25, 0.0),
    ] {
        let material = read_surface(&place, "UsdPreviewSurface", numbers);
        let found = (material.opacity, material.transmission_weight);
        assert_eq!(found, (opacity, transmission), "{numbers:?}");
    }
}

#[test]
fn surfaces_of_materialx_have_the_widths_that_their_nodes_define() {
    let place = Workplace::new();
    let widths = |material: &MaterialSettings| {
        let mean = f64::from(material.roughness).powi(2);
        let stretch = glossmith::optics::lobe::stretch_from_anisotropy(f64::from(material.anisotropy));
        [mean * stretch, mean / stretch]
    };
    // α = roughness², aspect = √(1 − anisotropy): α over the aspect, and times it.
    let numbers = [("roughness", 0.4), ("anisotropic", 0.5), ("clearcoat", 1.0)];
    let material = read_surface(&place, "disney_principled", &numbers);
    let aspect = 0.5_f64.sqrt();
    for (found, wanted) in widths(&material).into_iter().zip([0.16 / aspect, 0.16 * aspect]) {
        near!(found / wanted, 1.0, 0.0001);
    }
    assert_eq!((material.coat_weight, material.specular_weight), (1.0, 1.0));
    // glTF's: α is mix(roughness², 1, strength²) along, roughness² across.
    let material = read_surface(&place, "gltf_pbr", &[("roughness", 0.4), ("anisotropy_strength", 0.5)]);
    for (found, wanted) in widths(&material).into_iter().zip([0.16 + 0.84 * 0.25, 0.16]) {
        near!(found / wanted, 1.0, 0.0001);
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
    assert!(endings_written().contains(&"mtlx"));
    place.refused(1, "convert gold silver all", &["all", "--to"]);
    place.refused(1, "convert gilt b.mtlx", &["gilt"]);
    let ggx = MaterialSettings {
        lobe: glossmith::optics::lobe::Lobe::Ggx,
        ..MaterialSettings::default()
    };
    place.save_material("ggx.json", &ggx);
    place.refused(1, "convert ggx.json b.glsl", &["GGX", "specular.lobe=geometric"]);
    place.refused(2, "convert gold b.mtlx --to nothing", &["nothing"]);
    place.write("a.py", b"import bpy");
    place.refused(1, "convert a.py b.json", &["a.py", "exact parameters"]);
    let mirror = MaterialSettings {
        roughness: 0.0,
        ..MaterialSettings::default()
    };
    place.save_material("mirror.json", &mirror);
    place.refused(1, "convert mirror.json b.binary", &["b.binary", "roughness"]);
    place.refused(1, "convert mirror.json b.csv", &["b.csv", "roughness"]);
}
