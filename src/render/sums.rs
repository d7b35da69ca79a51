//! Films in `.exr` files: the sums behind a picture, so that parts of its samples can be rendered apart and joined.
//!
//! Beside the picture's own channels a file has, for each half of the samples, `sums.even.R.high` and `.low` and so on: the
//! upper and lower 32 bits of the f64 sum, as EXR's unsigned integers. Two f32 would hold 48 of its 53 bits. The document and
//! the numbers of the samples are attributes.

use std::path::{Path, PathBuf};

use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image as ExrImage, Layer, LayerAttributes,
    ReadChannels as _, ReadLayers as _, Text, WritableImage as _, read,
};

use crate::document::Document;
use crate::job::film::{Extras, Film, HalfSums};
use crate::store::FileError;
use crate::store::project::{document_text, parse_document};

/// The attributes of a file with sums.
const DOCUMENT: &str = "glossmithDocument";
const SAMPLES: &str = "glossmithSamples";
const HALVES: [&str; 2] = ["even", "odd"];
const COLORS: [&str; 3] = ["R", "G", "B"];

/// A film with what it is of.
#[derive(Clone, Debug, PartialEq)]
pub struct KeptFilm {
    /// The sums.
    pub film: Film,
    /// What was rendered.
    pub document: Document,
    /// Which samples: the first and the one after the last, several where films were joined; in order.
    pub samples: Vec<[u32; 2]>,
}

/// Why films cannot be read, joined or written.
#[derive(Debug, thiserror::Error)]
pub enum SumsError {
    /// Not an EXR file, or damaged.
    #[error("{}: cannot be read as a picture: {reason}; render it again with --keep-sums", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A picture without sums.
    #[error("{}: has no sums ({missing} is missing); render it with --keep-sums", path.display())]
    NoSums {
        /// The file.
        path: PathBuf,
        /// What is missing.
        missing: String,
    },
    /// The document inside is damaged.
    #[error(transparent)]
    Document(#[from] FileError),
    /// A picture whose pixels have different numbers of samples.
    #[error(
        "films are joined whose pixels have equally many samples, and here {reason}; give a number of samples alone"
    )]
    Uneven {
        /// Why.
        reason: &'static str,
    },
    /// Another picture.
    #[error("{}: of another picture than {}: they differ in {differs}; render both with the same settings", path.display(), first.display())]
    Differs {
        /// The file.
        path: PathBuf,
        /// The one that it is compared with.
        first: PathBuf,
        /// In what.
        differs: String,
    },
    /// Samples that are in both.
    #[error("{}: samples {from} to {to} are in {} too; render others by --samples-from and --samples-to", path.display(), first.display())]
    Twice {
        /// The file.
        path: PathBuf,
        /// The one that has them already.
        first: PathBuf,
        /// The first of the file's samples.
        from: u32,
        /// The one after its last.
        to: u32,
    },
    /// It cannot be written.
    #[error("{}: could not be written: {reason}. Is there room, and may the folder be written to?", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
}

/// Upper and lower half of each number's bits.
fn bits(values: impl Iterator<Item = f64> + Clone) -> [FlatSamples; 2] {
    let upper = values.clone().map(|x| (x.to_bits() >> 32) as u32).collect();
    let lower = values.map(|x| x.to_bits() as u32).collect();
    [FlatSamples::U32(upper), FlatSamples::U32(lower)]
}

impl KeptFilm {
    /// A film that was just rendered.
    pub fn of(film: Film, document: &Document) -> Self {
        let first = document.render.first_sample;
        Self {
            samples: vec![[first, first + film.samples_max()]],
            film,
            document: document.clone(),
        }
    }

    /// Whether films of this document can be joined: each pixel must have as many samples as any other, and how many must
    /// be known before.
    ///
    /// # Errors
    /// [`SumsError::Uneven`].
    pub fn check(document: &Document) -> Result<(), SumsError> {
        let render = &document.render;
        let reasons = [
            (render.is_adaptive(), "samples go where the error is (adaptive)"),
            (render.noise.is_some(), "it ends at a noise"),
            (render.time_s.is_some(), "it ends with a time"),
        ];
        match reasons.into_iter().find(|(is_so, _)| *is_so) {
            Some((_, reason)) => Err(SumsError::Uneven { reason }),
            None => Ok(()),
        }
    }

