//! Models that were loaded, with what was dropped or pasted beside them, and what was edited of them.

use std::{path::Path, path::PathBuf, sync::Arc};

use crate::{
    App,
    actions::{Action, Command},
    document::GroundKind,
    document::of_model::{lights_left_out, materials_of},
    handlers::files::{kind, textures_in},
    import::{environment, is_model},
    scene::{
        Model, ModelOptions, ModelSource,
        environment::EnvironmentSource,
        path_text::{file_name, path_of_text},
        texture::{UserTexture, set},
    },
    store::examples::still_life,
    store::file_kind::{FileKind, may_hold_document},
};

/// What was dropped on the window in this frame and, where text may be taken, pasted.
pub fn handed_over(ctx: &egui::Context, takes_text: bool) -> Vec<Action> {
    ctx.input(|input| {
        let dropped = input.raw.dropped_files.iter();
        let dropped: Vec<_> = dropped.map(|file| file.path().to_owned()).collect();
        let text = |event: &egui::Event| match event {
            egui::Event::Paste(text) if takes_text && !text.trim().is_empty() => {
                Some(Action::Paste(text.trim().to_owned()))
            }
            egui::Event::PasteImage(_) if takes_text => Some(Action::PastePicture),
            _ => None,
        };
        let pasted = input.events.iter().filter_map(text);
        let files = (!dropped.is_empty()).then_some(Action::Drop(dropped));
        files.into_iter().chain(pasted).collect()
    })
}

impl App {
    /// Opens a model with others that are shown with it and files that they may name.
    pub fn open_models(&mut self, first: PathBuf, beside: Vec<PathBuf>) {
        let options = ModelOptions {
            beside,
            ..ModelOptions::default()
        };
        self.open_model(ModelSource::File(first), options);
    }

    pub fn open_model(&mut self, source: ModelSource, options: ModelOptions) {
        self.put_aside();
        self.worker.open_model(source, options);
    }

    /// Reads the scene's files again.
    pub fn reload(&mut self) {
        self.put_aside();
        self.worker.reload();
    }

    /// Saves unsaved edits for recovery before a model is read: FBX and OBJ are read in C, where a fault would end the program.
    fn put_aside(&mut self) {
        if !self.edits.is_saved(&self.document) {
            let done = self.autosave.keep(&self.document, self.files.project.as_deref());
            self.worker.wait_for(done);
        }
    }

    /// Takes files that were dropped together. Models are shown together; what they name is looked for among the files,
    /// too. Images are for the selected material; one may have a document in it.
    pub fn drop_files(&mut self, paths: Vec<PathBuf>) {
        let address = paths
            .iter()
            .find_map(|path| path.to_str().filter(|text| is_address(text)));
        if let Some(address) = address {
            return self.refuse_address(address);
        }
        let [mut models, mut environments, mut pictures, mut parts] = [const { Vec::new() }; 4];
        if environment::are_faces(&paths) && paths.len() == 6 {
            // All lie in one folder, which is opened.
            environments.extend(paths[0].parent().map(Path::to_owned));
        } else {
            for path in paths {
                match kind(&path) {
                    Some(FileKind::Model) => models.push(path),
                    Some(FileKind::Light) => environments.push(path),
                    Some(FileKind::Picture) if path.is_dir() => pictures.extend(textures_in(&path)),
                    Some(FileKind::Picture) => pictures.push(path),
                    Some(FileKind::Part) => parts.push(path),
                    _ => drop(self.open(path)),
                }
            }
        }
        if let [shown @ .., last] = environments.as_slice() {
            for path in shown {
                let names = [path, last].map(|path| file_name(path));
                self.warn(format!(
                    "{}: one environment at a time; {} is opened",
                    names[0], names[1]
                ));
            }
            self.worker.open_environment(EnvironmentSource::File(last.clone()));
        }
        match models.as_slice() {
            [] => self.drop_without_model(pictures, &parts),
            [first, rest @ ..] => {
                let given = rest.iter().chain(&pictures).chain(&parts);
                // What lies beside the model is found there.
                let beside = given.filter(|path| is_model(path) || path.parent() != first.parent());
                self.open_models(first.clone(), beside.cloned().collect());
                self.files.dropped_with = pictures.into_iter().chain(parts).collect();
            }
        }
    }

    /// Opens files given at the start, models among them together; how many there are to be waited for.
    pub fn open_all(&mut self, mut paths: Vec<PathBuf>) -> usize {
        let mut models: Vec<PathBuf> = paths.extract_if(.., |path| is_model(path)).collect();
        let mut awaited = models.len().min(1);
        if awaited > 0 {
            self.open_models(models.remove(0), models);
        }
        for path in paths {
            awaited += usize::from(self.open(path));
        }
        awaited
    }

    /// Images by themselves: for the selected material.
    fn drop_without_model(&mut self, pictures: Vec<PathBuf>, parts: &[PathBuf]) {
        for part in parts {
            let part = part.display();
            self.fail(format!(
                "{part}: part of a model; drop it together with the .gltf or .obj that names it, or open that"
            ));
        }
        match (pictures.as_slice(), self.shared.selection.texture) {
            ([picture], Some(target)) => self.put_textures(&[(target, UserTexture::of(picture.clone()))]),
            ([picture], None) if may_hold_document(picture) => {
                // That is looked for first.
                self.files.dropped = Some(picture.clone());
                self.open(picture.clone());
            }
            _ => {
                let left = self.put_pictures(&pictures);
                self.leave_out(&left);
            }
        }
    }

