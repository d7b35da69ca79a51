//! Access to the rendered film.

use std::{borrow::Cow, path::Path, sync::Arc};

use super::{Session, SessionError};
use crate::{
    document::Document,
    job::features::Features,
    job::film::{Film, Image},
    render::{
        denoise::Noisy,
        frame::Frame,
        light_layers::{LightLayer, light_layers, mixed},
        output::{self, Layers, Rendered},
        shown::FilmSource,
        sums::KeptFilm,
    },
};

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

    /// The same without light groups, of a session that ends, in little more memory than the film's.
    pub fn into_layers(mut self) -> Result<Layers, SessionError> {
        let units = self.world_units_per_unit();
        let mixed = match self.mixed_film()? {
            Cow::Owned(film) => Some(film),
            Cow::Borrowed(_) => None,
        };
        let film = match mixed {
            Some(film) => film,
            None => std::mem::take(&mut self.engine).into_film()?,
        };
        drop(self);
        Ok(Layers::taken(film, units))
    }

    /// Writes the image and its light groups to a file, or the denoised image instead of the samples.
    pub fn write_image(&mut self, path: &Path, denoised: Option<&Image>, document: &Document) -> anyhow::Result<()> {
        let (image, lights) = (self.image()?, self.light_layers()?);
        let rendered = Rendered {
            lights: &lights,
            denoised,
            ..Rendered::from(&image)
        };
        Ok(output::write(path, rendered, document)?)
    }

    /// The film with the data to join it with others.
    pub fn kept_film(&mut self) -> Result<KeptFilm, SessionError> {
        let samples = self.engine.schedule().samples_per_pixel();
        let document = self.document.as_deref().cloned().unwrap_or_default();
        Ok(KeptFilm::of(
            self.engine.film()?.clone(),
            document,
            samples,
            self.world_units_per_unit(),
        ))
    }

    /// An image of the film as a frame, of a document whose size was divided by `reduction`.
    pub fn frame_of(&self, image: Arc<Image>, reduction: u32) -> Frame {
        Frame::new(self.film, image, self.engine.schedule().samples_per_pixel(), reduction)
    }

    /// Whether a frame is one of the film that is being rendered.
    pub fn has_film_of(&self, frame: &Frame) -> bool {
        frame.film == self.film
    }

    /// Inputs of a frame's maps; `None` if another film is being rendered.
    pub fn source<'a>(&'a mut self, frame: &'a Frame) -> Result<Option<FilmSource<'a>>, SessionError> {
        if !self.has_film_of(frame) {
            return Ok(None);
        }
        let world_units_per_unit = self.world_units_per_unit();
        Ok(Some(FilmSource {
            film: self.engine.film()?,
            denoised_errors: frame.errors.as_ref().map(|errors| &errors[..]),
            world_units_per_unit,
        }))
    }

    /// Input of the denoiser.
    pub fn noisy(&mut self) -> Result<Noisy, SessionError> {
        let region = self.document.as_ref().and_then(|document| document.render.region);
        Ok(Noisy::of(&*self.mixed_film()?, region))
    }
}
