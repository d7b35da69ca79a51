//! Environments from files: what is read right, what is mended, and what is refused in one clear line.

use crate::cli_support::Workplace;
use std::path::{Path, PathBuf};

use exr::meta::attribute::EnvironmentMap;
use exr::prelude::{
    AnyChannel, AnyChannels, Compression, Encoding, FlatSamples, Image, ImageAttributes, IntegerBounds, Layer,
    LayerAttributes, LineOrder, SmallVec, SpecificChannels, Vec2, WritableImage, f16,
};
use glossmith::{
    import::environment::{EnvironmentError, load},
    optics::vector::vec3,
    scene::environment::{Environment, EnvironmentSource, environment_radiance},
};
use image::codecs::hdr::HdrEncoder;

const WIDTH: usize = 16;
const HEIGHT: usize = 8;

fn load_file(path: &Path) -> Result<Environment, EnvironmentError> {
    load(&EnvironmentSource::File(path.to_owned()))
}

/// The error of loading a file, after checking that it is one line that names the file.
fn refusal(path: &Path) -> String {
    let error = match load_file(path) {
        Ok(_) => panic!("{} was accepted", path.display()),
        Err(error) => error.to_string(),
    };
    assert!(error.contains(&path.display().to_string()), "no file name in: {error}");
    assert!(!error.contains('\n'), "more than a line: {error}");
    error
}

fn assert_says(error: &str, parts: &[&str]) {
    for part in parts {
        assert!(error.contains(part), "'{part}' is not in: {error}");
    }
}

fn write_bytes(folder: &Workplace, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.path(name);
    std::fs::write(&path, bytes).expect("a writable folder");
    path
}

/// Values that RGBE holds exactly.
fn value(column: usize, row: usize, channel: usize) -> f32 {
    0.25 * (1 + (column * 5 + row * 3 + channel) % 64) as f32
}

fn hdr_bytes(width: usize, height: usize) -> Vec<u8> {
    let pixels: Vec<_> = (0..width * height)
        .map(|index| image::Rgb([0, 1, 2].map(|channel| value(index % width, index / width, channel))))
        .collect();
    let mut bytes = Vec::new();
    HdrEncoder::new(&mut bytes)
        .encode(&pixels, width, height)
        .expect("memory to write to");
    bytes
}

/// One channel of the test picture.
fn samples(channel: usize, kind: &str) -> FlatSamples {
    let values = (0..WIDTH * HEIGHT).map(|index| value(index % WIDTH, index / WIDTH, channel));
    match kind {
        "half" => FlatSamples::F16(values.map(f16::from_f32).collect()),
        "uint" => FlatSamples::U32(values.map(|value| (value * 4.0) as u32).collect()),
        _ => FlatSamples::F32(values.collect()),
    }
}

fn exr_layer(
    names: &[(&str, usize)],
    kind: &str,
    compression: Compression,
    attributes: LayerAttributes,
) -> Layer<AnyChannels<FlatSamples>> {
    let list: SmallVec<_> = names
        .iter()
        .map(|&(name, channel)| AnyChannel::new(name, samples(channel, kind)))
        .collect();
    let encoding = Encoding {
        compression,
        line_order: LineOrder::Increasing,
        ..Encoding::UNCOMPRESSED
    };
    Layer::new((WIDTH, HEIGHT), attributes, encoding, AnyChannels::sort(list))
}

fn exr_file(folder: &Workplace, name: &str, names: &[(&str, usize)], kind: &str, compression: Compression) -> PathBuf {
    let path = folder.path(name);
    let layer = exr_layer(names, kind, compression, LayerAttributes::default());
    Image::from_layer(layer)
        .write()
        .to_file(&path)
        .expect("a writable folder");
    path
}

