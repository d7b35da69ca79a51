//! Input and output of the denoiser.

use std::sync::Arc;

use crate::{
    analysis::{denoised::Colors, halves::Distance},
    job::film::{Film, Image, luminance},
    parallel,
};

/// Luminance of middle grey in the filter's input, and the darkest luminance that counts.
const KEY: f64 = 0.18;
const LUMINANCE_MIN: f64 = 1e-8;
/// Side in pixels of the squares whose mean luminances are averaged.
const KEY_SIDE: usize = 16;

/// Largest share of pixels without a sample in a half that is still used.
const MISSING_SHARE: f64 = 0.01;

/// A render to denoise: a copy of what the denoiser needs of the film, to send to another thread.
#[derive(Clone, Debug)]
pub struct Noisy {
    /// The mean of all samples.
    pub image: Arc<Image>,
    /// Width and height of the rendered part, and the numbers of its pixels.
    pub size: [usize; 2],
    pixels: Vec<usize>,
    /// Both halves of the samples in it; the second is missing after one sample.
    pub halves: [Option<NoisyHalf>; 2],
}

/// Means over one half of the samples. Invariant: independent of the other half, because the error estimate rests on that.
#[derive(Clone, Debug)]
pub struct NoisyHalf {
    pub color: Colors,
    pub albedo: Colors,
    pub normal: Colors,
}

impl Noisy {
    /// Copies a film's data. `region` is the rendered part: left, top, right, bottom as shares of width and height.
    pub fn of(film: &Film, region: Option<[f64; 4]>) -> Self {
        Self::of_samples(film, |pixel| film.guide_samples(pixel), region)
    }

    /// The same with the number of guide samples of each half, by pixel.
    pub fn of_samples(film: &Film, guide_samples: impl Fn(usize) -> [f64; 2] + Sync, region: Option<[f64; 4]>) -> Self {
        let [left, top, columns, rows] = rendered_rect(film, region);
        let pixels: Vec<usize> = (top..top + rows)
            .flat_map(|y| (left..left + columns).map(move |x| y * film.width as usize + x))
            .collect();
        let half = |number: usize| NoisyHalf::of(film, number, &|pixel| guide_samples(pixel)[number], &pixels);
        Self {
            image: Arc::new(film.image()),
            size: [columns, rows],
            halves: [half(0), half(1)],
            pixels,
        }
    }

    /// The same in one piece instead of two halves: denoised in half the time, without an error estimate.
    pub fn as_one(self) -> Self {
        let [albedo, normal] = self.guides();
        let color = |pixel: &usize| {
            let [red, green, blue, _] = self.image.pixels[*pixel];
            [red, green, blue].map(|x| x.max(0.0))
        };
        let color = self.pixels.iter().map(color).collect();
        Self {
            halves: [Some(NoisyHalf { color, albedo, normal }), None],
            ..self
        }
    }

    /// Albedo and normal guides, averaged over the halves present.
    pub fn guides(&self) -> [Colors; 2] {
        let halves: Vec<&NoisyHalf> = self.halves.iter().flatten().collect();
        let mean = |of: fn(&NoisyHalf) -> &Colors| -> Colors {
            (0..self.pixels.len())
                .map(|pixel| {
                    let sum = |c: usize| halves.iter().map(|half| of(half)[pixel][c]).sum::<f32>();
                    std::array::from_fn(|c| sum(c) / halves.len().max(1) as f32)
                })
                .collect()
        };
        [mean(|half| &half.albedo), mean(|half| &half.normal)]
    }

    /// Alpha values of the rendered part.
    pub fn alphas(&self) -> Vec<f32> {
        self.pixels.iter().map(|pixel| self.image.pixels[*pixel][3]).collect()
    }

    /// The mean of the denoised halves, blended with the samples' mean by `shares` in [0, 1]; `None` for no blend.
    pub fn mixed(&self, denoised: &[Colors; 2], shares: Option<&[f32]>) -> Colors {
        let [first, second] = denoised;
        let mix = |(i, pixel): (usize, &usize)| {
            let share = shares.map_or(0.0, |shares| shares[i]);
            let samples = self.image.pixels[*pixel];
            std::array::from_fn(|c| {
                let clean = 0.5 * (first[i][c] + second[i][c]);
                clean + share * (samples[c] - clean)
            })
        };
        self.pixels.iter().enumerate().map(mix).collect()
    }

    /// The mean image with the rendered part's colours and alpha replaced.
    pub fn with(&self, colors: &[[f32; 3]], alphas: &[f32]) -> Image {
        let mut image = Image::clone(&self.image);
        for ((pixel, [red, green, blue]), alpha) in self.pixels.iter().zip(colors).zip(alphas) {
            image.pixels[*pixel] = [*red, *green, *blue, *alpha];
        }
        image
    }

