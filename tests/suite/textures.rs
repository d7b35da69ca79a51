//! Textures against analytic look-ups, on both engines.

use glossmith::{
    compile::compile_textured,
    document::{AreaLight, Background, Document, ImportLobe, MaterialSettings},
    optics::{tone::linear_from_srgb, vector::Vec3},
    render::EngineChoice,
    scene::{
        Model, ModelSource,
        environment::EnvironmentSource,
        texture::{TextureTarget, Textures, opacity_at, texture_lookup},
    },
};
use image::{Rgba, RgbaImage};
use serde_json::{Value, json};

use super::{
    cli_support::Workplace,
    gltf_builder::{Buffer, glb, square},
    gltf_extensions::load_plain,
    renders::{adjust, render},
};

const ENGINES: [EngineChoice; 2] = [EngineChoice::Cpu, EngineChoice::Gpu];

fn png(picture: &RgbaImage) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// A square of this material whose textures show these pictures, each by one sampler.
pub fn textured_square(material: &Value, pictures: &[RgbaImage], sampler: &Value) -> (Buffer, Value) {
    let (mut buffer, mut document) = square();
    let second = buffer.floats(&[[0.25, 0.75], [0.75, 0.75], [0.75, 0.25], [0.25, 0.25]]);
    document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = json!(second);
    document["meshes"][0]["primitives"][0]["material"] = json!(0);
    let views: Vec<usize> = pictures.iter().map(|picture| buffer.view(&png(picture))).collect();
    document["images"] = views
        .iter()
        .map(|view| json!({"bufferView": view, "mimeType": "image/png"}))
        .collect();
    document["textures"] = (0..pictures.len())
        .map(|i| json!({"source": i, "sampler": 0}))
        .collect();
    document["samplers"] = json!([sampler]);
    document["materials"] = json!([material]);
    document["extensionsUsed"] = json!(["KHR_texture_transform"]);
    document["bufferViews"] = json!(buffer.views);
    document["accessors"] = json!(buffer.accessors);
    document["buffers"] = json!([{"byteLength": buffer.bytes.len()}]);
    (buffer, document)
}

pub fn load(material: &Value, pictures: &[RgbaImage], sampler: &Value) -> Model {
    let (buffer, document) = textured_square(material, pictures, sampler);
    load_plain(&document, &buffer)
}

/// Two by two: black, a dark red; a green, white; the alpha of each its own.
pub fn four_texels() -> RgbaImage {
    let texels = [[0, 0, 0, 255], [100, 0, 0, 128], [0, 200, 0, 64], [255, 255, 255, 0]];
    RgbaImage::from_fn(2, 2, |x, y| Rgba(texels[(x + 2 * y) as usize]))
}

fn linear(code: u8) -> f64 {
    linear_from_srgb(Vec3::<f64>::splat(f64::from(code) / 255.0)).x
}

const CLAMP: u32 = 33071;
const MIRROR: u32 = 33648;
const REPEAT: u32 = 10497;
const NEAREST: u32 = 9728;

/// Red, green, blue and alpha of the base colour's texture.
fn base_color(sampler: &Value, extension: &Value, uv: [f64; 2], is_srgb: bool) -> [f64; 4] {
    let kind = if is_srgb {
        "baseColorTexture"
    } else {
        "metallicRoughnessTexture"
    };
    let material = json!({"pbrMetallicRoughness": {kind: {"index": 0, "extensions": extension}}});
    let textures = Textures::new(&load(&material, &[four_texels()], sampler));
    let slot = textures.slots[0];
    let index = slot.record(if is_srgb {
        TextureTarget::BaseColor
    } else {
        TextureTarget::Roughness
    });
    let (color, alpha) = texture_lookup::<f64>(&textures, index, [uv, [0.0; 2], [0.0; 2]]);
    let [r, g, b] = color.to_f64();
    [r, g, b, alpha]
}

#[track_caller]
fn assert_near(found: [f64; 4], expected: [f64; 4]) {
    for (a, b) in found.iter().zip(expected) {
        near!(a, b, 1e-6, "{found:?}, expected {expected:?}");
    }
}

