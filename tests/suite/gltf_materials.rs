//! What glTF says of materials and pictures beyond its core: extensions, picture formats, tangents.

use glossmith::{
    compile::compile_textured,
    document::{ImportLobe, MaterialSettings, of_model::materials_of},
    optics::{lobe::stretch_from_anisotropy, thin_film::film_path, tone::linear_from_srgb, vector::Vec3},
    scene::{
        Fate, Model,
        texture::{TextureTarget, Textures, textured_material},
    },
};
use serde_json::{Value, json};

use super::gltf_extensions::{load_plain, says};
use super::{
    cli_support::Workplace,
    gltf_builder::{pictured, png},
};

/// What is read of a material on a square, with a picture of two texels as texture 0.
fn slot_of(material: &Value) -> Model {
    let (buffer, document) = pictured(material.clone(), &png());
    load_plain(&document, &buffer)
}

#[test]
fn material_extensions_reach_the_slots() {
    let texture = json!({"index": 0});
    let model = slot_of(
        &json!({"pbrMetallicRoughness": {"roughnessFactor": 0.5}, "extensions": {
            "KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [0.25, 2.0, 1.0]},
            "KHR_materials_clearcoat": {
                "clearcoatFactor": 0.5, "clearcoatTexture": texture, "clearcoatRoughnessFactor": 1.0,
                "clearcoatRoughnessTexture": texture,
                "clearcoatNormalTexture": {"index": 0, "scale": 0.5},
            },
            "KHR_materials_anisotropy": {"anisotropyStrength": 0.75, "anisotropyRotation": 0.5},
            "KHR_materials_ior": {"ior": 0.5},
        }}),
    );
    let slot = &model.slots[0];
    assert_eq!(
        ["coat.weight", "coat.roughness", "coat.normal_strength"].map(|key| slot.number(key)),
        [0.5, 1.0, 0.5]
    );
    says(&model, Fate::Approximated, "an index of refraction of 0.5, taken as 1");
    let material = &materials_of(&model, ImportLobe::Ggx)[0];
    assert_eq!(
        (material.specular_weight, material.specular_color),
        (0.5, [0.25, 2.0, 1.0])
    );
    // glTF's clearcoat leaves the base as it is.
    let uses = material.textures;
    assert!(
        uses[TextureTarget::Coat]
            && uses[TextureTarget::CoatRoughness]
            && uses[TextureTarget::CoatNormal]
            && !material.coat_on_base
    );
    has_widths(material, 0.5, 0.75);
    assert_eq!(material.coat_darkening, 0.0);
    assert_eq!((material.rotation_deg, material.ior), (0.5_f32.to_degrees(), 1.0));
}

/// Compares a material's widths with those that the extension defines: α = mix(roughness², 1, strength²) along the
/// direction of anisotropy, roughness² across.
fn has_widths(material: &MaterialSettings, roughness: f64, strength: f64) {
    let across = roughness * roughness;
    let along = across + (1.0 - across) * strength * strength;
    let stretch = stretch_from_anisotropy(f64::from(material.anisotropy));
    let mean = f64::from(material.roughness).powi(2);
    for (found, wanted) in [(mean * stretch, along), (mean / stretch, across)] {
        near!(
            found / wanted,
            1.0,
            0.0001,
            "roughness {roughness}, strength {strength}"
        );
    }
}

#[test]
fn a_stretched_highlight_has_the_widths_of_the_extension() {
    let read = |roughness: f64, strength: f64| {
        let model = slot_of(&json!({
            "pbrMetallicRoughness": {"roughnessFactor": roughness},
            "extensions": {"KHR_materials_anisotropy": {"anisotropyStrength": strength}},
        }));
        (materials_of(&model, ImportLobe::Ggx)[0].clone(), model)
    };
    for (roughness, strength) in [(0.5, 0.0), (0.3, 0.1), (0.3, 0.6), (0.5, 0.9), (0.9, 1.0), (1.0, 0.7)] {
        let (material, model) = read(roughness, strength);
        has_widths(&material, roughness, strength);
        let is_cut = model.report.entries.iter().any(|entry| entry.what.contains("19 : 1"));
        assert!(!is_cut, "{roughness}, {strength}");
    }
    // What is stretched more than any lobe of ours has the longer width.
    for (roughness, strength) in [(0.0, 0.5), (0.1, 0.5), (0.2, 1.0)] {
        let (material, model) = read(roughness, strength);
        let along = roughness * roughness + (1.0 - roughness * roughness) * strength * strength;
        let found = f64::from(material.roughness).powi(2) * stretch_from_anisotropy(f64::from(material.anisotropy));
        near!(found / along, 1.0, 0.0001);
        assert_eq!(material.anisotropy, 1.0);
        says(&model, Fate::Approximated, "stretched more than 19 : 1");
    }
}