    /// What was dropped with a model and is not part of it: images that say what they are for are assigned to its first material.
    pub fn use_dropped_with(&mut self, model: &Model) {
        let names: Vec<String> = model.files.iter().map(|path| file_name(path)).collect();
        let mut left = std::mem::take(&mut self.files.dropped_with);
        left.retain(|path| !names.iter().any(|known| known.eq_ignore_ascii_case(&file_name(path))));
        let (found, left) = set::recognised(&left);
        self.put_textures(&found);
        self.leave_out(&left);
    }

    fn leave_out(&mut self, files: &[PathBuf]) {
        for file in files {
            let name = file_name(file);
            self.warn(format!(
                "{name}: not used: nothing here names it, nor does its name say what it is for, as wood_roughness.png does; \
                 choose it in Material, beside its parameter"
            ));
        }
    }

    /// Opens the files whose names were pasted, one a line.
    pub fn paste(&mut self, text: &str) {
        let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        if let Some(address) = lines.clone().find(|line| is_address(line)) {
            return self.refuse_address(address);
        }
        let paths: Vec<PathBuf> = lines.map(path_of_text).collect();
        if paths.iter().all(|path| path.exists()) {
            self.drop_files(paths);
        } else {
            let shown: String = text.chars().take(80).collect();
            self.warn(format!("the pasted text is not a file name: {shown}"));
        }
    }

    fn refuse_address(&mut self, address: &str) {
        self.fail(format!(
            "{address}: web addresses are not opened; save the file and open it here"
        ));
    }
}

/// Whether a text names something that is no file of this machine.
fn is_address(text: &str) -> bool {
    let scheme = text.split_once(":/").map_or("", |(scheme, _)| scheme);
    let is_scheme = scheme.len() > 1 && scheme.chars().all(|letter| letter.is_ascii_alphanumeric());
    is_scheme && scheme != "file"
}

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
        let materials = materials_of(model, self.shared.import_lobe);
        let mut before = std::mem::replace(&mut self.document.materials, materials);
        if is_shown_anew {
            // Materials whose slots have the same name stay as they were edited.
            for material in &mut self.document.materials {
                if let Some(known) = before.iter().position(|known| known.name == material.name) {
                    *material = before.swap_remove(known);
                }
            }
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
            self.frame_all();
            if is_file {
                self.document.ground = true;
                self.match_ground();
            }
            let left_out = self.document.add_lights_and_cameras(model);
            self.report_all(lights_left_out(left_out));
        }
        self.edits.did(format!("{MODEL_CHANGED} {}", model.name));
    }

    /// The ground catches shadows alone where it would stand before a photograph.
    pub fn match_ground(&mut self) {
        let lighting = &mut self.document.lighting;
        if matches!(lighting.environment, EnvironmentSource::File(_)) && lighting.ground.kind == GroundKind::Plane {
            lighting.ground.kind = GroundKind::ShadowCatcher;
        }
    }

    /// Takes over what files hold now that were saved by another program. Materials that were edited stay, the others are
    /// those of the file; view and light stay as they are.
    pub fn adopt_reloaded(&mut self, before: Option<Arc<Model>>, model: Option<Arc<Model>>) {
        let (Some(before), Some(model)) = (before, model) else {
            return;
        };
        self.note(format!("read {} again", model.name));
        if !matches!(self.document.model, ModelSource::File(_)) {
            return;
        }
        let lobe = self.shared.import_lobe;
        let (old, mut materials) = (materials_of(&before, lobe), materials_of(&model, lobe));
        for material in &mut materials {
            let mut both = old.iter().zip(&self.document.materials);
            if let Some((old, edited)) = both.find(|(old, _)| old.name == material.name)
                && old != edited
            {
                *material = edited.clone();
            }
        }
        if materials != self.document.materials {
            self.document.materials = materials;
            self.shared.selection.slot = self.shared.selection.slot.min(model.slots.len().saturating_sub(1));
            self.edits.did(format!("Read {} again", model.name));
        }
    }

    /// What was called off while it was made ready is not in the document either.
    pub fn take_back_cancelled(&mut self, ctx: &egui::Context) {
        let Some(scene) = self.scene() else { return };
        let (shown, wanted) = (&scene.document, &self.document);
        let is_shown = (&shown.model, &shown.import, &shown.lighting.environment)
            == (&wanted.model, &wanted.import, &wanted.lighting.environment);
        let is_change = |label: &str| label.starts_with(MODEL_CHANGED) || label == ENVIRONMENT_CHANGED;
        if !is_shown && self.edits.history.undo_label().is_some_and(is_change) {
            self.apply(ctx, Action::Do(Command::Undo));
        }
    }

    /// Has the files looked at that are shown, and those read again that another program saved.
    pub fn watch_files(&mut self, ctx: &egui::Context) {
        let Some(scene) = self.scene() else { return };
        let mut files = scene.model.files.clone();
        if let EnvironmentSource::File(path) = &scene.document.lighting.environment {
            files.push(path.clone());
        }
        files.extend(scene.document.pictures().map(Path::to_owned));
        if self.files.watched.watch(ctx, files) {
            self.reload();
            self.restart_rival();
        }
    }
}
