//! Decoding of models' texture maps, of any format.

mod basis;
pub(crate) mod exr_space;
pub(crate) mod float_tiff;
pub(crate) mod gpu;

use std::borrow::Cow;
use std::io::Cursor;
use std::path::Path;

use exr::prelude::{MetaData, ReadChannels, ReadLayers, ReadSpecificChannel, Vec2};
use image::error::{LimitError, LimitErrorKind};
use image::{DynamicImage, ImageDecoder as _, ImageError, ImageFormat, ImageReader, ImageResult, Limits};

use crate::budget::Budget;
use crate::optics::primaries::{Matrix, NoSpace, transformed};
use crate::optics::tone::srgb_from_linear;
use crate::optics::vector::vec3;
use crate::panics::contained;
use crate::resource;
use crate::scene::Texture;
use crate::scene::report::{Fate, ImportReport};
use crate::scene::texture::scale::{nearest_of_16, scaled_to};
use crate::scene::texture::{TextureMean, texture_mean};
use gpu::Texels;

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

/// A decoded image with the file's own values.
pub(super) struct Decoded {
    name: String,
    width: u32,
    height: u32,
    /// Red, green, blue and opacity of each texel, row by row from the top.
    texels: Numbers,
    /// Matrix to linear Rec. 709, if in another space.
    rec709_from: Option<Matrix>,
    /// Note for the report, if it holds colours.
    pub note: Option<&'static str>,
}

enum Numbers {
    Codes8(Vec<u8>),
    Codes16(Vec<u16>),
    /// Linear for any use.
    Light(Vec<f32>),
}

impl Decoded {
    /// The texture map. Colours have 8 bits per channel in sRGB; others as many as the file, up to 16, because 8-bit steps
    /// are visible in normals and small roughnesses.
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
        Texture {
            name: self.name,
            width: self.width,
            height: self.height,
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

/// Use of an image as a texture map.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    pub is_color: bool,
    /// Largest side, in texels.
    pub side_max: u32,
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
            let Texture {
                width: columns,
                height: rows,
                ..
            } = self.texture;
            let reduction = format!("a texture of {width} × {height}, used at {columns} × {rows}");
            report.note(Fate::Approximated, reduction, name);
        }
    }
}

impl Encoded<'_> {
    /// Approximate memory for decoding in bytes, by the header.
    pub fn cost(&self) -> u64 {
        let header = header(&self.name, &self.bytes);
        // Containers say their size in many ways: their blocks hold a texel a byte at most.
        let of_container = CONTAINER_COST * self.bytes.len() as u64;
        header.map_or(of_container, |header| header.cost().max(of_container))
    }

    /// The texture map, if the import's budget permits.
    pub fn texture(self, wanted: Wanted, budget: &Budget) -> Result<Scaled, String> {
        check_growth(&self.name, &self.bytes)?;
        let Wanted { is_color, side_max } = wanted;
        budget.check(self.cost()).map_err(|over| over.to_string())?;
        let decoded = decode_bytes(self.name, &self.bytes)?;
        let note = decoded.note.filter(|_| is_color);
        let (texture, from) = scaled_to(decoded.texture(is_color), side_max, is_color);
        Ok(Scaled { texture, from, note })
    }
}

/// Header of an image.
struct Header {
    size: [u32; 2],
    /// True for more than 8 bits per channel.
    is_deep: bool,
}

impl Header {
    fn texels(&self) -> u64 {
        self.size.map(u64::from).iter().product()
    }

    /// Bytes for decoding it.
    fn cost(&self) -> u64 {
        let [of_codes, of_numbers] = TEXEL_COSTS;
        self.texels() * if self.is_deep { of_numbers } else { of_codes }
    }
}

/// Refuses an image that claims more texels than its bytes can encode, before memory is allocated.
fn check_growth(name: &str, bytes: &[u8]) -> Result<(), String> {
    let [growth, floor] = GROWTH;
    match header(name, bytes) {
        Some(header) if header.texels() > growth * bytes.len() as u64 + floor => {
            Err("the file is too small for the size in its header".to_owned())
        }
        _ => Ok(()),
    }
}