/// KHR_materials_ior: 0 is an infinite index, F = 1 everywhere, by which specular-glossiness is written.
#[test]
fn an_index_beyond_4_is_a_metal_of_the_specular_colour() {
    for (ior, reflectance) in [(0.0, 1.0), (1000.0, (999.0_f32 / 1001.0).powi(2))] {
        let model = slot_of(&json!({
            "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0},
            "extensions": {
                "KHR_materials_ior": {"ior": ior},
                "KHR_materials_specular": {"specularColorFactor": [0.5, 0.25, 0.5]},
            },
        }));
        let slot = &model.slots[0];
        let expected = [0.5, 0.25, 0.5].map(|factor| factor * reflectance);
        let found = slot.color("base.color");
        let is_near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.0001);
        assert!(
            is_near && (slot.number("base.metalness") - 1.0).abs() < 0.0001,
            "{slot:?}"
        );
        says(&model, Fate::Approximated, "above 4, as metalness");
    }
}

/// The WebP of EXT_texture_webp stands before the format's own image; the others after it.
#[test]
fn a_webp_is_taken_before_its_fallback() {
    for (extension, name) in [("EXT_texture_webp", "extension's"), ("KHR_texture_basisu", "own")] {
        let (buffer, mut document) = pictured(json!({"emissiveTexture": {"index": 0}}), &png());
        document["images"] = json!(["own", "extension's"].map(|name| json!({"name": name, "bufferView": 4})));
        document["textures"] = json!([{"source": 0, "extensions": {extension: {"source": 1}}}]);
        assert_eq!(load_plain(&document, &buffer).textures[0].name, name);
    }
}

#[test]
fn specular_glossiness_becomes_metalness_and_roughness() {
    let of = |diffuse: [f32; 3], specular: [f32; 3]| {
        let [r, g, b] = diffuse;
        let workflow = json!({"diffuseFactor": [r, g, b, 0.5], "specularFactor": specular, "glossinessFactor": 0.75});
        slot_of(&json!({"extensions": {"KHR_materials_pbrSpecularGlossiness": workflow}})).slots[0].clone()
    };
    let plastic = of([0.2, 0.4, 0.6], [0.04; 3]);
    assert_eq!(
        (
            plastic.number("base.metalness"),
            plastic.number("specular.roughness"),
            plastic.number("geometry.opacity")
        ),
        (0.0, 0.25, 0.5)
    );
    for (found, expected) in plastic.color("base.color").iter().zip([0.2, 0.4, 0.6]) {
        near!(found, expected, 1e-6, "{:?}", plastic.color("base.color"));
    }
    let gold = of([0.0; 3], [1.0, 0.75, 0.25]);
    near!(gold.number("base.metalness"), 1.0, 1e-6);
    for (found, expected) in gold.color("base.color").iter().zip([1.0, 0.75, 0.25]) {
        near!(found, expected, 1e-5, "{:?}", gold.color("base.color"));
    }
    // With textures, texel by texel: (10, 20, 30) is dark and reflects little.
    let texture = json!({"index": 0});
    let workflow = json!({"diffuseTexture": texture, "specularFactor": [0.04, 0.04, 0.04], "glossinessFactor": 0.5});
    let model = slot_of(&json!({"extensions": {"KHR_materials_pbrSpecularGlossiness": workflow}}));
    let names: Vec<&str> = model.textures.iter().map(|texture| texture.name.as_str()).collect();
    assert_eq!(model.textures.len(), 3, "{names:?}");
    let slot = &model.slots[0];
    let color = &model.textures[slot.texture(TextureTarget::BaseColor).unwrap().texture];
    let surface = &model.textures[slot.texture(TextureTarget::Roughness).unwrap().texture];
    assert_eq!(color.rgba8, [10, 20, 30, 255, 10, 20, 30, 128]);
    assert_eq!(surface.rgba8[..4], [255, 128, 0, 255]);
}