fn assert_shows(environment: &Environment, factor: f32, channels: [usize; 3]) {
    assert_eq!(
        (environment.width as usize, environment.height as usize),
        (WIDTH, HEIGHT)
    );
    assert!(environment.warnings.is_empty(), "{:?}", environment.warnings);
    for (index, texel) in environment.texels.iter().enumerate() {
        let expected = channels.map(|channel| factor * value(index % WIDTH, index / WIDTH, channel));
        assert_eq!(*texel, [expected[0], expected[1], expected[2], 1.0], "texel {index}");
    }
}

const RGB: [(&str, usize); 3] = [("R", 0), ("G", 1), ("B", 2)];

#[test]
fn names_are_read_and_written() {
    for (text, expected) in [
        ("studio", EnvironmentSource::Studio),
        ("sky", EnvironmentSource::Sky),
        ("furnace", EnvironmentSource::Furnace),
        ("./sky", EnvironmentSource::File("./sky".into())),
        ("a b.hdr", EnvironmentSource::File("a b.hdr".into())),
    ] {
        let source: EnvironmentSource = text.parse().unwrap();
        assert_eq!(source, expected);
        assert_eq!(source.to_string(), text);
        let json = serde_json::to_string(&source).unwrap();
        assert_eq!(
            serde_json::from_str::<EnvironmentSource>(&json).unwrap(),
            source,
            "{json}"
        );
    }
    assert!("".parse::<EnvironmentSource>().is_err());
}

#[test]
fn hdr_files_are_read() {
    let folder = Workplace::new();
    let bytes = hdr_bytes(WIDTH, HEIGHT);
    let environment = load_file(&write_bytes(&folder, "a.hdr", &bytes)).unwrap();
    assert_shows(&environment, 1.0, [0, 1, 2]);
    assert_eq!(environment.name, "a.hdr");
}

/// What Radiance's programs say before the pixels, and editors make of it.
#[test]
fn hdr_headers_are_heeded() {
    let folder = Workplace::new();
    let format = "FORMAT=32-bit_rle_rgbe";
    for (name, header, expected) in [
        (
            "line ends",
            format!("#?RADIANCE\r\n{format}\r\n\r\n-Y 1 +X 2\r\n"),
            [1.0, 0.5, 0.25],
        ),
        (
            "another signature",
            format!("#?RGBE\n{format}\n\n-Y 1 +X 2\n"),
            [1.0, 0.5, 0.25],
        ),
        ("no signature", format!("{format}\n\n-Y 1 +X 2\n"), [1.0, 0.5, 0.25]),
        (
            "corrections",
            format!("#?RADIANCE\n{format}\nCOLORCORR= 2 1 0.5\nCOLORCORR=1 0.5 1\n\n-Y 1 +X 2\n"),
            [0.5, 1.0, 0.5],
        ),
        (
            "exposures",
            format!("#?RADIANCE\nEXPOSURE=2.5\n{format}\nEXPOSURE= 0.2\nCOLORCORR=1 0.5 1\n\n-Y 1 +X 2\n"),
            [2.0, 2.0, 0.5],
        ),
        (
            "factors that nothing undoes",
            format!("#?RADIANCE\n{format}\nEXPOSURE=0\nEXPOSURE=much\nCOLORCORR=1 -1 1e-60\n\n-Y 1 +X 2\n"),
            [1.0, 0.5, 0.25],
        ),
        (
            // By the matrix of ITU-R BT.2087.
            "primaries",
            format!("#?RADIANCE\n{format}\nPRIMARIES=.708 .292 .17 .797 .131 .046 .3127 .329\n\n-Y 1 +X 2\n"),
            [1.3485, 0.4398, 0.2111],
        ),
    ] {
        let bytes = [header.as_bytes(), &[128, 64, 32, 129].repeat(2)].concat();
        let environment = load_file(&write_bytes(&folder, "a.hdr", &bytes)).unwrap();
        for (found, expected) in std::iter::zip(environment.texels[1], expected) {
            near!(found, expected, 0.001, "{name}");
        }
    }
}

