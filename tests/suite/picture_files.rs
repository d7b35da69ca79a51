//! Pictures as files: every format and every channel against the film that it was made of; and what pictures that are read
//! say of their texels.

use crate::{
    cli_support::{Workplace, channels},
    gltf_builder::pictured,
    gltf_extensions::load_plain,
    gpu_pictures::ktx2,
    renders::adjust,
};
use exr::prelude::WritableImage as _;
use glossmith::{
    document::{AreaLight, Background, Document},
    import::{Budget, environment::load, picture::read_texture},
    job::film::Film,
    optics::tone::ToneCurve,
    render::{EngineChoice, Session, output, output::Layers},
    scene::{ModelSource, environment::EnvironmentSource},
};
use image::ImageEncoder as _;
use serde_json::json;
use std::{collections::HashMap, path::Path, time::Duration};

/// Coloured, brighter than white in places, its pixels covered in part or not at all, with more samples here than there.
fn document() -> Document {
    let mut document = Document {
        model: ModelSource::Sphere,
        ..Document::default()
    };
    adjust(
        &mut document,
        "base.metalness=0 base.color=0.9,0.3,0.05 specular.roughness=0.3 lighting.strength=2 render.width=41 \
         render.height=29 render.samples=64 render.min_samples=4 render.noise=0.02 render.adaptive=on",
    );
    document.lighting.environment = EnvironmentSource::Studio;
    document.lighting.background = Background::Transparent;
    document.lighting.area_lights.push(AreaLight {
        color: [1.0, 0.2, 0.1],
        ..AreaLight::default()
    });
    (document.view.tone_map, document.view.exposure_ev) = (ToneCurve::None, -0.5);
    document
}

fn rendered(document: &Document) -> (Film, Layers) {
    let mut session = Session::open(EngineChoice::Cpu).unwrap();
    session.keep_guides("layers are compared");
    session.submit(document).unwrap();
    while !session.step(Duration::from_secs(1)).unwrap().is_done {}
    let layers = session.layers().unwrap();
    (session.film().unwrap().clone(), layers)
}

/// The mean of each pixel straight from the sums: red, green, blue, multiplied by the alpha that follows.
fn means(film: &Film) -> Vec<[f64; 4]> {
    let mean = |pixel| film.color(pixel).map(|sum| sum / film.samples_of(pixel));
    (0..film.pixel_count()).map(mean).collect()
}

