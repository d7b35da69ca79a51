//! Pictures of models, whatever their format.

use std::io::Cursor;
use std::path::Path;

use exr::prelude::{MetaData, ReadChannels, ReadLayers, ReadSpecificChannel, Vec2};
use image::error::{LimitError, LimitErrorKind};
use image::{DynamicImage, ImageError, ImageFormat, ImageReader, ImageResult, Limits};

use super::environment::exr_header;
use super::float_tiff;
use super::gpu_picture::{self, Texels};
use super::model::Texture;
use super::resource;
use super::rle_bmp;
use super::texture::scale::scaled_to;
use crate::optics::primaries::{Matrix, NoSpace, transformed};
use crate::optics::tone::srgb_from_linear;
use crate::optics::vector::vec3;
use crate::panics::contained;

/// The most memory that decoding one picture may take: 16 384 × 8 192 texels of 16 bits a channel take 1 GiB.
const DECODED_MAX: u64 = 2 << 30;
/// Texels that a byte may stand for, and beyond them: a run of one colour takes PNG and WebP next to nothing.
const GROWTH: [u64; 2] = [1 << 14, 1 << 20];
/// The first bytes of an OpenEXR file.
const EXR: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
/// The most columns or rows of an OpenEXR picture.
const SIDE_MAX: usize = 1 << 15;

/// A picture with the numbers that its file has.
pub(super) struct Decoded {
    name: String,
    width: u32,
    height: u32,
    /// Red, green, blue and opacity of each texel, row by row from the top.
    texels: Numbers,
    /// Brings its colours to linear Rec. 709, where they are not of it.
    rec709_from: Option<Matrix>,
    /// What is to be told of it where it holds colours.
    pub note: Option<&'static str>,
}

enum Numbers {
    Codes8(Vec<u8>),
    Codes16(Vec<u16>),
    /// Linear whatever the use.
    Light(Vec<f32>),
}

impl Decoded {
    /// The picture as it is looked up. One of colours has 8 bits a channel, of sRGB; any other as many as its file, up to
    /// 16: steps of 8 bits in a normal or in a small roughness are seen.
    pub fn texture(self, is_color: bool) -> Texture {
        let rec709_from = self.rec709_from;
        let rgba16 = match self.texels {
            Numbers::Codes8(rgba8) => {
                return Texture {
                    name: self.name,
                    width: self.width,
                    height: self.height,
                    rgba8,
                    rgba16: Vec::new(),
                };
            }
            Numbers::Codes16(codes) => codes,
            Numbers::Light(numbers) => {
                let code = |value: f64| (65535.0 * value).round().clamp(0.0, 65535.0) as u16;
                let texel = |texel: &[f32; 4]| {
                    let [r, g, b, a] = texel.map(|x| if x.is_finite() { f64::from(x) } else { 0.0 });
                    let [r, g, b] = if is_color {
                        let [r, g, b] = rec709_from.map_or([r, g, b], |matrix| transformed(&matrix, [r, g, b]));
                        srgb_from_linear(vec3(r, g, b)).to_f64()
                    } else {
                        [r, g, b]
                    };
                    [r, g, b, a].map(code)
                };
                numbers.as_chunks::<4>().0.iter().flat_map(texel).collect()
            }
        };
        let nearest = |code: &u16| ((u32::from(*code) * 255 + 32767) / 65535) as u8;
        Texture {
            name: self.name,
            width: self.width,
            height: self.height,
            rgba8: rgba16.iter().map(nearest).collect(),
            rgba16: if is_color { Vec::new() } else { rgba16 },
        }
    }
}

/// The picture in a file, its longest side at most `side_max`.
///
/// # Errors
/// Why it can't be had, in a few words.
pub fn read_texture(path: &Path, is_color: bool, side_max: u32) -> Result<Texture, String> {
    let bytes = resource::read(path, resource::BYTES_MAX).map_err(|error| error.to_string())?;
    let name = path
        .file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned();
    let picture = decode_bytes(name, &bytes)?.texture(is_color);
    Ok(scaled_to(picture, side_max, is_color).0)
}

/// Decodes a picture of any known format.
///
/// # Errors
/// Why it cannot be had, in a few words.
pub(super) fn decode_bytes(name: String, bytes: &[u8]) -> Result<Decoded, String> {
    // Some damaged files make decoders panic.
    let decoded = contained(|| decode(&name, bytes)).unwrap_or_else(|| Err("it is damaged".to_owned()));
    let (width, height, texels) = decoded?;
    let (rec709_from, note) = match rec709_from(bytes) {
        Ok(matrix) => (matrix, None),
        Err(NoSpace) => (None, Some("colours of no known space, taken as linear Rec. 709")),
    };
    Ok(Decoded {
        name,
        width,
        height,
        texels,
        rec709_from,
        note,
    })
}

