//! Access to the rendered film.

use std::borrow::Cow;

use super::{Session, SessionError};
use crate::document::ViewSettings;
use crate::job::features::Features;
use crate::job::film::{Film, Image};
use crate::render::denoise::Noisy;
use crate::render::light_layers::{LightLayer, light_layers, mixed};
use crate::render::output::Layers;
use crate::render::shown::Source;
use crate::render::sums::KeptFilm;

impl Session {
    /// The film so far.
    pub fn film(&mut self) -> Result<&Film, SessionError> {
        Ok(self.engine.film()?)
    }

    /// The film with the mix of its light groups.
    fn mixed_film(&mut self) -> Result<Cow<'_, Film>, SessionError> {
        let film = self.engine.film()?;
        Ok(match self.document.as_deref() {
            Some(document) => mixed(film, document),
            None => Cow::Borrowed(film),
        })
    }

    /// The light of each group as it was rendered, by the group's name.
    pub fn light_layers(&mut self) -> Result<Vec<LightLayer>, SessionError> {
        let film = self.engine.film()?;
        let document = self.document.as_deref();
        Ok(document
            .map(|document| light_layers(film, document))
            .unwrap_or_default())
    }

    /// The mean image, linear, with the mix of its light groups.
    pub fn image(&mut self) -> Result<Image, SessionError> {
        Ok(self.mixed_film()?.image())
    }

    /// The mean image with its per-pixel layers.
    pub fn layers(&mut self) -> Result<Layers, SessionError> {
        let units = self.world_units_per_unit();
        let lights = self.light_layers()?;
        let film = self.mixed_film()?;
        Ok(Layers {
            lights,
            ..Layers::of(&film, Features::of(&film, units))
        })
    }

    /// The film with the data to join it with others.
    pub fn kept_film(&mut self) -> Result<KeptFilm, SessionError> {
        let samples = self.engine.schedule().samples_per_pixel();
        let document = self.document.as_deref().cloned().unwrap_or_default();
        let units = self.world_units_per_unit();
        Ok(KeptFilm::of(self.engine.film()?.clone(), document, samples, units))
    }

    /// Inputs of maps for an image with display settings.
    pub fn source<'a>(&'a mut self, image: &'a Image, view: &'a ViewSettings) -> Result<Source<'a>, SessionError> {
        let world_units_per_unit = self.world_units_per_unit();
        Ok(Source {
            film: self.engine.film()?,
            image,
            view,
            world_units_per_unit,
        })
    }

    /// Input of the denoiser.
    pub fn noisy(&mut self) -> Result<Noisy, SessionError> {
        let region = self.document.as_ref().and_then(|document| document.render.region);
        Ok(Noisy::of(&*self.mixed_film()?, region))
    }
}
