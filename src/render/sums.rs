//! Films in `.exr` files: an image's sums, so that parts of its samples can be rendered separately and joined.
//!
//! Besides the image's channels, a file has `sums.even.R.high`, `.low` and so on for each half of the samples: the upper and
//! lower 32 bits of the f64 sum, as EXR's unsigned integers. Two f32 would hold only 48 of its 53 bits. The sums of the
//! guides of each half's first samples are f32 (`sums.guides.even.…`), with their number. Light groups have sums of their own
//! (`sums.light.NAME.even.…`). An attribute has the document and the sample ranges.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, FlatSamples, Layer, LayerAttributes, ReadChannels as _, ReadLayers as _,
    Text, read,
};

use crate::document::change::Change;
use crate::document::effect::without_what_is_off;
use crate::document::{Document, GroupName};
use crate::job::features::Features;
use crate::job::film::{Extras, Film, HalfSums, LightSums};
use crate::job::guides::GUIDE_SAMPLES;
use crate::render::denoise::Noisy;
use crate::render::light_layers::{LightLayer, light_groups, light_layers, mixed};
use crate::store::FileError;
use crate::store::project::{document_text, parse_document};

/// The attribute of a file with sums: a line with the numbers of the samples, one with the world's units, and the document.
/// One alone, as several are written in another order each time.
const KEPT: &str = "glossmithSums";
const HALVES: [&str; 2] = ["even", "odd"];
const COLORS: [&str; 3] = ["R", "G", "B"];
/// Channels of the guides, in the order of [`crate::job::guides::GuideSums`].
const GUIDES: [&str; 8] = [
    "albedo.R", "albedo.G", "albedo.B", "hits", "normal.X", "normal.Y", "normal.Z", "depth",
];

/// A film, the document that it shows and the range of samples in it.
#[derive(Clone, Debug, PartialEq)]
pub struct KeptFilm {
    pub film: Film,
    pub document: Document,
    /// Sample ranges (first, end) in order; several if films were joined.
    pub samples: Vec<[u32; 2]>,
    /// Guide samples per half of a pixel.
    guide_samples: Vec<[u32; 2]>,
    /// Units of the world in one of the geometry's: depths are summed in these.
    world_units_per_unit: f64,
}

/// Why films cannot be read, joined or written.
#[derive(Debug, thiserror::Error)]
pub enum SumsError {
    /// Not an EXR file, or damaged.
    #[error("{}: cannot be read as an image: {reason}; render it again with --keep-sums", path.display())]
    Read { path: PathBuf, reason: String },
    /// An image without sums, or with those of an older version.
    #[error("{}: has no sums that this version reads ({missing} is missing); render it with --keep-sums", path.display())]
    NoSums { path: PathBuf, missing: String },
    /// The document inside is damaged.
    #[error(transparent)]
    Document(#[from] FileError),
    /// Films of which none has the first samples.
    #[error(
        "layers and the denoiser need what the first samples saw (0 to {GUIDE_SAMPLES}), and none of the films has them; \
         join one that begins at 0"
    )]
    NotSeen,
    /// Sums of another image.
    #[error("{}: of another image than {}: they differ in {differs}; render both with the same settings", path.display(), first.display())]
    Differs {
        path: PathBuf,
        first: PathBuf,
        differs: String,
    },
    /// Samples that are in both.
    #[error("{}: samples {from} to {to} are in {} too; render others by --samples-from and --samples-to", path.display(), first.display())]
    Twice {
        path: PathBuf,
        first: PathBuf,
        from: u32,
        to: u32,
    },
}

/// Channels of the upper and the lower half of each number's bits.
fn doubles(name: &str, values: impl Iterator<Item = f64> + Clone) -> [(String, FlatSamples); 2] {
    let upper = values.clone().map(|x| (x.to_bits() >> 32) as u32).collect();
    let lower = values.map(|x| x.to_bits() as u32).collect();
    let of = |half: &str, bits| (format!("sums.{name}.{half}"), FlatSamples::U32(bits));
    [of("high", upper), of("low", lower)]
}

/// Name of the sums of a light group in one half of the samples, such as `light.key.even`.
fn light_sums(group: GroupName, half: &str) -> String {
    format!("light.{}.{half}", group.as_str())
}

