//! Views of a render in the window: the image, or maps of per-pixel quantities.

use super::display::{MIDDLE_GREY, display, exposure};
use crate::{
    analysis::noise::relative_errors,
    document::ViewSettings,
    job::features::Features,
    job::film::{Film, Image},
    named::named,
    optics::{tone::srgb_from_linear, vector::vec3},
    parallel,
    plot::scale_color,
};

/// Stops to either side of middle grey that false colours span.
const STOPS: f64 = 6.0;
/// Share of the pixels above the brightest colour of a map of errors, and how many times smaller the darkest is.
const ERRORS_ABOVE: f64 = 0.005;
const ERRORS_SPAN: f64 = 300.0;
/// Colours of pixels clipped at white and at black.
pub const CLIPPED: [[u8; 3]; 2] = [[255, 40, 40], [40, 90, 255]];
/// Colour of missing values.
const NOTHING: [u8; 4] = [24, 24, 24, 255];

named! {
    /// A view of a render.
    #[derive(Default)]
    Shown {
        #[default]
        Picture, "picture", "Image", "The image itself.";
        Error, "error", "Error", "The estimated standard error of each pixel, relative to the image's mean luminance.";
        Samples, "samples", "Samples", "How many samples each pixel has had: with adaptive sampling they go where the error is.";
        Precision, "precision", "Precision", "Where samples are dropped, f32 differs from f64, or rays start inside geometry.";
        FalseColor, "false-color", "False colour", "Luminance in stops from middle grey, with the exposure and without the tone map.";
        Clipping, "clipping", "Clipping", "The image; red where a channel is as bright as the screen can be, blue where all are black.";
        Albedo, "albedo", "Albedo", "The share of the light that what is seen first reflects.";
        Normal, "normal", "Normal", "Where what is seen first faces in the world: x red, y green, z blue.";
        Depth, "depth", "Depth", "The distance of what is seen first along the camera's axis, scene units.";
        Variance, "variance", "Variance", "The variance of each pixel's mean luminance, by the spread of its samples.";
    }
}

impl Shown {
    /// Whether its map is made of the film, not of the image alone.
    pub fn is_of_film(self) -> bool {
        !matches!(
            self,
            Self::Picture | Self::Precision | Self::FalseColor | Self::Clipping
        )
    }
}

/// Value range of a map's colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Value of the darkest colour.
    pub low: f64,
    /// Value of the brightest colour.
    pub high: f64,
    /// Equal factors, not differences, are equally far apart.
    pub is_logarithmic: bool,
}

impl Scale {
    /// Relative position of a value in the range, in [0, 1].
    fn place(&self, value: f64) -> f64 {
        let place = if self.is_logarithmic {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        place.clamp(0.0, 1.0)
    }
}

/// Inputs of a film's maps.
#[derive(Clone, Copy, Debug)]
pub struct FilmSource<'a> {
    pub film: &'a Film,
    /// Estimated error per pixel, if the image shown is denoised and has one.
    pub denoised_errors: Option<&'a [f32]>,
    /// Length of a unit of the geometry, scene units.
    pub world_units_per_unit: f64,
}

impl FilmSource<'_> {
    /// Estimated error per pixel of the image shown.
    fn errors(&self) -> Vec<f32> {
        self.denoised_errors
            .map_or_else(|| relative_errors(self.film), <[f32]>::to_vec)
    }
}

/// A map as opaque RGBA, with the range of its colours if they represent numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// Red, green, blue and alpha of 8 bits, row by row from the top.
    pub rgba: Vec<u8>,
    /// Value range, if numeric.
    pub scale: Option<Scale>,
}

/// The map of a view of the image alone; `None` for the image itself and other views.
pub fn map_of_image(image: &Image, view: &ViewSettings, shown: Shown) -> Option<Map> {
    match shown {
        Shown::FalseColor => Some(linear_map(&stops(image, view), [-STOPS, STOPS])),
        Shown::Clipping => Some(Map {
            rgba: with_clipping(display(image, view)),
            scale: None,
        }),
        _ => None,
    }
}

