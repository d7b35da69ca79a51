//! Image output.

use std::{io, io::Seek, io::Write, path::Path, path::PathBuf, sync::Arc};

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Layer, LayerAttributes, LineOrder, WritableImage as _,
};
use image::{Rgb, codecs::hdr::HdrEncoder};

use super::{display::display, light_layers::LightLayer, sums::KeptFilm};
use crate::{
    document::Document,
    import::endings::ending,
    job::features::Features,
    job::film::{Film, Image},
    optics::primaries::REC709,
    store::{FileError, picture::png_bytes, project::own_text, replace::save_by},
};

/// Errors of image output.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// The extension is not that of a format that can be written.
    #[error("{path}: images are written as .png, .exr or .hdr; give the file one of these endings")]
    Format { path: PathBuf },
    /// The file could not be written.
    #[error(transparent)]
    File(#[from] FileError),
}

/// An image to write.
#[derive(Clone, Copy, Debug)]
pub struct Rendered<'a> {
    /// The mean of the samples, linear.
    pub image: &'a Image,
    /// The denoised image, if there is one; it is the one shown.
    pub denoised: Option<&'a Image>,
    /// Layers written beside the colours in an .exr file.
    pub layers: Option<&'a Layers>,
    /// Light groups, written into an .exr file.
    pub lights: &'a [LightLayer],
    /// The sums that an .exr file keeps, to be joined with others.
    pub sums: Option<&'a KeptFilm>,
}

impl<'a> From<&'a Image> for Rendered<'a> {
    fn from(image: &'a Image) -> Self {
        Self {
            image,
            denoised: None,
            layers: None,
            lights: &[],
            sums: None,
        }
    }
}

impl<'a> From<&'a Layers> for Rendered<'a> {
    fn from(layers: &'a Layers) -> Self {
        Self {
            denoised: layers.denoised.as_deref(),
            layers: Some(layers),
            lights: &layers.lights,
            ..Self::from(&layers.image)
        }
    }
}

/// An image with per-pixel layers (AOVs).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layers {
    /// The linear image.
    pub image: Image,
    pub denoised: Option<Arc<Image>>,
    /// First-hit features.
    pub features: Features,
    /// Light groups as rendered, before the mix.
    pub lights: Vec<LightLayer>,
}

impl Layers {
    /// The layers of a film, with given first-hit features.
    pub fn of(film: &Film, features: Features) -> Self {
        Self {
            image: film.image(),
            features,
            ..Self::default()
        }
    }

    /// The layers of a film that goes as they are made, so that both together take little more memory than the film.
    pub fn taken(mut film: Film, world_units_per_unit: f64) -> Self {
        let (width, pixels) = (film.width as usize, film.pixel_count());
        let mut all = Self {
            image: Image {
                width: film.width,
                height: film.height,
                pixels: vec![[0.0; 4]; pixels],
            },
            features: Features {
                albedo: vec![[0.0; 3]; pixels],
                normal: vec![[0.0; 3]; pixels],
                depth: vec![0.0; pixels],
                samples: vec![0.0; pixels],
                variance: vec![0.0; pixels],
            },
            ..Self::default()
        };
        while film.height > 0 {
            let part = film.split_rows(TAKEN_ROWS.min(film.height));
            let features = Features::of(&part, world_units_per_unit);
            all.put(film.height as usize * width, &Self::of(&part, features));
        }
        all
    }

    /// Copies the pixels of a part to their place, from pixel `first` on.
    fn put(&mut self, first: usize, part: &Self) {
        fn copy<T: Copy>(to: &mut [T], first: usize, from: &[T]) {
            to[first..][..from.len()].copy_from_slice(from);
        }
        let (own, of_part) = (&mut self.features, &part.features);
        copy(&mut self.image.pixels, first, &part.image.pixels);
        copy(&mut own.albedo, first, &of_part.albedo);
        copy(&mut own.normal, first, &of_part.normal);
        copy(&mut own.depth, first, &of_part.depth);
        copy(&mut own.samples, first, &of_part.samples);
        copy(&mut own.variance, first, &of_part.variance);
    }
}

/// Rows of a film that go at a time as its layers are made.
const TAKEN_ROWS: u32 = 64;

/// The formats, by a file's ending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Display-referred sRGB of 8 bits, with exposure and tone curve.
    Png,
    /// Linear, full float, alpha premultiplied.
    Exr,
    /// Linear, shared exponents, no alpha.
    Hdr,
}

/// The formats with their endings.
pub const FORMATS: [(&str, Format); 3] = [("png", Format::Png), ("exr", Format::Exr), ("hdr", Format::Hdr)];

/// The format that a file's ending asks for.
///
/// # Errors
/// [`OutputError::Format`] for another ending: ask before hours of rendering.
pub fn format_of(path: &Path) -> Result<Format, OutputError> {
    let ending = ending(path);
    let found = FORMATS.iter().find(|(its, _)| *its == ending);
    found
        .map(|(_, format)| *format)
        .ok_or_else(|| OutputError::Format { path: path.to_owned() })
}

