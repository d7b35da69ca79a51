//! Panoramas in display-referred formats: PNG, JPEG, TIFF, WebP.

use std::path::Path;

use image::{DynamicImage, ImageError};

use super::canvas::Canvas;
use super::decoded::{Picture, Source};
use super::error::EnvironmentError;
use crate::optics::tone::linear_from_srgb;
use crate::optics::vector::Vec3;
use crate::panics::contained;
use crate::picture::{decode_image, float_tiff};
use crate::scene::environment::EnvironmentEncoding;

/// Decoding of integer values.
pub(super) struct Codes {
    encoding: EnvironmentEncoding,
    /// Linear values of 16-bit codes, which include those of 8 bits.
    linear: Vec<f32>,
}

impl Codes {
    pub fn new(encoding: EnvironmentEncoding) -> Self {
        let linear = |code: u16| match f32::from(code) / 65535.0 {
            value if encoding == EnvironmentEncoding::Display => linear_from_srgb(Vec3::splat(value)).x,
            value => value,
        };
        Self {
            encoding,
            linear: (0..=u16::MAX).map(linear).collect(),
        }
    }

    pub fn of_8(&self, code: u8) -> f32 {
        self.of_16(257 * u16::from(code))
    }

    pub fn of_16(&self, code: u16) -> f32 {
        self.linear[usize::from(code)]
    }

    /// Warning for images with this encoding.
    pub fn warning(&self) -> Option<String> {
        let text = "An image for screens: nothing in it is brighter than 1, so lamps and the sun are too dark.";
        (self.encoding == EnvironmentEncoding::Display).then(|| text.to_owned())
    }
}

/// Reads a panorama. Whole numbers are sRGB codes or linear, as the source's encoding says; numbers with a point are linear.
pub(super) fn read(source: Source<'_>) -> Result<Picture, EnvironmentError> {
    let path = source.path;
    let bytes = source.bytes()?;
    let damaged = |detail: String| EnvironmentError::damaged(path, detail);
    source.check_decoding(&bytes)?;
    // Some damaged files make the decoders panic.
    let floats =
        contained(|| float_tiff::decode(&bytes)).unwrap_or_else(|| Err("its pixels contradict each other".into()));
    if let Some(floats) = floats.map_err(damaged)? {
        let mut canvas = Canvas::new(source, floats.width.into(), floats.height.into())?;
        for row in 0..floats.height {
            (0..floats.width).for_each(|column| canvas.add_color(column, row, floats.rgb(column, row)));
        }
        return Ok(canvas.finish());
    }
    source.loading.step("decoding the image")?;
    let image = contained(|| decode_image(&path.to_string_lossy(), &bytes).map_err(|error| image_error(path, error)));
    let image = image.unwrap_or_else(|| Err(damaged("its pixels contradict each other".to_owned())))?;
    drop(bytes);
    let mut canvas = Canvas::new(source, image.width().into(), image.height().into())?;
    if matches!(image, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_)) {
        for (column, row, pixel) in image.into_rgb32f().enumerate_pixels() {
            canvas.add_color(column, row, pixel.0);
        }
        return Ok(canvas.finish());
    }
    let codes = Codes::new(source.encoding);
    if image.color().bytes_per_pixel() == image.color().channel_count() {
        for (column, row, pixel) in image.into_rgb8().enumerate_pixels() {
            canvas.add_color(column, row, pixel.0.map(|code| codes.of_8(code)));
        }
    } else {
        for (column, row, pixel) in image.into_rgb16().enumerate_pixels() {
            canvas.add_color(column, row, pixel.0.map(|code| codes.of_16(code)));
        }
    }
    let mut picture = canvas.finish();
    picture.warnings.extend(codes.warning());
    Ok(picture)
}

fn image_error(path: &Path, error: ImageError) -> EnvironmentError {
    let path = path.to_owned();
    match error {
        ImageError::IoError(source) if source.kind() == std::io::ErrorKind::UnexpectedEof => {
            EnvironmentError::truncated(&path, "its pixels end too early")
        }
        ImageError::Unsupported(error) => EnvironmentError::Unsupported {
            path,
            feature: error.to_string(),
            remedy: "re-save it as a PNG, .hdr or .exr",
        },
        error => EnvironmentError::damaged(&path, error),
    }
}
