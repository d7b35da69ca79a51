//! Films in `.exr` files: an image's sums, so that parts of its samples can be rendered separately and joined.
//!
//! Besides the image's channels, a file has `sums.even.R.high`, `.low` and so on for each half of the samples: the upper and
//! lower 32 bits of the f64 sum, as EXR's unsigned integers. Two f32 would hold only 48 of its 53 bits. The sums of the
//! guides of each half's first samples are f32 (`sums.guides.even.…`), with their number. Light groups have sums of their own
//! (`sums.light.NAME.even.…`). An attribute has the document and the sample ranges.

use std::{borrow::Cow, path::Path, path::PathBuf};

use exr::prelude::{
    AnyChannels, AttributeValue, FlatSamples, Layer, LayerAttributes, ReadChannels as _, ReadLayers as _, Text, read,
};

use crate::{
    document::{Document, GroupName, change::Change, effect::without_what_is_off},
    job::{features::Features, film::Extras, film::Film, guides::GUIDE_SAMPLES},
    render::denoise::Noisy,
    render::light_layers::{LightLayer, light_groups, light_layers, mixed},
    store::{FileError, project::document_text, project::parse_document},
};

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
    /// Not an image with sums that this version reads, or with sums that cannot be joined.
    #[error("{path}: {reason}")]
    File { path: PathBuf, reason: String },
    /// The document inside is damaged.
    #[error(transparent)]
    Document(#[from] FileError),
    /// Films of which none has the first samples.
    #[error(
        "layers and the denoiser need what the first samples saw (0 to {GUIDE_SAMPLES}), and none of the films has them; \
         join one that begins at 0"
    )]
    NotSeen,
}

impl SumsError {
    fn of(path: &Path, reason: String) -> Self {
        Self::File {
            path: path.to_owned(),
            reason,
        }
    }
}

/// 32 bits of each pixel: the channel's name, the array that they are of (of [`Film::words`], or the numbers of guide samples), their place among the words
/// of a pixel there, and whether they are an f32.
type Channel = (String, Array, usize, bool);

#[derive(Clone, Copy)]
enum Array {
    Pixels,
    Coverage,
    Lights,
    Guides,
    GuideSamples,
}

impl KeptFilm {
    /// A film of up to `samples` samples per pixel that was just rendered.
    pub fn of(film: Film, document: Document, samples: u32, world_units_per_unit: f64) -> Self {
        let first = document.render.first_sample;
        // Number of samples of either half before this range.
        let before = [first.div_ceil(2), first / 2];
        let most = match film.extras().guides {
            2 => before.map(|before| (GUIDE_SAMPLES / 2).saturating_sub(before)),
            _ => [0; 2],
        };
        let guide_samples = (0..film.pixel_count())
            .map(|pixel| std::array::from_fn(|half| most[half].min(film.pixels[pixel][half].samples as u32)))
            .collect();
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
        let samples = |pixel: usize| self.film.pixels[pixel].map(|half| half.samples);
        match (0..self.film.pixel_count())
            .all(|pixel| is_enough(self.guide_samples[pixel], samples(pixel)) || samples(pixel) == [0.0; 2])
        {
            true => Ok(()),
            false => Err(SumsError::NotSeen),
        }
    }

    /// Attributes of a file at `path`.
    pub fn attributes(&self, path: &Path) -> Result<LayerAttributes, FileError> {
        let samples = self.samples.iter().map(|[from, to]| format!("{from}-{to}"));
        let document = document_text(path, &self.document)?;
        let kept = format!(
            "{}\n{}\n{document}",
            crate::named::joined(samples, ","),
            self.world_units_per_unit
        );
        let mut attributes = LayerAttributes::default();
        attributes
            .other
            .insert(Text::from(KEPT), AttributeValue::Text(Text::from(kept.as_str())));
        Ok(attributes)
    }

    /// Every channel but those of deviations and numbers of samples, which are narrower here.
    fn layout(groups: &[GroupName], extras: Extras) -> Vec<Channel> {
        let mut channels = Vec::new();
        // The lower half of a number comes first in memory.
        let double = |name: String, array: Array, place: usize| {
            ["low", "high"].map(|half| {
                (
                    format!("{name}.{half}"),
                    array,
                    2 * place + usize::from(half == "high"),
                    false,
                )
            })
        };
        for (half, word) in HALVES.into_iter().enumerate() {
            for (i, color) in COLORS.into_iter().enumerate() {
                channels.extend(double(format!("{word}.{color}"), Array::Pixels, 5 * half + i));
                for (group, name) in groups.iter().enumerate() {
                    let name = format!("light.{}.{word}.{color}", name.as_str());
                    channels.extend(double(name, Array::Lights, 6 * group + 3 * half + i));
                }
            }
            if extras.guides == 2 {
                let guides = GUIDES.into_iter().enumerate();
                let guides =
                    guides.map(|(i, name)| (format!("guides.{word}.{name}"), Array::Guides, 8 * half + i, true));
                channels.extend(guides);
                channels.push((format!("guides.{word}.samples"), Array::GuideSamples, half, false));
            }
        }
        if extras.coverage {
            channels.extend(double("coverage".to_owned(), Array::Coverage, 0));
        }
        channels
    }

