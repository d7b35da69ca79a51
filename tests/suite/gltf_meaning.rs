//! What the numbers of a glTF file mean, as pixels: both engines show what the format says.

use glossmith::{
    document::{Background, Document, ImportLobe, of_model::materials_of},
    import::{GLTF_PARAMETERS, Goes, load},
    render::EngineChoice,
    scene::{ModelOptions, ModelSource, environment::EnvironmentSource},
};
use serde_json::{Value, json};

use super::{
    cli_support::Workplace,
    gltf_builder::{Buffer, glb, pictured, png, put, square},
    gltf_extensions::load_plain,
    renders::{adjust, render},
};

const SIZE: u32 = 17;

/// A square with this material and, if any, these colours at its vertices.
fn painted(material: Value, colors: Option<[[f32; 4]; 4]>) -> (Buffer, Value) {
    let (mut buffer, _) = square();
    let mut attributes = json!({"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2});
    if let Some(colors) = colors {
        attributes["COLOR_0"] = buffer.floats(&colors).into();
    }
    let primitive = json!({"attributes": attributes, "indices": 3, "material": 0});
    let mut document = buffer.document(json!([primitive]));
    document["materials"] = json!([material]);
    (buffer, document)
}

/// A document of a square that shines with the colours of its vertices.
pub fn shining_by_vertices(folder: &Workplace) -> Document {
    let material = json!({"extensions": {"KHR_materials_unlit": {}}});
    let colors = [
        [0.9, 0.1, 0.1, 1.0],
        [0.1, 0.5, 0.1, 1.0],
        [0.1, 0.1, 0.7, 1.0],
        [0.3, 0.3, 0.3, 1.0],
    ];
    let (buffer, file) = painted(material, Some(colors));
    let model = folder.glb("shining.glb", &file, &buffer);
    Document {
        materials: materials_of(&load(&model).unwrap(), ImportLobe::Geometric),
        model,
        ..Document::default()
    }
}

/// A picture of these texels beside each other.
fn strip(texels: &[[u8; 3]]) -> Vec<u8> {
    let picture = image::RgbImage::from_fn(texels.len() as u32, 1, |x, _| image::Rgb(texels[x as usize]));
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, image::ImageFormat::Png).expect("encodes");
    bytes.into_inner()
}

/// The pixels of a file, seen from the front in even light of this strength, as an engine draws them.
fn pixels(file: &(Buffer, Value), picture: Option<&[u8]>, choice: EngineChoice, light: f32) -> Vec<[f32; 4]> {
    let folder = Workplace::new();
    let path = folder.path("square.glb");
    if let Some(picture) = picture {
        folder.write("picture.png", picture);
    }
    std::fs::write(&path, glb(&file.1, &file.0.bytes)).unwrap();
    let source = ModelSource::File(path);
    let model = load(&source).unwrap();
    let mut document = Document {
        model: source,
        import: ModelOptions::default(),
        materials: materials_of(&model, ImportLobe::Geometric),
        ..Document::default()
    };
    document.ground = false;
    document.lighting.environment = EnvironmentSource::Furnace;
    document.lighting.strength = light;
    document.lighting.background = Background::Transparent;
    (document.camera.yaw_deg, document.camera.pitch_deg) = (0.0, 0.0);
    adjust(
        &mut document,
        &format!("render.width={SIZE} render.height={SIZE} render.samples=64"),
    );
    render(choice, &document).image().pixels
}

/// The pixel in the middle.
fn middle(pixels: &[[f32; 4]]) -> [f32; 4] {
    pixels[pixels.len() / 2]
}

fn assert_near(found: [f32; 4], expected: [f32; 3], tolerance: f32, what: &str) {
    let is_near = std::iter::zip(found, expected).all(|(a, b)| (a - b).abs() <= tolerance);
    assert!(is_near, "{what}: {found:?}, expected {expected:?}");
}

const ENGINES: [EngineChoice; 2] = [EngineChoice::Cpu, EngineChoice::Gpu];

/// KHR_materials_specular: "the metal BRDF is not affected by the parameter". Before: 0.150, and 1, 0.5, 0. What is white
/// under it reflects all light whatever it is made of.
#[test]
fn weight_and_colour_of_the_specular_reflection_leave_metals_alone() {
    let extensions = [
        json!({"specularFactor": 0.15}),
        json!({"specularColorFactor": [1, 0.5, 0]}),
        json!({"specularFactor": 0}),
    ];
    for (extension, metalness) in extensions
        .iter()
        .flat_map(|e| [1.0, 0.5].map(|metalness| (e, metalness)))
    {
        let material = json!({
            "pbrMetallicRoughness": {"metallicFactor": metalness, "roughnessFactor": 0.2},
            "extensions": {"KHR_materials_specular": extension},
        });
        for choice in ENGINES {
            let found = middle(&pixels(&painted(material.clone(), None), None, choice, 1.0));
            let tolerance = if metalness == 1.0 { 0.002 } else { 0.02 };
            assert_near(
                found,
                [1.0; 3],
                tolerance,
                &format!("{choice:?}, {extension}, metalness {metalness}"),
            );
        }
    }
}

/// The same where a texture tells what is metal: the left half is, over black the right half reflects nothing.
#[test]
fn a_texture_of_metalness_has_metals_that_the_specular_weight_leaves_alone() {
    let png = strip(&[[0, 0, 255], [0, 0, 0]]);
    let material = json!({
        "pbrMetallicRoughness": {"metallicRoughnessTexture": {"index": 0}},
        "extensions": {"KHR_materials_specular": {"specularFactor": 0}},
    });
    let mut file = painted(material, None);
    file.1["images"] = json!([{"uri": "picture.png"}]);
    file.1["samplers"] = json!([{"magFilter": 9728, "minFilter": 9728}]);
    file.1["textures"] = json!([{"source": 0, "sampler": 0}]);
    for choice in ENGINES {
        let all = pixels(&file, Some(&png), choice, 1.0);
        for column in [SIZE / 2 - 2, SIZE / 2 + 2] {
            let found = all[(SIZE * (SIZE / 2) + column) as usize];
            assert_near(found, [1.0; 3], 0.02, &format!("{choice:?}, column {column}"));
        }
    }
}

/// F0 = min(0.04 c, 1). Before: 0.040 three times.
#[test]
fn a_specular_colour_above_1_raises_the_reflectance() {
    let material = json!({
        "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0, "roughnessFactor": 0},
        "extensions": {"KHR_materials_specular": {"specularColorFactor": [10, 5, 1]}},
    });
    for choice in ENGINES {
        let found = middle(&pixels(&painted(material.clone(), None), None, choice, 1.0));
        assert_near(found, [0.40, 0.20, 0.04], 0.002, &format!("{choice:?}"));
    }
}

/// KHR_materials_unlit: factor times texture times COLOR_0. Before: 1, 1, 1.
#[test]
fn unlit_materials_show_the_colours_of_their_vertices() {
    let material = json!({"extensions": {"KHR_materials_unlit": {}}});
    for color in [0.5, 0.50196_f32] {
        let file = painted(material.clone(), Some([[color, 0.25, 1.0, 1.0]; 4]));
        for choice in ENGINES {
            let found = middle(&pixels(&file, None, choice, 0.0));
            assert_near(found, [color, 0.25, 1.0], 0.0001, &format!("{choice:?}"));
        }
    }
}

/// Before: 1, 1, 1.
#[test]
fn the_alpha_of_vertices_is_their_opacity() {
    let blend = json!({"alphaMode": "BLEND", "pbrMetallicRoughness": {"metallicFactor": 0}});
    let mask = json!({"alphaMode": "MASK", "alphaCutoff": 0.2, "pbrMetallicRoughness": {"metallicFactor": 0}});
    for choice in ENGINES {
        for (material, alpha, expected) in [
            (&blend, 0.0, 0.0),
            (&blend, 0.25, 0.25),
            (&mask, 0.25, 1.0),
            (&mask, 0.1, 0.0),
        ] {
            let file = painted(material.clone(), Some([[1.0, 1.0, 1.0, alpha]; 4]));
            let [.., found] = middle(&pixels(&file, None, choice, 1.0));
            // Whether a sample meets the square is drawn: its deviation is √(α (1 − α)/64).
            let tolerance = 4.0 * (expected * (1.0 - expected) / 64.0_f32).sqrt() + 0.0001;
            near!(found, expected, tolerance, "{choice:?}, {material}");
        }
    }
}

/// A material in which every layer has some weight, so that no number is without effect; in the old workflow if told so.
fn layered(is_old: bool) -> Value {
    let mut extensions = json!({
        "KHR_materials_clearcoat": {"clearcoatFactor": 0.5},
        "KHR_materials_transmission": {"transmissionFactor": 0.5},
        "KHR_materials_volume": {"thicknessFactor": 0.5, "attenuationDistance": 0.5},
        "KHR_materials_anisotropy": {"anisotropyStrength": 0.5},
        "KHR_materials_sheen": {"sheenColorFactor": [1, 1, 1]},
        "KHR_materials_iridescence": {"iridescenceFactor": 0.5},
        "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.5},
    });
    if is_old {
        extensions["KHR_materials_pbrSpecularGlossiness"] = json!({"specularFactor": [0.2, 0.2, 0.2]});
    }
    let pbr = json!({"roughnessFactor": 0.5, "metallicFactor": 0.5});
    json!({"pbrMetallicRoughness": pbr, "emissiveFactor": [1, 1, 1], "alphaMode": "MASK", "extensions": extensions})
}

/// Each parameter of the table, off its default, changes the material or the report.
#[test]
fn no_parameter_of_a_material_is_dropped_in_silence() {
    let read = |material: &Value| {
        let file = pictured(material.clone(), &png());
        let model = load_plain(&file.1, &file.0);
        let lines: Vec<_> = model
            .report
            .entries
            .iter()
            .map(|entry| (entry.fate, entry.what.clone()))
            .collect();
        (format!("{:?}", model.slots[0]), lines)
    };
    for parameter in GLTF_PARAMETERS {
        let plain = layered(parameter.place.contains("pbrSpecularGlossiness"));
        let mut changed = plain.clone();
        put(
            &mut changed,
            parameter.place,
            serde_json::from_str(parameter.example).unwrap(),
        );
        let (before, after) = (read(&plain), read(&changed));
        assert!(before != after, "{} leaves no trace: {before:?}", parameter.place);
        if let Goes::Nowhere(what) = parameter.goes {
            assert!(
                after.1.iter().any(|(_, said)| said == what),
                "{}: {:?}",
                parameter.place,
                after.1
            );
        }
    }
}
