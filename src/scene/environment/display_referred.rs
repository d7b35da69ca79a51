//! Panoramas in the picture formats of screens: PNG, JPEG, TIFF, WebP.

use std::path::Path;

use image::{DynamicImage, ImageError, ImageReader};

use super::canvas::Canvas;
use super::file::{Picture, io};
use super::{EnvironmentEncoding, EnvironmentError};
use crate::optics::tone::linear_from_srgb;
use crate::optics::vector::Vec3;

/// Reads a panorama. Whole numbers are sRGB codes or linear, as `encoding` says; numbers with a point are linear.
pub(super) fn read(path: &Path, encoding: EnvironmentEncoding) -> Result<Picture, EnvironmentError> {
    let reader = io(path, ImageReader::open(path))?;
    let reader = io(path, reader.with_guessed_format())?;
    let image = reader.decode().map_err(|error| image_error(path, error))?;
    let is_float = matches!(image, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
    let is_display = encoding == EnvironmentEncoding::Display && !is_float;
    let linear = |value: f32| {
        if is_display {
            linear_from_srgb(Vec3::splat(value)).x
        } else {
            value
        }
    };
    let mut canvas = Canvas::new(path, image.width().into(), image.height().into())?;
    if image.color().bytes_per_pixel() == image.color().channel_count() {
        let codes: Vec<f32> = (0..=255u8).map(|code| linear(f32::from(code) / 255.0)).collect();
        for (column, row, pixel) in image.into_rgb8().enumerate_pixels() {
            canvas.add_color(column, row, pixel.0.map(|code| codes[usize::from(code)]));
        }
    } else {
        for (column, row, pixel) in image.into_rgb32f().enumerate_pixels() {
            canvas.add_color(column, row, pixel.0.map(linear));
        }
    }
    let mut picture = canvas.finish();
    if is_display {
        let text = "A picture for screens: nothing in it is brighter than 1, so that lamps and the sun are too dark.";
        picture.warnings.push(text.to_owned());
    }
    Ok(picture)
}

fn image_error(path: &Path, error: ImageError) -> EnvironmentError {
    let path = path.to_owned();
    match error {
        ImageError::IoError(source) if source.kind() == std::io::ErrorKind::UnexpectedEof => {
            EnvironmentError::Truncated {
                path,
                detail: "its pixels end too early".to_owned(),
            }
        }
        ImageError::Unsupported(error) => EnvironmentError::Unsupported {
            path,
            feature: error.to_string(),
            remedy: "re-save it as a PNG, .hdr or .exr",
        },
        error => EnvironmentError::Damaged {
            path,
            detail: error.to_string(),
        },
    }
}
