//! Decoding of models' texture maps, of any format.

mod basis;
mod float_tiff;
mod gpu;
pub(crate) use gpu::is_container;

use std::borrow::Cow;
use std::fmt;
use std::io::Cursor;
use std::path::Path;

use exr::meta::header::Header;
use exr::prelude::{MetaData, ReadChannels, ReadLayers, ReadSpecificChannel, Vec2};
use image::{DynamicImage, ImageDecoder as _, ImageError, ImageFormat, ImageReader, ImageResult, Limits};

use crate::limits::{self, Budget};
use crate::optics::primaries::{Chromaticities, Matrix, NoSpace, REC709, transformed};
use crate::optics::tone::srgb_from_linear;
use crate::optics::vector::vec3;
use crate::panics::contained;
use crate::scene::Texture;
use crate::scene::report::{Fate, ImportReport};
use crate::scene::texture::scale::{nearest_of_16, scaled_to};
use crate::scene::texture::{TextureMean, texture_mean};

/// Memory limit for decoding one image: 16 384 × 8 192 texels of 16 bits per channel take 1 GiB.
pub(super) const DECODED_MAX: u64 = 2 << 30;
/// Largest expansion in texels per byte, and additional texels: a run of one colour takes PNG and WebP almost nothing.
const GROWTH: [u64; 2] = [1 << 14, 1 << 20];
/// Temporary bytes per texel of decoding: for 8-bit codes, and for deeper values.
const TEXEL_COSTS: [u64; 2] = [12, 28];
/// Temporary bytes per texel of decoding a GPU container.
const CONTAINER_COST: u64 = 8;
/// The first bytes of an OpenEXR file.
const EXR: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
/// Largest side of an OpenEXR image, in pixels.
const SIDE_MAX: usize = 1 << 15;

/// A decoded image with the file's own values, row by row from the top.
pub(super) struct Decoded {
    pub width: u32,
    pub height: u32,
    /// Numbers of a texel: grey, or red, green and blue; then its opacity.
    pub channels: usize,
    pub numbers: Numbers,
}

pub(super) enum Numbers {
    Codes8(Vec<u8>),
    Codes16(Vec<u16>),
    /// Linear for any use.
    Light(Vec<f32>),
}

/// Why an image can't be decoded.
#[derive(Debug)]
pub(super) enum Refusal {
    /// Valid, but unsupported.
    NotRead(String),
    /// Its bytes contradict each other.
    Damaged(String),
}

impl<T: Into<String>> From<T> for Refusal {
    fn from(reason: T) -> Self {
        Self::Damaged(reason.into())
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotRead(what) => write!(f, "{what}, which is not read"),
            Self::Damaged(reason) => f.write_str(reason),
        }
    }
}

/// Red, green, blue and opacity of each texel.
pub(super) fn rgba<T: Copy>(numbers: &[T], channels: usize, opaque: T) -> impl Iterator<Item = [T; 4]> {
    numbers.chunks_exact(channels).map(move |texel| match *texel {
        [grey] => [grey, grey, grey, opaque],
        [grey, opacity] => [grey, grey, grey, opacity],
        [r, g, b] => [r, g, b, opaque],
        [r, g, b, a, ..] => [r, g, b, a],
        [] => [opaque; 4],
    })
}

