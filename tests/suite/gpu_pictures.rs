//! Pictures in the containers of GPUs and of many bits: cube maps and panoramas in KTX2 and DDS, and
//! textures of 16 bits.

use super::{
    cli_support::Workplace,
    environment_shapes::{FACES, assert_is_that_cube},
    gltf_builder::pictured,
    gltf_extensions::load_plain,
};
use glossmith::{
    import::environment::load,
    optics::{material::NO_TEXTURE, tone::linear_from_srgb, tone::srgb_from_linear, vector::Vec3},
    scene::{
        Fate, Model, Texture,
        environment::EnvironmentSource,
        texture::{TextureTarget, Textures, scale::scaled_to, texture_lookup},
    },
};
use half::f16;
use image::{DynamicImage, ImageBuffer, Rgb};
use serde_json::json;

/// A KTX2 file of levels as they are.
pub fn ktx2(format: u32, [width, height, faces]: [u32; 3], levels: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = b"\xabKTX 20\xbb\r\n\x1a\n".to_vec();
    let numbers = [format, 1, width, height, 0, 0, faces, levels.len() as u32, 0];
    bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
    bytes.resize(80, 0);
    let mut start = 80 + 24 * levels.len() as u64;
    for level in levels {
        let length = level.len() as u64;
        bytes.extend([start, length, length].iter().flat_map(|number| number.to_le_bytes()));
        start += length;
    }
    bytes.extend(levels.iter().flatten());
    bytes
}

/// Six faces of `side` texels, each of one colour, as numbers of these bytes.
fn faces(side: u32, texel: impl Fn([f32; 3]) -> Vec<u8>) -> Vec<u8> {
    let face = |color: &[f32; 3]| texel(*color).repeat((side * side) as usize);
    FACES.iter().flat_map(face).collect()
}

/// A DDS file with DXGI's number of a format.
fn dds(format: u32, [width, height]: [u32; 2], is_cube: bool, texels: &[u8]) -> Vec<u8> {
    let mut bytes = b"DDS ".to_vec();
    let mut numbers = vec![124, 0x1007, height, width, 0, 0, 1];
    numbers.extend([0; 11]);
    // The pixel format: the extension tells.
    numbers.extend([32, 4, u32::from_le_bytes(*b"DX10"), 0, 0, 0, 0, 0]);
    numbers.extend([0x1000, if is_cube { 0xfe00 } else { 0 }, 0, 0, 0]);
    numbers.extend([format, 3, if is_cube { 4 } else { 0 }, 1, 0]);
    bytes.extend(numbers.iter().flat_map(|number: &u32| number.to_le_bytes()));
    bytes.extend(texels);
    bytes
}

fn halves([r, g, b]: [f32; 3]) -> Vec<u8> {
    [r, g, b, 1.0]
        .iter()
        .flat_map(|x| f16::from_f32(*x).to_le_bytes())
        .collect()
}

fn shared_exponent(color: [f32; 3]) -> Vec<u8> {
    // 256 · 2^(16 − 24) is one.
    let [r, g, b] = color.map(|x| (x * 256.0) as u32);
    (16_u32 << 27 | b << 18 | g << 9 | r).to_le_bytes().to_vec()
}

fn small_floats(color: [f32; 3]) -> Vec<u8> {
    let [r, g, b] = color.map(|x| u32::from(f16::from_f32(x).to_bits()));
    (r >> 4 | (g >> 4) << 11 | (b >> 5) << 22).to_le_bytes().to_vec()
}

