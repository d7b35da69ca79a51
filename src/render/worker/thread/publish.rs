//! Publishing of images, denoised images and maps.

use std::sync::Arc;
use std::time::Instant;

use super::State;
use crate::document::{Denoise, ViewSettings};
use crate::job::film::Image;
use crate::render::display::display;
use crate::render::error::SessionError;
use crate::render::shown::{PixelFacts, Shown, map, map_of_errors};
use crate::render::worker::{Activity, Level, Picture};

impl State<'_> {
    /// Publishes the current image again, after a change of display.
    pub(super) fn republish(&mut self) -> Result<(), SessionError> {
        match self.snapshot.picture.clone().filter(|picture| picture.is_denoised()) {
            Some(last) => self.publish(last.image.clone(), last.samples.clone(), last.samples_per_pixel),
            None => self.publish_picture(),
        }
    }

    /// Publishes the current render, or requests its denoising if it is shown denoised.
    pub(super) fn publish_picture(&mut self) -> Result<(), SessionError> {
        let start = Instant::now();
        let progress = self.session()?.progress();
        let Some(stage) = &self.stage else { return Ok(()) };
        if self.denoising.shows(&stage.submission.document, &progress) {
            // The first image after an edit uses the fast filter; later ones use the requested quality.
            let is_first_image = progress.samples_per_pixel < 2 && !progress.is_done;
            let how = match stage.submission.document.view.denoise {
                _ if is_first_image => Denoise::Fast,
                chosen => chosen,
            };
            let noisy = self.session()?.noisy()?;
            self.denoising.request(noisy, how, &progress);
            return Ok(());
        }
        let image = Arc::new(self.session()?.image()?);
        self.publish(image.clone(), image, progress.samples_per_pixel)?;
        self.published_samples = progress.samples_per_pixel;
        self.published_at = Instant::now();
        self.publish_cost = start.elapsed();
        Ok(())
    }

    /// Drops the denoised image, for another render or another display.
    pub(super) fn reset_denoised(&mut self) {
        self.denoising.reset();
        (self.denoised, self.snapshot.denoised) = (None, None);
    }

    /// Publishes the denoiser's result, if there is one.
    pub(super) fn collect_denoised(&mut self) {
        let Some(outcome) = self.denoising.collect() else {
            return;
        };
        match outcome.denoised {
            Ok(denoised) => {
                let image = denoised.image.clone();
                if let (Some(error), Some(session)) = (denoised.error, &mut self.session) {
                    session.set_denoised_error(error);
                }
                self.snapshot.denoised = denoised.error;
                self.denoised = Some(denoised);
                self.guarded(|state| state.publish(image, outcome.noisy.image, outcome.samples_per_pixel));
            }
            Err(why) => {
                self.message(Level::Warning, format!("{why}; images are shown as they are"));
                self.guarded(Self::publish_picture);
            }
        }
    }

    pub(super) fn publish(
        &mut self,
        image: Arc<Image>,
        samples: Arc<Image>,
        samples_per_pixel: u32,
    ) -> Result<(), SessionError> {
        let wanted = self.shown;
        let is_inspected = self.is_inspected;
        let Some(view) = self.stage.as_ref().map(|stage| stage.submission.document.view.clone()) else {
            return Ok(());
        };
        let denoised_errors = self.denoised.as_ref().map(|denoised| denoised.error_map.clone());
        let denoised_errors = denoised_errors.filter(|errors| !errors.is_empty());
        let (mut made, mut facts) = (None, None);
        if wanted != Shown::Picture || is_inspected {
            let source = self.session()?.source(&image, &view)?;
            made = match (wanted, &denoised_errors) {
                (Shown::Error, Some(errors)) => Some(map_of_errors(errors)),
                _ => map(&source, wanted),
            };
            facts = is_inspected.then(|| Arc::new(PixelFacts::of(&source, denoised_errors.as_deref())));
        }
        let Some(stage) = &mut self.stage else { return Ok(()) };
        self.serial += 1;
        let map = made.as_ref().map(|map| (wanted, map.scale));
        let rgba = made.map_or_else(|| shown(&image, &view), |map| map.rgba);
        (stage.is_shown, stage.is_seen) = (true, true);
        if self.snapshot.first_picture.is_none() {
            self.snapshot.first_picture = Some(stage.submission.at.elapsed());
        }
        self.snapshot.picture = Some(Arc::new(Picture {
            width: image.width,
            height: image.height,
            rgba,
            image,
            samples,
            serial: self.serial,
            revision: stage.submission.revision,
            reduction: stage.reduction,
            samples_per_pixel,
            map,
            facts,
            document: stage.submission.document.clone(),
        }));
        self.report(Activity::Rendering);
        Ok(())
    }
}

/// Display-referred RGBA, premultiplied in gamma space as windows blend it.
fn shown(image: &Image, view: &ViewSettings) -> Vec<u8> {
    let mut rgba = display(image, view);
    for pixel in rgba.chunks_exact_mut(4).filter(|pixel| pixel[3] < 255) {
        let alpha = u16::from(pixel[3]);
        for channel in &mut pixel[..3] {
            *channel = ((u16::from(*channel) * alpha + 127) / 255) as u8;
        }
    }
    rgba
}