fn luminance([r, g, b, _]: [f64; 4]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Fails at the first pixel of a channel that is not what it must be.
#[track_caller]
fn assert_channel(found: &[f32], expected: impl ExactSizeIterator<Item = f32>, name: &str) {
    assert_eq!(found.len(), expected.len(), "{name}");
    for (pixel, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert_eq!(*found, expected, "{name} of pixel {pixel}");
    }
}

/// What the colour's channels of an .exr must hold.
fn assert_color(found: &HashMap<String, Vec<f32>>, film: &Film) {
    for (i, name) in ["R", "G", "B", "A"].into_iter().enumerate() {
        assert_channel(&found[name], means(film).into_iter().map(|mean| mean[i] as f32), name);
    }
}

/// What an .exr with layers must hold beside the colour.
fn assert_layers(found: &HashMap<String, Vec<f32>>, film: &Film, layers: &Layers) {
    assert_color(found, film);
    let features = &layers.features;
    for (i, (color, axis)) in [("R", "X"), ("G", "Y"), ("B", "Z")].into_iter().enumerate() {
        for (name, vectors) in [
            (format!("albedo.{color}"), &features.albedo),
            (format!("normal.{axis}"), &features.normal),
        ] {
            assert_channel(&found[&name], vectors.iter().map(|vector| vector[i]), &name);
        }
    }
    assert_channel(&found["depth.Z"], features.depth.iter().copied(), "depth.Z");
    let counts = (0..film.pixel_count()).map(|pixel| film.samples_of(pixel) as f32);
    assert_channel(&found["samples.Y"], counts, "samples.Y");
    // The spread of the samples over their number: the variance of the mean, with Bessel's correction.
    for (pixel, mean) in means(film).into_iter().enumerate() {
        let n = film.samples_of(pixel);
        let halves = film.pixels[pixel];
        // Within the halves, and between them.
        let within = halves.iter().map(|half| half.squared_deviations);
        let between = halves
            .iter()
            .map(|half| half.samples * (half.luminance() / half.samples - luminance(mean)).powi(2));
        let expected = (within.sum::<f64>() + between.sum::<f64>()) / (n * (n - 1.0));
        let error = f64::from(found["variance.Y"][pixel]) - expected;
        assert!(
            error.abs() <= 1e-6 * expected,
            "pixel {pixel}: off by {error} of {expected}"
        );
    }
}

/// sRGB's encoding (IEC 61966-2-1) of what is in [0, 1], from 0 to 255.
fn srgb_code(linear: f64) -> f64 {
    let x = linear.clamp(0.0, 1.0);
    255.0
        * if x <= 0.003_130_8 {
            12.92 * x
        } else {
            1.055 * x.powf(1.0 / 2.4) - 0.055
        }
}

fn assert_png(path: &Path, film: &Film, exposure: f64) {
    let found = image::open(path).unwrap().into_rgba8();
    assert_eq!(found.dimensions(), (film.width, film.height));
    for (pixel, mean) in found.pixels().zip(means(film)) {
        let alpha = mean[3];
        let expected = [0, 1, 2].map(|i| {
            if alpha > 0.0 {
                srgb_code(mean[i] / alpha * exposure)
            } else {
                0.0
            }
        });
        for (code, expected) in pixel.0.into_iter().zip(expected.into_iter().chain([255.0 * alpha])) {
            // To the nearest code, as far as f32 tells which.
            near!(f64::from(code), expected, 0.51, "{pixel:?}: {expected:?} of {mean:?}");
        }
    }
}

fn assert_hdr(path: &Path, film: &Film) {
    let found = image::open(path).unwrap().into_rgb32f();
    assert_eq!(found.dimensions(), (film.width, film.height));
    for (pixel, mean) in found.pixels().zip(means(film)) {
        // One exponent for the three: eight bits for the largest.
        let step = mean[..3].iter().copied().fold(0.0, f64::max) / 128.0;
        for (value, expected) in pixel.0.into_iter().zip(mean) {
            near!(f64::from(value), expected, step, "{pixel:?} of {mean:?}");
        }
    }
}

#[test]
fn every_format_holds_the_film() {
    let document = document();
    let (film, layers) = rendered(&document);
    let all = means(&film);
    let count = |is: fn(&[f64; 4]) -> bool| all.iter().filter(|mean| is(mean)).count();
    assert!(count(|mean| mean[3] > 0.05 && mean[3] < 0.95) > 20, "covered in part");
    assert!(
        count(|mean| mean[0] > 1.5 * mean[2] && mean[3] == 1.0) > 100,
        "coloured"
    );
    let samples: Vec<f64> = (0..film.pixel_count()).map(|pixel| film.samples_of(pixel)).collect();
    assert!(samples.iter().any(|n| *n != samples[0]), "samples differ");

    let place = Workplace::new();
    for name in ["a.exr", "a.png", "a.hdr"] {
        output::write(&place.path(name), (&layers.image).into(), &document).unwrap();
    }
    output::write_layers(&place.path("layers.exr"), &layers).unwrap();
    assert_color(&channels(&place.path("a.exr")), &film);
    assert_layers(&channels(&place.path("layers.exr")), &film, &layers);
    assert_png(&place.path("a.png"), &film, f64::from(document.view.exposure_ev).exp2());
    assert_hdr(&place.path("a.hdr"), &film);
}

const RED: [u8; 4] = [255, 0, 0, 255];
const GREEN: [u8; 4] = [0, 255, 0, 255];
const BLUE: [u8; 4] = [0, 0, 255, 255];
const WHITE: [u8; 4] = [255; 4];

/// Little-endian bytes.
fn words(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

/// Two by two texels that say a key of theirs.
fn keyed(key_and_value: &[u8], texels: [[u8; 4]; 4]) -> Vec<u8> {
    let mut file = ktx2(37, [2, 2, 1], &[texels.concat()]);
    let values = [&words(&[key_and_value.len() as u32]), key_and_value].concat();
    file.splice(56..64, words(&[file.len() as u32, values.len() as u32]));
    file.extend(values);
    file
}

/// A file of 32 bits that promises so many of opacity.
fn tga(opacity_bits: u8, texels: [[u8; 4]; 4]) -> Vec<u8> {
    let header = [0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2, 0, 32, 0x20 | opacity_bits];
    let texels = texels.map(|[r, g, b, a]| [b, g, r, a]);
    [&header[..], texels.as_flattened()].concat()
}

/// A file whose extra sample is of this kind: 1 is opacity that multiplies the colours.
fn tiff(extra: u32, texels: [[u8; 4]; 4]) -> Vec<u8> {
    // Tag, type, count, value; 8 × 4 bits stand behind the directory, the texels behind them.
    let tags = [
        [256, 3, 1, 2],
        [257, 3, 1, 2],
        [258, 3, 4, 134],
        [259, 3, 1, 1],
        [262, 3, 1, 2],
        [273, 4, 1, 142],
        [277, 3, 1, 4],
        [278, 3, 1, 2],
        [279, 4, 1, 16],
        [338, 3, 1, extra],
    ];
    let entry = |[tag, kind, count, value]: [u32; 4]| words(&[tag | kind << 16, count, value]);
    let directory = tags.map(entry).concat();
    let start = [b"II*\0\x08\0\0\0", &[10, 0][..], &directory, &[0; 4]].concat();
    [&start, &[8, 0].repeat(4)[..], texels.as_flattened()].concat()
}

/// A photograph of a camera that was held upright: to be turned clockwise.
fn photo(texels: [[u8; 4]; 4]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = image::codecs::png::PngEncoder::new(&mut bytes);
    let exif = b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0";
    encoder.set_exif_metadata(exif.to_vec()).unwrap();
    let color = image::ExtendedColorType::Rgba8;
    encoder.write_image(texels.as_flattened(), 2, 2, color).unwrap();
    bytes
}

/// Runs of 8 bits that leave the first texel out.
fn bmp() -> Vec<u8> {
    let runs = [1, 2, 1, 3, 0, 0, 0, 2, 1, 0, 1, 1, 0, 1];
    let palette = [RED, GREEN, BLUE, WHITE].map(|[r, g, b, _]| [b, g, r, 0]);
    let header = words(&[40, 2, 2, 1 | 8 << 16, 1, runs.len() as u32, 0, 0, 4, 4]);
    let start = words(&[70 + runs.len() as u32, 0, 70]);
    [b"BM", &start[..], &header, palette.as_flattened(), &runs].concat()
}

/// Light that a fifth of opacity multiplies, under names in lower case.
fn exr(place: &Workplace) -> Vec<u8> {
    use exr::prelude::{Encoding, Image, SpecificChannels, Vec2};
    let texels = [RED, GREEN, BLUE, WHITE].map(|texel| texel.map(|code| f32::from(code) / 255.0 * 0.2));
    let texel = |Vec2(x, y): Vec2<usize>| {
        let [r, g, b, a] = texels[2 * y + x];
        (r, g, b, a)
    };
    let channels = SpecificChannels::build()
        .with_channel::<f32>("r")
        .with_channel("g")
        .with_channel("b")
        .with_channel("a")
        .with_pixel_fn(texel);
    let path = place.path("written.exr");
    let image = Image::from_encoded_channels((2, 2), Encoding::UNCOMPRESSED, channels);
    image.write().to_file(&path).unwrap();
    std::fs::read(path).unwrap()
}

#[test]
fn what_a_picture_says_of_its_texels_is_heeded() {
    let place = Workplace::new();
    let all = [RED, GREEN, BLUE, WHITE];
    let with_opacity = |opacity: u8| all.map(|[r, g, b, _]| [r, g, b, opacity]);
    let fifth = all.map(|texel| texel.map(|code| code / 5));
    // 0.5, by a shared exponent of 128.
    let half = all.map(|[r, g, b, _]| [r.div_ceil(2), g.div_ceil(2), b.div_ceil(2), 128]);
    for (name, bytes, expected) in [
        ("no bits of opacity.tga", tga(0, with_opacity(0)), all),
        ("bits of opacity.tga", tga(8, with_opacity(0)), with_opacity(0)),
        ("multiplied.tif", tiff(1, fifth), with_opacity(51)),
        ("not multiplied.tif", tiff(2, fifth), fifth),
        ("multiplied.exr", exr(&place), with_opacity(51)),
        ("photo.png", photo(all), [BLUE, RED, WHITE, GREEN]),
        (
            "exposed.hdr",
            [
                &b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\nEXPOSURE=.5\nCOLORCORR=.5 .5 .5\n\n-Y 2 +X 2\n"[..],
                &half.concat(),
            ]
            .concat(),
            all,
        ),
        ("runs.bmp", bmp(), all),
        (
            "up.ktx2",
            keyed(b"KTXorientation\0ru\0", all),
            [BLUE, WHITE, RED, GREEN],
        ),
        (
            "left.ktx2",
            keyed(b"KTXorientation\0ld\0", all),
            [GREEN, RED, WHITE, BLUE],
        ),
        (
            "exchanged.ktx2",
            keyed(b"KTXswizzle\0bgr1\0", with_opacity(9)),
            [BLUE, GREEN, RED, WHITE],
        ),
    ] {
        place.write(name, &bytes);
        let texture = read_texture(&place.path(name), true, 16, &Budget::of_import()).expect(name);
        assert_eq!(texture.rgba8, expected.concat(), "{name}");
    }
    let panorama = load(&EnvironmentSource::File(place.path("photo.png"))).expect("loads");
    let first = [0, 1].map(|place| panorama.texels[place].map(f32::round));
    assert_eq!(first, [[0.0, 0.0, 1.0, 1.0], [1.0, 0.0, 0.0, 1.0]]);
    // The format says that cameras' words don't count (glTF 2.0, "Images").
    let material = json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    let (buffer, document) = pictured(material, &photo(all));
    let model = load_plain(&document, &buffer);
    assert_eq!(model.textures[0].rgba8, all.concat());
}