impl Decoded {
    /// The texture map. Colours have 8 bits per channel in sRGB; others as many as the file, up to 16, because 8-bit steps
    /// are visible in normals and small roughnesses. Colours of another space are brought to linear Rec. 709 by the matrix.
    fn texture(self, name: String, is_color: bool, rec709_from: Option<Matrix>) -> Texture {
        let (width, height, channels) = (self.width, self.height, self.channels);
        let rgba16: Vec<u16> = match self.numbers {
            Numbers::Codes8(codes) => {
                let rgba8 = match channels {
                    4 => codes,
                    _ => rgba(&codes, channels, 255).flatten().collect(),
                };
                let rgba16 = Vec::new();
                return Texture {
                    name,
                    width,
                    height,
                    rgba8,
                    rgba16,
                };
            }
            Numbers::Codes16(codes) => rgba(&codes, channels, u16::MAX).flatten().collect(),
            Numbers::Light(numbers) => {
                let code = |value: f64| (65535.0 * value).round().clamp(0.0, 65535.0) as u16;
                let texel = |texel: [f32; 4]| {
                    let [r, g, b, a] = texel.map(|x| if x.is_finite() { f64::from(x) } else { 0.0 });
                    let [r, g, b] = if is_color {
                        let [r, g, b] = rec709_from.map_or([r, g, b], |matrix| transformed(&matrix, [r, g, b]));
                        srgb_from_linear(vec3(r, g, b)).to_f64()
                    } else {
                        [r, g, b]
                    };
                    [r, g, b, a].map(code)
                };
                rgba(&numbers, channels, 1.0).flat_map(texel).collect()
            }
        };
        Texture {
            name,
            width,
            height,
            rgba8: rgba16.iter().copied().map(nearest_of_16).collect(),
            rgba16: if is_color { Vec::new() } else { rgba16 },
        }
    }
}

/// An encoded image.
pub(super) struct Encoded<'a> {
    pub name: String,
    pub bytes: Cow<'a, [u8]>,
}

/// A texture map at the size that is used.
pub(super) struct Scaled {
    pub texture: Texture,
    /// Size of the file's image, if reduced.
    from: Option<[u32; 2]>,
    note: Option<&'static str>,
}

impl Scaled {
    /// Reports the map under its name in the model's file.
    pub fn report(&self, report: &mut ImportReport) {
        let name = &self.texture.name;
        report.note(Fate::Used, "textures", name);
        if let Some(note) = self.note {
            report.note(Fate::Approximated, note, name);
        }
        if let Some([width, height]) = self.from {
            let (columns, rows) = (self.texture.width, self.texture.height);
            let reduction = format!("a texture of {width} × {height}, used at {columns} × {rows}");
            report.note(Fate::Approximated, reduction, name);
        }
    }
}

impl Encoded<'_> {
    /// Approximate memory for decoding in bytes, by the header.
    pub fn cost(&self) -> u64 {
        // Containers say their size in many ways: their blocks hold a texel a byte at most.
        let of_container = CONTAINER_COST * self.bytes.len() as u64;
        match header(&self.name, &self.bytes) {
            Some((texels, is_deep)) => of_container.max(texels.saturating_mul(TEXEL_COSTS[usize::from(is_deep)])),
            None => of_container,
        }
    }

    /// The texture map, if the import's budget permits.
    pub fn texture(self, is_color: bool, side_max: u32, budget: &Budget) -> Result<Scaled, String> {
        let (texture, note) = self.whole(is_color, budget)?;
        let (texture, from) = scaled_to(texture, side_max, is_color);
        Ok(Scaled { texture, from, note })
    }

    /// The texture map at its own size, and a note if its colours are of no known space.
    fn whole(self, is_color: bool, budget: &Budget) -> Result<(Texture, Option<&'static str>), String> {
        check_growth(&self.name, &self.bytes)?;
        budget.check(self.cost()).map_err(|over| over.to_string())?;
        let decoded = decode(&self.name, &self.bytes, [u32::MAX; 2]).map_err(|refusal| refusal.to_string())?;
        let decoded = decoded.into_iter().next().ok_or("it has no texels")?;
        let (rec709_from, note) = match rec709_from(&self.bytes) {
            Ok(matrix) => (matrix, None),
            Err(NoSpace) => (None, Some("colours of no known space, taken as linear Rec. 709")),
        };
        let texture = decoded.texture(self.name, is_color, rec709_from);
        Ok((texture, note.filter(|_| is_color)))
    }
}

