//! Handing the renderers what has been edited: that of the viewport, and that of B.

use std::{sync::Arc, time::Instant};

use crate::{
    App, MOVING,
    document::{Change, Document},
    is_dragging,
    optics::lobe::Lobe,
    render::worker::{Activity, Event, Level, Pace, Picture, Snapshot, Worker},
    services::compare::{BEFORE, Renderer, Rival},
    services::viewing::Resolution,
};

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
        let is_new = differs(self.submitted.as_ref(), &wanted);
        let is_moving = is_turning || is_dragging || (self.edits.is_in_flow() && self.submitted_at.elapsed() < MOVING);
        let pace = if is_moving { Pace::Moving } else { Pace::Still };
        self.keep_up_rival(ctx, &wanted, pace);
        if !is_new {
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
        let snapshot = self.worker.snapshot();
        let old = self.submitted.as_ref().filter(|_| {
            self.submitted_resolution == self.shared.viewing.resolution
                && snapshot.activity == Activity::Done
                && snapshot.progress.render_seconds >= self.keep_pictures_from.as_secs_f64()
                && snapshot
                    .picture
                    .as_deref()
                    .is_some_and(|picture| self.is_whole(picture))
        });
        if let Some(old) = old {
            (wanted.render.width, wanted.render.height) = (old.render.width, old.render.height);
            if !Change::between(old, wanted).restarts() {
                return;
            }
        }
        (wanted.render.width, wanted.render.height) = (width, height);
    }

    /// Whether an image is of the document as submitted last, at its full size.
    pub fn is_whole(&self, picture: &Picture) -> bool {
        picture.revision == self.revision && picture.reduction == 1
    }

    /// The renderer of B; `None` where nothing is compared.
    pub fn rival_snapshot(&self) -> Option<Arc<Snapshot>> {
        self.shared.compare.snapshot()
    }

    /// How the images of A and B differ: the root mean square relative difference.
    pub fn rms_difference(&self) -> Option<f64> {
        Some(self.shared.compare.compared()?.rms)
    }

    /// Starts or ends the comparison. Where nothing was chosen for it, it is with the materials before the last change, else
    /// with the other of the two lobes that matter most.
    pub fn toggle_compare(&mut self) {
        let material = self.desk_material();
        let before = self.edits.materials_before(&self.document);
        let compare = &mut self.shared.compare;
        compare.is_on = !compare.is_on;
        if !compare.is_on || compare.is_chosen {
            return;
        }
        if let Some(before) = before {
            compare.rival = Rival::Materials(BEFORE.to_owned(), before);
        } else if compare.rival == Rival::Lobe(material.lobe) {
            compare.rival = Rival::Lobe(match material.lobe {
                Lobe::Ggx => Lobe::Geometric,
                _ => Lobe::Ggx,
            });
        }
    }

    /// B becomes the document, and what the document was becomes B.
    pub fn swap_compared(&mut self) {
        if !self.shared.compare.is_on {
            return;
        }
        let name = self.desk_material().name;
        let before = std::mem::take(&mut self.document.materials);
        self.document.materials = before.clone();
        self.take_rival("Swap A and B");
        self.shared.compare.rival = Rival::Materials(name, before);
        self.shared.compare.is_chosen = true;
    }

    /// B becomes the document, and nothing is left to compare.
    pub fn take_compared(&mut self) {
        if self.shared.compare.is_on {
            self.take_rival("Take B");
            self.shared.compare.is_on = false;
        }
    }

    fn take_rival(&mut self, label: &'static str) {
        let slot = self.shared.selection.slot;
        self.document.materials = self.shared.compare.rival_document(&self.document, slot).materials;
        self.edits.did(label);
    }

    /// Keeps B's renderer on what A's was given.
    pub fn keep_up_rival(&mut self, ctx: &egui::Context, wanted: &Document, pace: Pace) {
        let snapshot = self.worker.snapshot();
        let material = self.desk_material();
        let slot = self.shared.selection.slot;
        let is_paused = self.shared.rendering.is_paused;
        let compare = &mut self.shared.compare;
        let engine = snapshot.engine.as_ref().map(|engine| engine.kind);
        let its_engine = compare.renderer.as_ref().map(|renderer| renderer.engine);
        if !compare.is_on || its_engine != engine {
            compare.stop();
        }
        if !compare.is_on {
            return;
        }
        // A goes first: its engine is B's, and its first image comes before B's.
        let (Some(engine), Some(a)) = (engine, &snapshot.picture) else {
            return;
        };
        compare.match_look(ctx, &material);
        if compare.renderer.is_none() {
            let repainting = ctx.clone();
            let spawned = Worker::spawn_with(engine.into(), self.worker.assets().clone(), move || {
                repainting.request_repaint()
            });
            let Ok(worker) = spawned else {
                compare.is_on = false;
                return self.fail("cannot start a thread to render B");
            };
            compare.generation += 1;
            compare.renderer = Some(Renderer {
                worker,
                engine,
                submitted: None,
                is_paused: false,
            });
        }
        let rival = compare.rival_document(wanted, slot);
        let Some(renderer) = &mut compare.renderer else { return };
        if renderer.is_paused != is_paused {
            renderer.worker.pause(is_paused);
            renderer.is_paused = is_paused;
        }
        if differs(renderer.submitted.as_ref(), &rival) {
            renderer.worker.submit(&rival, pace);
            renderer.submitted = Some(rival);
        }
        let events = renderer.worker.take_events();
        compare.take_difference(ctx, Some(a));
        for event in events {
            if let Event::Message(level @ (Level::Warning | Level::Error), text) = event {
                self.report(level, format!("B: {text}"));
            }
        }
    }

    /// Restarts B's render, as A's.
    pub fn restart_rival(&self) {
        if let Some(renderer) = &self.shared.compare.renderer {
            renderer.worker.restart();
        }
    }
}

/// Whether the renderer that has been given `old`, if anything, is to be given `wanted`.
fn differs(old: Option<&Document>, wanted: &Document) -> bool {
    old.is_none_or(|old| !Change::between(old, wanted).is_none())
}
