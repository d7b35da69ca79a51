//! Comparison of two materials: a ball of each in the studio, and the difference of the renders.

use std::{sync::Arc, time::Duration};

use image::RgbImage;

use super::{
    EngineChoice, denoise::Library, display::display, error::SessionError, session::Session,
    step_denoiser::StepDenoiser,
};
use crate::{
    analysis::halves::Halves,
    document::{Denoise, Document, MaterialSettings, RenderSettings, ViewSettings},
    job::film::{Film, Image},
    plot::scale_color,
    scene::ModelSource,
};

/// Width and height of each render, in pixels.
pub const SIDE: u32 = 160;
/// Pixels to each side over which the difference is averaged.
const REACH: usize = 3;
/// Samples per pixel.
const SAMPLES: u32 = 64;
/// Step of the session.
const STEP: Duration = Duration::from_millis(100);
/// Relative difference with the brightest colour of the map.
const BRIGHTEST: f64 = 0.5;

/// Result of a comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Compared {
    /// The first render, the second, both denoised where there is a denoiser, and a map of their difference without noise:
    /// dark for none, yellow from half the mean brightness.
    pub pictures: [RgbImage; 3],
    /// Root mean square of the difference of luminance over the mean luminance, free of noise: the two halves of the samples
    /// err independently, so that the mean of their differences' product does not.
    pub difference: f64,
}

/// Renders a ball of each material in the studio on the CPU.
pub fn compared(materials: &[MaterialSettings; 2]) -> Result<Compared, SessionError> {
    let mut session = Session::open(EngineChoice::Cpu)?;
    let [first, second] = [
        rendered(&mut session, &materials[0])?,
        rendered(&mut session, &materials[1])?,
    ];
    let halves = [&first, &second].map(|(_, film)| Halves::of(film));
    let products: Vec<f64> = (0..first.1.pixel_count())
        .map(|pixel| {
            let [first, second] = &halves;
            (first.even[pixel] - second.even[pixel]) * (first.odd[pixel] - second.odd[pixel])
        })
        .collect();
    let mean = halves[0].mean_luminance().max(1e-9);
    let mut map = RgbImage::new(SIDE, SIDE);
    for (x, y, color) in map.enumerate_pixels_mut() {
        color.0 = scale_color(resolved(&products, [x as usize, y as usize]) / mean / BRIGHTEST);
    }
    let squares = products.iter().sum::<f64>() / products.len() as f64;
    Ok(Compared {
        difference: squares.max(0.0).sqrt() / mean,
        pictures: [shown(&first.0), shown(&second.0), map],
    })
}

/// The difference about a pixel as far as it is no noise: the root of the mean product of both halves' differences, less
/// the standard error of that mean.
fn resolved(products: &[f64], [x, y]: [usize; 2]) -> f64 {
    let side = SIDE as usize;
    let reach = |at: usize| at.saturating_sub(REACH)..(at + REACH + 1).min(side);
    let near = reach(y).flat_map(|row| reach(x).map(move |column| products[row * side + column]));
    let [mut count, mut sum, mut squares] = [0.0; 3];
    for product in near {
        count += 1.0;
        sum += product;
        squares += product * product;
    }
    let mean: f64 = sum / count;
    (mean - ((squares / count - mean * mean).max(0.0) / count).sqrt())
        .max(0.0)
        .sqrt()
}

/// As the default view shows it.
fn shown(image: &Image) -> RgbImage {
    let codes = display(image, &ViewSettings::default());
    let colors = codes.as_chunks::<4>().0.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]);
    RgbImage::from_raw(image.width, image.height, colors.collect()).unwrap_or_default()
}

/// The denoiser, where there is one: a missing one is not reported, as nobody asked for it.
pub(super) fn denoise_if_possible() -> Denoise {
    match Library::get() {
        Ok(_) => Denoise::High,
        Err(_) => Denoise::Off,
    }
}

/// A ball of a material in the studio. The studio stays visible, because glass needs something to refract.
pub(super) fn ball(material: &MaterialSettings, side: u32, samples: u32, denoise: Denoise) -> Document {
    Document {
        model: ModelSource::Sphere,
        materials: vec![material.clone()],
        render: RenderSettings {
            width: side,
            height: side,
            samples,
            ..RenderSettings::default()
        },
        view: ViewSettings {
            denoise,
            ..ViewSettings::default()
        },
        ..Document::default()
    }
}

/// What a material looks like, and its samples.
fn rendered(session: &mut Session, material: &MaterialSettings) -> Result<(Arc<Image>, Film), SessionError> {
    let mut document = ball(material, SIDE, SAMPLES, denoise_if_possible());
    match session.submit(&document) {
        // The denoiser needs most of the memory.
        Err(SessionError::TooLarge(_)) => {
            document.view.denoise = Denoise::Off;
            session.submit(&document)?
        }
        other => other?,
    };
    while !session.step(STEP)?.is_done {}
    let image = match StepDenoiser::new(&document).finish(session)? {
        Some(denoised) => denoised.image,
        None => Arc::new(session.image()?),
    };
    Ok((image, session.film()?.clone()))
}
