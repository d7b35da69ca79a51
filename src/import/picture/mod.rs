//! Decoding of models' texture maps, of any format.

mod basis;
mod bmp_runs;
mod gpu;
mod tiff_files;
pub(crate) use gpu::is_container;

use std::{borrow::Cow, fmt, io::Cursor, path::Path};

use exr::meta::header::Header;
use exr::prelude::{MetaData, ReadChannels, ReadLayers, ReadSpecificChannel, Vec2};
use image::{
    DynamicImage, ImageBuffer, ImageDecoder as _, ImageError, ImageFormat, ImageReader, ImageResult, Limits, Rgba,
    metadata::Orientation,
};

use crate::{
    limits,
    limits::Budget,
    optics::{
        primaries::{Chromaticities, Matrix, NoSpace, REC709, transformed},
        tone::srgb_from_linear,
        vector::vec3,
    },
    panics::contained,
    scene::{
        Texture,
        report::Fate,
        report::ImportReport,
        texture::{TextureMean, scale::nearest_of_16, scale::scaled_to, texture_mean},
    },
};

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

/// An image of 8-bit codes: grey, or red, green and blue, perhaps with an opacity. Too few are no image.
fn codes(size: [u32; 2], channels: usize, codes: Vec<u8>) -> Option<DynamicImage> {
    let [width, height] = size;
    match channels {
        1 => ImageBuffer::from_raw(width, height, codes).map(DynamicImage::ImageLuma8),
        3 => ImageBuffer::from_raw(width, height, codes).map(DynamicImage::ImageRgb8),
        _ => ImageBuffer::from_raw(width, height, codes).map(DynamicImage::ImageRgba8),
    }
}

/// The same of numbers that are linear for any use.
fn light(size: [u32; 2], channels: usize, numbers: Vec<f32>) -> Option<DynamicImage> {
    let [width, height] = size;
    let numbers = match channels {
        1 => numbers.into_iter().flat_map(|grey| [grey; 3]).collect(),
        2 => {
            let texels = numbers.as_chunks::<2>().0.iter();
            texels
                .flat_map(|[grey, opacity]| [*grey, *grey, *grey, *opacity])
                .collect()
        }
        _ => numbers,
    };
    match channels % 2 {
        1 => ImageBuffer::from_raw(width, height, numbers).map(DynamicImage::ImageRgb32F),
        _ => ImageBuffer::from_raw(width, height, numbers).map(DynamicImage::ImageRgba32F),
    }
}

/// Bytes of a channel: 1 and 2 of codes, 4 of linear numbers.
pub(super) fn depth(picture: &DynamicImage) -> u8 {
    let color = picture.color();
    color.bytes_per_pixel() / color.channel_count()
}

/// An image whose texels are mapped: red, green, blue and opacity in [0, 1], or linear.
fn mapped(picture: DynamicImage, texel: impl Fn([f32; 4]) -> [f32; 4]) -> DynamicImage {
    let depth = depth(&picture);
    let mut numbers = picture.into_rgba32f();
    numbers.pixels_mut().for_each(|pixel| pixel.0 = texel(pixel.0));
    let numbers = DynamicImage::from(numbers);
    match depth {
        1 => numbers.into_rgba8().into(),
        2 => numbers.into_rgba16().into(),
        _ => numbers,
    }
}