/// Refuses an image that claims more texels than its bytes can encode, before memory is allocated.
fn check_growth(name: &str, bytes: &[u8]) -> Result<(), String> {
    let [growth, floor] = GROWTH;
    match header(name, bytes) {
        Some((texels, _)) if texels > growth * bytes.len() as u64 + floor => {
            Err("the file is too small for the size in its header".to_owned())
        }
        _ => Ok(()),
    }
}

/// Texels of an image by its header, and whether channels have more than 8 bits; `None` if unknown or damaged.
fn header(name: &str, bytes: &[u8]) -> Option<(u64, bool)> {
    if gpu::is_container(bytes) {
        return None;
    }
    let texels = |[width, height]: [u64; 2]| width.saturating_mul(height);
    if bytes.starts_with(&EXR) {
        let meta = contained(|| MetaData::read_from_buffered(Cursor::new(bytes), false))?.ok()?;
        let size = meta.headers.first()?.layer_size;
        return Some((texels([size.0 as u64, size.1 as u64]), true));
    }
    if let Some(size) = float_tiff::size(bytes) {
        return Some((texels(size.map(u64::from)), true));
    }
    let reader = reader(name, bytes).ok()?;
    let decoder = contained(|| reader.into_decoder().ok())??;
    let ((width, height), color) = (decoder.dimensions(), decoder.color_type());
    let is_deep = color.bytes_per_pixel() > color.channel_count();
    Some((texels([width.into(), height.into()]), is_deep))
}

/// The texture map in a file, with sides of at most `side_max`, within the import's budget, which it takes from.
pub fn read_texture(path: &Path, is_color: bool, side_max: u32, budget: &Budget) -> Result<Texture, String> {
    let texture = read_encoded(path, budget)?.texture(is_color, side_max, budget)?.texture;
    budget.take(texture.bytes() as u64).map_err(|over| over.to_string())?;
    Ok(texture)
}

fn read_encoded(path: &Path, budget: &Budget) -> Result<Encoded<'static>, String> {
    let read = || {
        budget.check(limits::open(path)?.metadata()?.len())?;
        limits::read(path, limits::BYTES_MAX)
    };
    let name = path
        .file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned();
    let bytes = read().map_err(|error| error.to_string())?.into();
    Ok(Encoded { name, bytes })
}

/// Mean of a texture map in a file, within the import's budget.
pub fn mean_of_file(path: &Path, budget: &Budget) -> Result<TextureMean, String> {
    let (texture, _) = read_encoded(path, budget)?.whole(true, budget)?;
    Ok(texture_mean(&texture))
}

/// Colour space of an OpenEXR file: Rec. 709 by default.
pub(crate) fn exr_space(header: &Header) -> Chromaticities {
    let place = |Vec2(x, y): Vec2<f32>| [f64::from(x), f64::from(y)];
    let named = header.shared_attributes.chromaticities;
    named.map_or(REC709, |file| Chromaticities {
        primaries: [file.red, file.green, file.blue].map(place),
        white: place(file.white),
    })
}

/// Matrix from the colour space of an OpenEXR file to linear Rec. 709, if it names another.
fn rec709_from(bytes: &[u8]) -> Result<Option<Matrix>, NoSpace> {
    let meta = bytes
        .starts_with(&EXR)
        .then(|| MetaData::read_from_buffered(Cursor::new(bytes), false));
    let Some(Ok(meta)) = meta else { return Ok(None) };
    let header = meta.headers.first();
    header.map_or(Ok(None), |header| exr_space(header).rec709_from())
}