/// The map of a view of the film; `None` for other views.
pub fn map_of_film(source: &FilmSource<'_>, shown: Shown) -> Option<Map> {
    let features = || Features::of(source.film, source.world_units_per_unit);
    Some(match shown {
        Shown::Picture | Shown::Precision | Shown::FalseColor | Shown::Clipping => return None,
        Shown::Error => map_of_errors(&source.errors()),
        Shown::Variance => map_of_errors(&features().variance),
        Shown::Samples => {
            let counts = features().samples;
            linear_map(&counts, [0.0, f64::from(counts.iter().copied().fold(1.0, f32::max))])
        }
        Shown::Albedo => colors(&features().albedo, |[r, g, b]| srgb_from_linear(vec3(r, g, b)).to_f32()),
        Shown::Normal => colors(&features().normal, |normal| normal.map(|x| 0.5 + 0.5 * x)),
        Shown::Depth => {
            let depths = features().depth;
            let ends = depths
                .iter()
                .filter(|depth| depth.is_finite())
                .map(|depth| f64::from(*depth));
            let [low, high] = ends.fold([f64::INFINITY, 0.0], |[low, high], depth| {
                [low.min(depth), high.max(depth)]
            });
            linear_map(&depths, [low.min(high), high.max(low.min(high) + 1e-9)])
        }
    })
}

/// Errors of pixels in colours.
fn map_of_errors(errors: &[f32]) -> Map {
    let mut sorted: Vec<f32> = errors.iter().copied().filter(|error| error.is_finite()).collect();
    sorted.sort_by(f32::total_cmp);
    let rank = ((1.0 - ERRORS_ABOVE) * sorted.len() as f64) as usize;
    let high = sorted.get(rank).or(sorted.last()).copied().unwrap_or(0.0);
    let high = f64::from(high).max(1e-9);
    let scale = Scale {
        low: high / ERRORS_SPAN,
        high,
        is_logarithmic: true,
    };
    colored(errors, scale)
}

fn linear_map(values: &[f32], [low, high]: [f64; 2]) -> Map {
    let scale = Scale {
        low,
        high,
        is_logarithmic: false,
    };
    colored(values, scale)
}

fn colored(values: &[f32], scale: Scale) -> Map {
    Map {
        rgba: parallel::map_each(values, |value| {
            if !value.is_finite() {
                return NOTHING;
            }
            let [red, green, blue] = scale_color(scale.place(f64::from(*value)));
            [red, green, blue, 255]
        })
        .into_flattened(),
        scale: Some(scale),
    }
}

/// Colours in [0, 1].
fn colors(values: &[[f32; 3]], encode: impl Fn([f32; 3]) -> [f32; 3] + Sync) -> Map {
    Map {
        rgba: parallel::map_each(values, |value| {
            let [r, g, b] = encode(*value).map(|x| (255.0 * x.clamp(0.0, 1.0) + 0.5) as u8);
            [r, g, b, 255]
        })
        .into_flattened(),
        scale: None,
    }
}

/// Stops from middle grey of a luminance that has the exposure, −∞ for black.
pub fn stops_of(luminance: f64) -> f64 {
    (luminance / MIDDLE_GREY).log2()
}

/// Luminance of a linear colour.
pub fn luminance([red, green, blue]: [f32; 3]) -> f64 {
    crate::job::film::luminance([red, green, blue].map(f64::from))
}

fn stops(image: &Image, view: &ViewSettings) -> Vec<f32> {
    let exposure = exposure(image, view);
    parallel::map_each(&image.pixels, |[red, green, blue, alpha]| {
        let straight = exposure / alpha.max(1e-9);
        stops_of(luminance([red, green, blue].map(|x| x * straight)).max(1e-30)).clamp(-1e3, 1e3) as f32
    })
}

/// Whether displayed bytes are as bright as they can be in a channel, or black in all.
pub fn clipped([red, green, blue]: [u8; 3]) -> Option<usize> {
    match [red, green, blue] {
        [0, 0, 0] => Some(1),
        channels if channels.contains(&255) => Some(0),
        _ => None,
    }
}

fn with_clipping(mut rgba: Vec<u8>) -> Vec<u8> {
    for pixel in rgba.chunks_exact_mut(4) {
        if let Some(kind) = clipped([pixel[0], pixel[1], pixel[2]]).filter(|_| pixel[3] > 0) {
            pixel[..3].copy_from_slice(&CLIPPED[kind]);
        }
        pixel[3] = 255;
    }
    rgba
}

/// Per-pixel quantities of an image.
#[derive(Clone, Debug, Default)]
pub struct PixelFacts {
    /// Standard error of the shown luminance, relative to the image's mean.
    pub errors: Vec<f32>,
    pub features: Features,
}

impl PixelFacts {
    /// The quantities of a film.
    pub fn of(source: &FilmSource<'_>) -> Self {
        Self {
            errors: source.errors(),
            features: Features::of(source.film, source.world_units_per_unit),
        }
    }
}
