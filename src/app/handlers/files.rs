//! Opening and saving: projects, materials, textures, what files name elsewhere. The window never waits for them.

use std::{path::Path, path::PathBuf, sync::mpsc::Receiver};

use crate::{
    App,
    document::{AreaLightShape, Document, MaterialSettings, ProfileFile, Reference},
    handlers::pictures::{Asked, Destination},
    import::{endings, endings::ending, holds_model, light_profile, limits},
    new_document,
    render::{output::format_of, queue::Task, worker::LayersMade},
    scene::{
        environment::EnvironmentSource,
        path_text::file_name,
        texture::{TextureTarget, UserTexture, set},
    },
    services::{disk, disk::Disk, edits::Edits, messages::LogEntry, watched::Watched},
    sheets::{dialogs::Purpose, question, unsaved::Then},
    store::{
        FileError, Loaded,
        exchange::{self, ExchangeError, ReadOptions},
        file_kind::{FileKind, may_hold_document, what_is_opened},
        lut,
        opened::Opened,
        preset, save_document, save_material,
    },
};

/// What the names of projects end with before .json: by it desktops know them from other files.
const KIND: &str = ".glossmith";

/// The project's file, and the thread that reads and writes.
pub struct Files {
    pub disk: Disk<Finish>,
    pub project: Option<PathBuf>,
    /// An image that was dropped on the window and may hold a document.
    pub dropped: Option<PathBuf>,
    /// Images and buffers that were dropped together with a model that is still being opened.
    pub dropped_with: Vec<PathBuf>,
    /// The files that are shown, looked at for changes.
    pub watched: Watched,
    /// Images to be written, and where they go.
    pub wanted_pictures: Vec<(Asked, Destination)>,
    /// The image that a path is being chosen for.
    pub asked: Option<Asked>,
    /// The layers that a path is being chosen for, and the revision that they are of.
    pub asked_layers: Option<(u64, Receiver<LayersMade>)>,
    /// The preset that is exported; the document's materials where there is none.
    pub exported: Option<MaterialSettings>,
}

/// What is to be done in the window with what was read or written; false where that failed.
pub type Finish = Box<dyn FnOnce(&mut App, &egui::Context) -> bool + Send>;

pub fn finish(finish: impl FnOnce(&mut App, &egui::Context) -> bool + Send + 'static) -> Finish {
    Box::new(finish)
}

impl Files {
    pub fn new(ctx: egui::Context) -> std::io::Result<Self> {
        Ok(Self {
            watched: Watched::default(),
            disk: Disk::new(ctx)?,
            project: None,
            dropped: None,
            dropped_with: Vec::new(),
            wanted_pictures: Vec::new(),
            asked: None,
            asked_layers: None,
            exported: None,
        })
    }

    /// What to call the project.
    pub fn project_name(&self) -> String {
        let stem = self.project.as_ref().and_then(|path| path.file_stem());
        let name = stem.map_or("untitled".into(), |stem| stem.to_string_lossy());
        name.strip_suffix(KIND).unwrap_or(&name).to_owned()
    }

    /// Whether something is still to be written.
    pub fn is_saving(&self) -> bool {
        self.disk.is_writing() || !self.wanted_pictures.is_empty()
    }

    /// Whether a material or a project that was opened has not been read yet.
    pub fn is_reading(&self) -> bool {
        self.disk.is_reading()
    }
}

/// What a file or a folder holds.
pub fn kind(path: &Path) -> Option<FileKind> {
    match path.is_dir() {
        true if holds_model(path) => Some(FileKind::Model),
        true if !textures_in(path).is_empty() => Some(FileKind::Picture),
        true => Some(FileKind::Light),
        false => FileKind::of(path),
    }
}

/// The images in a folder, where their names say that they belong on a material.
pub fn textures_in(folder: &Path) -> Vec<PathBuf> {
    let mut pictures = endings::pictures_in(folder);
    if set::recognised(&pictures).0.is_empty() {
        pictures.clear();
    }
    pictures
}

impl App {
    /// Opens a file by its ending, beside the window; true where it is of a kind that can be opened.
    pub fn open(&mut self, path: PathBuf) -> bool {
        match kind(&path) {
            Some(FileKind::Model) => self.open_models(path, Vec::new()),
            Some(FileKind::Picture) if path.is_dir() => {
                self.drop_files(vec![path]);
                return false;
            }
            Some(FileKind::Document | FileKind::Material) => self.read(path),
            Some(FileKind::Picture) if may_hold_document(&path) => self.read(path),
            Some(FileKind::Light | FileKind::Picture) => self.worker.open_environment(EnvironmentSource::File(path)),
            Some(FileKind::LightProfile) => {
                self.drop_profile(path);
                return false;
            }
            _ => {
                let (file, what) = (path.display(), what_is_opened());
                self.fail(format!(
                    "{file}: not a kind of file that can be opened; those are {what}"
                ));
                return false;
            }
        }
        true
    }