/// The texture map. Colours have 8 bits per channel in sRGB; others as many as the file, up to 16, because 8-bit steps are
/// visible in normals and small roughnesses. Colours of another space are brought to linear Rec. 709 by the matrix.
fn texture(picture: DynamicImage, name: String, is_color: bool, rec709_from: Option<Matrix>) -> Texture {
    let (width, height) = (picture.width(), picture.height());
    let rgba16: Vec<u16> = match depth(&picture) {
        1 => {
            return Texture {
                name,
                width,
                height,
                rgba8: picture.into_rgba8().into_raw(),
                rgba16: Vec::new(),
            };
        }
        2 => picture.into_rgba16().into_raw(),
        _ => {
            let code = |value: f64| (65535.0 * value).round().clamp(0.0, 65535.0) as u16;
            let texel = |texel: &Rgba<f32>| {
                let [r, g, b, a] = texel.0.map(|x| if x.is_finite() { f64::from(x) } else { 0.0 });
                let [r, g, b] = if is_color {
                    let [r, g, b] = rec709_from.map_or([r, g, b], |matrix| transformed(&matrix, [r, g, b]));
                    srgb_from_linear(vec3(r, g, b)).to_f64()
                } else {
                    [r, g, b]
                };
                [r, g, b, a].map(code)
            };
            picture.into_rgba32f().pixels().flat_map(texel).collect()
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
    /// It, taken from the budget.
    pub fn within(self, budget: &Budget) -> Result<Self, String> {
        let taken = budget.take(self.texture.bytes() as u64);
        taken.map_err(|over| over.to_string()).map(|()| self)
    }

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
        let (texture, note) = self.whole(is_color, false, budget)?;
        let (texture, from) = scaled_to(texture, side_max, is_color);
        Ok(Scaled { texture, from, note })
    }

    /// The texture map at its own size, turned as a camera says of its photograph, or not; and a note if its colours are of
    /// no known space.
    fn whole(self, is_color: bool, is_photo: bool, budget: &Budget) -> Result<(Texture, Option<&'static str>), String> {
        check_growth(&self.name, &self.bytes)?;
        budget.check(self.cost()).map_err(|over| over.to_string())?;
        let decoded =
            decode(&self.name, &self.bytes, [u32::MAX; 2], is_photo).map_err(|refusal| refusal.to_string())?;
        let mut decoded = decoded.into_iter().next().ok_or("it has no texels")?;
        // Light of OpenEXR is multiplied by opacity, data are not.
        if is_color && self.bytes.starts_with(&EXR) || tiff_files::is_premultiplied(&self.bytes) {
            decoded = mapped(decoded, straight);
        }
        let (rec709_from, note) = match rec709_from(&self.bytes) {
            Ok(matrix) => (matrix, None),
            Err(NoSpace) => (None, Some("colours of no known space, taken as linear Rec. 709")),
        };
        let texture = texture(decoded, self.name, is_color, rec709_from);
        Ok((texture, note.filter(|_| is_color)))
    }
}

/// A colour that opacity multiplies no more; one without opacity stays, for it is light.
fn straight([r, g, b, a]: [f32; 4]) -> [f32; 4] {
    if a > 0.0 {
        [r / a, g / a, b / a, a]
    } else {
        [r, g, b, a]
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
    if let Some(size) = tiff_files::size(bytes) {
        return Some((texels(size.map(u64::from)), true));
    }
    let reader = reader(name, bytes).ok()?;
    let decoder = contained(|| reader.into_decoder().ok())??;
    let ((width, height), color) = (decoder.dimensions(), decoder.color_type());
    let is_deep = color.bytes_per_pixel() > color.channel_count();
    Some((texels([width.into(), height.into()]), is_deep))
}

/// The texture map in a file, turned as its camera says, with sides of at most `side_max`, within the import's budget, which
/// it takes from.
pub fn read_texture(path: &Path, is_color: bool, side_max: u32, budget: &Budget) -> Result<Texture, String> {
    let (texture, _) = read_encoded(path, budget)?.whole(is_color, true, budget)?;
    let (texture, _) = scaled_to(texture, side_max, is_color);
    budget.take(texture.bytes() as u64).map_err(|over| over.to_string())?;
    Ok(texture)
}

fn read_encoded(path: &Path, budget: &Budget) -> Result<Encoded<'static>, String> {
    let read = || {
        budget.check(limits::length(path)?)?;
        limits::read(path, limits::BYTES_MAX)
    };
    let name = path
        .file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned();
    let bytes = read().map_err(|error: std::io::Error| error.to_string())?.into();
    Ok(Encoded { name, bytes })
}

/// What a texture map's numbers are on the whole, whatever they mean.
#[derive(Clone, Copy, Debug)]
pub struct FileMean {
    pub mean: TextureMean,
    /// All texels are the same.
    pub is_even: bool,
    /// Its numbers are colours of 8 bits, as screens take them.
    pub is_of_screen: bool,
}

/// Mean of a texture map in a file, within the import's budget.
pub fn mean_of_file(path: &Path, budget: &Budget) -> Result<FileMean, String> {
    let encoded = read_encoded(path, budget)?;
    let color = contained(|| {
        Some(
            reader(&encoded.name, &encoded.bytes)
                .ok()?
                .into_decoder()
                .ok()?
                .color_type(),
        )
    });
    let is_colored = color.flatten().is_none_or(|color| color.has_color());
    let (texture, _) = encoded.whole(false, true, budget)?;
    let (texels, deep) = (texture.rgba8.as_chunks::<4>().0, texture.rgba16.as_chunks::<4>().0);
    Ok(FileMean {
        mean: texture_mean(&texture),
        is_even: texels.iter().all(|texel| texel == &texels[0]) && deep.iter().all(|texel| texel == &deep[0]),
        is_of_screen: is_colored && deep.is_empty(),
    })
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
/// several sizes: the largest within `side_max` (of an image, of a face) is read. A photograph is turned as its camera says.
pub(super) fn decode(
    name: &str,
    bytes: &[u8],
    side_max: [u32; 2],
    is_photo: bool,
) -> Result<Vec<DynamicImage>, Refusal> {
    check_growth(name, bytes)?;
    // Some damaged files make decoders panic.
    let decoded = contained(|| {
        if gpu::is_container(bytes) {
            return gpu::decode(bytes, side_max);
        }
        let decoded = match tiff_files::decode(bytes)? {
            Some(floats) => floats,
            None if bytes.starts_with(&EXR) => decode_exr(bytes)?,
            None => decode_image(name, bytes, is_photo)?,
        };
        Ok(vec![decoded])
    });
    decoded.unwrap_or_else(|| Err("its pixels contradict each other".into()))
}

/// What undoes the factors in the header of a Radiance file, which may be several; 1 for one that nothing undoes.
pub(crate) fn radiance_gains(bytes: &[u8]) -> [f32; 3] {
    let lines = bytes.split(|byte| *byte == b'\n').map(String::from_utf8_lossy);
    let mut product = [1.0_f64; 3];
    for line in lines.take_while(|line| !line.trim().is_empty()) {
        let factors = line.strip_prefix("EXPOSURE=").or(line.strip_prefix("COLORCORR="));
        let factors = factors.unwrap_or_default().split_whitespace();
        let factors: Vec<f64> = factors.filter_map(|word| word.parse().ok()).collect();
        for (channel, all) in product.iter_mut().enumerate() {
            *all *= factors.get(channel).or(factors.first()).unwrap_or(&1.0);
        }
    }
    product
        .map(|factor| (1.0 / factor) as f32)
        .map(|gain| if gain.is_normal() && gain > 0.0 { gain } else { 1.0 })
}

/// Decodes a format of the `image` crate; the name decides if the bytes do not.
fn decode_image(name: &str, bytes: &[u8], is_photo: bool) -> Result<DynamicImage, Refusal> {
    let refused = |error: ImageError| match error {
        ImageError::Unsupported(what) => Refusal::NotRead(what.to_string()),
        error => Refusal::Damaged(error.to_string()),
    };
    let indexed = bmp_runs::indexed(bytes);
    let (bytes, colors) = indexed
        .as_ref()
        .map_or((bytes, None), |(bytes, colors)| (bytes, Some(colors)));
    let mut reader = reader(name, bytes).map_err(refused)?;
    let (is_tga, is_hdr) = [ImageFormat::Tga, ImageFormat::Hdr]
        .map(|format| reader.format() == Some(format))
        .into();
    let mut limits = Limits::default();
    limits.max_alloc = Some(DECODED_MAX);
    reader.limits(limits.clone());
    let mut decoder = reader.into_decoder().map_err(refused)?;
    limits.reserve(decoder.total_bytes()).map_err(refused)?;
    let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
    let mut picture = DynamicImage::from_decoder(decoder).map_err(refused)?;
    if let (Some(colors), DynamicImage::ImageRgb8(texels)) = (colors, &mut picture) {
        texels
            .pixels_mut()
            .for_each(|texel| texel.0 = colors.get(usize::from(texel.0[0])).copied().unwrap_or_default());
    }
    // A TGA that promises no bits of opacity (byte 17) may have a fourth byte all the same.
    if let DynamicImage::ImageRgba8(texels) = &mut picture
        && is_tga
        && bytes.get(17).is_some_and(|bits| bits & 0xf == 0)
        && texels.pixels().all(|texel| texel.0[3] == 0)
    {
        texels.pixels_mut().for_each(|texel| texel.0[3] = 255);
    }
    if is_hdr {
        let [r, g, b] = radiance_gains(bytes);
        picture = mapped(picture, |texel| [r * texel[0], g * texel[1], b * texel[2], texel[3]]);
    }
    if is_photo {
        picture.apply_orientation(orientation);
    }
    Ok(picture)
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
fn decode_exr(bytes: &[u8]) -> Result<DynamicImage, String> {
    let text = |error: exr::error::Error| error.to_string();
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(text)?;
    let is_large = |size: Vec2<usize>| size.0.max(size.1) > SIDE_MAX || 16 * size.area() as u64 > DECODED_MAX;
    if meta.headers.iter().any(|header| is_large(header.layer_size)) {
        return Err("it is too large".to_owned());
    }
    let empty = |size: Vec2<usize>| (size.width(), vec![0.0_f32; 4 * size.area()]);
    let layers = || exr::prelude::read().no_deep_data().largest_resolution_level();
    let colors = |[r, g, b, a]: [&'static str; 4]| {
        layers()
            .specific_channels()
            .required(r)
            .required(g)
            .required(b)
            .optional(a, 1.0)
            .collect_pixels(
                |size, _| empty(size),
                |pixels: &mut Pixels, at, (r, g, b, a): (f32, f32, f32, f32)| put(pixels, at, [r, g, b, a]),
            )
            .first_valid_layer()
            .all_attributes()
            .non_parallel()
            .from_buffered(Cursor::new(bytes))
            .map(|image| (image.layer_data.size, image.layer_data.channel_data.pixels))
    };
    // Some programs write the names in lower case.
    let lower = |_| colors(["r", "g", "b", "a"]);
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
    let found = colors(["R", "G", "B", "A"]).or_else(lower).or_else(grey);
    let (size, (_, texels)) = found.map_err(text)?;
    light([size.width() as u32, size.height() as u32], 4, texels).ok_or_else(|| "it has no texels".to_owned())
}