impl KeptFilm {
    /// A film of up to `samples` samples per pixel that was just rendered.
    pub fn of(film: Film, document: Document, samples: u32, world_units_per_unit: f64) -> Self {
        let first = document.render.first_sample;
        // Number of samples of either half before this range.
        let before = [first.div_ceil(2), first / 2];
        let most = match film.extras().guides {
            true => before.map(|before| (GUIDE_SAMPLES / 2).saturating_sub(before)),
            false => [0; 2],
        };
        let seen = |pixel: usize| std::array::from_fn(|half| most[half].min(film.halves(pixel)[half].samples as u32));
        let guide_samples = (0..film.pixel_count()).map(seen).collect();
        Self {
            samples: vec![[first, first + samples]],
            film,
            document,
            guide_samples,
            world_units_per_unit,
        }
    }

    /// The film with the mix of its light groups.
    pub fn mixed(&self) -> Cow<'_, Film> {
        mixed(&self.film, &self.document)
    }

    /// The light of each group as it was rendered, by the group's name.
    pub fn light_layers(&self) -> Vec<LightLayer> {
        light_layers(&self.film, &self.document)
    }

    /// First-hit features.
    ///
    /// # Errors
    ///
    /// [`SumsError::NotSeen`] if a pixel has samples, but none of the first ones.
    pub fn features(&self) -> Result<Features, SumsError> {
        self.check_seen(|[even, odd], _| even + odd > 0)?;
        let samples = |pixel: usize| self.guide_samples[pixel].map(f64::from);
        Ok(Features::of_samples(&self.film, samples, self.world_units_per_unit))
    }

    /// Input of the denoiser.
    ///
    /// # Errors
    ///
    /// The same for each half, as each is guided by its own samples.
    pub fn noisy(&self) -> Result<Noisy, SumsError> {
        self.check_seen(|seen, samples| (0..2).all(|half| seen[half] > 0 || samples[half] == 0.0))?;
        let samples = |pixel: usize| self.guide_samples[pixel].map(f64::from);
        Ok(Noisy::of_samples(&self.mixed(), samples, self.document.render.region))
    }

    /// Refuses a film with a pixel that has samples, but not enough of the first among them.
    fn check_seen(&self, is_enough: impl Fn([u32; 2], [f64; 2]) -> bool) -> Result<(), SumsError> {
        let samples = |pixel: usize| self.film.halves(pixel).map(|half| half.samples);
        let is_seen = |pixel: usize| is_enough(self.guide_samples[pixel], samples(pixel)) || samples(pixel) == [0.0; 2];
        match (0..self.film.pixel_count()).all(is_seen) {
            true => Ok(()),
            false => Err(SumsError::NotSeen),
        }
    }

    /// Attributes of a file at `path`.
    pub fn attributes(&self, path: &Path) -> Result<LayerAttributes, FileError> {
        let samples: Vec<String> = self.samples.iter().map(|[from, to]| format!("{from}-{to}")).collect();
        let document = document_text(path, &self.document)?;
        let kept = format!("{}\n{}\n{document}", samples.join(","), self.world_units_per_unit);
        let mut attributes = LayerAttributes::default();
        let value = AttributeValue::Text(Text::from(kept.as_str()));
        attributes.other.insert(Text::from(KEPT), value);
        Ok(attributes)
    }

    /// The sums by the names of their channels.
    pub fn channels(&self) -> Vec<(String, FlatSamples)> {
        let film = &self.film;
        let pixels = || 0..film.pixel_count();
        let mut channels = Vec::new();
        let groups = light_groups(film, &self.document);
        let groups = || groups.iter().enumerate();
        for (half, word) in HALVES.into_iter().enumerate() {
            for (i, color) in COLORS.into_iter().enumerate() {
                let sums = pixels().map(|pixel| film.halves(pixel)[half].color[i]);
                channels.extend(doubles(&format!("{word}.{color}"), sums));
                for (group, name) in groups() {
                    let sums = pixels().map(|pixel| film.lights(pixel)[group][half][i]);
                    channels.extend(doubles(&format!("{}.{color}", light_sums(*name, word)), sums));
                }
            }
            let of = |pixel: usize| film.halves(pixel)[half];
            let deviations = pixels()
                .map(|pixel| of(pixel).squared_deviations.min(f64::from(f32::MAX)) as f32)
                .collect();
            channels.push((format!("sums.{word}.deviations"), FlatSamples::F32(deviations)));
            let samples = pixels().map(|pixel| of(pixel).samples as u32).collect();
            channels.push((format!("sums.{word}.samples"), FlatSamples::U32(samples)));
        }
        if film.extras().coverage {
            channels.extend(doubles("coverage", pixels().map(|pixel| film.color(pixel)[3])));
        }
        if film.extras().guides {
            let guides: &[[[f32; GUIDES.len()]; 2]] = bytemuck::cast_slice(&film.guides);
            for (half, word) in HALVES.into_iter().enumerate() {
                for (i, name) in GUIDES.into_iter().enumerate() {
                    let values = guides.iter().map(|guides| guides[half][i]).collect();
                    channels.push((format!("sums.guides.{word}.{name}"), FlatSamples::F32(values)));
                }
                let samples = self.guide_samples.iter().map(|samples| samples[half]).collect();
                channels.push((format!("sums.guides.{word}.samples"), FlatSamples::U32(samples)));
            }
        }
        channels
    }

    /// Reads a film from a file.
    pub fn read(path: &Path) -> Result<Self, SumsError> {
        let file = Sums::open(path)?;
        let [samples, units, document] = file.kept()?;
        let document = parse_document(path, document.as_bytes())?.value;
        let samples = ranges(&samples).ok_or_else(|| file.missing(KEPT))?;
        let world_units_per_unit = units.parse().map_err(|_| file.missing(KEPT))?;
        let groups = without_what_is_off(&document).light_groups();
        let extras = Extras {
            coverage: file.find("coverage.high").is_some(),
            guides: file.has_guides(),
            light_groups: groups.len() as u32,
        };
        let [width, height] = file.size();
        let mut film = Film::keeping(width, height, extras);
        let halves = file.halves(film.pixel_count())?;
        for (pixel, halves) in halves.iter().enumerate() {
            film.set_halves(pixel, halves);
        }
        for (group, name) in groups.iter().enumerate() {
            for (half, word) in HALVES.into_iter().enumerate() {
                file.add_light(&mut film, group, half, &light_sums(*name, word))?;
            }
        }
        if extras.coverage {
            let coverage = file.doubles("coverage")?.into_iter().enumerate();
            coverage.for_each(|(pixel, sum)| film.add_coverage(pixel, sum));
        }
        let mut guide_samples = vec![[0; 2]; film.pixel_count()];
        if extras.guides {
            let guides: &mut [[[f32; GUIDES.len()]; 2]] = bytemuck::cast_slice_mut(&mut film.guides);
            for (half, word) in HALVES.into_iter().enumerate() {
                for (i, name) in GUIDES.into_iter().enumerate() {
                    let values = file.numbers(&format!("guides.{word}.{name}"))?.iter();
                    guides
                        .iter_mut()
                        .zip(values)
                        .for_each(|(sums, value)| sums[half][i] = *value);
                }
                let samples = file.words(&format!("guides.{word}.samples"))?.iter();
                guide_samples
                    .iter_mut()
                    .zip(samples)
                    .for_each(|(own, samples)| own[half] = *samples);
            }
        }
        Ok(Self {
            film,
            document,
            samples,
            guide_samples,
            world_units_per_unit,
        })
    }

    /// Maximum samples per pixel.
    pub fn sample_count(&self) -> u32 {
        self.samples.iter().map(|[from, to]| to - from).sum()
    }

    /// Whether both are samples of the same image.
    fn is_alike(&self, other: &Self) -> bool {
        let mut document = other.document.clone();
        document.render.first_sample = self.document.render.first_sample;
        !Change::between(&self.document, &document).restarts()
            && self.film.extras().coverage == other.film.extras().coverage
            && self.film.light_groups() == other.film.light_groups()
    }

    /// Adds the samples of another film of the same image. The paths are for messages.
    pub fn add(&mut self, other: &Self, path: &Path, first: &Path) -> Result<(), SumsError> {
        let differs = |differs: &str| SumsError::Differs {
            path: path.to_owned(),
            first: first.to_owned(),
            differs: differs.to_owned(),
        };
        if (self.film.width, self.film.height) != (other.film.width, other.film.height) {
            return Err(differs("size"));
        }
        if !self.is_alike(other) {
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
            for (group, more) in other.film.lights(pixel).iter().enumerate() {
                self.film.add_light(pixel, group, *more);
            }
        }
        if other.film.extras().guides {
            self.film.guides.resize(other.film.guides.len(), Default::default());
            let (own, more) = (self.film.guides.as_flattened_mut(), other.film.guides.as_flattened());
            own.iter_mut().zip(more).for_each(|(guides, more)| guides.add(more));
            let (own, more) = (
                self.guide_samples.as_flattened_mut(),
                other.guide_samples.as_flattened(),
            );
            own.iter_mut().zip(more).for_each(|(samples, more)| *samples += more);
        }
        self.samples.extend(&other.samples);
        self.samples.sort_unstable();
        joined(&mut self.samples);
        self.document.render.first_sample = self.samples[0][0];
        self.document.render.samples = self.sample_count();
        Ok(())
    }
}

