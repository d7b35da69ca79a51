//! Pictures written to files.

use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use image::Rgb;
use image::codecs::hdr::HdrEncoder;

use super::display::display;
use crate::document::Document;
use crate::job::features::Features;
use crate::job::film::Image;
use crate::store::picture::png_bytes;
use crate::store::project::document_text;

/// Why a picture can't be written.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// The name's ending says no format that is written.
    #[error("{}: pictures are written as .png, .exr or .hdr; give the file one of these endings", path.display())]
    Format {
        /// The file.
        path: PathBuf,
    },
    /// The file could not be written.
    #[error("{}: could not be written: {reason}. Is there room, and may the folder be written to?", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
}

/// A picture to write.
#[derive(Clone, Copy, Debug)]
pub struct Rendered<'a> {
    /// The mean of the samples, linear.
    pub image: &'a Image,
    /// The same denoised: what is shown, where it is there.
    pub denoised: Option<&'a Image>,
}

impl<'a> From<&'a Image> for Rendered<'a> {
    fn from(image: &'a Image) -> Self {
        Self { image, denoised: None }
    }
}

/// A picture with what is known beside it about each pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    /// The linear picture.
    pub image: Image,
    /// The same denoised.
    pub denoised: Option<Arc<Image>>,
    /// What the camera sees first.
    pub features: Features,
    /// Samples in each pixel's mean.
    pub samples: Vec<f32>,
    /// Variance of each pixel's mean luminance; infinite below two samples.
    pub variance: Vec<f32>,
}

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

/// The format that a file's ending asks for.
///
/// # Errors
/// [`OutputError::Format`] for another ending: ask before hours of rendering.
pub fn format_of(path: &Path) -> Result<Format, OutputError> {
    let ending = path
        .extension()
        .and_then(|ending| ending.to_str())
        .unwrap_or_default()
        .to_ascii_lowercase();
    match ending.as_str() {
        "png" => Ok(Format::Png),
        "exr" => Ok(Format::Exr),
        "hdr" => Ok(Format::Hdr),
        _ => Err(OutputError::Format { path: path.to_owned() }),
    }
}

/// Writes a picture of a document in the format of the file's ending. A .png has the document's exposure and tone curve,
/// and the document itself inside. A denoised picture takes the samples' place; in an .exr file it stands beside them, as
/// `denoised.R`, `.G`, `.B`.
///
/// # Errors
/// [`OutputError`] naming the file.
pub fn write(path: &Path, rendered: Rendered<'_>, document: &Document) -> Result<(), OutputError> {
    let shown = rendered.denoised.unwrap_or(rendered.image);
    let written = match (format_of(path)?, rendered.denoised) {
        (Format::Png, _) => write_png(path, shown, document),
        (Format::Exr, None) => write_exr(path, shown),
        (Format::Exr, Some(denoised)) => {
            write_channels(path, rendered.image, color_channels(rendered.image, Some(denoised)))
        }
        (Format::Hdr, _) => write_hdr(path, shown),
    };
    written.map_err(|reason| OutputError::Write {
        path: path.to_owned(),
        reason,
    })
}

fn write_png(path: &Path, image: &Image, document: &Document) -> Result<(), String> {
    let text = document_text(path, document);
    if let Err(error) = &text {
        log::warn!("the picture is saved without its document: {error}");
    }
    let pixels = display(image, &document.view);
    let bytes = png_bytes([image.width, image.height], &pixels, text.as_deref().ok())?;
    std::fs::write(path, bytes).map_err(|error| error.to_string())
}

/// Writes a file through a buffer, and notices where the last of it does not fit on the disc.
fn write_buffered(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> image::ImageResult<()>,
) -> Result<(), String> {
    let mut file = BufWriter::new(File::create(path).map_err(|error| error.to_string())?);
    write(&mut file).map_err(|error| error.to_string())?;
    file.flush().map_err(|error| error.to_string())
}

fn write_exr(path: &Path, image: &Image) -> Result<(), String> {
    let pixel = |x: usize, y: usize| {
        let [r, g, b, a] = image.pixels[y * image.width as usize + x];
        (r, g, b, a)
    };
    exr::prelude::write_rgba_file(path, image.width as usize, image.height as usize, pixel)
        .map_err(|error| error.to_string())
}

/// Writes an EXR file with layers beside the colour: `denoised.R`, `.G`, `.B` where it was denoised; `albedo.R`, `.G`,
/// `.B`; `normal.X`, `.Y`, `.Z`; `depth.Z`; `samples.Y`; `variance.Y`.
///
/// # Errors
/// [`OutputError`] naming the file.
pub fn write_layers(path: &Path, layers: &Layers) -> Result<(), OutputError> {
    write_exr_layers(path, layers).map_err(|reason| OutputError::Write {
        path: path.to_owned(),
        reason,
    })
}

fn write_exr_layers(path: &Path, layers: &Layers) -> Result<(), String> {
    let features = &layers.features;
    let mut channels = color_channels(&layers.image, layers.denoised.as_deref());
    for i in 0..3 {
        let vector = |values: &[[f32; 3]]| values.iter().map(|value| value[i]).collect();
        channels.push((format!("albedo.{}", COLORS[i]), vector(&features.albedo)));
        channels.push((format!("normal.{}", ["X", "Y", "Z"][i]), vector(&features.normal)));
    }
    channels.push(("depth.Z".to_owned(), features.depth.clone()));
    channels.push(("samples.Y".to_owned(), layers.samples.clone()));
    channels.push(("variance.Y".to_owned(), layers.variance.clone()));
    write_channels(path, &layers.image, channels)
}

const COLORS: [&str; 4] = ["R", "G", "B", "A"];

/// A picture's colours and opacity, and the colours of the denoised one, as named channels.
fn color_channels(image: &Image, denoised: Option<&Image>) -> Vec<(String, Vec<f32>)> {
    let channel = |image: &Image, i: usize| image.pixels.iter().map(|pixel| pixel[i]).collect();
    let own = (0..4).map(|i| (COLORS[i].to_owned(), channel(image, i)));
    let of_denoised = |denoised| (0..3).map(move |i| (format!("denoised.{}", COLORS[i]), channel(denoised, i)));
    own.chain(denoised.into_iter().flat_map(of_denoised)).collect()
}

/// Writes channels of the size of `image`.
fn write_channels(path: &Path, image: &Image, channels: Vec<(String, Vec<f32>)>) -> Result<(), String> {
    use exr::prelude::{
        AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage as _,
    };
    let channel = |(name, values): (String, Vec<f32>)| AnyChannel::new(name.as_str(), FlatSamples::F32(values));
    let size = (image.width as usize, image.height as usize);
    let channels = AnyChannels::sort(channels.into_iter().map(channel).collect());
    let layer = Layer::new(size, LayerAttributes::default(), Encoding::FAST_LOSSLESS, channels);
    Image::from_layer(layer)
        .write()
        .to_file(path)
        .map_err(|error| error.to_string())
}

fn write_hdr(path: &Path, image: &Image) -> Result<(), String> {
    let pixels: Vec<_> = image.pixels.iter().map(|&[r, g, b, _]| Rgb([r, g, b])).collect();
    let (width, height) = (image.width as usize, image.height as usize);
    write_buffered(path, |file| HdrEncoder::new(file).encode(&pixels, width, height))
}
