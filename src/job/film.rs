//! The film: an image as sums, which the engines accumulate.

use super::{BackgroundKind, Job, effect::EffectId, guides::GUIDE_SAMPLES, guides::GuideSums, tiles::TileGrid};
use crate::parallel;

/// Sums over the samples of each pixel. Colours are summed in f64, so that they do not stall after millions of samples. 80
/// bytes per pixel and 32 per tile, plus the requested [`Extras`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Film {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Sums of each pixel, row by row from the top.
    pub pixels: Vec<[HalfSums; 2]>,
    /// Sums of coverage; empty if every pixel is covered.
    pub coverage: Vec<f64>,
    /// First-hit guides of the first [`GUIDE_SAMPLES`] samples, those of a pixel in a row: of the even and the odd ones, or
    /// of all; empty if not requested.
    pub guides: Vec<GuideSums>,
    /// Sums of each light group, those of a pixel in a row; empty if not requested.
    pub lights: Vec<LightSums>,
    /// Costs and removed energy per tile.
    pub costs: Vec<TileCosts>,
}

/// Sums of a light group's light in one pixel, of the even and the odd samples: linear RGB.
pub type LightSums = [[f64; 3]; 2];

/// Optional data of a film, besides colour and spread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extras {
    /// Coverage, 8 bytes a pixel: the background is transparent.
    pub coverage: bool,
    /// First-hit guides per pixel, 32 bytes each: 2, of either half, for the denoiser; 1 for layers alone; or 0.
    pub guides: u32,
    /// Light groups that are summed apart, 48 bytes per pixel each.
    pub light_groups: u32,
}

/// Sums over the samples of all pixels of a tile.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TileCosts {
    pub rays: f64,
    /// Luminance that limiting fireflies took.
    pub clamped: f64,
    /// Throughput's luminance of paths that the bounce limit ended; only counted with refraction.
    pub cut: f64,
    /// Samples left out because they were not finite or negative.
    pub dropped: u64,
}

/// Sums over one of the two independent halves of a pixel's samples.
///
/// Squared deviations lose nothing by cancellation, unlike squares minus the mean's. f32 would be precise enough for the
/// spread, but rounded after each pass, whose length depends on the clock: the same render twice would differ.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct HalfSums {
    /// Linear red, green and blue.
    pub color: [f64; 3],
    /// Squared deviations of the luminance from its mean.
    pub squared_deviations: f64,
    pub samples: f64,
}