    /// Writes the picture with its sums.
    ///
    /// # Errors
    /// [`SumsError::Write`].
    pub fn write(&self, path: &Path) -> Result<(), SumsError> {
        let write = |reason: String| SumsError::Write {
            path: path.to_owned(),
            reason,
        };
        let text = document_text(path, &self.document)?;
        let samples: Vec<String> = self.samples.iter().map(|[from, to]| format!("{from}-{to}")).collect();
        let mut attributes = LayerAttributes::default();
        for (name, value) in [(DOCUMENT, text), (SAMPLES, samples.join(","))] {
            let value = Text::from(value.as_str());
            attributes.other.insert(Text::from(name), AttributeValue::Text(value));
        }
        let size = (self.film.width as usize, self.film.height as usize);
        let channels = AnyChannels::sort(self.channels().into_iter().collect());
        let layer = Layer::new(size, attributes, Encoding::SMALL_FAST_LOSSLESS, channels);
        let written = ExrImage::from_layer(layer).write().to_file(path);
        written.map_err(|error| write(error.to_string()))
    }

    fn channels(&self) -> Vec<AnyChannel<FlatSamples>> {
        let film = &self.film;
        let pixels = || 0..film.pixel_count();
        let image = film.image();
        let mut channels = Vec::new();
        let mut push = |name: &str, samples: FlatSamples| channels.push(AnyChannel::new(name, samples));
        for (i, name) in ["R", "G", "B", "A"].into_iter().enumerate() {
            push(
                name,
                FlatSamples::F32(image.pixels.iter().map(|pixel| pixel[i]).collect()),
            );
        }
        for (half, word) in HALVES.into_iter().enumerate() {
            for (i, color) in COLORS.into_iter().enumerate() {
                let [high, low] = bits(pixels().map(|pixel| film.halves(pixel)[half].color[i]));
                push(&format!("sums.{word}.{color}.high"), high);
                push(&format!("sums.{word}.{color}.low"), low);
            }
            let of = |pixel: usize| film.halves(pixel)[half];
            let deviations = pixels().map(|pixel| of(pixel).squared_deviations as f32).collect();
            push(&format!("sums.{word}.deviations"), FlatSamples::F32(deviations));
            let samples = pixels().map(|pixel| of(pixel).samples as u32).collect();
            push(&format!("sums.{word}.samples"), FlatSamples::U32(samples));
        }
        if film.extras().coverage {
            let [high, low] = bits(pixels().map(|pixel| film.color(pixel)[3]));
            push("sums.coverage.high", high);
            push("sums.coverage.low", low);
        }
        channels
    }