/// A sheen comes as fuzz of about its albedo, and older files that kept it show it.
#[test]
fn sheens_are_fuzz() {
    let sheen = json!({"sheenColorFactor": [0.5, 0.25, 0.0], "sheenRoughnessFactor": 0.5});
    let model = slot_of(&json!({"extensions": {"KHR_materials_sheen": sheen}}));
    says(&model, Fate::Approximated, "a sheen, as fuzz of about its albedo");
    let material = materials_of(&model, ImportLobe::Geometric).remove(0);
    assert_eq!((material.fuzz_weight, material.fuzz_color), (0.5, [1.0, 0.5, 0.0]));
    near!(material.fuzz_roughness, 0.55, 1e-6);
    let folder = Workplace::new();
    let path = folder.path("older.json");
    let kept = json!({"sheen.color": [0.5, 0.25, 0.0], "sheen.roughness": 0.5});
    std::fs::write(&path, json!({"glossmith": 1, "material": kept}).to_string()).unwrap();
    let older = glossmith::store::load_material(&path).unwrap();
    assert!(older.warnings.is_empty(), "{:?}", older.warnings);
    let fuzz = |of: &glossmith::document::MaterialSettings| (of.fuzz_weight, of.fuzz_color, of.fuzz_roughness);
    assert_eq!(fuzz(&older.value), fuzz(&material));
    // The draft has the numbers themselves, and goes before the sheen that stands beside it.
    let draft = json!({"fuzzFactor": 0.25, "fuzzColorFactor": [1, 0, 1], "fuzzRoughnessFactor": 0.75});
    let model = slot_of(&json!({"extensions": {"KHR_materials_sheen": sheen, "KHR_materials_fuzz": draft}}));
    let material = materials_of(&model, ImportLobe::Geometric).remove(0);
    assert_eq!(fuzz(&material), (0.25, [1.0, 0.0, 1.0], 0.75));
}

/// Textures of a sheen are turned into those of fuzz texel by texel: its weight is the brightest channel's.
#[test]
fn textures_of_sheens_and_fuzz_are_looked_up() {
    let fuzz_at = |material: MaterialSettings, model: &Model| {
        let (compiled, tables) = compile_textured(&[material], &Textures::new(model).slots);
        let textures = Textures::new(model);
        // In the middle of the left texel.
        let at = textured_material(&textures, &tables, &compiled[0], &[[[0.25, 0.5]; 3]], Vec3::splat(1.0));
        let [r, g, b] = at.fuzz_color.to_f64();
        [f64::from(at.fuzz_weight), r, g, b, f64::from(at.fuzz_roughness)]
    };
    let near = |found: [f64; 5], expected: [f64; 5]| {
        let is_near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.003);
        assert!(is_near, "{found:?} for {expected:?}");
    };
    let linear = [10.0, 20.0, 30.0].map(|code: f64| linear_from_srgb(Vec3::splat(code / 255.0)).x);
    let texture = json!({"index": 0});
    let read = |extension: &str, numbers: Value| {
        let model = slot_of(&json!({"extensions": {extension: numbers}}));
        let mut unused = model.report.entries.iter().filter(|entry| entry.fate != Fate::Used);
        assert!(
            unused.all(|entry| !entry.what.contains("texture")),
            "{:?}",
            model.report
        );
        let material = materials_of(&model, ImportLobe::Geometric).remove(0);
        let uses = material.textures;
        assert!(uses[TextureTarget::Fuzz] && uses[TextureTarget::FuzzColor] && uses[TextureTarget::FuzzRoughness]);
        fuzz_at(material, &model)
    };
    let draft = json!({"fuzzFactor": 0.5, "fuzzTexture": texture, "fuzzColorFactor": [1, 0.5, 1],
        "fuzzColorTexture": texture, "fuzzRoughnessFactor": 0.75, "fuzzRoughnessTexture": texture});
    let expected = [0.5 * 10.0 / 255.0, linear[0], 0.5 * linear[1], linear[2], 0.75];
    near(read("KHR_materials_fuzz", draft), expected);
    let sheen = json!({"sheenColorFactor": [0.5, 1, 0.5], "sheenColorTexture": texture,
        "sheenRoughnessFactor": 0.5, "sheenRoughnessTexture": texture});
    let weight = linear[1];
    let expected = [weight, 0.5 * linear[0] / weight, 1.0, 0.5 * linear[2] / weight, 0.55];
    near(read("KHR_materials_sheen", sheen), expected);
}

