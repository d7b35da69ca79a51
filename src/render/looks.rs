//! Comparison of two materials: a ball of each in the studio, and the difference of the renders.

use std::time::Duration;

use image::RgbImage;

use super::EngineChoice;
use super::display::display;
use super::error::SessionError;
use super::session::Session;
use crate::document::{Denoise, Document, MaterialSettings, RenderSettings, ViewSettings};
use crate::job::film::Film;
use crate::plot::scale_color;
use crate::scene::ModelSource;

/// Width and height of each render, in pixels.
pub const SIDE: u32 = 64;
/// Samples per pixel.
const SAMPLES: u32 = 64;
/// Step of the session.
const STEP: Duration = Duration::from_millis(100);
/// Relative difference with the brightest colour of the map.
const BRIGHTEST: f64 = 0.5;

/// Result of a comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Compared {
    /// The first render, the second, and a map of their difference: dark for none, yellow from half the mean brightness.
    pub pictures: [RgbImage; 3],
    /// Root mean square of the difference of luminance over the mean luminance, free of noise: the two halves of the samples
    /// err independently, so that the mean of their differences' product does not.
    pub difference: f64,
}

/// Renders a ball of each material in the studio on the CPU.
///
/// # Errors
///
/// The session's.
pub fn compared(materials: &[MaterialSettings; 2]) -> Result<Compared, SessionError> {
    let mut session = Session::open(EngineChoice::Cpu)?;
    let [first, second] = [
        rendered(&mut session, &materials[0])?,
        rendered(&mut session, &materials[1])?,
    ];
    let mean = (0..first.pixel_count())
        .map(|pixel| luminance(&first, pixel, None))
        .sum::<f64>();
    let mean = (mean / first.pixel_count() as f64).max(1e-9);
    let mut squares = 0.0;
    let mut map = RgbImage::new(SIDE, SIDE);
    for (pixel, color) in map.pixels_mut().enumerate() {
        let apart = |half: Option<usize>| luminance(&first, pixel, half) - luminance(&second, pixel, half);
        squares += apart(Some(0)) * apart(Some(1));
        color.0 = scale_color(apart(None).abs() / mean / BRIGHTEST);
    }
    let shown = |film: &Film| {
        let codes = display(&film.image(), &ViewSettings::default());
        let colors = codes.as_chunks::<4>().0.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]);
        RgbImage::from_raw(SIDE, SIDE, colors.collect()).unwrap_or_default()
    };
    Ok(Compared {
        difference: (squares / first.pixel_count() as f64).max(0.0).sqrt() / mean,
        pictures: [shown(&first), shown(&second), map],
    })
}

/// The mean luminance of a pixel, or of a half of its samples.
fn luminance(film: &Film, pixel: usize, half: Option<usize>) -> f64 {
    half.map_or_else(|| film.sums(pixel), |half| film.halves(pixel)[half])
        .mean_luminance()
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

fn rendered(session: &mut Session, material: &MaterialSettings) -> Result<Film, SessionError> {
    session.submit(&ball(material, SIDE, SAMPLES, Denoise::Off))?;
    while !session.step(STEP)?.is_done {}
    Ok(session.film()?.clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_material_is_not_apart_and_another_is() {
        let gold = MaterialSettings::default();
        let rougher = MaterialSettings {
            roughness: 0.8,
            ..gold.clone()
        };
        assert_eq!(compared(&[gold.clone(), gold.clone()]).unwrap().difference, 0.0);
        let apart = compared(&[gold, rougher]).unwrap();
        assert!(apart.difference > 0.05, "{}", apart.difference);
        assert!(apart.pictures[0] != apart.pictures[1]);
    }
}