#[test]
fn colours_are_decoded_before_they_are_filtered() {
    let clamp = json!({"wrapS": CLAMP, "wrapT": CLAMP});
    let red = linear(100);
    assert_near(
        base_color(&clamp, &json!({}), [0.75, 0.25], true),
        [red, 0.0, 0.0, 128.0 / 255.0],
    );
    let middle = base_color(&clamp, &json!({}), [0.5, 0.25], true);
    assert_near(middle, [0.5 * red, 0.0, 0.0, (255.0 + 128.0) / 510.0]);
    assert!((0.5 * red - linear(50)).abs() > 0.02, "the order makes a difference");
    // Of roughness and metalness the numbers themselves are meant.
    let plain = base_color(&clamp, &json!({}), [0.25, 0.5], false);
    assert_near(plain, [0.0, 100.0 / 255.0, 0.0, (255.0 + 64.0) / 510.0]);
    let all = base_color(&clamp, &json!({}), [0.5, 0.5], false);
    assert_near(all, [355.0 / 1020.0, 455.0 / 1020.0, 255.0 / 1020.0, 447.0 / 1020.0]);
}

#[test]
fn textures_go_on_beyond_their_edges_as_the_sampler_says() {
    let of = |wrap: u32, uv: [f64; 2]| base_color(&json!({"wrapS": wrap, "wrapT": CLAMP}), &json!({}), uv, false)[0];
    let red = 100.0 / 255.0;
    // Along the upper row: black, red.
    for (wrap, u, expected) in [
        (REPEAT, 1.25, 0.0),
        (REPEAT, -0.25, red),
        (REPEAT, 1.0, 0.5 * red),
        (REPEAT, 7.75, red),
        (MIRROR, 1.25, red),
        (MIRROR, -0.25, 0.0),
        (MIRROR, 1.0, red),
        (MIRROR, 0.0, 0.0),
        (MIRROR, 3.75, 0.0),
        (MIRROR, 4.75, red),
        (CLAMP, 1.25, red),
        (CLAMP, 0.9, red),
        (CLAMP, -5.0, 0.0),
        (CLAMP, 0.5, 0.5 * red),
    ] {
        let found = of(wrap, [u, 0.0]);
        near!(found, expected, 1e-5, "wrap {wrap} at {u}");
    }
    let nearest = json!({"magFilter": NEAREST, "wrapS": CLAMP, "wrapT": CLAMP});
    for (u, expected) in [(0.0, 0.0), (0.49, 0.0), (0.51, red), (1.0, red)] {
        assert_near(
            [base_color(&nearest, &json!({}), [u, 0.0], false)[0], 0.0, 0.0, 0.0],
            [expected, 0.0, 0.0, 0.0],
        );
    }
}

/// A quarter turn, half the size, moved: the place that the extension's text gives.
#[test]
fn the_texture_transform_moves_turns_and_scales() {
    let transform = json!({"KHR_texture_transform": {
        "offset": [0.25, 1.0], "rotation": std::f64::consts::FRAC_PI_2, "scale": [0.5, 1.0]}});
    let repeat = json!({});
    for uv in [[0.3, 0.2], [0.8, 0.65]] {
        let [u, v] = uv;
        // Offset · rotation · scale: (0.5 u, v) turned to (v, −0.5 u).
        let expected = base_color(&repeat, &json!({}), [v + 0.25, 1.0 - 0.5 * u], true);
        assert_near(base_color(&repeat, &transform, uv, true), expected);
    }
}

/// Two sets of texture coordinates side by side; a third one is left out and said to be.
#[test]
fn a_material_may_look_up_two_sets_of_coordinates() {
    let material = json!({
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
        "emissiveTexture": {"index": 0, "texCoord": 1},
        "normalTexture": {"index": 0, "texCoord": 0},
        "doubleSided": true,
    });
    let model = load(&material, &[four_texels()], &json!({}));
    assert_eq!(model.mesh.second_uvs[0].to_array(), [0.25, 0.75]);
    let textures = Textures::new(&model);
    let uvs = [[0.25, 0.25], [0.75, 0.25], [0.0; 2]];
    let slot = textures.slots[0];
    assert!(
        texture_lookup::<f64>(&textures, slot.record(TextureTarget::BaseColor), uvs)
            .0
            .x
            < 1e-6
    );
    near!(
        texture_lookup::<f64>(&textures, slot.record(TextureTarget::Emission), uvs)
            .0
            .x,
        linear(100),
        1e-6
    );
    assert!(model.report.is_clean(), "{:?}", model.report);
}