    fn read(&mut self, path: PathBuf) {
        let options = ReadOptions {
            lobe: self.shared.import_lobe,
            ..ReadOptions::default()
        };
        self.files.disk.order(disk::Task::Open, move || {
            let loading = options.loading.clone();
            let opened = exchange::open(&path, options);
            let refused = loading.take_refused();
            finish(move |app, ctx| {
                app.ask_about(&path, refused);
                app.take_opened(ctx, path, opened);
                true
            })
        });
    }

    /// Takes what has been read and written.
    pub fn take_files(&mut self, ctx: &egui::Context) {
        let mut has_failed = false;
        for (task, outcome) in self.files.disk.take_done() {
            let is_done = match outcome {
                Ok(finish) => finish(self, ctx),
                Err(why) => {
                    self.awaited = self.awaited.saturating_sub(usize::from(task == disk::Task::Open));
                    self.fail(format!("reading or writing a file failed by an internal error: {why}"));
                    false
                }
            };
            has_failed |= task == disk::Task::Write && !is_done;
        }
        self.go_on_after_save(ctx, has_failed);
    }

    /// Writes something after what was written before, and says what came of it.
    pub fn write(&mut self, work: impl FnOnce() -> Result<LogEntry, String> + Send + 'static) {
        self.files.disk.order(disk::Task::Write, || written(work()));
    }

    /// The same for what takes long.
    pub fn write_beside(&mut self, work: impl FnOnce() -> Result<LogEntry, String> + Send + 'static) {
        self.files.disk.beside(disk::Task::Write, || written(work()));
    }

    fn take_opened(&mut self, ctx: &egui::Context, path: PathBuf, opened: Result<Opened, ExchangeError>) {
        let is_start = self.awaited > 0 && self.edits.is_saved(&self.document);
        match opened {
            Ok(Opened::Material(loaded)) => {
                self.use_material(loaded.value);
                self.report_all(loaded.warnings);
                self.shared.recent.add(&path);
                self.count_as_start(is_start);
            }
            // An edit like others, so that saving does not replace the image.
            Ok(Opened::Picture(loaded)) => {
                self.report_all(loaded.warnings);
                self.shared.recent.add(&path);
                self.replace_document(loaded.value, format!("Open {}", file_name(&path)));
                self.count_as_start(is_start);
            }
            Ok(Opened::Document(loaded)) => {
                self.unless_unsaved(ctx, Then::Adopt(loaded, path));
                if is_start {
                    self.edits = Edits::new(self.document.clone());
                }
            }
            Err(ExchangeError::File(FileError::NoDocument { path }))
                if self.files.dropped.take_if(|dropped| *dropped == path).is_some() =>
            {
                self.put_pictures(&[path]);
            }
            Err(error) => {
                self.fail(&error);
                if let ExchangeError::File(FileError::Outside { path, files }) = error {
                    self.ask_about(&path, files);
                }
            }
        }
        self.awaited = self.awaited.saturating_sub(1);
    }

    /// Files given at the start are where editing begins, not edits that could be lost or undone; a project's changes
    /// are.
    pub fn count_as_start(&mut self, is_start: bool) {
        self.edits.record(&self.document, false);
        if is_start && self.files.project.is_none() {
            self.edits = Edits::new(self.document.clone());
        }
    }

    /// Goes on with another document, as an edit.
    pub fn replace_document(&mut self, document: Document, label: String) {
        self.document = document;
        self.shared.selection.slot = 0;
        self.edits.did(label);
    }

    /// Goes on with a project that has been read.
    pub fn adopt_project(&mut self, loaded: Loaded<Document>, path: PathBuf) {
        self.report_all(loaded.warnings);
        self.shared.recent.add(&path);
        self.files.project = Some(path);
        self.replace_document(loaded.value, format!("Open {}", self.files.project_name()));
        self.edits.record(&self.document, false);
        self.edits.history.mark_saved();
    }

    /// Goes on with the document of the start.
    pub fn start_anew(&mut self) {
        self.files.project = None;
        self.replace_document(new_document(self.document.view.denoise, false), "New".to_owned());
        self.edits.record(&self.document, false);
        self.edits.history.mark_saved();
    }

    pub fn report_all(&mut self, warnings: impl IntoIterator<Item = String>) {
        warnings.into_iter().for_each(|warning| self.warn(warning));
    }

