//! Pictures in the containers of GPUs and of many bits: cube maps and panoramas in KTX2 and DDS, TIFF of halves, floats and
//! doubles, textures of 16 bits and of light.

use glossmith::import::environment::{load, load_encoded};
use glossmith::import::{load as load_model, load_with};
use glossmith::optics::material::NO_TEXTURE;
use glossmith::optics::tone::{linear_from_srgb, srgb_from_linear};
use glossmith::optics::vector::Vec3;
use glossmith::scene::environment::{EnvironmentEncoding, EnvironmentSource};
use glossmith::scene::texture::TextureTarget;
use glossmith::scene::texture::scale::scaled_to;
use glossmith::scene::texture::{Textures, texture_lookup};
use glossmith::scene::{Fate, Model, ModelOptions, ModelSource, Texture};
use half::f16;
use image::{DynamicImage, ImageBuffer, Rgb};
use serde_json::{Value, json};

use super::environment_shapes::{FACES, assert_is_that_cube};
use super::gltf_builder::{Folder, glb, square};

/// A KTX2 file of levels as they are.
fn ktx2(format: u32, [width, height, faces]: [u32; 3], levels: &[Vec<u8>]) -> Vec<u8> {
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
    let folder = Folder::new();
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
    let folder = Folder::new();
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

/// A TIFF of one strip: 2 × 1 texels of `bits` bits a channel with a point.
fn float_tiff(bits: u16, channels: u16, texels: &[u8]) -> Vec<u8> {
    let mut bytes = b"II*\0\x08\0\0\0".to_vec();
    let after = 8 + 2 + 12 * 10 + 4;
    let entries: [(u16, u16, u32, u32); 10] = [
        (256, 4, 1, 2),
        (257, 4, 1, 1),
        // Where the bits of each channel are told; one channel has them here.
        (
            258,
            3,
            u32::from(channels),
            if channels == 1 { u32::from(bits) } else { after },
        ),
        (259, 3, 1, 1),
        (262, 3, 1, if channels == 1 { 1 } else { 2 }),
        (273, 4, 1, after + 16),
        (277, 3, 1, u32::from(channels)),
        (278, 4, 1, 1),
        (279, 4, 1, texels.len() as u32),
        (339, 3, u32::from(channels), if channels == 1 { 3 } else { after + 8 }),
    ];
    bytes.extend(10_u16.to_le_bytes());
    for (tag, kind, count, value) in entries {
        bytes.extend(tag.to_le_bytes());
        bytes.extend(kind.to_le_bytes());
        bytes.extend(count.to_le_bytes());
        bytes.extend(value.to_le_bytes());
    }
    bytes.extend(0_u32.to_le_bytes());
    for value in [bits, 3] {
        bytes.extend([value, value, value, 0].iter().flat_map(|x| x.to_le_bytes()));
    }
    bytes.extend(texels);
    bytes
}

#[test]
fn tiffs_of_halves_floats_and_doubles_are_light() {
    let folder = Folder::new();
    let path = folder.path("light.tif");
    let numbers = [4.0_f64, 0.5, 0.25, 0.125, 8.0, 1.0];
    let bytes = |bits: u16| -> Vec<u8> {
        let bytes = |x: &f64| match bits {
            16 => f16::from_f64(*x).to_le_bytes().to_vec(),
            32 => (*x as f32).to_le_bytes().to_vec(),
            _ => x.to_le_bytes().to_vec(),
        };
        numbers.iter().flat_map(bytes).collect()
    };
    for bits in [16, 32, 64] {
        std::fs::write(&path, float_tiff(bits, 3, &bytes(bits))).unwrap();
        let environment =
            load(&EnvironmentSource::File(path.clone())).unwrap_or_else(|error| panic!("{bits}: {error}"));
        assert_eq!(
            environment.texels,
            [[4.0, 0.5, 0.25, 1.0], [0.125, 8.0, 1.0, 1.0]],
            "{bits} bits"
        );
        assert!(environment.warnings.is_empty(), "{:?}", environment.warnings);
    }
    let grey: Vec<u8> = [3.0_f32, 0.5].iter().flat_map(|x| x.to_le_bytes()).collect();
    std::fs::write(&path, float_tiff(32, 1, &grey)).unwrap();
    let environment = load(&EnvironmentSource::File(path.clone())).expect("grey loads");
    assert_eq!(environment.texels, [[3.0, 3.0, 3.0, 1.0], [0.5, 0.5, 0.5, 1.0]]);
    // Whole numbers of 16 bits are codes, as ever.
    let codes: ImageBuffer<Rgb<u16>, _> = ImageBuffer::from_pixel(2, 1, Rgb([65535, 32768, 0]));
    DynamicImage::ImageRgb16(codes).save(&path).unwrap();
    let linear = load_encoded(&EnvironmentSource::File(path.clone()), EnvironmentEncoding::Linear).expect("loads");
    assert!((linear.texels[0][1] - 0.5).abs() < 1e-4, "{:?}", linear.texels[0]);
    let display = load(&EnvironmentSource::File(path)).expect("loads");
    assert!((display.texels[0][1] - 0.214).abs() < 1e-3, "{:?}", display.texels[0]);
}

/// A square with a picture in the slot of this name.
fn textured(picture: &[u8], slot: &str) -> Model {
    let folder = Folder::new();
    let (mut buffer, _) = square();
    let view = buffer.view(picture);
    let primitive = json!({"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3, "material": 0});
    let mut document = buffer.document(json!([primitive]));
    document["images"] = json!([{"bufferView": view, "mimeType": "image/png"}]);
    document["textures"] = json!([{"source": 0}]);
    let mut material: Value = json!({"pbrMetallicRoughness": {}});
    match slot {
        "normalTexture" => material[slot] = json!({"index": 0}),
        of_surface => material["pbrMetallicRoughness"][of_surface] = json!({"index": 0}),
    }
    document["materials"] = json!([material]);
    folder
        .load("square.glb", &glb(&document, &buffer.bytes))
        .expect("loads")
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
            assert!((found - expected).abs() < 1e-6, "{slot}: {found} for {expected}");
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

#[test]
fn textures_of_light_are_encoded_by_their_use() {
    let folder = Folder::new();
    let path = folder.path("light.exr");
    super::cli_support::write_exr(
        &path,
        2,
        1,
        |x, _| if x == 0 { [0.5, 0.25, 1.0] } else { [0.0, 3.0, 0.1] },
    );
    let exr = std::fs::read(&path).unwrap();
    let surface = textured(&exr, "metallicRoughnessTexture");
    let half = surface.textures[0].rgba16[0];
    assert!(half.abs_diff(32768) < 2, "linear numbers stay: {half}");
    let color = textured(&exr, "baseColorTexture");
    // 0.5 of light is the code 188; what is brighter than white is white.
    assert_eq!(color.textures[0].rgba8, [188, 137, 255, 255, 0, 255, 89, 255]);
    let texels = [10_u8, 20, 30, 255, 40, 50, 60, 255];
    let model = textured(&dds(28, [2, 1], false, &texels), "baseColorTexture");
    assert_eq!(model.textures[0].rgba8, texels);
}

#[test]
fn grey_indexed_and_cmyk_pictures_are_colours() {
    let mut grey = std::io::Cursor::new(Vec::new());
    DynamicImage::ImageLuma8(ImageBuffer::from_pixel(2, 1, image::Luma([77])))
        .write_to(&mut grey, image::ImageFormat::Png)
        .unwrap();
    let model = textured(&grey.into_inner(), "baseColorTexture");
    assert_eq!(model.textures[0].rgba8[..4], [77, 77, 77, 255]);

    let mut indexed = Vec::new();
    let mut encoder = png::Encoder::new(&mut indexed, 2, 1);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::One);
    encoder.set_palette(vec![1, 2, 3, 200, 100, 50]);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&[0b0100_0000]).unwrap();
    writer.finish().unwrap();
    let model = textured(&indexed, "baseColorTexture");
    assert_eq!(model.textures[0].rgba8, [1, 2, 3, 255, 200, 100, 50, 255]);

    // Magenta and yellow ink: red.
    let cmyk = include_bytes!("../../fuzz/corpus/jpg/cmyk.jpg");
    let model = textured(cmyk, "baseColorTexture");
    let [r, g, b] = [0, 1, 2].map(|channel| model.textures[0].rgba8[channel]);
    assert!(r > 220 && g < 40 && b < 40, "{r} {g} {b}");
}

#[test]
fn textures_above_the_chosen_size_are_scaled_in_all_their_bits() {
    let folder = Folder::new();
    let picture: ImageBuffer<Rgb<u16>, _> = ImageBuffer::from_fn(8, 8, |x, _| Rgb([1000 * x as u16, 40000, 65535]));
    let path = folder.path("normal.png");
    DynamicImage::ImageRgb16(picture).save(&path).unwrap();
    let obj = "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
    std::fs::write(folder.path("a.mtl"), "newmtl m\nnorm normal.png\n").unwrap();
    let model = folder.path("a.obj");
    std::fs::write(&model, obj).unwrap();
    let options = ModelOptions {
        texture_side_max: 4,
        ..ModelOptions::default()
    };
    let small = load_with(&ModelSource::File(model.clone()), &options).expect("loads");
    assert_eq!((small.textures[0].width, small.textures[0].rgba16[0]), (4, 500));
    assert!(
        small.report.lines().join("\n").contains("8 × 8, used at 4 × 4"),
        "{:?}",
        small.report
    );
    assert_eq!(
        load_model(&ModelSource::File(model.clone())).expect("loads").textures[0].width,
        8
    );
    // A TGA is known by its name alone.
    image::RgbImage::from_pixel(2, 2, Rgb([9, 90, 200]))
        .save(folder.path("color.tga"))
        .unwrap();
    std::fs::write(folder.path("a.mtl"), "newmtl m\nmap_Kd color.tga\n").unwrap();
    let painted = load_model(&ModelSource::File(model)).expect("loads");
    assert_eq!(painted.textures[0].rgba8[..4], [9, 90, 200, 255]);
}

/// A DDS file of one texel whose pixel format is told by flags, bits and masks, or by a code.
fn dds_of_masks(flags: u32, code: [u8; 4], bits: u32, masks: [u32; 4], texels: &[u8]) -> Vec<u8> {
    let mut bytes = dds(0, [1, 1], false, &[]);
    bytes.truncate(128);
    let [red, green, blue, opacity] = masks;
    let format = [32, flags, u32::from_le_bytes(code), bits, red, green, blue, opacity];
    for (place, number) in bytes[76..108].chunks_exact_mut(4).zip(format) {
        place.copy_from_slice(&number.to_le_bytes());
    }
    bytes.extend(texels);
    bytes
}

/// The layouts of old DDS files; what is not read is not called damaged.
#[test]
fn old_layouts_of_dds_are_read() {
    let folder = Folder::new();
    let path = folder.path("old.dds");
    let read = |bytes: Vec<u8>| {
        std::fs::write(&path, bytes).unwrap();
        glossmith::import::picture::mean_of_file(&path, &glossmith::import::Budget::of_import())
            .map(|mean| mean.codes.map(|code| (255.0 * code).round() as u8))
    };
    let (with_opacity, alone, code, colors, grey) = (1, 2, 4, 0x40, 0x2_0000);
    let by_masks = |flags, bits, masks, texels: &[u8]| read(dds_of_masks(flags, [0; 4], bits, masks, texels));
    for (name, found, expected) in [
        ("a8", by_masks(alone, 8, [0, 0, 0, 0xff], &[51]), [0, 0, 0, 51]),
        ("l8", by_masks(grey, 8, [0xff, 0, 0, 0], &[51]), [51, 51, 51, 255]),
        (
            "l8a8",
            by_masks(grey | with_opacity, 16, [0xff, 0, 0, 0xff00], &[51, 102]),
            [51, 51, 51, 102],
        ),
        (
            "bgr8",
            by_masks(colors, 24, [0xff_0000, 0xff00, 0xff, 0], &[1, 2, 3]),
            [3, 2, 1, 255],
        ),
        (
            "r5g6b5",
            by_masks(colors, 16, [0xf800, 0x7e0, 0x1f, 0], &[0x1f, 0xf8]),
            [255, 0, 255, 255],
        ),
        (
            "rgb332",
            by_masks(colors, 8, [0xe0, 0x1c, 0x3, 0], &[0xe3]),
            [255, 0, 255, 255],
        ),
        (
            "rgb5a1",
            by_masks(colors | with_opacity, 16, [0x7c00, 0x3e0, 0x1f, 0x8000], &[0x00, 0xfc]),
            [255, 0, 0, 255],
        ),
        (
            "rgb10a2",
            by_masks(
                colors | with_opacity,
                32,
                [0x3ff, 0xf_fc00, 0x3ff0_0000, 0xc000_0000],
                &[0xff, 3, 0, 0x80],
            ),
            [255, 0, 0, 170],
        ),
        // A block of one colour, (0, 255, 0), whose opacity of 51 is its red.
        (
            "bc3rxgb",
            read(dds_of_masks(
                code,
                *b"RXGB",
                0,
                [0; 4],
                &[51, 51, 0, 0, 0, 0, 0, 0, 0xe0, 7, 0xe0, 7, 0, 0, 0, 0],
            )),
            [51, 255, 0, 255],
        ),
    ] {
        assert_eq!(found, Ok(expected), "{name}");
    }
    std::fs::write(&path, dds_of_masks(code, *b"UYVY", 0, [0; 4], &[0; 4])).unwrap();
    let error = load(&EnvironmentSource::File(path)).expect_err("not read").to_string();
    assert!(error.contains("not supported") && !error.contains("damaged"), "{error}");
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
            assert!((half - f64::from(mean(false))).abs() <= 0.5);
            let light = [code, other].map(|code| linear_from_srgb(Vec3::splat(f64::from(code) / 255.0)).x);
            let exact = 255.0 * srgb_from_linear(Vec3::splat((light[0] + light[1]) / 2.0)).x;
            assert!(
                (exact - f64::from(mean(true))).abs() < 0.5 + 1e-4,
                "{code} and {other}: {exact}"
            );
        }
    }
    // Sides that are odd: every row and column counts once.
    let rows: Vec<[u8; 4]> = (0..15).map(|place| [10 * place, 0, 0, 255]).collect();
    let (reduced, from) = scaled_to(texels(3, 5, &rows), 2, false);
    assert_eq!(([reduced.width, reduced.height], from), ([1, 2], Some([3, 5])));
    assert_eq!([reduced.rgba8[0], reduced.rgba8[4]], [25, 100]);
}
