//! An image of a film, with what belongs to it.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use super::denoise::Denoised;
use super::output::Rendered;
use super::shown::{PixelFacts, Source};
use crate::job::film::{Film, Image};

/// Identifies a film among those of all sessions. A render begun again, or at another size, has another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FilmId(u64);

impl FilmId {
    pub(super) fn new() -> Self {
        static LAST: AtomicU64 = AtomicU64::new(0);
        Self(LAST.fetch_add(1, Relaxed))
    }
}

/// An image of a film. Maps and facts are made of it together with the film it came from, see [`Frame::source`].
#[derive(Clone, Debug)]
pub struct Frame {
    /// The linear image that is shown.
    pub image: Arc<Image>,
    /// The mean of the samples; differs from `image` if that is denoised.
    pub samples: Arc<Image>,
    /// Samples per pixel.
    pub samples_per_pixel: u32,
    /// Divisor of width and height; 1 is the full resolution.
    pub reduction: u32,
    /// Per-pixel quantities while the inspector is open.
    pub facts: Option<Arc<PixelFacts>>,
    /// Estimated error per pixel, if the image is denoised and has one.
    errors: Option<Arc<Vec<f32>>>,
    film: FilmId,
}

impl Frame {
    pub(super) fn new(film: FilmId, image: Arc<Image>, samples_per_pixel: u32, reduction: u32) -> Self {
        Self {
            samples: image.clone(),
            image,
            samples_per_pixel,
            reduction,
            facts: None,
            errors: None,
            film,
        }
    }

    /// The frame with its image denoised.
    pub(super) fn denoised(self, denoised: Denoised) -> Self {
        let errors = Some(denoised.error_map).filter(|errors| !errors.is_empty());
        Self {
            image: denoised.image,
            errors: errors.map(Arc::new),
            ..self
        }
    }

    /// Whether it is an image of this film.
    pub(super) fn is_of(&self, film: FilmId) -> bool {
        self.film == film
    }

    /// What maps and facts are made of; `None` if the film is that of another image.
    pub(super) fn source<'a>(&'a self, id: FilmId, film: &'a Film, world_units_per_unit: f64) -> Option<Source<'a>> {
        let is_of_size = (film.width, film.height) == (self.image.width, self.image.height);
        (self.is_of(id) && is_of_size).then(|| Source {
            film,
            denoised_errors: self.errors.as_ref().map(|errors| &errors[..]),
            world_units_per_unit,
        })
    }

    /// Whether it is denoised.
    pub fn is_denoised(&self) -> bool {
        !Arc::ptr_eq(&self.image, &self.samples)
    }

    /// The image as it is written to files.
    pub fn rendered(&self) -> Rendered<'_> {
        Rendered {
            denoised: self.is_denoised().then_some(&*self.image),
            ..Rendered::from(&*self.samples)
        }
    }
}