#[test]
fn ktx2_cubes_of_every_kind_of_light_are_read() {
    let folder = Workplace::new();
    let path = folder.path("cube.ktx2");
    let floats = |[r, g, b]: [f32; 3]| [r, g, b, 1.0_f32].iter().flat_map(|x| x.to_le_bytes()).collect();
    let codes = |color: [f32; 3]| color.iter().map(|x| (255.0 * x) as u8).chain([255]).collect();
    let three_halves = |color: [f32; 3]| halves(color)[..6].to_vec();
    let shorts = |[r, g, b]: [f32; 3]| {
        let codes = [r, g, b, 1.0].map(|x| (65535.0 * x).round() as u16);
        codes.iter().flat_map(|code| code.to_le_bytes()).collect()
    };
    let kinds: [(&str, u32, Vec<u8>); 7] = [
        ("halves", 97, faces(8, halves)),
        ("three halves", 90, faces(8, three_halves)),
        ("floats", 109, faces(8, floats)),
        ("shared exponent", 123, faces(8, shared_exponent)),
        ("small floats", 122, faces(8, small_floats)),
        ("shorts", 91, faces(8, shorts)),
        ("codes", 43, faces(8, codes)),
    ];
    for (name, format, level) in kinds {
        std::fs::write(&path, ktx2(format, [8, 8, 6], std::slice::from_ref(&level))).unwrap();
        let environment =
            load(&EnvironmentSource::File(path.clone())).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_is_that_cube(&environment, name);
        let is_of_screens = environment
            .warnings
            .iter()
            .any(|warning| warning.contains("for screens"));
        assert_eq!(is_of_screens, name == "codes", "{name}: {:?}", environment.warnings);
        // Cut short: refused.
        let cut = ktx2(format, [8, 8, 6], &[level[..level.len() - 9].to_vec()]);
        std::fs::write(&path, cut).unwrap();
        let error = load(&EnvironmentSource::File(path.clone()))
            .expect_err("it is cut")
            .to_string();
        assert!(error.contains("cube.ktx2") && error.contains("damaged"), "{error}");
    }
}

#[test]
fn dds_cubes_and_panoramas_are_read() {
    let folder = Workplace::new();
    let path = folder.path("cube.dds");
    let load_of = |bytes: Vec<u8>| {
        std::fs::write(&path, bytes).unwrap();
        load(&EnvironmentSource::File(path.clone())).unwrap_or_else(|error| panic!("{error}"))
    };
    assert_is_that_cube(&load_of(dds(10, [8, 8], true, &faces(8, halves))), "halves");
    assert_is_that_cube(
        &load_of(dds(67, [8, 8], true, &faces(8, shared_exponent))),
        "shared exponents",
    );
    assert_is_that_cube(&load_of(dds(26, [8, 8], true, &faces(8, small_floats))), "small floats");
    let codes = |color: [f32; 3]| color.iter().map(|x| (255.0 * x) as u8).chain([255]).collect();
    assert_is_that_cube(&load_of(dds(28, [8, 8], true, &faces(8, codes))), "codes");
    // A block of one colour, 5, 6 and 5 bits: both ends the same, no texel of another.
    let block = |[r, g, b]: [f32; 3]| {
        let code = ((r * 31.0) as u16) << 11 | ((g * 63.0) as u16) << 5 | (b * 31.0) as u16;
        [code.to_le_bytes(), code.to_le_bytes(), [0; 2], [0; 2]].concat()
    };
    let blocks: Vec<u8> = FACES.iter().flat_map(|color| block(*color).repeat(4)).collect();
    assert_is_that_cube(&load_of(dds(71, [8, 8], true, &blocks)), "blocks");
    // A flat one is a panorama.
    let flat: Vec<u8> = halves([2.0, 0.5, 0.25]).repeat(128);
    let panorama = load_of(dds(10, [16, 8], false, &flat));
    assert_eq!(
        (panorama.width, panorama.height, panorama.texels[77]),
        (16, 8, [2.0, 0.5, 0.25, 1.0])
    );
    std::fs::write(&path, b"DDS what?").unwrap();
    let error = load(&EnvironmentSource::File(path.clone()))
        .expect_err("no DDS")
        .to_string();
    assert!(error.contains("cube.dds"), "{error}");
    std::fs::write(&path, b"GIF89a").unwrap();
    let error = load(&EnvironmentSource::File(path)).expect_err("no DDS").to_string();
    assert!(error.contains("not a KTX2 or DDS file"), "{error}");
}

/// A square with a picture in the slot of this name.
fn textured(picture: &[u8], slot: &str) -> Model {
    let texture = json!({"index": 0});
    let material = match slot {
        "normalTexture" => json!({slot: texture}),
        of_surface => json!({"pbrMetallicRoughness": {of_surface: texture}}),
    };
    let (buffer, document) = pictured(material, picture);
    load_plain(&document, &buffer)
}

