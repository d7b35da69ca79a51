//! An image of a film, with what belongs to it.

use std::sync::{Arc, atomic::AtomicU64, atomic::Ordering::Relaxed};

use super::{denoise::Denoised, output::Rendered, shown::PixelFacts};
use crate::job::film::Image;

/// Identifies a film among those of all sessions. A render begun again, or at another size, has another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilmId(u64);

impl FilmId {
    /// Another one each time.
    pub fn another() -> Self {
        static LAST: AtomicU64 = AtomicU64::new(0);
        Self(LAST.fetch_add(1, Relaxed))
    }
}

/// An image of a film. Maps and facts are made of it together with the film it came from.
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
    pub errors: Option<Arc<Vec<f32>>>,
    pub film: FilmId,
}

impl Frame {
    pub fn new(film: FilmId, image: Arc<Image>, samples_per_pixel: u32, reduction: u32) -> Self {
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
    pub fn denoised(self, denoised: Denoised) -> Self {
        let errors = Some(denoised.error_map).filter(|errors| !errors.is_empty());
        Self {
            image: denoised.image,
            errors: errors.map(Arc::new),
            ..self
        }
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