/// Which half of which face lies where (OpenEXR, `CubeMap::pixelPosition`).
#[test]
fn exr_cubes_have_their_own_orientation() {
    let folder = Workplace::new();
    let (path, side) = (folder.path("cube.exr"), 32);
    let attributes = LayerAttributes {
        environment_map: Some(EnvironmentMap::Cube),
        ..LayerAttributes::default()
    };
    // The face's number, and 1 in its right and in its lower half.
    let half = |place: usize| if place % side < side / 2 { 0.0_f32 } else { 1.0 };
    let color = |Vec2(x, y): Vec2<usize>| ((y / side) as f32, half(x), half(y));
    let layer = Layer::new(
        (side, 6 * side),
        attributes,
        Encoding::UNCOMPRESSED,
        SpecificChannels::rgb(color),
    );
    Image::from_layer(layer).write().to_file(&path).unwrap();
    let environment = load_file(&path).unwrap();
    let lower_right: [[f64; 3]; 6] = [
        [1.0, -0.4, 0.4],
        [-1.0, -0.4, -0.4],
        [0.4, 1.0, -0.4],
        [0.4, -1.0, 0.4],
        [-0.4, -0.4, 1.0],
        [0.4, -0.4, -1.0],
    ];
    for (face, [x, y, z]) in lower_right.into_iter().enumerate() {
        let found = environment_radiance(&environment, vec3(x, y, z).normalize()).to_f32();
        for (found, expected) in std::iter::zip(found, [face as f32, 1.0, 1.0]) {
            near!(found, expected, 0.001, "face {face}");
        }
    }
}

#[test]
fn exr_files_are_read_in_every_supported_compression_and_number_type() {
    let folder = Workplace::new();
    let lossless = [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
    ];
    for compression in lossless {
        for (kind, factor) in [("half", 1.0), ("float", 1.0), ("uint", 4.0)] {
            let path = exr_file(&folder, "a.exr", &RGB, kind, compression);
            assert_shows(&load_file(&path).unwrap(), factor, [0, 1, 2]);
        }
    }
}

#[test]
fn exr_channels_are_chosen() {
    let folder = Workplace::new();
    let zip = Compression::ZIP16;
    for (channels, kind, shown) in [
        (
            &[("R", 0), ("G", 1), ("B", 2), ("A", 7), ("Z", 8)][..],
            "half",
            [0, 1, 2],
        ),
        (&[("r", 0), ("g", 1), ("b", 2), ("a", 7)], "half", [0, 1, 2]),
        (&[("Y", 3)], "float", [3; 3]),
        (
            &[
                ("a.b.B", 5),
                ("a.b.G", 6),
                ("a.b.R", 7),
                ("v.B", 2),
                ("v.G", 1),
                ("v.R", 0),
                ("Y", 9),
            ],
            "half",
            [0, 1, 2],
        ),
    ] {
        let path = exr_file(&folder, "a.exr", channels, kind, zip);
        assert_shows(&load_file(&path).unwrap(), 1.0, shown);
    }
    let depth = exr_file(&folder, "d.exr", &[("Z", 0), ("N.X", 1)], "float", zip);
    assert_says(&refusal(&depth), &["only the channels N.X, Z", "R, G and B"]);
}

#[test]
fn exr_pixels_go_where_the_windows_say() {
    let folder = Workplace::new();
    let attributes = LayerAttributes::default().with_position(Vec2(7, -3));
    let layer = exr_layer(&RGB, "float", Compression::ZIP16, attributes);
    let path = folder.path("window.exr");
    // A display window of 20 × 10 whose corner is at (5, −1): two columns are missing on the left, two rows above it.
    let display = IntegerBounds::new(Vec2(5, -1), Vec2(20, 10));
    Image::new(ImageAttributes::new(display), layer)
        .write()
        .to_file(&path)
        .unwrap();
    let environment = load_file(&path).unwrap();
    assert_eq!((environment.width, environment.height), (20, 10));
    for (index, texel) in environment.texels.iter().enumerate() {
        let (column, row) = (index as i32 % 20 - 2, index as i32 / 20 + 2);
        let is_stored = (0..WIDTH as i32).contains(&column) && (0..HEIGHT as i32).contains(&row);
        let expected = [0, 1, 2].map(|channel| {
            if is_stored {
                value(column as usize, row as usize, channel)
            } else {
                0.0
            }
        });
        assert_eq!(texel[..3], expected, "texel {index}");
    }
}

