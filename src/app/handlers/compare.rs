//! What the window does to compare the document with something else.

use std::sync::Arc;

use crate::app::App;
use crate::app::services::compare::{BEFORE, Renderer, Rival};
use crate::document::{Change, Document};
use crate::optics::lobe::Lobe;
use crate::render::worker::{Event, Level, Pace, Snapshot};

impl App {
    /// The renderer of B; `None` where nothing is compared.
    pub fn rival_snapshot(&self) -> Option<Arc<Snapshot>> {
        self.shared.compare.snapshot()
    }

    /// How the images of A and B differ: the root mean square relative difference.
    pub fn rms_difference(&self) -> Option<f64> {
        Some(self.shared.compare.compared()?.rms)
    }

    pub fn compare_with(&mut self, rival: Rival) {
        let compare = &mut self.shared.compare;
        compare.rival = rival;
        (compare.is_on, compare.is_chosen) = (true, true);
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
            let other = if material.lobe == Lobe::Ggx {
                Lobe::Geometric
            } else {
                Lobe::Ggx
            };
            compare.rival = Rival::Lobe(other);
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
        self.edits.note(label, "");
    }

    /// Keeps B's renderer on what A's was given.
    pub fn keep_up_rival(&mut self, ctx: &egui::Context, wanted: &Document, pace: Pace) {
        let snapshot = self.worker.snapshot();
        let material = self.desk_material();
        let slot = self.shared.selection.slot;
        let is_paused = self.shared.rendering.is_paused;
        let compare = &mut self.shared.compare;
        let engine = snapshot.engine.as_ref().map(|engine| engine.kind);
        let is_other_engine = compare
            .renderer
            .as_ref()
            .is_some_and(|renderer| Some(renderer.engine) != engine);
        if !compare.is_on || is_other_engine {
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
            let Ok(worker) = self
                .worker
                .spawn_beside(engine.into(), move || repainting.request_repaint())
            else {
                compare.is_on = false;
                self.report(Level::Error, "cannot start a thread to render B");
                return;
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
        let change = renderer
            .submitted
            .as_ref()
            .map_or(Change::everything(), |old| Change::between(old, &rival));
        if !change.is_none() {
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
