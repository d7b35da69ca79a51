//! Models that were loaded: their materials, and what was edited of them.

use std::path::Path;
use std::sync::Arc;

use crate::app::App;
use crate::app::actions::{Action, Command};
use crate::document::MaterialSettings;
use crate::document::of_model::{lights_left_out, materials_of};
use crate::render::worker::Level;
use crate::scene::environment::EnvironmentSource;
use crate::scene::{Model, ModelOptions, ModelSource};
use crate::store::examples::still_life;

/// What an edit is called that changes the model, before the model's name.
const MODEL_CHANGED: &str = "Change the model to";
/// What an edit is called that changes the environment.
pub const ENVIRONMENT_CHANGED: &str = "Change the environment";

impl App {
    /// Takes a loaded model over: a file's materials come with it, a built-in keeps the one that is being edited.
    pub fn adopt_model(&mut self, source: ModelSource, options: ModelOptions, model: &Model) {
        let is_file = matches!(source, ModelSource::File(_));
        let is_shown_anew = self.document.model == source && self.document.import != options;
        let edited = self.desk_material();
        let before = std::mem::take(&mut self.document.materials);
        self.document.materials = materials_of(model, self.shared.import_lobe);
        if is_shown_anew {
            self.keep_edits(before);
        } else if source == ModelSource::StillLife {
            self.document.materials = still_life().materials;
        } else if !is_file && let Some(first) = self.document.materials.first_mut() {
            *first = edited;
        }
        self.shared.selection.slot = 0;
        if self.document.model != source || self.document.import.scene != options.scene {
            self.shared.selection.forget();
            self.document.hidden_objects.clear();
            self.document.object_names.clear();
        }
        self.document.model = source;
        self.document.import = options;
        if !is_shown_anew {
            let camera = &mut self.document.camera;
            (camera.target, camera.distance, camera.position) = (None, None, None);
            let left_out = self.document.add_lights_and_cameras(model);
            if let Some(message) = lights_left_out(left_out) {
                self.report(Level::Warning, message);
            }
        }
        self.edits.note(format!("{MODEL_CHANGED} {}", model.name), "");
    }

    /// Where the same file is shown in another way: materials whose slots have the same name stay as they were edited.
    fn keep_edits(&mut self, mut before: Vec<MaterialSettings>) {
        for material in &mut self.document.materials {
            if let Some(known) = before.iter().position(|known| known.name == material.name) {
                *material = before.swap_remove(known);
            }
        }
    }

    /// Takes over what files hold now that were saved by another program. Materials that were edited stay, the others are
    /// those of the file; view and light stay as they are.
    pub fn adopt_reloaded(&mut self, before: Option<Arc<Model>>, model: Option<Arc<Model>>) {
        let (Some(before), Some(model)) = (before, model) else {
            return;
        };
        self.report(Level::Info, format!("read {} again", model.name));
        if !matches!(self.document.model, ModelSource::File(_)) {
            return;
        }
        let lobe = self.shared.import_lobe;
        let (old, mut materials) = (materials_of(&before, lobe), materials_of(&model, lobe));
        for material in &mut materials {
            let place = old.iter().position(|known| known.name == material.name);
            let edited = place.and_then(|place| Some((&old[place], self.document.materials.get(place)?)));
            if let Some((_, edited)) = edited.filter(|(old, edited)| old != edited) {
                *material = edited.clone();
            }
        }
        if materials != self.document.materials {
            self.document.materials = materials;
            self.shared.selection.slot = self.shared.selection.slot.min(model.slots.len().saturating_sub(1));
            self.edits.note(format!("Read {} again", model.name), "");
        }
    }

    /// What was called off while it was made ready is not in the document either.
    pub fn take_back_cancelled(&mut self, ctx: &egui::Context) {
        let snapshot = self.worker.snapshot();
        let Some(scene) = &snapshot.scene else { return };
        let (shown, wanted) = (&scene.document, &self.document);
        let is_shown = (&shown.model, &shown.import, &shown.lighting.environment)
            == (&wanted.model, &wanted.import, &wanted.lighting.environment);
        let is_change = |label: &str| label.starts_with(MODEL_CHANGED) || label == ENVIRONMENT_CHANGED;
        if !is_shown && self.edits.undo_label().is_some_and(is_change) {
            self.apply(ctx, Action::Do(Command::Undo));
        }
    }

    /// Has the files looked at that are shown, and those read again that another program saved.
    pub fn watch_files(&mut self) {
        let snapshot = self.worker.snapshot();
        let Some(scene) = &snapshot.scene else { return };
        let mut files = scene.model.files.clone();
        if let EnvironmentSource::File(path) = &scene.document.lighting.environment {
            files.push(path.clone());
        }
        files.extend(scene.document.pictures().map(Path::to_owned));
        self.files.watched.watch(&files);
        if !self.files.watched.take_changed().is_empty() {
            self.worker.reload();
            self.restart_rival();
        }
    }
}