/// Where a file gives a mask no cutoff it is a half: an alpha of 127 is a hole, 128 is there.
#[test]
fn a_mask_without_a_cutoff_cuts_at_a_half() {
    let texels = RgbaImage::from_fn(2, 1, |x, _| Rgba([9, 9, 9, 127 + x as u8]));
    let material = json!({"alphaMode": "MASK", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    let model = load(&material, &[texels], &json!({"magFilter": NEAREST}));
    let textures = Textures::new(&model);
    let settings = MaterialSettings::from_slot(&model.slots[0], ImportLobe::Geometric);
    let (materials, _) = compile_textured(&[settings], &textures.slots);
    let opacity = |u: f32| opacity_at::<f32>(&textures, &materials[0], [[u, 0.5], [0.0; 2], [0.0; 2]], 1.0);
    assert_eq!([opacity(0.25), opacity(0.75)], [0.0, 1.0]);
}

/// The square seen head-on, filling the picture.
pub fn head_on(folder: &Workplace, buffer: &Buffer, json: &Value, light: EnvironmentSource) -> Document {
    let path = folder.path("square.glb");
    std::fs::write(&path, glb(json, &buffer.bytes)).unwrap();
    let model = glossmith::import::load(&ModelSource::File(path.clone())).unwrap();
    let mut document = Document {
        model: ModelSource::File(path),
        materials: model
            .slots
            .iter()
            .map(|slot| MaterialSettings::from_slot(slot, ImportLobe::Geometric))
            .collect(),
        ..Document::default()
    };
    document.lighting.environment = light;
    adjust(
        &mut document,
        "render.width=32 render.height=32 render.samples=64 render.filter=box render.sequence=independent",
    );
    // Unit square: half of it over the distance is the half angle's tangent.
    (document.camera.yaw_deg, document.camera.pitch_deg) = (0.0, 0.0);
    document.camera.distance = Some(10.0);
    document.camera.fov_deg = 2.0 * 0.05_f64.atan().to_degrees();
    document
}

/// What a texture shows is found where it belongs, upright: the upper left of the picture in that of the square.
#[test]
fn a_texture_lies_upright_on_the_square() {
    let material = json!({"emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0},
        "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "roughnessFactor": 1}});
    let (buffer, json) = textured_square(&material, &[four_texels()], &json!({"magFilter": NEAREST}));
    for choice in ENGINES {
        let folder = Workplace::new();
        let mut document = head_on(&folder, &buffer, &json, EnvironmentSource::Furnace);
        document.lighting.strength = 0.0;
        let image = render(choice, &document).image();
        let at = |x: usize, y: usize| image.pixels[y * 32 + x];
        let near = |a: f32, b: f64| (f64::from(a) - b).abs() < 0.002;
        assert!(
            near(at(8, 8)[0], 0.0) && near(at(24, 8)[0], linear(100)),
            "{choice:?} {:?}",
            at(24, 8)
        );
        assert!(
            near(at(8, 24)[1], linear(200)) && near(at(8, 24)[0], 0.0),
            "{choice:?} {:?}",
            at(8, 24)
        );
        assert!(near(at(24, 24)[2], 1.0), "{choice:?} {:?}", at(24, 24));
    }
}

/// What textures of two halves leave of weights: of a reflection by alpha, over black; of a thin sheet before a lamp by red.
#[test]
fn weights_follow_their_textures() {
    let halves = RgbaImage::from_fn(2, 2, |x, _| Rgba([255 * x as u8, 0, 0, 255 * x as u8]));
    let reflects =
        json!({"KHR_materials_specular": {"specularTexture": {"index": 0}}, "KHR_materials_ior": {"ior": 3}});
    let transmits = json!({"transmissionFactor": 1, "transmissionTexture": {"index": 0}});
    let rows = [
        (reflects, 0.0, 1.0, 0.25),
        (json!({"KHR_materials_transmission": transmits}), 0.5, 0.0, 0.48),
    ];
    for (choice, (extensions, base, light, expected)) in ENGINES.iter().flat_map(|c| rows.iter().map(move |r| (*c, r)))
    {
        let material = json!({"extensions": extensions,
            "pbrMetallicRoughness": {"baseColorFactor": [base, base, base, 1], "metallicFactor": 0, "roughnessFactor": 0}});
        let (buffer, json) = textured_square(&material, std::slice::from_ref(&halves), &json!({"magFilter": NEAREST}));
        let folder = Workplace::new();
        let mut document = head_on(&folder, &buffer, &json, EnvironmentSource::Furnace);
        document.lighting.strength = *light;
        document.lighting.area_lights = vec![AreaLight {
            yaw_deg: 180.0,
            pitch_deg: 0.0,
            width: 9.0,
            height: 9.0,
            strength: 1.0 - light,
            ..AreaLight::default()
        }];
        let pixels = render(choice, &document).image().pixels;
        let [left, right] = [6, 26].map(|column| pixels[16 * 32 + column][0]);
        assert!(
            left < 0.001 && (right - expected).abs() < 0.02,
            "{choice:?} {extensions}: {left}, {right}"
        );
    }
}

/// The share that is there, and the cut where there is one: alpha 1, 0.5, 0.25 and 0 of the four quarters.
#[test]
fn alpha_is_a_share_or_a_cut() {
    let nearest = json!({"magFilter": NEAREST});
    let shine = |mode: &str, cutoff: f64| {
        json!({"emissiveFactor": [1, 1, 1], "alphaMode": mode, "alphaCutoff": cutoff,
            "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "baseColorTexture": {"index": 0}}})
    };
    let shares = [1.0, 128.0 / 255.0, 64.0 / 255.0, 0.0];
    for choice in ENGINES {
        for (mode, cutoff) in [("BLEND", 0.5), ("MASK", 0.3), ("OPAQUE", 0.5)] {
            let (buffer, json) = textured_square(&shine(mode, cutoff), &[four_texels()], &nearest);
            let folder = Workplace::new();
            let mut document = head_on(&folder, &buffer, &json, EnvironmentSource::Furnace);
            document.lighting.background = Background::Transparent;
            document.render.bounces = 1;
            document.lighting.strength = 0.0;
            let film = render(choice, &document);
            for (quarter, share) in shares.into_iter().enumerate() {
                let expected = match mode {
                    "BLEND" => share,
                    "MASK" => f64::from(u8::from(share >= cutoff)),
                    _ => 1.0,
                };
                let (left, top) = (16 * (quarter % 2) + 4, 16 * (quarter / 2) + 4);
                let places = (0..64).map(|i| (top + i / 8) * 32 + left + i % 8);
                let sums = places
                    .map(|place| film.color(place))
                    .fold([0.0; 2], |sum, c| [sum[0] + c[0], sum[1] + c[3]]);
                let [emitted, alpha] = sums.map(|sum| sum / (64.0 * 64.0));
                // 4096 samples.
                near!(alpha, expected, 0.04, "{choice:?} {mode} {quarter}");
                near!(emitted, expected, 0.04, "{choice:?} {mode} {quarter}");
            }
        }
    }
}

/// Random slopes of up to 45 degrees.
fn bumps() -> RgbaImage {
    RgbaImage::from_fn(16, 16, |x, y| {
        let code = |i: u32| ((x * 37 + y * 101 + i * 71).wrapping_mul(2_654_435_761) >> 24) as u8;
        Rgba([code(1), code(2), 200, 255])
    })
}

/// Roughness and metalness that differ from texel to texel.
fn rough() -> RgbaImage {
    RgbaImage::from_fn(8, 8, |x, y| Rgba([0, (20 + 30 * x) as u8, (36 * y) as u8, 255]))
}

/// A square of this material, with pictures of bumps, of roughness and of colours, seen from aside.
fn all_over(folder: &Workplace, material: &Value) -> Document {
    let (buffer, json) = textured_square(material, &[bumps(), rough(), four_texels()], &json!({}));
    let mut document = head_on(folder, &buffer, &json, EnvironmentSource::Studio);
    (document.camera.yaw_deg, document.camera.pitch_deg) = (30.0, 25.0);
    (document.camera.distance, document.camera.fov_deg) = (Some(3.0), 40.0);
    document
}

/// Everything at once: both engines and all strategies.
pub fn all_at_once(folder: &Workplace) -> Document {
    let material = json!({
        "normalTexture": {"index": 0, "scale": 0.7},
        "alphaMode": "MASK", "alphaCutoff": 0.4, "emissiveFactor": [0.3, 0.2, 0.1],
        "emissiveTexture": {"index": 2, "texCoord": 1},
        "pbrMetallicRoughness": {"metallicFactor": 0.8, "roughnessFactor": 0.5,
            "baseColorFactor": [0.9, 0.8, 0.7, 1], "baseColorTexture": {"index": 2},
            "metallicRoughnessTexture": {"index": 1}},
    });
    let mut document = all_over(folder, &material);
    document.ground = true;
    document
}

/// A coat with textures of its weight, roughness and normal over a flat, coloured base.
pub fn coated_all_over(folder: &Workplace) -> Document {
    let material = json!({
        "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0.5, "baseColorFactor": [0.6, 0.3, 0.1, 1]},
        "extensions": {"KHR_materials_clearcoat": {
            "clearcoatFactor": 1, "clearcoatTexture": {"index": 2}, "clearcoatRoughnessFactor": 0.8,
            "clearcoatRoughnessTexture": {"index": 1}, "clearcoatNormalTexture": {"index": 0, "scale": 0.7},
        }},
    });
    all_over(folder, &material)
}
