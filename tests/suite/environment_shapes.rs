//! Environments in other shapes than a lat-long map of rows from the top: old run lengths, cube maps, pictures for
//! screens, pictures too large to keep.

use crate::cli_support::Workplace;
use std::path::Path;

use glossmith::{
    import::environment::{load, load_encoded},
    optics::vector::vec3,
    scene::environment::{Environment, EnvironmentEncoding, EnvironmentSource, environment_radiance},
};
use image::{DynamicImage, ImageBuffer, Rgb};

fn load_file(path: &Path) -> Environment {
    load(&EnvironmentSource::File(path.to_owned())).expect("loads")
}

#[test]
fn old_run_lengths_and_xyz_are_read() {
    let folder = Workplace::new();
    let path = folder.path("old.hdr");
    // A pixel, then five more like it: (1, 1, 1, 5); and a run longer than a byte holds, in two parts: 256 + 3.
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 266\n".to_vec();
    bytes.extend([7, 9, 11, 129, 1, 1, 1, 5, 20, 30, 40, 130, 1, 1, 1, 3, 1, 1, 1, 1]);
    std::fs::write(&path, &bytes).unwrap();
    let environment = load_file(&path);
    assert_eq!(environment.texels[5], [7.0 / 128.0, 9.0 / 128.0, 11.0 / 128.0, 1.0]);
    assert_eq!(environment.texels[6][0], 20.0 / 64.0);
    assert_eq!(environment.texels[265], environment.texels[6]);

    // The white of D65 in XYZ is white.
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n".to_vec();
    bytes.extend([195, 205, 223, 128]);
    std::fs::write(&path, &bytes).unwrap();
    let [r, g, b, _] = load_file(&path).texels[0];
    let white = 205.0 / 256.0;
    assert!(
        [r, g, b].iter().all(|channel| (channel - white).abs() < 0.01),
        "{r} {g} {b}"
    );
}

/// The colours of the faces +X, −X, +Y, −Y, +Z, −Z of OpenGL's order.
pub const FACES: [[f32; 3]; 6] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 1.0],
    [1.0, 0.0, 1.0],
];

/// Ahead, to the right, above and so on of somebody who looks along +Z of our world, whose right is −X.
pub fn assert_is_that_cube(environment: &Environment, what: &str) {
    let looks = [
        ([-1.0, 0.0, 0.0], 0),
        ([1.0, 0.0, 0.0], 1),
        ([0.0, 1.0, 0.0], 2),
        ([0.0, -1.0, 0.0], 3),
        ([0.0, 0.0, 1.0], 4),
        ([0.0, 0.0, -1.0], 5),
    ];
    for ([x, y, z], face) in looks {
        let found = environment_radiance(environment, vec3::<f64>(x, y, z)).to_f32();
        for channel in 0..3 {
            let difference = (found[channel] - FACES[face][channel]).abs();
            assert!(difference < 0.02, "{what}, face {face}: {found:?}");
        }
    }
}

/// A picture of faces of `side` texels at these places.
fn cube_picture(side: u32, size: [u32; 2], places: [[u32; 2]; 6]) -> DynamicImage {
    let picture = ImageBuffer::from_fn(size[0] * side, size[1] * side, |x, y| {
        let face = places.iter().position(|place| *place == [x / side, y / side]);
        Rgb(face.map_or([0; 3], |face| FACES[face].map(|channel| (255.0 * channel) as u8)))
    });
    DynamicImage::ImageRgb8(picture)
}