#[test]
fn iridescence_is_a_thin_film() {
    let texture = json!({"index": 0});
    let model = slot_of(&json!({"extensions": {"KHR_materials_iridescence": {
        "iridescenceFactor": 0.5, "iridescenceIor": 1.75, "iridescenceThicknessMaximum": 350,
        "iridescenceTexture": texture, "iridescenceThicknessTexture": texture,
    }}}));
    assert!(
        model
            .report
            .entries
            .iter()
            .all(|entry| !entry.what.contains("iridescence"))
    );
    let material = materials_of(&model, ImportLobe::Geometric).remove(0);
    let film = |m: &MaterialSettings| [m.film_weight, m.film_ior, m.film_thickness];
    assert_eq!(film(&material), [0.5, 1.75, 0.001 * 350.0]);
    // Both texels of the picture are (10, 20, 30); the least thickness is 100 nm.
    let (compiled, _) = compile_textured(&[material], &Textures::new(&model).slots);
    let share = 20.0 / 255.0;
    let expected = [0.5 * 10.0 / 255.0, film_path(0.1 + 0.25 * share).x];
    for (found, expected) in [compiled[0].film_weight, compiled[0].film_path.x].iter().zip(expected) {
        near!(found, expected, 1e-5);
    }
    // Files of versions that only kept it.
    let folder = Workplace::new();
    let path = folder.path("old.json");
    let old = json!({"glossmith": 1, "name": "Old", "material": {
        "iridescence.weight": 0.5, "iridescence.ior": 1.75, "iridescence.thickness_nm": 350,
        "iridescence.thickness_min_nm": 100,
    }});
    std::fs::write(&path, old.to_string()).unwrap();
    let read = glossmith::store::load_material(&path).unwrap();
    assert_eq!(
        (film(&read.value), read.warnings),
        ([0.5, 1.75, 0.35], Vec::<String>::new())
    );
    assert!(read.value.extra.is_empty());
}

/// A strip of two squares, the texture of the right one mirrored about their common edge: tangents follow their textures,
/// and the edge is split for it, with a normal texture and without.
#[test]
fn normal_textures_get_the_tangents_of_mikktspace() {
    for material in [json!({"normalTexture": {"index": 0}}), json!({})] {
        let (mut buffer, mut file) = pictured(material, &png());
        let positions: Vec<[f32; 3]> = (0..6).map(|i| [(i % 3) as f32, (i / 3) as f32, 0.0]).collect();
        let uvs: Vec<[f32; 2]> = (0..6).map(|i| [[0.0, 1.0, 0.0][i % 3], 1.0 - (i / 3) as f32]).collect();
        let primitive = &mut file["meshes"][0]["primitives"][0];
        primitive["attributes"] = json!({
            "POSITION": buffer.floats(&positions), "TEXCOORD_0": buffer.floats(&uvs),
            "NORMAL": buffer.floats(&[[0.0, 0.0, 1.0]; 6]),
        });
        primitive["indices"] = json!(buffer.indices(&[0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4]));
        file["bufferViews"] = json!(buffer.views);
        file["accessors"] = json!(buffer.accessors);
        file["buffers"][0]["byteLength"] = json!(buffer.bytes.len());
        let mesh = load_plain(&file, &buffer).mesh;
        assert_eq!(
            mesh.positions.len(),
            8,
            "the two vertices of the common edge are there twice"
        );
        for triangle in 0..4 {
            let sign = if triangle < 2 { 1.0 } else { -1.0 };
            for vertex in mesh.triangles[triangle] {
                let tangent = mesh.tangents[vertex as usize];
                assert_eq!(tangent.to_array(), [sign, 0.0, 0.0, sign], "triangle {triangle}");
            }
        }
    }
}