/// Writes an image of a document in the format of the file extension. A .png has the document's exposure and tone curve, and
/// contains the document. A denoised image replaces the samples; in an .exr file it is added as `denoised.R`, `.G`, `.B`,
/// and so are layers (`albedo.R`, `.G`, `.B`; `normal.X`, `.Y`, `.Z`; `depth.Z`; `samples.Y`; `variance.Y`), light
/// groups (`light.NAME.R`, `.G`, `.B`) and sums.
pub fn write(path: &Path, rendered: Rendered<'_>, document: &Document) -> Result<(), OutputError> {
    let shown = rendered.denoised.unwrap_or(rendered.image);
    let format = format_of(path)?;
    let sums = rendered.sums.filter(|_| format == Format::Exr);
    let attributes = sums.map(|sums| sums.attributes(path)).transpose()?;
    Ok(save_by(path, |file| match format {
        Format::Png => file.write_all(&png(path, shown, document)?),
        Format::Exr => write_exr(file, rendered, attributes.unwrap_or_default()),
        Format::Hdr => write_hdr(file, shown),
    })?)
}

/// Writes an .exr file with layers.
pub fn write_layers(path: &Path, layers: &Layers) -> Result<(), OutputError> {
    Ok(save_by(path, |file| {
        write_exr(file, layers.into(), LayerAttributes::default())
    })?)
}

/// The bytes of a .png to lie at `path`, beside the files that the document inside names.
fn png(path: &Path, image: &Image, document: &Document) -> io::Result<Vec<u8>> {
    let text = own_text(path, document);
    if let Err(error) = &text {
        log::warn!("the image is saved without its document: {error}");
    }
    let pixels = display(image, &document.view);
    png_bytes([image.width, image.height], &pixels, text.as_deref().ok()).map_err(io::Error::other)
}

/// Writes an image's layers as named channels.
fn write_exr(file: &mut (impl Write + Seek), rendered: Rendered<'_>, attributes: LayerAttributes) -> io::Result<()> {
    let mut channels = color_channels("", rendered.image, &COLORS);
    if let Some(denoised) = rendered.denoised {
        channels.extend(color_channels("denoised.", denoised, &COLORS[..3]));
    }
    channels.extend(rendered.layers.into_iter().flat_map(layer_channels));
    for (name, light) in rendered.lights {
        channels.extend(color_channels(&format!("light.{name}."), light, &COLORS[..3]));
    }
    let numbers = channels
        .into_iter()
        .map(|(name, values)| (name, FlatSamples::F32(values)));
    let all = numbers.chain(rendered.sums.into_iter().flat_map(KeptFilm::channels));
    let all = all
        .map(|(name, samples)| AnyChannel::new(name.as_str(), samples))
        .collect();
    let size = (rendered.image.width as usize, rendered.image.height as usize);
    let encoding = if rendered.sums.is_some() {
        Encoding::SMALL_FAST_LOSSLESS
    } else {
        Encoding::FAST_LOSSLESS
    };
    // In scan-line order: tiles in order of completion would make a different file each time.
    let encoding = Encoding {
        line_order: LineOrder::Increasing,
        ..encoding
    };
    let layer = Layer::new(size, attributes, encoding, AnyChannels::sort(all));
    let mut image = exr::prelude::Image::from_layer(layer);
    image.attributes.chromaticities = Some(rec709());
    image.write().to_buffered(file).map_err(io::Error::other)
}

/// The space of all colours here.
fn rec709() -> exr::meta::attribute::Chromaticities {
    let place = |[x, y]: [f64; 2]| exr::math::Vec2(x as f32, y as f32);
    let [red, green, blue] = REC709.primaries.map(place);
    exr::meta::attribute::Chromaticities {
        red,
        green,
        blue,
        white: place(REC709.white),
    }
}

const COLORS: [&str; 4] = ["R", "G", "B", "A"];

/// An image's channels (colours and alpha) by name.
fn color_channels(prefix: &str, image: &Image, names: &[&str]) -> Vec<(String, Vec<f32>)> {
    let values = |i: usize| image.pixels.iter().map(|pixel| pixel[i]).collect();
    let named = names.iter().enumerate();
    named.map(|(i, name)| (format!("{prefix}{name}"), values(i))).collect()
}

fn layer_channels(layers: &Layers) -> Vec<(String, Vec<f32>)> {
    let features = &layers.features;
    let numbers = [
        ("depth.Z", &features.depth),
        ("samples.Y", &features.samples),
        ("variance.Y", &features.variance),
    ];
    let mut channels: Vec<_> = numbers.map(|(name, values)| (name.to_owned(), values.clone())).into();
    for (name, axes, vectors) in [("albedo", "RGB", &features.albedo), ("normal", "XYZ", &features.normal)] {
        let vectors = axes.chars().enumerate().map(|(i, axis)| {
            (
                format!("{name}.{axis}"),
                vectors.iter().map(|vector| vector[i]).collect(),
            )
        });
        channels.extend(vectors);
    }
    channels
}

fn write_hdr(file: &mut impl Write, image: &Image) -> io::Result<()> {
    let pixels: Vec<_> = image.pixels.iter().map(|&[r, g, b, _]| Rgb([r, g, b])).collect();
    let (width, height) = (image.width as usize, image.height as usize);
    HdrEncoder::new(file)
        .encode(&pixels, width, height)
        .map_err(io::Error::other)
}
