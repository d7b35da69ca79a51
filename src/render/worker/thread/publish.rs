//! What of a render is shown: pictures, denoised ones and maps.

use std::sync::Arc;
use std::time::Instant;

use super::State;
use crate::document::{Denoise, ViewSettings};
use crate::job::film::Image;
use crate::render::display::display;
use crate::render::error::SessionError;
use crate::render::shown::{Facts, Shown, map, map_of_errors};
use crate::render::worker::{Activity, Level, Picture};

impl State<'_> {
    /// What is shown already, in another way.
    pub(super) fn show_anew(&mut self) -> Result<(), SessionError> {
        match self.snapshot.picture.clone().filter(|picture| picture.is_denoised()) {
            Some(last) => self.publish(last.image.clone(), last.samples.clone(), last.samples_per_pixel),
            None => self.publish_picture(),
        }
    }

    /// Publishes what has been rendered; where it is shown denoised, asks for that instead.
    pub(super) fn publish_picture(&mut self) -> Result<(), SessionError> {
        let begun = Instant::now();
        let progress = self.session()?.progress();
        let Some(stage) = &self.stage else { return Ok(()) };
        if self.denoising.shows(&stage.submission.document, &progress) {
            // The first look after an edit is to be there soon; what follows is as careful as was asked for.
            let is_first_look = progress.samples_per_pixel < 2 && !progress.is_done;
            let how = match stage.submission.document.view.denoise {
                _ if is_first_look => Denoise::Fast,
                chosen => chosen,
            };
            let noisy = self.session()?.noisy()?;
            self.denoising.ask(noisy, how, &progress);
            return Ok(());
        }
        let image = Arc::new(self.session()?.image()?);
        self.publish(image.clone(), image, progress.samples_per_pixel)?;
        self.published_samples = progress.samples_per_pixel;
        self.published_at = Instant::now();
        self.publish_cost = begun.elapsed();
        Ok(())
    }

    /// Another picture is begun, or the same is shown in another way.
    pub(super) fn forget_denoised(&mut self) {
        self.denoising.begin();
        (self.denoised, self.snapshot.denoised) = (None, None);
    }

    /// Shows the denoised picture that has come back, if one has.
    pub(super) fn collect_denoised(&mut self) {
        let Some(outcome) = self.denoising.collect() else {
            return;
        };
        match outcome.denoised {
            Ok(denoised) => {
                let image = denoised.image.clone();
                if let (Some(error), Some(session)) = (denoised.error, &mut self.session) {
                    session.note_denoised(error);
                }
                self.snapshot.denoised = denoised.error;
                self.denoised = Some(denoised);
                self.guarded(|state| state.publish(image, outcome.noisy.image, outcome.samples_per_pixel));
            }
            Err(why) => {
                self.say(Level::Warning, format!("{why}; pictures are shown as they are"));
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
        let looks_closer = self.looks_closer;
        let Some(view) = self.stage.as_ref().map(|stage| stage.submission.document.view.clone()) else {
            return Ok(());
        };
        let denoised_errors = self.denoised.as_ref().map(|denoised| denoised.error_map.clone());
        let denoised_errors = denoised_errors.filter(|errors| !errors.is_empty());
        let (mut made, mut facts) = (None, None);
        if wanted != Shown::Picture || looks_closer {
            let source = self.session()?.source(&image, &view)?;
            made = match (wanted, &denoised_errors) {
                (Shown::Error, Some(errors)) => Some(map_of_errors(errors)),
                _ => map(&source, wanted),
            };
            facts = looks_closer.then(|| Arc::new(Facts::of(&source, denoised_errors.as_deref())));
        }
        let Some(stage) = &mut self.stage else { return Ok(()) };
        self.serial += 1;
        let map = made.as_ref().map(|map| (wanted, map.scale));
        let rgba = made.map_or_else(|| shown(&image, &view), |map| map.rgba);
        stage.is_shown = true;
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
        self.tell(Activity::Rendering);
        Ok(())
    }
}

/// Display-referred bytes, premultiplied as windows blend them.
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
