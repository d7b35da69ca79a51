//! What a denoiser takes from a film, and the picture that it gives back.

use std::sync::Arc;

use rayon::prelude::*;

use crate::analysis::denoised::Colors;
use crate::analysis::halves::Distance;
use crate::job::film::{Film, Image, luminance};

/// What middle grey is brought to before filtering, and the darkest luminance that counts.
const KEY: f64 = 0.18;
const LUMINANCE_MIN: f64 = 1e-8;
/// Side of the squares whose mean luminances are averaged for it, pixels.
const KEY_SIDE: usize = 16;

/// Share of the pixels without a sample in a half up to which that half counts.
const MISSING_SHARE: f64 = 0.01;

/// What of a film is denoised: everything that the denoiser needs of it, to take to another thread.
#[derive(Clone, Debug)]
pub struct Noisy {
    /// The mean picture.
    pub image: Arc<Image>,
    /// The part of it that was rendered: left, top, width, height in pixels.
    rect: [usize; 4],
    /// Both halves within it; without the second where there is none yet.
    pub(super) halves: [Option<NoisyHalf>; 2],
}

/// Means over one half of the samples: nothing of it comes from the other half, as the error that is told rests on both
/// being independent.
#[derive(Clone, Debug)]
pub(super) struct NoisyHalf {
    pub(super) color: Colors,
    pub(super) albedo: Colors,
    pub(super) normal: Colors,
}

impl Noisy {
    /// Reads a film; `region` is the part that is rendered: left, top, right, bottom as shares of width and height.
    pub fn of(film: &Film, region: Option<[f64; 4]>) -> Self {
        Self::of_samples(film, |pixel| film.guide_samples(pixel), region)
    }

    /// The same where it is said how many samples of each half of a pixel are in the sums of what is seen first.
    pub fn of_samples(film: &Film, guide_samples: impl Fn(usize) -> [f64; 2] + Sync, region: Option<[f64; 4]>) -> Self {
        let rect = rendered_rect(film, region);
        let pixels = pixels_of(rect, film.width as usize);
        let half = |number: usize| NoisyHalf::of(film, number, &|pixel| guide_samples(pixel)[number], &pixels);
        Self {
            image: Arc::new(film.image()),
            rect,
            halves: [half(0), half(1)],
        }
    }

    /// Width and height of the part that was rendered.
    pub(super) fn size(&self) -> [usize; 2] {
        [self.rect[2], self.rect[3]]
    }

    /// The mean guides of the halves that there are, albedo and normal.
    pub(super) fn guides(&self) -> [Colors; 2] {
        let halves: Vec<&NoisyHalf> = self.halves.iter().flatten().collect();
        let mean = |of: &dyn Fn(&NoisyHalf) -> &Colors| -> Colors {
            let at = |pixel: usize| {
                let sum = |c: usize| halves.iter().map(|half| of(half)[pixel][c]).sum::<f32>();
                std::array::from_fn(|c| sum(c) / halves.len().max(1) as f32)
            };
            (0..self.rect[2] * self.rect[3]).map(at).collect()
        };
        [mean(&|half| &half.albedo), mean(&|half| &half.normal)]
    }

    fn pixels(&self) -> Vec<usize> {
        pixels_of(self.rect, self.image.width as usize)
    }

    /// The opacities of the part that was rendered.
    pub(super) fn alphas(&self) -> Vec<f32> {
        self.pixels().iter().map(|pixel| self.image.pixels[*pixel][3]).collect()
    }

    /// The mean of the denoised halves, mixed with these shares of the samples' mean.
    pub(super) fn mixed(&self, denoised: &[Colors; 2], shares: Option<&[f32]>) -> Colors {
        let [first, second] = denoised;
        let mix = |(i, pixel): (usize, usize)| {
            let share = shares.map_or(0.0, |shares| shares[i]);
            let samples = self.image.pixels[pixel];
            std::array::from_fn(|c| {
                let clean = 0.5 * (first[i][c] + second[i][c]);
                clean + share * (samples[c] - clean)
            })
        };
        self.pixels().into_iter().enumerate().map(mix).collect()
    }