/// What brings the colours of an OpenEXR picture to linear Rec. 709, where its file says that they are of another space.
fn rec709_from(bytes: &[u8]) -> Result<Option<Matrix>, NoSpace> {
    let meta = bytes
        .starts_with(&EXR)
        .then(|| MetaData::read_from_buffered(Cursor::new(bytes), false));
    let Some(Ok(meta)) = meta else { return Ok(None) };
    let header = meta.headers.first();
    header.map_or(Ok(None), |header| exr_header::space(header).rec709_from())
}

fn decode(name: &str, bytes: &[u8]) -> Result<(u32, u32, Numbers), String> {
    if gpu_picture::is_container(bytes) {
        let faces = gpu_picture::decode(bytes, [u32::MAX; 2])?;
        let face = faces.into_iter().next().ok_or("it has no texels")?;
        let texels = match face.texels {
            Texels::Codes(codes) => Numbers::Codes8(codes),
            Texels::Light(numbers) => Numbers::Light(numbers),
        };
        return Ok((face.width, face.height, texels));
    }
    if bytes.starts_with(&EXR) {
        return decode_exr(bytes);
    }
    if let Some(picture) = float_tiff::decode(bytes)? {
        let places = (0..picture.height).flat_map(|row| (0..picture.width).map(move |column| (column, row)));
        let texel = |(column, row)| {
            let [r, g, b] = picture.rgb(column, row);
            [r, g, b, picture.opacity(column, row)]
        };
        let texels = places.flat_map(texel).collect();
        return Ok((picture.width, picture.height, Numbers::Light(texels)));
    }
    let picture = match decode_image(name, bytes) {
        Ok(picture) => picture,
        Err(error) => {
            let (width, height, codes) = rle_bmp::decode(bytes).ok_or_else(|| error.to_string())?;
            return Ok((width, height, Numbers::Codes8(codes)));
        }
    };
    let (width, height) = (picture.width(), picture.height());
    let texels = match picture {
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
            Numbers::Light(picture.into_rgba32f().into_raw())
        }
        deep if deep.color().bytes_per_pixel() > deep.color().channel_count() => {
            Numbers::Codes16(deep.into_rgba16().into_raw())
        }
        codes => Numbers::Codes8(codes.into_rgba8().into_raw()),
    };
    Ok((width, height, texels))
}

/// A picture in one of the formats of screens; the name counts where its bytes do not tell which.
pub(super) fn decode_image(name: &str, bytes: &[u8]) -> ImageResult<DynamicImage> {
    let guessed = || -> ImageResult<_> {
        let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format()?;
        // A TGA has nothing to tell it by but its name.
        if reader.format().is_none()
            && let Ok(format) = ImageFormat::from_path(name)
        {
            reader.set_format(format);
        }
        Ok(reader)
    };
    let (width, height) = guessed()?.into_dimensions()?;
    let [growth, floor] = GROWTH;
    if u64::from(width) * u64::from(height) > growth * bytes.len() as u64 + floor {
        let kind = LimitErrorKind::InsufficientMemory;
        return Err(ImageError::Limits(LimitError::from_kind(kind)));
    }
    let mut reader = guessed()?;
    let mut limits = Limits::default();
    limits.max_alloc = Some(DECODED_MAX);
    reader.limits(limits);
    reader.decode()
}

/// The width and the texels of a picture that is being filled.
type Pixels = (usize, Vec<f32>);

fn put((width, texels): &mut Pixels, at: Vec2<usize>, rgba: [f32; 4]) {
    let first = 4 * (at.y() * *width + at.x());
    texels[first..first + 4].copy_from_slice(&rgba);
}

/// The first layer with colours, or with luminance.
fn decode_exr(bytes: &[u8]) -> Result<(u32, u32, Numbers), String> {
    let text = |error: exr::error::Error| error.to_string();
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(text)?;
    let is_large = |size: Vec2<usize>| size.0.max(size.1) > SIDE_MAX || 16 * size.area() as u64 > DECODED_MAX;
    if meta.headers.iter().any(|header| is_large(header.layer_size)) {
        return Err("it is too large".to_owned());
    }
    let empty = |size: Vec2<usize>| (size.width(), vec![0.0_f32; 4 * size.area()]);
    let layers = || exr::prelude::read().no_deep_data().largest_resolution_level();
    let colors = layers()
        .rgba_channels(
            |size, _| empty(size),
            |pixels: &mut Pixels, at, (r, g, b, a): (f32, f32, f32, f32)| {
                put(pixels, at, [r, g, b, a]);
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes));
    let (size, (_, texels)) = match colors {
        Ok(image) => (image.layer_data.size, image.layer_data.channel_data.pixels),
        Err(error) => {
            let grey = layers()
                .specific_channels()
                .required("Y")
                .collect_pixels(
                    |size, _| empty(size),
                    |pixels: &mut Pixels, at, (y,): (f32,)| {
                        put(pixels, at, [y, y, y, 1.0]);
                    },
                )
                .first_valid_layer()
                .all_attributes()
                .non_parallel()
                .from_buffered(Cursor::new(bytes));
            let image = grey.map_err(|_| text(error))?;
            (image.layer_data.size, image.layer_data.channel_data.pixels)
        }
    };
    Ok((size.width() as u32, size.height() as u32, Numbers::Light(texels)))
}