    /// Values of the rendered part as a full-size image, 0 elsewhere.
    pub fn spread(&self, values: &[f32]) -> Vec<f32> {
        let mut all = vec![0.0; self.image.pixels.len()];
        for (pixel, value) in self.pixels.iter().zip(values) {
            all[*pixel] = *value;
        }
        all
    }
}

impl NoisyHalf {
    /// Copies one half of a film; `None` if too many pixels lack samples.
    fn of(film: &Film, number: usize, guide_samples: &(dyn Fn(usize) -> f64 + Sync), pixels: &[usize]) -> Option<Self> {
        let has_samples = |pixel: usize| film.pixels[pixel][number].samples > 0.0;
        let present = pixels.iter().filter(|pixel| has_samples(**pixel)).count();
        let (missing, first) = (pixels.len() - present, pixels.iter().find(|pixel| has_samples(**pixel)));
        if missing as f64 > MISSING_SHARE * pixels.len() as f64 {
            return None;
        }
        // A pixel whose samples were all dropped takes the values of the previous pixel in the same half.
        let mut replacement = *first?;
        let sources = pixels.iter().map(|pixel| {
            if has_samples(*pixel) {
                replacement = *pixel;
            }
            replacement
        });
        let sources: Vec<usize> = sources.collect();
        let color = |pixel: &usize| {
            let half = film.pixels[*pixel][number];
            half.color.map(|sum| (sum / half.samples).max(0.0) as f32)
        };
        let guides = |pixel: usize| match film.guides_of(pixel).get(number) {
            Some(guides) => guides.means(guide_samples(pixel)),
            None => Default::default(),
        };
        Some(Self {
            color: parallel::map_each(&sources, color),
            albedo: parallel::map_each(&sources, |pixel| guides(*pixel)[0]),
            normal: parallel::map_each(&sources, |pixel| guides(*pixel)[1]),
        })
    }
}

/// A denoised image.
#[derive(Clone, Debug)]
pub struct Denoised {
    /// The denoised image, with `auto` blended with the samples' mean where that lowers the estimated error.
    pub image: Arc<Image>,
    /// Estimated error, relative to the mean luminance; `None` without two halves.
    pub error: Option<Distance>,
    /// The filter's bias, as part of `error`.
    pub bias: Option<Distance>,
    /// Estimated error per pixel, relative to the mean luminance; empty without two halves.
    pub error_map: Vec<f32>,
    /// Time of denoising, in seconds.
    pub seconds: f64,
}

impl Denoised {
    /// The samples' mean, not denoised.
    pub fn untouched(noisy: &Noisy) -> Self {
        Self {
            image: noisy.image.clone(),
            error: None,
            bias: None,
            error_map: Vec::new(),
            seconds: 0.0,
        }
    }
}

/// Bounding rectangle of the rendered tiles: left, top, width, height in pixels.
fn rendered_rect(film: &Film, region: Option<[f64; 4]>) -> [usize; 4] {
    let grid = film.grid();
    let (mut low, mut high) = ([u32::MAX; 2], [0_u32; 2]);
    for tile in (0..grid.tiles()).filter(|tile| grid.is_rendered(*tile, region)) {
        let (origin, size) = (grid.origin(tile), grid.size(tile));
        for axis in 0..2 {
            low[axis] = low[axis].min(origin[axis]);
            high[axis] = high[axis].max(origin[axis] + size[axis]);
        }
    }
    let side = |axis: usize| high[axis].saturating_sub(low[axis]) as usize;
    [low[0] as usize, low[1] as usize, side(0), side(1)]
}

/// The factor that maps the geometric mean of the luminance to middle grey. One factor for the whole image, so that its
/// bands match.
pub fn input_scale(colors: &[[f32; 3]], [width, height]: [usize; 2]) -> f32 {
    let of_square = |x: usize, y: usize| {
        let (right, bottom) = ((x + KEY_SIDE).min(width), (y + KEY_SIDE).min(height));
        let rows = (y..bottom).flat_map(|row| &colors[row * width + x..row * width + right]);
        let sum: f64 = rows.map(|color| luminance(color.map(f64::from))).sum();
        sum / ((right - x) * (bottom - y)) as f64
    };
    let squares = (0..height)
        .step_by(KEY_SIDE)
        .flat_map(|y| (0..width).step_by(KEY_SIDE).map(move |x| (x, y)));
    let bright = squares
        .map(|(x, y)| of_square(x, y))
        .filter(|mean| *mean > LUMINANCE_MIN);
    let (sum, count) = bright.fold((0.0, 0), |(sum, count), mean| (sum + mean.ln(), count + 1));
    if count == 0 {
        return 1.0;
    }
    (KEY / (sum / f64::from(count)).exp()) as f32
}