    /// Asks for a file.
    pub fn ask(&mut self, ctx: &egui::Context, purpose: Purpose) {
        let project = self.files.project_name();
        let material = || {
            let preset = self.files.exported.as_ref().filter(|_| purpose == Purpose::Export);
            preset::command_line_name(&preset.map_or_else(|| self.desk_material().name, |preset| preset.name.clone()))
        };
        let suggestion = match purpose {
            Purpose::SaveProject => format!("{project}{KIND}.json"),
            Purpose::SaveMaterial => format!("{}.json", material()),
            Purpose::Export => format!("{}.mtlx", material()),
            Purpose::SaveLayers => format!("{project}.exr"),
            Purpose::SaveWindow => "glossmith-window.png".to_owned(),
            Purpose::QueuePicture | Purpose::SavePicture => format!("{project}.png"),
            _ => String::new(),
        };
        match purpose {
            Purpose::SavePicture => self.files.asked = self.asked(),
            Purpose::SaveLayers => self.files.asked_layers = Some((self.revision, self.worker.make_layers())),
            _ => {}
        }
        self.dialogs.ask(purpose, suggestion, ctx);
    }

    /// Saves the project; asks for its file where it has none.
    pub fn save_or_ask(&mut self, ctx: &egui::Context) {
        match self.files.project.clone() {
            Some(path) => self.save_project(path),
            None => self.ask(ctx, Purpose::SaveProject),
        }
    }

    /// A file was chosen in a dialog.
    pub fn chosen(&mut self, purpose: Purpose, path: PathBuf) {
        match purpose {
            Purpose::Open => {
                self.open(path);
            }
            Purpose::OpenLut => self.use_lut(path),
            Purpose::LightProfile(light) => self.use_profile(light, path),
            Purpose::Reference => {
                let before = self.document.view.reference.take().unwrap_or_default();
                self.document.view.reference = Some(Reference { file: path, ..before });
                self.edits.did("Choose a reference image");
            }
            Purpose::Texture(target) => self.put_textures(&[(target, UserTexture::of(path))]),
            Purpose::OpenMeasured => self.shared.measured = Some(path),
            Purpose::WatchFolder => self.shared.shelves.watch(path),
            // The ending says what is saved: an image has the document inside, too.
            Purpose::SaveProject if is_picture(&path) => self.want_picture(None, Destination::File(path)),
            Purpose::SaveProject => self.save_project(as_json(path, KIND)),
            Purpose::SaveMaterial => self.save_material(as_json(path, "")),
            Purpose::Export => self.prepare_export(path),
            Purpose::SaveLayers => self.write_layers(path.with_extension("exr")),
            Purpose::SaveWindow => self.window_picture = Some(path.with_extension("png")),
            Purpose::QueuePicture => self.enqueue(Task::Picture {
                document: Box::new(self.document.clone()),
                path: with_ending(path, "png"),
            }),
            Purpose::SavePicture => {
                let asked = self.files.asked.take();
                self.want_picture(asked, Destination::File(with_ending(path, "png")));
            }
        }
    }

    /// The system's dialog was left without a file, or was never seen; it does not report which.
    pub fn report_unsaved(&mut self, purpose: Purpose) {
        let title = purpose.title();
        self.warn(format!(
            "{title}: no file was chosen, nothing is saved. If no dialog was seen: Ctrl+K, Type file names"
        ));
    }

    /// Changes how files are chosen.
    pub fn toggle_typed_paths(&mut self) {
        let is_typed = self.dialogs.toggle_typed();
        self.note(match is_typed {
            true => "files are chosen by typing their paths in the window",
            false => "files are chosen in the system's dialog",
        });
    }

    /// Shows the image through a table of colours.
    fn use_lut(&mut self, path: PathBuf) {
        // Tables are small: this one is read at once, so that errors are reported here.
        if self.taken(lut::load(&path)).is_some() {
            self.edits.did(format!("Show through {}", file_name(&path)));
            self.document.view.lut = Some(path);
        }
    }

    /// Gives an area light a profile, and its shape for it.
    fn use_profile(&mut self, number: usize, path: PathBuf) {
        if self.taken(light_profile::load(&path)).is_some()
            && let Some(light) = self.document.lighting.area_lights.get_mut(number)
        {
            (light.profile, light.shape) = (Some(ProfileFile::new(&path)), AreaLightShape::Sphere);
            self.edits.did("Choose a light profile");
        }
    }