/// Luminance of linear Rec. 709.
pub fn luminance([red, green, blue]: [f64; 3]) -> f64 {
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

impl HalfSums {
    /// Sum of the luminance.
    pub fn luminance(&self) -> f64 {
        luminance(self.color)
    }

    /// Mean luminance; 0 without samples.
    pub fn mean_luminance(&self) -> f64 {
        self.luminance() / self.samples.max(1.0)
    }

    pub fn add(&mut self, color: [f64; 3]) {
        self.add_to_mean(self.mean_luminance(), color);
    }

    /// Adds a sample (Welford 1962), given the mean luminance before; that after it.
    #[inline(always)]
    pub fn add_to_mean(&mut self, before: f64, color: [f64; 3]) -> f64 {
        let y = luminance(color);
        self.samples += 1.0;
        self.color = added(self.color, color);
        let after = self.luminance() / self.samples;
        self.squared_deviations += ((y - before) * (y - after)).max(0.0);
        after
    }

    /// Both together (Chan, Golub and LeVeque 1983).
    #[inline]
    pub fn with(&self, other: &Self) -> Self {
        let samples = self.samples + other.samples;
        let between = if self.samples > 0.0 && other.samples > 0.0 {
            let difference = self.mean_luminance() - other.mean_luminance();
            difference * difference * self.samples * other.samples / samples
        } else {
            0.0
        };
        Self {
            color: added(self.color, other.color),
            squared_deviations: self.squared_deviations + other.squared_deviations + between,
            samples,
        }
    }

    /// Variance of a sample's luminance, unbiased for independent samples; NaN below two.
    pub fn spread(&self) -> f64 {
        if self.samples < 2.0 {
            return f64::NAN;
        }
        self.squared_deviations.max(0.0) / (self.samples - 1.0)
    }
}

fn added(mut sum: [f64; 3], color: [f64; 3]) -> [f64; 3] {
    sum.iter_mut().zip(color).for_each(|(sum, x)| *sum += x);
    sum
}

impl Extras {
    /// The data that a job needs.
    pub fn of(job: &Job) -> Self {
        Self {
            coverage: job.settings.background == BackgroundKind::Transparent,
            guides: if job.plan.has(EffectId::Guides) {
                job.settings.guides
            } else {
                0
            },
            light_groups: job.settings.light_groups,
        }
    }

    /// Bytes of a film for each pixel.
    pub fn pixel_bytes(self) -> u64 {
        let tile = size_of::<TileCosts>().div_ceil(64);
        let coverage = if self.coverage { size_of::<f64>() } else { 0 };
        let guides = self.guides as usize * size_of::<GuideSums>();
        let lights = self.light_groups as usize * size_of::<LightSums>();
        (size_of::<[HalfSums; 2]>() + tile + coverage + guides + lights) as u64
    }
}

impl Film {
    /// An empty film without extras.
    pub fn new(width: u32, height: u32) -> Self {
        Self::keeping(width, height, Extras::default())
    }

    /// An empty film.
    pub fn keeping(width: u32, height: u32, extras: Extras) -> Self {
        let pixels = width as usize * height as usize;
        Self {
            width,
            height,
            pixels: vec![Default::default(); pixels],
            coverage: vec![0.0; if extras.coverage { pixels } else { 0 }],
            guides: vec![Default::default(); pixels * extras.guides as usize],
            lights: vec![Default::default(); pixels * extras.light_groups as usize],
            costs: vec![TileCosts::default(); TileGrid { width, height }.tiles()],
        }
    }

    /// An empty film for a job.
    pub fn of(job: &Job) -> Self {
        let [width, height] = job.settings.image_size;
        Self::keeping(width, height, Extras::of(job))
    }

    /// The optional data that is kept.
    pub fn extras(&self) -> Extras {
        Extras {
            coverage: !self.coverage.is_empty(),
            guides: self.guides_each() as u32,
            light_groups: self.light_groups() as u32,
        }
    }

    /// Number of pixels.
    pub fn pixel_count(&self) -> usize {
        self.pixels.len()
    }

    /// Tiles of the image.
    pub fn grid(&self) -> TileGrid {
        TileGrid {
            width: self.width,
            height: self.height,
        }
    }

    /// Adds sample number `sample` of a pixel: linear colour with coverage.
    pub fn add(&mut self, pixel: usize, sample: u32, color: [f64; 4]) {
        let mut halves = self.pixels[pixel];
        let [red, green, blue, coverage] = color;
        halves[sample as usize % 2].add([red, green, blue]);
        self.pixels[pixel] = halves;
        self.add_coverage(pixel, coverage);
    }

    /// Adds to a pixel's coverage, if kept.
    pub fn add_coverage(&mut self, pixel: usize, coverage: f64) {
        if let Some(sum) = self.coverage.get_mut(pixel) {
            *sum += coverage;
        }
    }

    /// Adds to a pixel's guides of the even or the odd samples, if kept.
    pub fn add_guides(&mut self, pixel: usize, half: usize, seen: &GuideSums) {
        let each = self.guides_each();
        if each > 0 {
            self.guides[pixel * each + half % each].add(seen);
        }
    }

    /// A pixel's guides.
    pub fn guides_of(&self, pixel: usize) -> &[GuideSums] {
        let each = self.guides_each();
        &self.guides[pixel * each..][..each]
    }

    fn guides_each(&self) -> usize {
        self.guides.len() / self.pixel_count().max(1)
    }

    /// Sums over all samples of a pixel.
    pub fn sums(&self, pixel: usize) -> HalfSums {
        let [even, odd] = self.pixels[pixel];
        even.with(&odd)
    }

    /// Sums of linear red, green, blue and of the coverage.
    pub fn color(&self, pixel: usize) -> [f64; 4] {
        let HalfSums { color, samples, .. } = self.sums(pixel);
        let [red, green, blue] = color;
        [red, green, blue, self.coverage.get(pixel).copied().unwrap_or(samples)]
    }

    /// The same of each pixel.
    pub fn colors(&self) -> impl Iterator<Item = [f64; 4]> {
        (0..self.pixels.len()).map(|pixel| self.color(pixel))
    }

    /// Mean colour and coverage of a pixel; black without samples. Coverage is clamped to [0, 1], because the noise of a
    /// caught shadow may exceed it.
    pub fn mean(&self, pixel: usize) -> [f64; 4] {
        let samples = self.samples_of(pixel).max(1.0);
        let [red, green, blue, coverage] = self.color(pixel).map(|sum| sum / samples);
        [red, green, blue, coverage.clamp(0.0, 1.0)]
    }

    /// Number of samples in a pixel's sums.
    pub fn samples_of(&self, pixel: usize) -> f64 {
        self.pixels[pixel].iter().map(|half| half.samples).sum()
    }

    /// Guide samples per half of a pixel, if rendering started with the first sample.
    pub fn guide_samples(&self, pixel: usize) -> [f64; 2] {
        let most = f64::from(GUIDE_SAMPLES / 2);
        self.pixels[pixel].map(|half| half.samples.min(most))
    }

    /// A rectangle of it, from `origin`, which is that of a tile.
    pub fn part(&self, origin: [u32; 2], size: [u32; 2]) -> Film {
        let mut part = Film::keeping(size[0], size[1], self.extras());
        part.copy_part([0, 0], self, origin, size);
        part
    }

    /// Copies such a part back to its place.
    pub fn place(&mut self, origin: [u32; 2], part: &Film) {
        self.copy_part(origin, part, [0, 0], [part.width, part.height]);
    }

    fn copy_part(&mut self, to: [u32; 2], film: &Film, from: [u32; 2], [width, height]: [u32; 2]) {
        let tiles = TileGrid { width, height };
        let (own, other) = (self.grid(), film.grid());
        for place in (0..tiles.tiles()).map(|tile| tiles.origin(tile)) {
            let at = |grid: TileGrid, [x, y]: [u32; 2]| grid.at([x + place[0], y + place[1]]);
            self.costs[at(own, to)] = film.costs[at(other, from)];
        }
        for row in 0..height {
            let pixel = |film: &Film, [x, y]: [u32; 2]| ((y + row) * film.width + x) as usize;
            self.copy_pixels(pixel(self, to), film, pixel(film, from), width as usize);
        }
    }

    /// Copies the sums of `count` pixels in a row from a film that keeps the same.
    fn copy_pixels(&mut self, to: usize, film: &Film, from: usize, count: usize) {
        fn copy<T: Copy>(to: (&mut [T], usize), from: (&[T], usize), count: usize, pixels: usize) {
            let each = from.0.len() / pixels;
            to.0[each * to.1..][..each * count].copy_from_slice(&from.0[each * from.1..][..each * count]);
        }
        let pixels = film.pixel_count();
        copy((&mut self.pixels, to), (&film.pixels, from), count, pixels);
        copy((&mut self.coverage, to), (&film.coverage, from), count, pixels);
        copy((&mut self.guides, to), (&film.guides, from), count, pixels);
        copy((&mut self.lights, to), (&film.lights, from), count, pixels);
    }

    /// Splits off the last rows, without tile costs. What they took of memory is free.
    pub fn split_rows(&mut self, rows: u32) -> Film {
        fn cut<T>(of: &mut Vec<T>, [pixels, kept]: [usize; 2]) {
            of.truncate(of.len() / pixels * kept);
            of.shrink_to_fit();
        }
        let mut part = Film::keeping(self.width, rows, self.extras());
        let pixels = self.pixel_count();
        let sizes = [pixels, pixels - part.pixel_count()];
        part.copy_pixels(0, self, sizes[1], pixels - sizes[1]);
        self.height -= rows;
        cut(&mut self.pixels, sizes);
        cut(&mut self.coverage, sizes);
        cut(&mut self.guides, sizes);
        cut(&mut self.lights, sizes);
        part
    }

    /// The chosen pixels as a film of one row, without tile costs.
    pub fn of_pixels(&self, is_chosen: impl Fn(usize) -> bool) -> Film {
        let chosen: Vec<usize> = (0..self.pixels.len()).filter(|&pixel| is_chosen(pixel)).collect();
        let mut film = Film::keeping(chosen.len() as u32, 1, self.extras());
        for (to, from) in chosen.into_iter().enumerate() {
            film.copy_pixels(to, self, from, 1);
        }
        film
    }

    /// The words of the sums of pixels, of coverage, of light groups and of guides, each pixel by pixel; the order of the
    /// words is that of the structures.
    pub fn words(&self) -> [&[u32]; 4] {
        use bytemuck::cast_slice as words;
        [
            words(&self.pixels),
            words(&self.coverage),
            words(&self.lights),
            words(&self.guides),
        ]
    }

    pub fn words_mut(&mut self) -> [&mut [u32]; 4] {
        use bytemuck::cast_slice_mut as words;
        [
            words(&mut self.pixels),
            words(&mut self.coverage),
            words(&mut self.lights),
            words(&mut self.guides),
        ]
    }

    /// Rays traced for all pixels together.
    pub fn total_rays(&self) -> u64 {
        self.costs.iter().map(|costs| costs.rays).sum::<f64>() as u64
    }

    /// Samples left out because they were not finite or negative.
    pub fn dropped(&self) -> u64 {
        self.costs.iter().map(|costs| costs.dropped).sum()
    }

    /// Luminance that limiting fireflies took from all samples together.
    pub fn clamped(&self) -> f64 {
        self.costs.iter().map(|costs| costs.clamped).sum()
    }

    /// Share of the image's energy, in [0, 1], that the firefly clamp removed.
    pub fn clamped_share(&self) -> f64 {
        match self.clamped() {
            0.0 => 0.0,
            clamped => {
                let kept: f64 = (0..self.pixels.len()).map(|pixel| self.sums(pixel).luminance()).sum();
                clamped / (clamped + kept)
            }
        }
    }

    /// Estimated share of the image's energy, in [0, 1], lost at the bounce limit, assuming that further light is as bright
    /// as the light found.
    pub fn cut_share(&self) -> f64 {
        let cut: f64 = self.costs.iter().map(|costs| costs.cut).sum();
        if cut > 0.0 { cut / self.samples() as f64 } else { 0.0 }
    }

    /// Samples in the sums of all pixels together.
    pub fn samples(&self) -> u64 {
        self.pixels.as_flattened().iter().map(|half| half.samples as u64).sum()
    }

    /// The mean image: linear Rec. 709, premultiplied alpha; black without samples.
    pub fn image(&self) -> Image {
        self.image_of(|pixel| self.mean(pixel).map(|x| x as f32))
    }

    pub fn image_of(&self, of_pixel: impl Fn(usize) -> [f32; 4] + Sync) -> Image {
        Image {
            width: self.width,
            height: self.height,
            pixels: parallel::map(self.pixels.len(), of_pixel),
        }
    }

    /// Mean luminance of a pixel; NaN without samples.
    pub fn luminance_of(&self, pixel: usize) -> f64 {
        let sums = self.sums(pixel);
        sums.luminance() / sums.samples
    }

    /// Mean luminance of each pixel; NaN without samples.
    pub fn luminance(&self) -> Vec<f64> {
        parallel::map(self.pixels.len(), |pixel| self.luminance_of(pixel))
    }

    /// Difference of the total luminance from another render's of the same size, in standard deviations. The sum over many
    /// pixels is nearly normal even for skewed pixels. Rounding of f32 radiance counts as an uncertainty of 1e-4.
    pub fn difference_in_sigma(&self, other: &Film) -> f64 {
        let (a, b): (f64, f64) = (self.luminance().iter().sum(), other.luminance().iter().sum());
        let variance: f64 = self.variance_of_mean().iter().chain(&other.variance_of_mean()).sum();
        (a - b) / (variance + (0.0001 * a).powi(2)).sqrt()
    }

    /// Variance of the mean luminance of each pixel as if its samples were independent; infinite below two samples.
    /// Unbiased for uniform random numbers, too large for the Sobol sequence: see `analysis::noise`.
    pub fn variance_of_mean(&self) -> Vec<f64> {
        parallel::map(self.pixels.len(), |pixel| self.variance_of_mean_at(pixel))
    }

    /// The same of one pixel.
    pub fn variance_of_mean_at(&self, pixel: usize) -> f64 {
        let sums = self.sums(pixel);
        if sums.samples < 2.0 {
            f64::INFINITY
        } else {
            sums.spread() / sums.samples
        }
    }
}

impl Image {
    /// The luminance of each pixel.
    pub fn luminance(&self) -> Vec<f64> {
        let of_pixel = |[red, green, blue, _]: &[f32; 4]| luminance([*red, *green, *blue].map(f64::from));
        self.pixels.iter().map(of_pixel).collect()
    }
}

/// A linear image.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Linear Rec. 709 red, green, blue, premultiplied by the alpha that follows; row by row from the top.
    pub pixels: Vec<[f32; 4]>,
}
