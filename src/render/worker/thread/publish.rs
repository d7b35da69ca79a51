//! Publishing of images, denoised images and maps.

use std::{sync::Arc, time::Instant};

use super::State;
use crate::{
    document::Denoise,
    render::{
        error::SessionError,
        frame::Frame,
        shown::{PixelFacts, map_of_film, map_of_image},
        worker::{Activity, Level, picture::Picture, picture::displayed},
    },
};

impl State<'_> {
    /// Publishes the current image again, after a change of display.
    pub fn republish(&mut self) {
        if self.stage.as_ref().is_some_and(|stage| stage.is_shown) {
            self.guarded(|state| match state.frame.clone().filter(Frame::is_denoised) {
                Some(frame) => state.publish(frame),
                None => state.publish_picture(),
            });
        }
    }

    /// Publishes the current render, or requests its denoising if it is shown denoised. Before the first sample the image of
    /// the step before stays, if there is one.
    pub fn publish_picture(&mut self) -> Result<(), SessionError> {
        let start = Instant::now();
        let progress = self.session()?.progress();
        let Some(stage) = &self.stage else { return Ok(()) };
        if progress.samples_per_pixel == 0 && stage.is_shown {
            return Ok(());
        }
        let reduction = stage.reduction;
        if self.denoising.shows(&stage.submission.document, &progress) {
            let chosen = stage.submission.document.view.denoise;
            let mut noisy = self.session()?.noisy()?;
            let mut how = chosen;
            if self.denoising.is_as_one(&progress) {
                (noisy, how) = (noisy.as_one(), Denoise::Fast);
            }
            let session = self.session()?;
            let frame = session.frame_of(noisy.image.clone(), reduction);
            self.denoising.request(noisy, frame, how, &progress);
            return Ok(());
        }
        let session = self.session()?;
        let image = Arc::new(session.image()?);
        let frame = session.frame_of(image, reduction);
        self.publish(frame)?;
        self.published_samples = progress.samples_per_pixel;
        self.published_at = Instant::now();
        self.publish_cost = start.elapsed();
        Ok(())
    }

    /// Drops the denoiser's work and what is known of it, for another film or another way to denoise.
    pub fn reset_denoised(&mut self) {
        self.denoising.reset();
        self.snapshot.denoised = None;
    }

    /// Publishes the denoiser's result, if there is one.
    pub fn collect_denoised(&mut self) {
        let Some(outcome) = self.denoising.collect() else {
            return;
        };
        match outcome.denoised {
            Ok(denoised) => {
                if let (Some(error), Some(session)) = (denoised.error, &mut self.session) {
                    session.denoised = Some(error);
                }
                self.snapshot.denoised = denoised.error;
                self.guarded(|state| state.publish(outcome.frame.denoised(denoised)));
            }
            Err(why) => {
                self.message(Level::Warning, format!("{why}; images are shown as they are"));
                self.guarded(Self::publish_picture);
            }
        }
    }

    /// Shows a frame as the image or the map that is wanted. A map of a film that has gone on to another step waits for that
    /// step's frame: what is shown stays.
    pub fn publish(&mut self, mut frame: Frame) -> Result<(), SessionError> {
        let (wanted, is_inspected) = (self.shown, self.is_inspected);
        let Some(stage) = &self.stage else { return Ok(()) };
        let mut map = map_of_image(&frame.image, &stage.submission.document.view, wanted);
        let session = self.session()?;
        let is_current = session.has_film_of(&frame);
        let mut facts = frame.facts.take().filter(|_| is_inspected);
        if wanted.is_of_film() || (is_inspected && facts.is_none()) {
            match session.source(&frame)? {
                Some(source) => {
                    map = map.or_else(|| map_of_film(&source, wanted));
                    facts = facts.or_else(|| is_inspected.then(|| Arc::new(PixelFacts::of(&source))));
                }
                None if wanted.is_of_film() => return Ok(()),
                None => {}
            }
        }
        frame.facts = facts;
        let Some(stage) = &mut self.stage else { return Ok(()) };
        stage.is_shown = true;
        stage.is_seen |= is_current;
        if self.snapshot.first_picture.is_none() {
            self.snapshot.first_picture = Some(stage.submission.at.elapsed());
        }
        let document = stage.submission.document.clone();
        let (rgba, map) = match map {
            Some(map) => (map.rgba, Some((wanted, map.scale))),
            None => (displayed(&frame.image, &document.view), None),
        };
        let picture = Picture {
            width: frame.image.width,
            height: frame.image.height,
            rgba,
            serial: self.snapshot.picture.as_ref().map_or(1, |latest| latest.serial + 1),
            revision: stage.submission.revision,
            map,
            document,
            frame: frame.clone(),
        };
        (self.frame, self.snapshot.picture) = (Some(frame), Some(Arc::new(picture)));
        self.report(Activity::Rendering);
        Ok(())
    }
}
