//! Colours of OpenEXR files by the primaries that they name.

use crate::cli_support::Workplace;
use std::path::Path;

use glossmith::{
    import::{
        Budget,
        environment::{EnvironmentError, load},
        picture::read_texture,
    },
    scene::environment::{Environment, EnvironmentSource},
};

const SIZE: [usize; 2] = [4, 2];
/// Red, green, blue and white of CIE XYZ.
const XYZ: [f32; 8] = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0 / 3.0, 1.0 / 3.0];

/// A channel's name, and its value everywhere.
type Channel = (&'static str, f32);

/// An OpenEXR file of one colour: scan lines of floats, not compressed. The channels are in the order of their names.
fn write(path: &Path, channels: &[Channel], chromaticities: Option<[f32; 8]>) {
    let [width, height] = SIZE;
    let ints = |numbers: &[i32]| {
        numbers
            .iter()
            .flat_map(|number| number.to_le_bytes())
            .collect::<Vec<u8>>()
    };
    let floats = |numbers: &[f32]| {
        numbers
            .iter()
            .flat_map(|number| number.to_le_bytes())
            .collect::<Vec<u8>>()
    };
    let mut list = Vec::new();
    for (name, _) in channels {
        list.extend(name.bytes());
        // Its end; floats.
        list.push(0);
        list.extend(ints(&[2, 0, 1, 1]));
    }
    list.push(0);
    let window = ints(&[0, 0, width as i32 - 1, height as i32 - 1]);
    let mut attributes = vec![
        ("channels", "chlist", list),
        ("compression", "compression", vec![0]),
        ("dataWindow", "box2i", window.clone()),
        ("displayWindow", "box2i", window),
        ("lineOrder", "lineOrder", vec![0]),
        ("pixelAspectRatio", "float", floats(&[1.0])),
        ("screenWindowCenter", "v2f", floats(&[0.0; 2])),
        ("screenWindowWidth", "float", floats(&[1.0])),
    ];
    attributes.extend(chromaticities.map(|places| ("chromaticities", "chromaticities", floats(&places))));
    let mut bytes = vec![0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
    for (name, kind, value) in attributes {
        bytes.extend([name.as_bytes(), &[0], kind.as_bytes(), &[0]].concat());
        bytes.extend(ints(&[value.len() as i32]));
        bytes.extend(value);
    }
    bytes.push(0);
    let line: Vec<u8> = channels
        .iter()
        .flat_map(|(_, value)| floats(&vec![*value; width]))
        .collect();
    let mut start = bytes.len() + 8 * height;
    for _ in 0..height {
        bytes.extend((start as u64).to_le_bytes());
        start += 8 + line.len();
    }
    for row in 0..height {
        bytes.extend(ints(&[row as i32, line.len() as i32]));
        bytes.extend(&line);
    }
    std::fs::write(path, bytes).expect("a writable folder");
}

fn read(channels: &[Channel], chromaticities: Option<[f32; 8]>) -> Environment {
    opened(channels, chromaticities).expect("loads")
}

fn opened(channels: &[Channel], chromaticities: Option<[f32; 8]>) -> Result<Environment, EnvironmentError> {
    let folder = Workplace::new();
    let path = folder.path("colour.exr");
    write(&path, channels, chromaticities);
    load(&EnvironmentSource::File(path))
}

#[track_caller]
fn assert_is(environment: &Environment, expected: [f32; 3]) {
    for texel in &environment.texels {
        for (found, expected) in texel.iter().zip(expected) {
            near!(found, expected, 0.001, "{texel:?} in place of {expected:?}");
        }
    }
}

/// The same colour in linear Rec. 709, by its matrix alone: XYZ has no white that would be brought to another.
const OF_XYZ: [f32; 3] = [0.2285, 0.5752, 0.5545];

#[test]
fn xyz_is_brought_to_rec_709() {
    let colors = read(&[("B", 0.6), ("G", 0.5), ("R", 0.4)], Some(XYZ));
    assert_is(&colors, OF_XYZ);
    assert!(
        !colors.warnings.iter().any(|told| told.contains("space")),
        "{:?}",
        colors.warnings
    );
    let vivid = read(&[("B", 0.0), ("G", 0.5), ("R", 0.0)], Some(XYZ));
    let is_told = |told: &String| told.contains("100.0 % of its colours are more saturated than linear Rec. 709");
    assert!(vivid.warnings.iter().any(is_told), "{:?}", vivid.warnings);
    // As a picture on a model, too.
    let folder = Workplace::new();
    let texture = |chromaticities| {
        let path = folder.path("a.exr");
        write(&path, &[("B", 0.6), ("G", 0.5), ("R", 0.4)], chromaticities);
        read_texture(&path, true, 16, &Budget::of_import())
            .expect("loads")
            .rgba8
    };
    assert!(texture(None) != texture(Some(XYZ)));
    // The longest that is read.
    let path = folder.path("long.exr");
    exr::prelude::write_rgb_file(&path, 1 << 15, 1, |_, _| (0.5_f32, 0.5_f32, 0.5_f32)).unwrap();
    read_texture(&path, true, 16, &Budget::of_import()).expect("loads");
}

/// Primaries in a line span no space: the numbers stay as they are, which is told.
#[test]
fn what_has_no_conversion_is_told() {
    let line = [0.3, 0.3, 0.4, 0.4, 0.5, 0.5, 0.3127, 0.329];
    let environment = read(&[("B", 0.6), ("G", 0.5), ("R", 0.4)], Some(line));
    let is_told = |told: &String| told.contains("no space of colours");
    assert!(environment.warnings.iter().any(is_told), "{:?}", environment.warnings);
    near!(environment.texels[0][1], 0.5, 0.001);
}

/// The luminance of what has chroma beside it is not the image.
#[test]
fn luminance_with_chroma_is_refused() {
    let refused = opened(&[("BY", 0.2), ("RY", -0.2), ("Y", 0.5)], None).expect_err("refused");
    assert!(refused.to_string().contains("channels BY, RY, Y"), "{refused}");
}
