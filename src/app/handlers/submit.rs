//! Handing the renderer what has been edited, at the size that the viewport asks for.

use std::time::Instant;

use crate::app::services::viewing::Resolution;
use crate::app::{App, MOVING, is_dragging};
use crate::document::{Change, Document};
use crate::render::worker::{Activity, Pace, Picture};

impl App {
    /// Records the frame's edit and hands the renderer what differs from what it has.
    pub fn record_and_submit(&mut self, ctx: &egui::Context) {
        let is_dragging = is_dragging(ctx);
        self.record(is_dragging);
        if self.awaited > 0 {
            return;
        }
        let (mut wanted, is_turning) = self.document_shown(ctx);
        match self.viewport.fill_size(self.shared.viewing.resolution) {
            Some(size) => self.set_size(&mut wanted, size),
            // The first frame has not been laid out: the size would be wrong.
            None if self.shared.viewing.resolution != Resolution::Document => return,
            None => {}
        }
        let change = self
            .submitted
            .as_ref()
            .map_or(Change::everything(), |old| Change::between(old, &wanted));
        let is_moving = is_turning || is_dragging || (self.edits.is_in_flow() && self.submitted_at.elapsed() < MOVING);
        let pace = if is_moving { Pace::Moving } else { Pace::Still };
        self.keep_up_rival(ctx, &wanted, pace);
        if change.is_none() {
            return;
        }
        self.revision = self.worker.submit(&wanted, pace);
        self.submitted = Some(wanted);
        self.submitted_resolution = self.shared.viewing.resolution;
        self.submitted_at = Instant::now();
    }

    /// Gives a document that is to be rendered the viewport's size, unless nothing else would make the renderer start over
    /// and the image is finished and has cost too much for that. One in progress is begun again, however slow it is.
    fn set_size(&self, wanted: &mut Document, [width, height]: [u32; 2]) {
        (wanted.render.width, wanted.render.height) = (width, height);
        let Some(old) = &self.submitted else { return };
        let old_size = (old.render.width, old.render.height);
        if old_size == (width, height) || self.submitted_resolution != self.shared.viewing.resolution {
            return;
        }
        let snapshot = self.worker.snapshot();
        let is_its_picture = |picture: &Picture| picture.revision == self.revision && picture.reduction == 1;
        let is_costly = snapshot.activity == Activity::Done
            && snapshot.progress.render_seconds >= self.keep_pictures_from.as_secs_f64()
            && snapshot.picture.as_deref().is_some_and(is_its_picture);
        (wanted.render.width, wanted.render.height) = old_size;
        if !is_costly || Change::between(old, wanted).restarts() {
            (wanted.render.width, wanted.render.height) = (width, height);
        }
    }
}