    /// The mean picture with other colours and opacities in the part that was rendered.
    pub(super) fn with(&self, colors: &[[f32; 3]], alphas: &[f32]) -> Image {
        let mut image = Image::clone(&self.image);
        for ((pixel, [red, green, blue]), alpha) in self.pixels().into_iter().zip(colors).zip(alphas) {
            image.pixels[pixel] = [*red, *green, *blue, *alpha];
        }
        image
    }

    /// Values of the part that was rendered in a picture that is 0 elsewhere.
    pub(super) fn spread(&self, values: &[f32]) -> Vec<f32> {
        let mut all = vec![0.0; self.image.pixels.len()];
        for (pixel, value) in self.pixels().into_iter().zip(values) {
            all[pixel] = *value;
        }
        all
    }
}

impl NoisyHalf {
    /// Reads the pixels of one half of a film; `None` where too many lack samples.
    fn of(film: &Film, number: usize, guide_samples: &(dyn Fn(usize) -> f64 + Sync), pixels: &[usize]) -> Option<Self> {
        let has_samples = |pixel: usize| film.halves(pixel)[number].samples > 0.0;
        let present = pixels.iter().filter(|pixel| has_samples(**pixel)).count();
        let (missing, first) = (pixels.len() - present, pixels.iter().find(|pixel| has_samples(**pixel)));
        if missing as f64 > MISSING_SHARE * pixels.len() as f64 {
            return None;
        }
        // For a pixel whose samples were all dropped the one before it stands in, of the same half.
        let mut stand_in = *first?;
        let sources = pixels.iter().map(|pixel| {
            if has_samples(*pixel) {
                stand_in = *pixel;
            }
            stand_in
        });
        let sources: Vec<usize> = sources.collect();
        let of_pixel = |pixel: &usize| {
            let half = film.halves(*pixel)[number];
            let [albedo, normal] = match film.guides.get(*pixel) {
                Some(guides) => guides[number].means(guide_samples(*pixel)),
                None => Default::default(),
            };
            let color = half.color.map(|sum| (sum / half.samples).max(0.0) as f32);
            (color, (albedo, normal))
        };
        let (color, (albedo, normal)) = sources.par_iter().map(of_pixel).unzip();
        Some(Self { color, albedo, normal })
    }
}

/// A denoised picture.
#[derive(Clone, Debug)]
pub struct Denoised {
    /// What is shown: the denoised picture, or where that is nearer to the truth (`auto`) a mixture with the samples.
    pub image: Arc<Image>,
    /// How far it is from the truth; `None` before there are two halves of samples.
    pub error: Option<Distance>,
    /// Of that the filter's bias.
    pub bias: Option<Distance>,
    /// The error around each pixel, over the mean luminance; empty before there are two halves.
    pub error_map: Vec<f32>,
    /// How long it took.
    pub seconds: f64,
}

impl Denoised {
    /// The samples' mean itself.
    pub(super) fn untouched(noisy: &Noisy) -> Self {
        Self {
            image: noisy.image.clone(),
            error: None,
            bias: None,
            error_map: Vec::new(),
            seconds: 0.0,
        }
    }
}

/// The smallest rectangle of pixels around all tiles that are rendered: left, top, width, height.
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

/// The numbers of a rectangle's pixels in a picture of this width.
fn pixels_of([left, top, columns, rows]: [usize; 4], width: usize) -> Vec<usize> {
    let row = |y: usize| (0..columns).map(move |x| (top + y) * width + left + x);
    (0..rows).flat_map(row).collect()
}

/// The factor that brings the geometric mean of a picture's luminance to middle grey. One for the whole picture, so that
/// parts of it that are filtered by themselves fit together.
pub(super) fn input_scale(colors: &[[f32; 3]], [width, height]: [usize; 2]) -> f32 {
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