/// Decodes an image of any known format, or the six faces of a cube (+X, −X, +Y, −Y, +Z, −Z). Containers of GPUs have it in
/// several sizes: the largest within `side_max` (of an image, of a face) is read.
pub(super) fn decode(name: &str, bytes: &[u8], side_max: [u32; 2]) -> Result<Vec<Decoded>, Refusal> {
    check_growth(name, bytes)?;
    // Some damaged files make decoders panic.
    let decoded = contained(|| {
        if gpu::is_container(bytes) {
            return gpu::decode(bytes, side_max);
        }
        let decoded = match float_tiff::decode(bytes)? {
            Some(floats) => floats,
            None if bytes.starts_with(&EXR) => decode_exr(bytes)?,
            None => decode_image(name, bytes)?,
        };
        Ok(vec![decoded])
    });
    decoded.unwrap_or_else(|| Err("its pixels contradict each other".into()))
}

/// Decodes a display-referred format; the name decides if the bytes do not.
fn decode_image(name: &str, bytes: &[u8]) -> Result<Decoded, Refusal> {
    let refused = |error: ImageError| match error {
        ImageError::Unsupported(what) => Refusal::NotRead(what.to_string()),
        error => Refusal::Damaged(error.to_string()),
    };
    let mut reader = reader(name, bytes).map_err(refused)?;
    let mut limits = Limits::default();
    limits.max_alloc = Some(DECODED_MAX);
    reader.limits(limits);
    let picture = reader.decode().map_err(refused)?;
    let (width, height, color) = (picture.width(), picture.height(), picture.color());
    let is_deep = color.bytes_per_pixel() > color.channel_count();
    let is_light = matches!(picture, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
    let numbers = match (is_light, is_deep, color.has_alpha()) {
        (true, _, true) => Numbers::Light(picture.into_rgba32f().into_raw()),
        (true, _, false) => Numbers::Light(picture.into_rgb32f().into_raw()),
        (_, true, true) => Numbers::Codes16(picture.into_rgba16().into_raw()),
        (_, true, false) => Numbers::Codes16(picture.into_rgb16().into_raw()),
        (_, _, true) => Numbers::Codes8(picture.into_rgba8().into_raw()),
        (_, _, false) => Numbers::Codes8(picture.into_rgb8().into_raw()),
    };
    let channels = if color.has_alpha() { 4 } else { 3 };
    Ok(Decoded {
        width,
        height,
        channels,
        numbers,
    })
}

/// A reader by format; the name decides if the bytes do not.
fn reader<'a>(name: &str, bytes: &'a [u8]) -> ImageResult<ImageReader<Cursor<&'a [u8]>>> {
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format()?;
    // A TGA is only recognised by its name.
    if reader.format().is_none()
        && let Ok(format) = ImageFormat::from_path(name)
    {
        reader.set_format(format);
    }
    Ok(reader)
}

/// Width and texels of an image being filled.
type Pixels = (usize, Vec<f32>);

fn put((width, texels): &mut Pixels, at: Vec2<usize>, rgba: [f32; 4]) {
    let first = 4 * (at.y() * *width + at.x());
    texels[first..first + 4].copy_from_slice(&rgba);
}

/// The first layer with colours, or with luminance.
fn decode_exr(bytes: &[u8]) -> Result<Decoded, String> {
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
            |pixels: &mut Pixels, at, (r, g, b, a): (f32, f32, f32, f32)| put(pixels, at, [r, g, b, a]),
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map(|image| (image.layer_data.size, image.layer_data.channel_data.pixels));
    let grey = |_| {
        layers()
            .specific_channels()
            .required("Y")
            .collect_pixels(
                |size, _| empty(size),
                |pixels: &mut Pixels, at, (y,): (f32,)| put(pixels, at, [y, y, y, 1.0]),
            )
            .first_valid_layer()
            .all_attributes()
            .non_parallel()
            .from_buffered(Cursor::new(bytes))
            .map(|image| (image.layer_data.size, image.layer_data.channel_data.pixels))
    };
    let (size, (_, texels)) = colors.or_else(grey).map_err(text)?;
    Ok(Decoded {
        width: size.width() as u32,
        height: size.height() as u32,
        channels: 4,
        numbers: Numbers::Light(texels),
    })
}
