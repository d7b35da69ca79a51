//! Panoramas and cubes in the formats of textures: PNG, JPEG, TIFF, WebP, KTX2, DDS.

use image::{DynamicImage, Rgb};

use super::canvas::{Canvas, Picture, Source};
use super::error::EnvironmentError;
use crate::{
    endings::has_ending,
    optics::{tone::linear_from_srgb, vector::Vec3},
    picture::{Encoded, Refusal, decode, depth, is_container},
    scene::environment::{EnvironmentEncoding, MAX_WIDTH},
};

/// The longest side of a cube's face that is of use: four of them are as wide as the widest map.
const FACE_MAX: u32 = MAX_WIDTH / 4;

/// Reads a cube as a strip of its six faces, a flat image unchanged. Whole numbers are sRGB codes or linear, as the source's
/// encoding says; numbers with a point are linear.
pub fn read(source: Source<'_>) -> Result<Picture, EnvironmentError> {
    let encoded = Encoded {
        name: source.path.to_string_lossy().into_owned(),
        bytes: source.bytes()?.into(),
    };
    if has_ending(source.path, &["ktx2", "dds"]) && !is_container(&encoded.bytes) {
        return Err(source.wrong("a KTX2 or DDS"));
    }
    source.within(source.budget.check(encoded.cost()))?;
    source.loading.step("decoding the image")?;
    let decoded = decode(&encoded.name, &encoded.bytes, [MAX_WIDTH, FACE_MAX], true);
    let images = decoded.map_err(|refusal| match refusal {
        Refusal::Damaged(detail) => source.damaged(detail),
        Refusal::NotRead(feature) => source.unsupported(feature, "re-save it as a PNG, .hdr or .exr"),
    })?;
    drop(encoded);
    let first = &images[0];
    let is_display = source.encoding == EnvironmentEncoding::Display;
    // Linear values of 16-bit codes, which include those of 8 bits.
    let linear = |code: u16| match f32::from(code) / 65535.0 {
        value if is_display => linear_from_srgb(Vec3::splat(value)).x,
        value => value,
    };
    let codes: Vec<f32> = (0..=u16::MAX).map(linear).collect();
    let (count, is_light) = (images.len(), depth(first) == 4);
    let [width, height] = [first.width(), first.height()];
    let mut picture = if count == 1 {
        let mut canvas = Canvas::new(source, width.into(), height.into())?;
        let mut place = 0;
        for_each_color(images, &codes, |color| {
            canvas.add_color(place % width, place / width, color);
            place += 1;
        });
        canvas.finish()
    } else {
        let mut texels = Vec::with_capacity(6 * width as usize * height as usize);
        for_each_color(images, &codes, |[r, g, b]| texels.push([r, g, b, 1.0]));
        Picture::new(width, 6 * height, texels)
    };
    if is_display && !is_light {
        let warning = "An image for screens: nothing in it is brighter than 1, so lamps and the sun are too dark.";
        picture.warnings.push(warning.to_owned());
    }
    Ok(picture)
}

/// The linear colours of images, row by row.
fn for_each_color(images: Vec<DynamicImage>, codes: &[f32], mut take: impl FnMut([f32; 3])) {
    for image in images {
        if depth(&image) == 4 {
            image.into_rgb32f().pixels().for_each(|color| take(color.0));
        } else {
            let linear = |color: &Rgb<u16>| color.0.map(|code| codes[usize::from(code)]);
            image.into_rgb16().pixels().map(linear).for_each(&mut take);
        }
    }
}