#[test]
fn cube_maps_are_unfolded() {
    let folder = Workplace::new();
    let strip = [0, 1, 2, 3, 4, 5];
    let shapes = [
        ("strip.png", [6, 1], strip.map(|face| [face, 0])),
        ("column.png", [1, 6], strip.map(|face| [0, face])),
        ("cross.png", [4, 3], [[2, 1], [0, 1], [1, 0], [1, 2], [1, 1], [3, 1]]),
        ("tall.png", [3, 4], [[2, 1], [0, 1], [1, 0], [1, 2], [1, 1], [1, 3]]),
    ];
    for (name, size, places) in shapes {
        let path = folder.path(name);
        cube_picture(8, size, places).save(&path).unwrap();
        let environment = load_file(&path);
        assert_eq!((environment.width, environment.height), (32, 16), "{name}");
        assert_is_that_cube(&environment, name);
    }
    // Six files in a folder.
    let faces = folder.path("faces");
    std::fs::create_dir(&faces).unwrap();
    for (face, name) in ["px", "nx", "py", "ny", "pz", "nz"].into_iter().enumerate() {
        let color = FACES[face].map(|channel| (255.0 * channel) as u8);
        let picture = ImageBuffer::from_pixel(8, 8, Rgb(color));
        picture.save(faces.join(format!("sky_{name}.png"))).unwrap();
    }
    assert_is_that_cube(&load_file(&faces), "six files");
    // A panorama of a cross's shape, with something in its corners, stays a panorama.
    let path = folder.path("odd.png");
    let picture = ImageBuffer::from_fn(32, 24, |x, y| Rgb([(8 * x) as u8, (8 * y) as u8, 77u8]));
    picture.save(&path).unwrap();
    assert_eq!(load_file(&path).width, 32);
}

#[test]
fn pictures_for_screens_are_decoded_or_taken_as_light() {
    let folder = Workplace::new();
    let color = [188u8, 128, 55];
    let deep = color.map(|code| u16::from(code) * 257);
    let shallow = DynamicImage::ImageRgb8(ImageBuffer::from_pixel(16, 8, Rgb(color)));
    let deep = DynamicImage::ImageRgb16(ImageBuffer::from_pixel(16, 8, Rgb(deep)));
    let display = |code: u8| (f64::from(code) / 255.0 + 0.055) / 1.055;
    for (name, picture, tolerance) in [
        ("a.png", &shallow, 1e-5),
        ("deep.png", &deep, 1e-5),
        ("a.tiff", &shallow, 1e-5),
        ("deep.tif", &deep, 1e-5),
        ("a.webp", &shallow, 1e-5),
        ("a.jpg", &shallow, 0.03),
    ] {
        let path = folder.path(name);
        picture.save(&path).unwrap();
        let shown = load_file(&path);
        let source = EnvironmentSource::File(path.clone());
        let linear = load_encoded(&source, EnvironmentEncoding::Linear).unwrap();
        for (channel, code) in color.into_iter().enumerate() {
            let expected = [display(code).powf(2.4), f64::from(code) / 255.0];
            let found = [&shown, &linear].map(|map| f64::from(map.texels[37][channel]));
            for (found, expected) in found.into_iter().zip(expected) {
                near!(found, expected, tolerance, "{name}");
            }
        }
        assert!(
            shown.warnings.join("").contains("screens"),
            "{name}: {:?}",
            shown.warnings
        );
        assert!(linear.warnings.is_empty(), "{name}: {:?}", linear.warnings);
    }
}

#[test]
fn pictures_too_large_to_keep_are_made_smaller() {
    let folder = Workplace::new();
    let path = folder.path("wide.png");
    // Stripes of one texel, and an odd width that halving does not divide.
    let picture = ImageBuffer::from_fn(8195, 2, |x, _| Rgb([if x % 2 == 0 { 255u8 } else { 0 }; 3]));
    picture.save(&path).unwrap();
    let source = EnvironmentSource::File(path);
    let environment = load_encoded(&source, EnvironmentEncoding::Linear).unwrap();
    assert_eq!((environment.width, environment.height), (4098, 1));
    assert_eq!((environment.texels[0][0], environment.texels[4097][1]), (0.5, 1.0));
    let warnings = environment.warnings.join(" ");
    assert!(
        warnings.contains("8195 × 2") && warnings.contains("4098 × 1"),
        "{warnings}"
    );
}