    /// The film in a file.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub fn read(path: &Path) -> Result<Self, SumsError> {
        let wrong = |error: exr::error::Error| SumsError::Read {
            path: path.to_owned(),
            reason: error.to_string(),
        };
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_file(path)
            .map_err(wrong)?;
        let layer = image.layer_data;
        let missing = |missing: &str| SumsError::NoSums {
            path: path.to_owned(),
            missing: missing.to_owned(),
        };
        let attribute = |name: &str| match layer.attributes.other.get(&Text::from(name)) {
            Some(AttributeValue::Text(text)) => Ok(text.to_string()),
            _ => Err(missing(name)),
        };
        let find = |name: &str| {
            let mut channels = layer.channel_data.list.iter();
            channels
                .find(|channel| channel.name == *name)
                .map(|channel| &channel.sample_data)
        };
        let words = |name: &str| match find(name) {
            Some(FlatSamples::U32(words)) => Ok(words),
            _ => Err(missing(name)),
        };
        let doubles = |name: &str| -> Result<Vec<f64>, SumsError> {
            let (high, low) = (words(&format!("{name}.high"))?, words(&format!("{name}.low"))?);
            let joined = high
                .iter()
                .zip(low)
                .map(|(high, low)| (u64::from(*high) << 32) | u64::from(*low));
            Ok(joined.map(f64::from_bits).collect())
        };
        let document = parse_document(path, attribute(DOCUMENT)?.as_bytes())?.value;
        let samples = ranges(&attribute(SAMPLES)?).ok_or_else(|| missing(SAMPLES))?;
        let extras = Extras {
            coverage: find("sums.coverage.high").is_some(),
            guides: false,
        };
        let mut film = Film::keeping(layer.size.0 as u32, layer.size.1 as u32, extras);
        let mut halves = vec![[HalfSums::default(); 2]; film.pixel_count()];
        for (half, word) in HALVES.into_iter().enumerate() {
            for (i, color) in COLORS.into_iter().enumerate() {
                let sums = doubles(&format!("sums.{word}.{color}"))?;
                halves
                    .iter_mut()
                    .zip(sums)
                    .for_each(|(halves, sum)| halves[half].color[i] = sum);
            }
            let name = format!("sums.{word}.deviations");
            let Some(FlatSamples::F32(deviations)) = find(&name) else {
                return Err(missing(&name));
            };
            let counts = words(&format!("sums.{word}.samples"))?;
            for ((halves, deviation), count) in halves.iter_mut().zip(deviations).zip(counts) {
                halves[half].squared_deviations = f64::from(*deviation);
                halves[half].samples = f64::from(*count);
            }
        }
        for (pixel, halves) in halves.iter().enumerate() {
            film.set_halves(pixel, halves);
        }
        if extras.coverage {
            let coverage = doubles("sums.coverage")?;
            coverage
                .into_iter()
                .enumerate()
                .for_each(|(pixel, sum)| film.add_coverage(pixel, sum));
        }
        Ok(Self {
            film,
            document,
            samples,
        })
    }

    /// Samples a pixel.
    pub fn sample_count(&self) -> u32 {
        self.samples.iter().map(|[from, to]| to - from).sum()
    }

    /// What both must have in common.
    fn picture(&self) -> Document {
        let mut document = self.document.clone();
        (document.render.samples, document.render.first_sample) = (0, 0);
        document
    }

    /// Adds the samples of another film of the same picture. The paths are only named in messages.
    ///
    /// # Errors
    /// [`SumsError::Differs`], [`SumsError::Twice`].
    pub fn add(&mut self, other: &Self, path: &Path, first: &Path) -> Result<(), SumsError> {
        let differs = |differs: &str| SumsError::Differs {
            path: path.to_owned(),
            first: first.to_owned(),
            differs: differs.to_owned(),
        };
        if (self.film.width, self.film.height) != (other.film.width, other.film.height) {
            return Err(differs("size"));
        }
        if self.picture() != other.picture() || self.film.extras().coverage != other.film.extras().coverage {
            return Err(differs("what was rendered, or how"));
        }
        for [from, to] in &other.samples {
            if self.samples.iter().any(|own| own[0] < *to && *from < own[1]) {
                return Err(SumsError::Twice {
                    path: path.to_owned(),
                    first: first.to_owned(),
                    from: *from,
                    to: *to,
                });
            }
        }
        for pixel in 0..self.film.pixel_count() {
            let (own, more) = (self.film.halves(pixel), other.film.halves(pixel));
            self.film
                .set_halves(pixel, &[own[0].with(&more[0]), own[1].with(&more[1])]);
            self.film.add_coverage(pixel, other.film.color(pixel)[3]);
        }
        self.samples.extend(&other.samples);
        self.samples.sort_unstable();
        joined(&mut self.samples);
        self.document.render.first_sample = self.samples[0][0];
        self.document.render.samples = self.sample_count();
        Ok(())
    }
}

/// Neighbouring ranges as one.
fn joined(ranges: &mut Vec<[u32; 2]>) {
    let mut whole: Vec<[u32; 2]> = Vec::new();
    for range in ranges.drain(..) {
        match whole.last_mut() {
            Some(last) if last[1] == range[0] => last[1] = range[1],
            _ => whole.push(range),
        }
    }
    *ranges = whole;
}

/// Ranges as text, such as `0-64,128-192`.
fn ranges(text: &str) -> Option<Vec<[u32; 2]>> {
    text.split(',').map(range).collect()
}

/// A range as text, such as `0-64`.
pub fn range(text: &str) -> Option<[u32; 2]> {
    let (from, to) = text.split_once('-')?;
    let range = [from.parse().ok()?, to.parse().ok()?];
    (range[0] < range[1]).then_some(range)
}