    /// The sums by the names of their channels.
    pub fn channels(&self) -> Vec<(String, FlatSamples)> {
        let (film, pixels) = (&self.film, self.film.pixel_count());
        let mut channels = Vec::new();
        for (half, word) in HALVES.into_iter().enumerate() {
            let sums = |pixel: usize| film.pixels[pixel][half];
            let deviations = FlatSamples::F32(
                (0..pixels)
                    .map(|pixel| sums(pixel).squared_deviations.min(f64::from(f32::MAX)) as f32)
                    .collect(),
            );
            let samples = FlatSamples::U32((0..pixels).map(|pixel| sums(pixel).samples as u32).collect());
            channels.push((format!("sums.{word}.deviations"), deviations));
            channels.push((format!("sums.{word}.samples"), samples));
        }
        let layout = Self::layout(&light_groups(&self.film, &self.document), self.film.extras());
        for (name, array, place, is_float) in layout {
            let array = match array {
                Array::GuideSamples => self.guide_samples.as_flattened(),
                array => self.film.words()[array as usize],
            };
            let words = array.iter().skip(place).step_by(array.len() / pixels).copied();
            let samples = match is_float {
                true => FlatSamples::F32(words.map(f32::from_bits).collect()),
                false => FlatSamples::U32(words.collect()),
            };
            channels.push((format!("sums.{name}"), samples));
        }
        channels
    }

    /// Reads a film from a file.
    pub fn read(path: &Path) -> Result<Self, SumsError> {
        let file = Sums::open(path)?;
        let [samples, units, document] = file.kept()?;
        let document = parse_document(path, document.as_bytes())?.value;
        let samples: Option<_> = samples.split(',').map(range).collect();
        let groups = without_what_is_off(&document).light_groups();
        let extras = Extras {
            coverage: file.find("coverage.high").is_some(),
            guides: if file.has_guides() { 2 } else { 0 },
            light_groups: groups.len() as u32,
        };
        let film = Film::keeping(file.layer.size.0 as u32, file.layer.size.1 as u32, extras);
        let pixels = film.pixel_count();
        let mut kept = Self {
            film,
            document,
            samples: samples.ok_or_else(|| file.missing(KEPT))?,
            guide_samples: vec![[0; 2]; pixels],
            world_units_per_unit: units.parse().map_err(|_| file.missing(KEPT))?,
        };
        for (name, array, place, is_float) in Self::layout(&groups, extras) {
            let array = match array {
                Array::GuideSamples => kept.guide_samples.as_flattened_mut(),
                array => &mut *kept.film.words_mut()[array as usize],
            };
            let each = array.len() / pixels;
            let own = array.iter_mut().skip(place).step_by(each);
            own.zip(file.words(&name, is_float)?)
                .for_each(|(own, word)| *own = word);
        }
        for (half, word) in HALVES.into_iter().enumerate() {
            let deviations = file.words(&format!("{word}.deviations"), true)?;
            let samples = file.words(&format!("{word}.samples"), false)?;
            for (pixel, (deviation, samples)) in deviations.into_iter().zip(samples).enumerate() {
                let sums = &mut kept.film.pixels[pixel][half];
                sums.squared_deviations = f64::from(f32::from_bits(deviation));
                sums.samples = f64::from(samples);
            }
        }
        Ok(kept)
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
        let first = first.display();
        let differs = match (self.film.width, self.film.height) == (other.film.width, other.film.height) {
            true if self.is_alike(other) => None,
            true => Some("what was rendered, or how"),
            false => Some("size"),
        };
        if let Some(differs) = differs {
            let reason =
                format!("of another image than {first}: they differ in {differs}; render both with the same settings");
            return Err(SumsError::of(path, reason));
        }
        for [from, to] in &other.samples {
            if self.samples.iter().any(|own| own[0] < *to && *from < own[1]) {
                let remedy = "render others by --samples-from and --samples-to";
                let reason = format!("samples {from} to {to} are in {first} too; {remedy}");
                return Err(SumsError::of(path, reason));
            }
        }
        for pixel in 0..self.film.pixel_count() {
            let (own, more) = (self.film.pixels[pixel], other.film.pixels[pixel]);
            self.film.pixels[pixel] = [own[0].with(&more[0]), own[1].with(&more[1])];
            self.film.add_coverage(pixel, other.film.color(pixel)[3]);
            for (group, more) in other.film.lights(pixel).iter().enumerate() {
                self.film.add_light(pixel, group, *more);
            }
        }
        if other.film.extras().guides > 0 {
            self.film.guides.resize(other.film.guides.len(), Default::default());
            let own = self.film.guides.iter_mut();
            own.zip(&other.film.guides).for_each(|(guides, more)| guides.add(more));
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
            .map_err(|error| {
                let reason = format!("cannot be read as an image: {error}; render it again with --keep-sums");
                SumsError::of(path, reason)
            })?;
        let layer = image.layer_data;
        Ok(Self { path, layer })
    }

    fn missing(&self, missing: &str) -> SumsError {
        let remedy = "render it with --keep-sums";
        let reason = format!("has no sums that this version reads ({missing} is missing); {remedy}");
        SumsError::of(self.path, reason)
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
        channels
            .find(|channel| channel.name == *name.as_str())
            .map(|channel| &channel.sample_data)
    }

    /// Whether it has guides. Those of an older version, over both halves, are missing in each.
    fn has_guides(&self) -> bool {
        let mut channels = self.layer.channel_data.list.iter();
        channels.any(|channel| channel.name.to_string().starts_with("sums.guides."))
    }

    /// The words of a channel, which are f32 or u32.
    fn words(&self, name: &str, are_floats: bool) -> Result<Vec<u32>, SumsError> {
        match (self.find(name), are_floats) {
            (Some(FlatSamples::U32(words)), false) => Ok(words.clone()),
            (Some(FlatSamples::F32(numbers)), true) => Ok(numbers.iter().map(|number| number.to_bits()).collect()),
            _ => Err(self.missing(name)),
        }
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

/// A range as text, such as `0-64`.
pub fn range(text: &str) -> Option<[u32; 2]> {
    let (from, to) = text.split_once('-')?;
    let range = [from.parse().ok()?, to.parse().ok()?];
    (range[0] < range[1]).then_some(range)
}
