//! The picture as a screen shows it, and maps of its error and of its samples.

use rayon::prelude::*;

use crate::analysis::noise::relative_errors;
use crate::document::ViewSettings;
use crate::job::film::{Film, Image};
use crate::optics::tone::{srgb_from_linear, tone_map};
use crate::optics::vector::vec3;
use crate::plot::scale_color;

/// Luminance of middle grey.
const MIDDLE_GREY: f64 = 0.18;
/// Luminances that count for the automatic exposure: what is darker is taken for this.
const LUMINANCE_MIN: f64 = 1e-4;

/// The factor on radiance. The automatic one brings the geometric mean of the luminance to middle grey (Reinhard et al.
/// 2002), weighed by the pixels' opacity.
pub fn exposure(image: &Image, view: &ViewSettings) -> f32 {
    let chosen = view.exposure_ev.exp2();
    if !view.auto_exposure {
        return chosen;
    }
    let log_of = |pixel: &[f32; 4]| {
        let [r, g, b, alpha] = pixel.map(f64::from);
        let luminance = (0.2126 * r + 0.7152 * g + 0.0722 * b) / alpha.max(1e-9);
        [alpha * luminance.max(LUMINANCE_MIN).ln(), alpha]
    };
    let add = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
    let [logs, weight] = image.pixels.par_iter().map(log_of).reduce(|| [0.0; 2], add);
    if weight > 0.0 {
        chosen * (MIDDLE_GREY / (logs / weight).exp()) as f32
    } else {
        chosen
    }
}

/// Exposure, tone curve and sRGB encoding: red, green, blue and alpha of 8 bits, row by row from the top; alpha is not
/// premultiplied.
pub fn display(image: &Image, view: &ViewSettings) -> Vec<u8> {
    let exposure = exposure(image, view);
    let encode = |pixel: &[f32; 4]| -> [u8; 4] {
        let [r, g, b, alpha] = *pixel;
        let straight = if alpha > 0.0 { exposure / alpha } else { 0.0 };
        let mapped = tone_map(view.tone_map, vec3(r * straight, g * straight, b * straight));
        let [r, g, b] = srgb_from_linear(mapped).to_f32();
        [r, g, b, alpha].map(|x| (255.0 * x.clamp(0.0, 1.0) + 0.5) as u8)
    };
    image.pixels.par_iter().flat_map_iter(encode).collect()
}

/// What of a render is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Shown {
    /// The picture itself.
    #[default]
    Picture,
    /// The estimated error of each pixel.
    Error,
    /// The samples of each pixel.
    Samples,
    /// Where numbers are not to be trusted: made beside the picture, see [`super::precision`].
    Precision,
}

impl Shown {
    /// All of them, with their labels and what they are.
    pub const ALL: [(Self, &str, &str); 4] = [
        (Self::Picture, "Picture", "The picture itself."),
        (
            Self::Error,
            "Error",
            "The estimated standard error of each pixel, relative to the picture's mean luminance.",
        ),
        (
            Self::Samples,
            "Samples",
            "How many samples each pixel has had: with adaptive sampling they go where the error is.",
        ),
        (
            Self::Precision,
            "Precision",
            "Where samples are dropped, f32 differs from f64, or rays start inside geometry.",
        ),
    ];
}

/// What the ends of a map's colours stand for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// The darkest colour.
    pub low: f64,
    /// The brightest.
    pub high: f64,
    /// Equal factors, not differences, are equally far apart.
    pub is_logarithmic: bool,
}

impl Scale {
    /// Where a value lies between the ends, in [0, 1].
    fn place(&self, value: f64) -> f64 {
        let place = if self.is_logarithmic {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        place.clamp(0.0, 1.0)
    }
}

/// Share of the pixels above the brightest colour of a map of errors, and how many times smaller the darkest is.
const ERRORS_ABOVE: f64 = 0.005;
const ERRORS_SPAN: f64 = 300.0;

/// A film's errors or samples in colours: opaque bytes as [`display`] gives them, and what they mean; `None` for the
/// picture itself, and for what is no map of a film.
pub fn map(film: &Film, shown: Shown) -> Option<(Vec<u8>, Scale)> {
    let (values, scale) = match shown {
        Shown::Picture | Shown::Precision => return None,
        Shown::Error => return Some(map_of_errors(&relative_errors(film))),
        Shown::Samples => {
            let counts: Vec<f32> = (0..film.pixel_count())
                .map(|pixel| film.samples_of(pixel) as f32)
                .collect();
            let high = f64::from(counts.iter().copied().fold(0.0, f32::max)).max(1.0);
            let scale = Scale {
                low: 0.0,
                high,
                is_logarithmic: false,
            };
            (counts, scale)
        }
    };
    Some((colored(&values, scale), scale))
}

/// Errors of pixels in colours, see [`map`].
pub fn map_of_errors(errors: &[f32]) -> (Vec<u8>, Scale) {
    let mut sorted = errors.to_vec();
    sorted.sort_by(f32::total_cmp);
    let rank = ((1.0 - ERRORS_ABOVE) * sorted.len() as f64) as usize;
    let high = sorted.get(rank).or(sorted.last()).copied().unwrap_or(0.0);
    let high = f64::from(high).max(1e-9);
    let scale = Scale {
        low: high / ERRORS_SPAN,
        high,
        is_logarithmic: true,
    };
    (colored(errors, scale), scale)
}

fn colored(values: &[f32], scale: Scale) -> Vec<u8> {
    let color = |value: &f32| {
        let [red, green, blue] = scale_color(scale.place(f64::from(*value)));
        [red, green, blue, 255]
    };
    values.par_iter().flat_map_iter(color).collect()
}
