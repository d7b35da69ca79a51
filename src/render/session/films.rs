//! What has been rendered, read out of the engine.

use super::{Session, SessionError};
use crate::document::ViewSettings;
use crate::job::features::Features;
use crate::job::film::{Film, Image};
use crate::render::denoise::Noisy;
use crate::render::output::Layers;
use crate::render::shown::Source;
use crate::render::sums::KeptFilm;

impl Session {
    /// The sums of what has been rendered.
    ///
    /// # Errors
    /// If the GPU fails.
    pub fn film(&mut self) -> Result<&Film, SessionError> {
        Ok(self.engine.film()?)
    }

    /// The mean picture, linear.
    ///
    /// # Errors
    /// If the GPU fails.
    pub fn image(&mut self) -> Result<Image, SessionError> {
        Ok(self.film()?.image())
    }

    /// The mean picture with what is known beside it about each pixel.
    ///
    /// # Errors
    /// If the GPU fails.
    pub fn layers(&mut self) -> Result<Layers, SessionError> {
        let units = self.world_units_per_unit();
        let film = self.engine.film()?;
        Ok(Layers::of(film, Features::of(film, units)))
    }

    /// The sums of what has been rendered, with what is needed to join them with others.
    ///
    /// # Errors
    /// If the GPU fails.
    pub fn kept_film(&mut self) -> Result<KeptFilm, SessionError> {
        let samples = self.engine.schedule().samples_per_pixel();
        let document = self.document.as_deref().cloned().unwrap_or_default();
        let units = self.world_units_per_unit();
        Ok(KeptFilm::of(self.engine.film()?.clone(), document, samples, units))
    }

    /// What is known of each pixel, for a picture that is shown in this way.
    ///
    /// # Errors
    /// If the GPU fails.
    pub fn source<'a>(&'a mut self, image: &'a Image, view: &'a ViewSettings) -> Result<Source<'a>, SessionError> {
        let world_units_per_unit = self.world_units_per_unit();
        Ok(Source {
            film: self.engine.film()?,
            image,
            view,
            world_units_per_unit,
        })
    }

    /// What the denoiser needs of what has been rendered.
    ///
    /// # Errors
    /// If the GPU fails.
    pub fn noisy(&mut self) -> Result<Noisy, SessionError> {
        let region = self.document.as_ref().and_then(|document| document.render.region);
        Ok(Noisy::of(self.film()?, region))
    }
}