/// The channels and attributes of a file with sums.
struct Sums<'a> {
    path: &'a Path,
    layer: Layer<AnyChannels<FlatSamples>>,
}

impl<'a> Sums<'a> {
    fn open(path: &'a Path) -> Result<Self, SumsError> {
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_file(path)
            .map_err(|error| SumsError::Read {
                path: path.to_owned(),
                reason: error.to_string(),
            })?;
        let layer = image.layer_data;
        Ok(Self { path, layer })
    }

    fn size(&self) -> [u32; 2] {
        [self.layer.size.0 as u32, self.layer.size.1 as u32]
    }

    fn missing(&self, missing: &str) -> SumsError {
        SumsError::NoSums {
            path: self.path.to_owned(),
            missing: missing.to_owned(),
        }
    }

    /// The numbers of the samples, the world's units and the document.
    fn kept(&self) -> Result<[String; 3], SumsError> {
        let missing = || self.missing(KEPT);
        let Some(AttributeValue::Text(text)) = self.layer.attributes.other.get(&Text::from(KEPT)) else {
            return Err(missing());
        };
        let parts: Vec<String> = text.to_string().splitn(3, '\n').map(str::to_owned).collect();
        parts.try_into().map_err(|_| missing())
    }

    fn find(&self, name: &str) -> Option<&FlatSamples> {
        let name = format!("sums.{name}");
        let mut channels = self.layer.channel_data.list.iter();
        let is_meant = |channel: &&AnyChannel<FlatSamples>| channel.name == *name.as_str();
        channels.find(is_meant).map(|channel| &channel.sample_data)
    }