/// The header of an image; `None` if unknown or damaged.
fn header(name: &str, bytes: &[u8]) -> Option<Header> {
    if gpu::is_container(bytes) {
        return None;
    }
    if bytes.starts_with(&EXR) {
        let meta = contained(|| MetaData::read_from_buffered(Cursor::new(bytes), false))?.ok()?;
        let size = meta.headers.first()?.layer_size;
        let side = |side: usize| u32::try_from(side).unwrap_or(u32::MAX);
        return Some(Header {
            size: [side(size.0), side(size.1)],
            is_deep: true,
        });
    }
    if let Some(size) = float_tiff::size(bytes) {
        return Some(Header { size, is_deep: true });
    }
    let reader = reader(name, bytes).ok()?;
    let decoder = contained(|| reader.into_decoder().ok())??;
    let color = decoder.color_type();
    Some(Header {
        size: decoder.dimensions().into(),
        is_deep: color.bytes_per_pixel() > color.channel_count(),
    })
}

/// The texture map in a file, with sides of at most `side_max`, within the import's budget, which it takes from.
pub fn read_texture(path: &Path, is_color: bool, side_max: u32, budget: &Budget) -> Result<Texture, String> {
    let scaled = read_encoded(path, budget)?.texture(Wanted { is_color, side_max }, budget)?;
    budget
        .take(scaled.texture.bytes() as u64)
        .map_err(|over| over.to_string())?;
    Ok(scaled.texture)
}

/// The texture map in a file at its own size, for temporary use.
pub(super) fn whole_texture(path: &Path, is_color: bool, budget: &Budget) -> Result<Texture, String> {
    let encoded = read_encoded(path, budget)?;
    check_growth(&encoded.name, &encoded.bytes)?;
    budget.check(encoded.cost()).map_err(|over| over.to_string())?;
    Ok(decode_bytes(encoded.name, &encoded.bytes)?.texture(is_color))
}

fn read_encoded(path: &Path, budget: &Budget) -> Result<Encoded<'static>, String> {
    let length = resource::open(path)
        .and_then(|file| file.metadata())
        .map_err(|error| error.to_string())?
        .len();
    budget.check(length).map_err(|over| over.to_string())?;
    let bytes = resource::read(path, resource::BYTES_MAX).map_err(|error| error.to_string())?;
    let name = path
        .file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned();
    Ok(Encoded {
        name,
        bytes: bytes.into(),
    })
}

/// Mean of a texture map in a file, within the import's budget.
pub fn mean_of_file(path: &Path, budget: &Budget) -> Result<TextureMean, String> {
    Ok(texture_mean(&whole_texture(path, true, budget)?))
}

/// Decodes an image of any known format.
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

/// Matrix from the colour space of an OpenEXR file to linear Rec. 709, if it names another.
fn rec709_from(bytes: &[u8]) -> Result<Option<Matrix>, NoSpace> {
    let meta = bytes
        .starts_with(&EXR)
        .then(|| MetaData::read_from_buffered(Cursor::new(bytes), false));
    let Some(Ok(meta)) = meta else { return Ok(None) };
    let header = meta.headers.first();
    header.map_or(Ok(None), |header| exr_space::space(header).rec709_from())
}

fn decode(name: &str, bytes: &[u8]) -> Result<(u32, u32, Numbers), String> {
    if gpu::is_container(bytes) {
        let faces = gpu::decode(bytes, [u32::MAX; 2])?;
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
    let picture = decode_image(name, bytes).map_err(|error| error.to_string())?;
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

/// Decodes a display-referred format; the name decides if the bytes do not.
pub(super) fn decode_image(name: &str, bytes: &[u8]) -> ImageResult<DynamicImage> {
    let (width, height) = reader(name, bytes)?.into_dimensions()?;
    let [growth, floor] = GROWTH;
    if u64::from(width) * u64::from(height) > growth * bytes.len() as u64 + floor {
        let kind = LimitErrorKind::InsufficientMemory;
        return Err(ImageError::Limits(LimitError::from_kind(kind)));
    }
    let mut reader = reader(name, bytes)?;
    let mut limits = Limits::default();
    limits.max_alloc = Some(DECODED_MAX);
    reader.limits(limits);
    reader.decode()
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