    /// Gives a dropped profile to the chosen light, or to the only one.
    fn drop_profile(&mut self, path: PathBuf) {
        let lights = self.document.lighting.area_lights.len();
        match self.shared.selection.light.or((lights == 1).then_some(0)) {
            Some(light) => self.use_profile(light, path),
            None => {
                let file = path.display();
                self.fail(format!("{file}: choose the area light for it in the panel Light first"));
            }
        }
    }

    fn save_project(&mut self, path: PathBuf) {
        let document = self.document.clone();
        self.files.disk.order(disk::Task::Write, move || {
            let saved = save_document(&path, &document).map_err(crate::in_words);
            finish(move |app, _| {
                if saved.is_ok() {
                    app.edits.history.mark_value_saved(&document);
                    app.shared.recent.add(&path);
                    app.files.project = Some(path.clone());
                }
                app.report_outcome(saved.map(|()| LogEntry::done_with("Saved", &path, "")))
            })
        });
    }

    fn save_material(&mut self, path: PathBuf) {
        let material = self.desk_material();
        self.write(move || {
            save_material(&path, &material).map_err(crate::in_words)?;
            Ok(LogEntry::done_with("Saved", &path, ""))
        });
    }

    /// Reports what was to be done, in a note; whether it was done.
    pub fn report_outcome(&mut self, outcome: Result<LogEntry, String>) -> bool {
        let done = self.taken(outcome);
        let is_done = done.is_some();
        self.say_all(done);
        is_done
    }
}

fn written(outcome: Result<LogEntry, String>) -> Finish {
    finish(move |app, _| app.report_outcome(outcome))
}

/// Whether a file of this name is an image.
fn is_picture(path: &Path) -> bool {
    format_of(path).is_ok()
}

/// The path with the ending of what is written as JSON, after any other that it has: that would say something else; and with
/// that of its kind before. What has been called .json by the user, without more, is left so.
fn as_json(path: PathBuf, kind: &str) -> PathBuf {
    if ending(&path) == "json" {
        return path;
    }
    let is_kind = path.to_string_lossy().to_lowercase().ends_with(kind);
    let mut name = path.into_os_string();
    name.push(if is_kind { "" } else { kind });
    name.push(".json");
    name.into()
}

/// The path, with an ending where it has none.
fn with_ending(path: PathBuf, ending: &str) -> PathBuf {
    if path.extension().is_some() {
        path
    } else {
        path.with_extension(ending)
    }
}

impl App {
    /// Puts images on the selected materials, in one edit.
    pub fn put_textures(&mut self, textures: &[(TextureTarget, UserTexture)]) {
        let Some((_, first)) = textures.first() else { return };
        let label = match textures.len() {
            1 => format!("Put {} on the material", file_name(&first.file)),
            count => format!("Put {count} textures on the material"),
        };
        for slot in self.shared.selection.slots() {
            let material = self.document.material_mut(slot);
            for (target, texture) in textures {
                // What is in the image's place keeps the way in which it lies there.
                let known = material.user_textures.get(*target).filter(|_| textures.len() == 1);
                let mut put = known.unwrap_or(texture).clone();
                put.file.clone_from(&texture.file);
                material.put_texture(*target, put);
            }
        }
        self.edits.did(label);
        self.edits.history.seal();
    }

    /// Puts images on what their names say; those that are left over. One by itself whose name says nothing is a base colour.
    pub fn put_pictures(&mut self, pictures: &[PathBuf]) -> Vec<PathBuf> {
        let (found, left) = set::recognised(pictures);
        if let (true, [picture]) = (found.is_empty(), pictures) {
            self.put_textures(&[(TextureTarget::BaseColor, UserTexture::of(picture.clone()))]);
            return Vec::new();
        }
        self.put_textures(&found);
        left
    }

    /// Asks about files that a file names, which is opened again once they are allowed.
    pub fn ask_about(&mut self, path: &Path, files: Vec<PathBuf>) {
        if !files.is_empty() {
            self.unsaved.outside.ask(files);
            self.unsaved.outside.named_by = Some(path.to_owned());
        }
    }

    /// Asks once for all that was refused; what is allowed is remembered, and read.
    pub fn show_outside(&mut self, ctx: &egui::Context) {
        let outside = &mut self.unsaved.outside;
        outside.ask(self.worker.loading().take_refused());
        if outside.files.is_empty() {
            outside.named_by = None;
            return;
        }
        let Some(is_allowed) = question(ctx, "outside", false, |ui| outside.show(ui)) else {
            return;
        };
        let files = std::mem::take(&mut outside.files);
        let named_by = outside.named_by.take();
        if !is_allowed {
            outside.denied.extend(files);
            return;
        }
        limits::allow(&files);
        match named_by {
            Some(path) => {
                self.open(path);
            }
            None => self.reload(),
        }
    }
}