    /// Whether it has guides. Those of an older version, over both halves, are missing in each.
    fn has_guides(&self) -> bool {
        let mut channels = self.layer.channel_data.list.iter();
        channels.any(|channel| channel.name.to_string().starts_with("sums.guides."))
    }

    fn words(&self, name: &str) -> Result<&[u32], SumsError> {
        match self.find(name) {
            Some(FlatSamples::U32(words)) => Ok(words),
            _ => Err(self.missing(name)),
        }
    }

    fn numbers(&self, name: &str) -> Result<&[f32], SumsError> {
        match self.find(name) {
            Some(FlatSamples::F32(numbers)) => Ok(numbers),
            _ => Err(self.missing(name)),
        }
    }

    fn doubles(&self, name: &str) -> Result<Vec<f64>, SumsError> {
        let high = self.words(&format!("{name}.high"))?;
        let low = self.words(&format!("{name}.low"))?;
        let both = high.iter().zip(low);
        let joined = both.map(|(high, low)| (u64::from(*high) << 32) | u64::from(*low));
        Ok(joined.map(f64::from_bits).collect())
    }

    /// Adds the sums of a light group in one half of the samples to a film.
    fn add_light(&self, film: &mut Film, group: usize, half: usize, name: &str) -> Result<(), SumsError> {
        for (channel, color) in COLORS.into_iter().enumerate() {
            for (pixel, sum) in self.doubles(&format!("{name}.{color}"))?.into_iter().enumerate() {
                let mut sums = LightSums::default();
                sums[half][channel] = sum;
                film.add_light(pixel, group, sums);
            }
        }
        Ok(())
    }

    /// The sums of both halves of each pixel's samples.
    fn halves(&self, pixels: usize) -> Result<Vec<[HalfSums; 2]>, SumsError> {
        let mut halves = vec![[HalfSums::default(); 2]; pixels];
        for (half, word) in HALVES.into_iter().enumerate() {
            for (i, color) in COLORS.into_iter().enumerate() {
                let sums = self.doubles(&format!("{word}.{color}"))?;
                let of_pixels = halves.iter_mut().zip(sums);
                of_pixels.for_each(|(halves, sum)| halves[half].color[i] = sum);
            }
            let deviations = self.numbers(&format!("{word}.deviations"))?;
            let counts = self.words(&format!("{word}.samples"))?;
            for ((halves, deviation), count) in halves.iter_mut().zip(deviations).zip(counts) {
                halves[half].squared_deviations = f64::from(*deviation);
                halves[half].samples = f64::from(*count);
            }
        }
        Ok(halves)
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