#[test]
fn values_that_are_no_radiance_are_replaced_and_counted() {
    let folder = Workplace::new();
    let mut values = vec![2.0_f32; WIDTH * HEIGHT];
    values[0] = f32::NAN;
    values[1] = -1.0;
    values[2] = f32::INFINITY;
    values[3] = f32::NEG_INFINITY;
    values[4] = 7.0;
    values[5] = -0.0;
    let channels = AnyChannels::sort(SmallVec::from_vec(vec![AnyChannel::new("Y", FlatSamples::F32(values))]));
    let layer = Layer::new(
        (WIDTH, HEIGHT),
        LayerAttributes::default(),
        Encoding::UNCOMPRESSED,
        channels,
    );
    let path = folder.path("odd.exr");
    Image::from_layer(layer).write().to_file(&path).unwrap();
    let environment = load_file(&path).unwrap();
    let found: Vec<f32> = environment.texels[..6].iter().map(|texel| texel[0]).collect();
    assert_eq!(found, [0.0, 0.0, 7.0, 0.0, 7.0, 0.0]);
    let warnings = environment.warnings.join(" ");
    assert_says(
        &warnings,
        &["3 not-a-number", "6 negative", "3 infinite", "finite one, 7"],
    );
    assert!(
        environment
            .distribution(true)
            .cells
            .iter()
            .all(|cell| cell.density.is_finite())
    );
}

#[test]
fn odd_shapes_are_shown_with_a_warning() {
    let folder = Workplace::new();
    let square = load_file(&write_bytes(&folder, "square.hdr", &hdr_bytes(12, 12))).unwrap();
    assert_says(&square.warnings.join(" "), &["12 × 12", "twice as wide"]);
    let dot = load_file(&write_bytes(&folder, "dot.hdr", &hdr_bytes(1, 1))).unwrap();
    assert_eq!((dot.distribution(true).cells.len(), dot.is_constant), (1, true));
}

#[test]
fn what_is_no_environment_is_refused() {
    let folder = Workplace::new();
    std::fs::create_dir(folder.path("folder.hdr")).unwrap();
    let text = &b"Dear reader, this is a letter and no picture.\n"[..];
    for (name, contents, parts) in [
        ("text.exr", Some(text), ["not an OpenEXR file", "first bytes"]),
        ("text.hdr", Some(text), ["not a Radiance .hdr file", "first bytes"]),
        ("empty.hdr", Some(b""), ["no content", ""]),
        ("empty.exr", Some(b""), ["no content", ""]),
        ("a.jpg", Some(text), ["a.jpg", "re-save it"]),
        ("a.svg", Some(text), ["neither a .hdr nor an .exr", "convert"]),
        ("none", Some(text), ["neither a .hdr nor an .exr", ""]),
        ("missing.hdr", None, ["cannot read", "check the path"]),
        ("missing.exr", None, ["cannot read", "check the path"]),
        ("folder.hdr", None, ["folder without six images", "px, nx"]),
    ] {
        let path = contents.map(|bytes| write_bytes(&folder, name, bytes));
        assert_says(&refusal(&path.unwrap_or_else(|| folder.path(name))), &parts);
    }
    // More than any memory; on the disk it is a hole.
    let vast = folder.path("vast.hdr");
    std::fs::File::create(&vast).unwrap().set_len(1 << 42).unwrap();
    assert_says(&refusal(&vast), &["is not loaded"]);
}