fn png16(texels: [[u16; 3]; 2]) -> Vec<u8> {
    let picture: ImageBuffer<Rgb<u16>, _> = ImageBuffer::from_fn(2, 1, |x, _| Rgb(texels[x as usize]));
    let mut bytes = std::io::Cursor::new(Vec::new());
    DynamicImage::ImageRgb16(picture)
        .write_to(&mut bytes, image::ImageFormat::Png)
        .unwrap();
    bytes.into_inner()
}

#[test]
fn normals_and_roughness_keep_sixteen_bits_and_colours_have_eight() {
    let png = png16([[32768 + 77, 32768 - 40, 65535], [33000, 40000, 65000]]);
    for slot in ["normalTexture", "metallicRoughnessTexture"] {
        let model = textured(&png, slot);
        assert_eq!(model.textures[0].rgba16[..3], [32768 + 77, 32768 - 40, 65535], "{slot}");
        // Where there is room for a texel it is one of as many bits.
        assert_eq!(Textures::within(&model, 256 + 3).warnings.len(), 1, "{slot}");
        let textures = Textures::new(&model);
        let of_slot = &textures.slots[0];
        let record = of_slot.record(match slot {
            "normalTexture" => TextureTarget::Normal,
            _ => TextureTarget::Roughness,
        });
        assert_ne!(record, NO_TEXTURE);
        // The middle of the first texel.
        let (found, alpha) = texture_lookup(&textures, record, [[0.25_f64, 0.5]; 3]);
        let expected = [32768.0 + 77.0, 32768.0 - 40.0, 65535.0].map(|code| code / 65535.0);
        for (found, expected) in found.to_f64().into_iter().zip(expected) {
            near!(found, expected, 1e-6, "{slot}");
        }
        assert_eq!(alpha, 1.0);
    }
    let model = textured(&png, "baseColorTexture");
    assert!(model.textures[0].rgba16.is_empty());
    assert_eq!(model.textures[0].rgba8[..4], [128, 127, 255, 255]);
    let memory = model
        .report
        .of(Fate::Used)
        .find(|entry| entry.what.contains("MiB in memory"));
    assert!(memory.is_some(), "{:?}", model.report);
}

/// A picture of 8 bits.
fn texels(width: u32, height: u32, rgba8: &[[u8; 4]]) -> Texture {
    Texture {
        name: String::new(),
        width,
        height,
        rgba8: rgba8.concat(),
        rgba16: Vec::new(),
    }
}

/// Colours are averaged as light and encoded again, other values as they are; what is equal stays as it is.
#[test]
fn means_of_texels_are_rounded_once() {
    for code in 0..=255_u8 {
        let texel = [code, 255 - code, code / 3, code];
        for is_color in [false, true] {
            let halved = |last: [u8; 4]| {
                let picture = texels(3, 2, &[texel, texel, texel, texel, texel, last]);
                scaled_to(picture, 1, is_color).0.rgba8
            };
            assert_eq!(halved(texel), texel);
            // With one that differs in opacity alone, colours are computed.
            let [r, g, b, a] = texel;
            assert_eq!(halved([r, g, b, a.wrapping_add(1)])[..3], texel[..3], "{is_color}");
        }
        for other in (0..=255_u8).step_by(5) {
            let mean = |is_color| scaled_to(texels(2, 1, &[[code; 4], [other; 4]]), 1, is_color).0.rgba8[0];
            let half = (f64::from(code) + f64::from(other)) / 2.0;
            near!(half, f64::from(mean(false)), 0.5);
            let light = [code, other].map(|code| linear_from_srgb(Vec3::splat(f64::from(code) / 255.0)).x);
            let exact = 255.0 * srgb_from_linear(Vec3::splat((light[0] + light[1]) / 2.0)).x;
            near!(exact, f64::from(mean(true)), 0.5 + 0.0001, "{code} and {other}");
        }
    }
    // Sides that are odd: every row and column counts once.
    let rows: Vec<[u8; 4]> = (0..15).map(|place| [10 * place, 0, 0, 255]).collect();
    let (reduced, from) = scaled_to(texels(3, 5, &rows), 2, false);
    assert_eq!(([reduced.width, reduced.height], from), ([1, 2], Some([3, 5])));
    assert_eq!([reduced.rgba8[0], reduced.rgba8[4]], [25, 100]);
}
