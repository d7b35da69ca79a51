//! Opening and saving: projects, materials, images. The window never waits for them.

use std::path::{Path, PathBuf};

use crate::app::actions::Command;
use crate::app::handlers::dropped::textures_in;
use crate::app::handlers::take_picture::Destination;
use crate::app::services::disk::{Disk, Done, Task};
use crate::app::services::edits::Edits;
use crate::app::services::messages::Success;
use crate::app::services::watched::{self, Watched};
use crate::app::sheets::dialogs::Purpose;
use crate::app::sheets::unsaved::Then;
use crate::app::{App, new_document};
use crate::document::{AreaLightShape, Document, MaterialSettings, ProfileFile, Reference};
use crate::import::endings::ending;
use crate::import::{holds_model, light_profile};
use crate::render::output::format_of;
use crate::render::worker::Level;
use crate::scene::environment::EnvironmentSource;
use crate::scene::texture::UserTexture;
use crate::scene::{ModelOptions, ModelSource};
use crate::store::exchange::{self, ExchangeError, ReadOptions};
use crate::store::file_kind::{FileKind, may_hold_document, what_is_opened};
use crate::store::opened::Opened;
use crate::store::{FileError, Loaded, lut, preset, save_document, save_material};

/// What the names of projects end with before .json: by it desktops know them from other files.
const KIND: &str = ".glossmith";

/// The project's file, and the thread that reads and writes.
pub struct Files {
    pub disk: Disk,
    pub project: Option<PathBuf>,
    /// An image that was dropped on the window and may hold a document.
    pub dropped: Option<PathBuf>,
    /// Images and buffers that were dropped together with a model that is still being opened.
    pub dropped_with: Vec<PathBuf>,
    /// The files that are shown, looked at for changes.
    pub watched: Watched,
    /// Where the next whole image goes.
    pub wanted_pictures: Vec<Destination>,
    /// The preset that is exported; the document's materials where there is none.
    pub exported: Option<MaterialSettings>,
}

impl Files {
    pub fn new(ctx: egui::Context) -> std::io::Result<Self> {
        let repaint = ctx.clone();
        Ok(Self {
            watched: Watched::new(watched::INTERVAL, move || repaint.request_repaint())?,
            disk: Disk::new(ctx)?,
            project: None,
            dropped: None,
            dropped_with: Vec::new(),
            wanted_pictures: Vec::new(),
            exported: None,
        })
    }

    /// What to call the project.
    pub fn project_name(&self) -> String {
        let stem = self.project.as_ref().and_then(|path| path.file_stem());
        let name = stem.map_or_else(|| "untitled".to_owned(), |stem| stem.to_string_lossy().into_owned());
        name.strip_suffix(KIND).map_or(name.clone(), str::to_owned)
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

/// What a file or folder is opened as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Opening {
    Model,
    Environment,
    Document,
    Textures,
    Profile,
    Unknown,
}

fn opening(path: &Path) -> Opening {
    match FileKind::of(path) {
        _ if path.is_dir() && holds_model(path) => Opening::Model,
        _ if path.is_dir() && !textures_in(path).is_empty() => Opening::Textures,
        _ if path.is_dir() => Opening::Environment,
        _ if may_hold_document(path) => Opening::Document,
        Some(FileKind::Model) => Opening::Model,
        Some(FileKind::Light | FileKind::Picture) => Opening::Environment,
        Some(FileKind::Material) => Opening::Document,
        Some(FileKind::LightProfile) => Opening::Profile,
        _ => Opening::Unknown,
    }
}

impl App {
    /// Opens a file by its ending, beside the window; true where it is of a kind that can be opened.
    pub fn open(&mut self, path: PathBuf) -> bool {
        match opening(&path) {
            Opening::Model => self.worker.open_model(ModelSource::File(path), ModelOptions::default()),
            Opening::Environment => self.worker.open_environment(EnvironmentSource::File(path)),
            Opening::Document => {
                let options = ReadOptions {
                    lobe: self.shared.import_lobe,
                    ..ReadOptions::default()
                };
                self.files.disk.open(move || {
                    let loading = options.loading.clone();
                    let opened = exchange::open(&path, options);
                    Done::Read(path, opened, loading.take_refused())
                });
            }
            Opening::Textures => {
                self.drop_files(vec![path]);
                return false;
            }
            Opening::Profile => {
                self.drop_profile(path);
                return false;
            }
            Opening::Unknown => {
                let what = what_is_opened();
                let text = format!(
                    "{}: not a kind of file that can be opened; those are {what}",
                    path.display()
                );
                self.report(Level::Error, text);
                return false;
            }
        }
        true
    }

    /// Takes what has been read and written.
    pub fn take_files(&mut self, ctx: &egui::Context) {
        let mut has_failed = false;
        for done in self.files.disk.take_done() {
            match done {
                Done::Read(path, opened, refused) => {
                    self.ask_about(&path, refused);
                    self.take_opened(ctx, path, opened);
                }
                Done::Prepared(ready) => self.take_prepared(ctx, *ready),
                Done::Copied(copied) => self.take_copied(ctx, copied),
                Done::SavedProject(path, document, saved) => {
                    has_failed |= saved.is_err();
                    if saved.is_ok() {
                        self.edits.mark_value_saved(&document);
                        self.shared.recent.add(&path);
                        self.files.project = Some(path.clone());
                    }
                    let saved = saved.map_err(crate::in_words);
                    self.report_outcome(saved.map(|()| Success::with_file("Saved", &path, "")));
                }
                Done::Listed(listed) => self.take_library(listed),
                Done::ChangedLibrary(changed) => {
                    has_failed |= changed.is_err();
                    self.take_library(changed);
                }
                Done::ListedPins(listed) => self.take_snapshots(listed),
                Done::ChangedPins(changed) => {
                    has_failed |= changed.is_err();
                    self.take_snapshots(changed);
                }
                Done::Wrote(result) => {
                    has_failed |= result.is_err();
                    self.report_outcome(result);
                }
                Done::Broke(task, why) => {
                    has_failed |= task == Task::Write;
                    self.awaited = self.awaited.saturating_sub(usize::from(task == Task::Open));
                    self.report(
                        Level::Error,
                        format!("reading or writing a file failed by an internal error: {why}"),
                    );
                }
            }
        }
        self.go_on_after_save(ctx, has_failed);
    }

    fn take_opened(&mut self, ctx: &egui::Context, path: PathBuf, opened: Result<Opened, ExchangeError>) {
        let is_at_start = self.awaited > 0;
        match opened {
            Ok(Opened::Material(loaded)) => {
                let is_saved = self.edits.is_saved(&self.document);
                self.use_material(loaded.value);
                self.report_all(loaded.warnings);
                self.shared.recent.add(&path);
                self.count_as_start(is_at_start && is_saved);
            }
            Ok(Opened::Picture(loaded)) => {
                let is_saved = self.edits.is_saved(&self.document);
                self.adopt_picture(*loaded, &path);
                self.count_as_start(is_at_start && is_saved);
            }
            Ok(Opened::Document(loaded)) => {
                let is_saved = self.edits.is_saved(&self.document);
                self.unless_unsaved(ctx, Then::Adopt(loaded, path));
                if is_at_start && is_saved {
                    self.edits = Edits::new(self.document.clone());
                }
            }
            Err(ExchangeError::File(FileError::NoDocument { path }))
                if self.files.dropped.take_if(|dropped| *dropped == path).is_some() =>
            {
                self.put_pictures(&[path]);
            }
            Err(error) => {
                self.report(Level::Error, error.to_string());
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

    /// Goes on with a project that has been read.
    pub fn adopt_project(&mut self, loaded: Loaded<Document>, path: PathBuf) {
        self.report_all(loaded.warnings);
        self.shared.recent.add(&path);
        self.document = loaded.value;
        self.shared.selection.slot = 0;
        self.files.project = Some(path);
        self.edits.note(format!("Open {}", self.files.project_name()), "");
        self.edits.record(&self.document, false);
        self.edits.mark_saved();
    }

    /// Goes on with the document in an image: an edit like others, so that saving does not replace the image.
    fn adopt_picture(&mut self, loaded: Loaded<Document>, path: &Path) {
        self.report_all(loaded.warnings);
        self.shared.recent.add(path);
        self.document = loaded.value;
        self.shared.selection.slot = 0;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        self.edits.note(format!("Open {name}"), "");
    }

    /// Goes on with the document of the start.
    pub fn start_anew(&mut self) {
        self.document = new_document(self.document.view.denoise, false);
        self.shared.selection.slot = 0;
        self.files.project = None;
        self.edits.note("New", "");
        self.edits.record(&self.document, false);
        self.edits.mark_saved();
    }

    pub fn report_all(&mut self, warnings: Vec<String>) {
        for warning in warnings {
            self.report(Level::Warning, warning);
        }
    }

    /// The commands of the file menu.
    pub fn file_command(&mut self, ctx: &egui::Context, command: Command) {
        let material_file = || format!("{}.json", preset::command_line_name(&self.desk_material().name));
        let ask = match command {
            Command::New => return self.unless_unsaved(ctx, Then::New),
            Command::CopyPicture => return self.want_picture(Destination::Clipboard),
            Command::Save => match self.files.project.clone() {
                Some(path) => return self.save_project(path),
                None => (Purpose::SaveProject, format!("untitled{KIND}.json")),
            },
            Command::SaveAs => (
                Purpose::SaveProject,
                format!("{}{KIND}.json", self.files.project_name()),
            ),
            Command::Open => (Purpose::Open, String::new()),
            Command::OpenModel => (Purpose::OpenModel, String::new()),
            Command::OpenEnvironment => (Purpose::OpenEnvironment, String::new()),
            Command::OpenMaterial => (Purpose::OpenMaterial, String::new()),
            Command::OpenMeasured => (Purpose::OpenMeasured, String::new()),
            Command::WatchFolder => (Purpose::WatchFolder, String::new()),
            Command::TypePaths => return self.toggle_typed_paths(),
            Command::SaveMaterial => (Purpose::SaveMaterial, material_file()),
            Command::Export => return self.ask_export(ctx, None),
            Command::SaveLayers => (Purpose::SaveLayers, format!("{}.exr", self.files.project_name())),
            Command::SaveWindow => (Purpose::SaveWindow, "glossmith-window.png".to_owned()),
            Command::QueuePicture => (Purpose::QueuePicture, format!("{}.png", self.files.project_name())),
            Command::SavePicture => (Purpose::SavePicture, format!("{}.png", self.files.project_name())),
            // The others are done where this is called.
            _ => return,
        };
        self.dialogs.ask(ask.0, ask.1, ctx);
    }

    /// A file was chosen in a dialog.
    pub fn chosen(&mut self, purpose: Purpose, path: PathBuf) {
        match purpose {
            Purpose::Open | Purpose::OpenModel | Purpose::OpenEnvironment | Purpose::OpenMaterial => {
                self.open(path);
            }
            Purpose::OpenLut => self.use_lut(path),
            Purpose::LightProfile(light) => self.use_profile(light, path),
            Purpose::Reference => {
                let before = self.document.view.reference.take().unwrap_or_default();
                self.document.view.reference = Some(Reference { file: path, ..before });
                self.edits.note("Choose a reference image", "");
            }
            Purpose::Texture(target) => self.put_textures(&[(target, UserTexture::of(path))]),
            Purpose::OpenMeasured => self.shared.lobe_plots.measured = Some(path),
            Purpose::WatchFolder => self.shared.shelves.watch(path),
            // The ending says what is saved: an image has the document inside, too.
            Purpose::SaveProject if is_picture(&path) => self.want_picture(Destination::File(path)),
            Purpose::SaveProject => self.save_project(as_project(path)),
            Purpose::SaveMaterial => self.save_material(as_json(path)),
            Purpose::Export => self.prepare_export(path),
            Purpose::SaveLayers => self.worker.make_layers(path.with_extension("exr")),
            Purpose::SaveWindow => self.window_picture = Some(path.with_extension("png")),
            Purpose::QueuePicture => self.enqueue_picture(with_ending(path, "png")),
            Purpose::SavePicture => self.want_picture(Destination::File(with_ending(path, "png"))),
        }
    }

    /// The system's dialog was left without a file, or was never seen; it does not report which.
    pub fn report_unsaved(&mut self, purpose: Purpose) {
        let text = format!(
            "{}: no file was chosen, nothing is saved. If no dialog was seen: File › Type file names",
            purpose.title()
        );
        self.report(Level::Warning, text);
    }

    /// Changes how files are chosen.
    pub fn toggle_typed_paths(&mut self) {
        let text = match self.dialogs.toggle_typed() {
            true => "files are chosen by typing their paths in the window",
            false => "files are chosen in the system's dialog",
        };
        self.report(Level::Info, text);
    }

    /// Shows the image through a table of colours.
    fn use_lut(&mut self, path: PathBuf) {
        // Tables are small: this one is read at once, so that errors are reported here.
        match lut::load(&path) {
            Ok(_) => {
                let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                self.document.view.lut = Some(path);
                self.edits.note(format!("Show through {name}"), "");
            }
            Err(error) => self.report(Level::Error, error.to_string()),
        }
    }

    /// Gives an area light a profile, and its shape for it.
    fn use_profile(&mut self, number: usize, path: PathBuf) {
        if let Err(error) = light_profile::load(&path) {
            self.report(Level::Error, error.to_string());
            return;
        }
        let Some(light) = self.document.lighting.area_lights.get_mut(number) else {
            return;
        };
        (light.profile, light.shape) = (Some(ProfileFile::new(&path)), AreaLightShape::Sphere);
        self.edits.note("Choose a light profile", "");
    }

    /// Gives a dropped profile to the chosen light, or to the only one.
    fn drop_profile(&mut self, path: PathBuf) {
        let lights = self.document.lighting.area_lights.len();
        match self.shared.selection.light.or((lights == 1).then_some(0)) {
            Some(light) => self.use_profile(light, path),
            None => {
                let text = format!(
                    "{}: choose the area light for it in the panel Light first",
                    path.display()
                );
                self.report(Level::Error, text);
            }
        }
    }

    fn save_project(&mut self, path: PathBuf) {
        let document = Box::new(self.document.clone());
        self.files.disk.write(move || {
            let saved = save_document(&path, &document);
            Done::SavedProject(path, document, saved)
        });
    }

    fn save_material(&mut self, path: PathBuf) {
        let material = self.desk_material();
        self.files.disk.write(move || {
            let saved = save_material(&path, &material).map_err(crate::in_words);
            Done::Wrote(saved.map(|()| Success::with_file("Saved", &path, "")))
        });
    }

    /// Reports what was to be done, in a note.
    pub fn report_outcome(&mut self, outcome: Result<Success, String>) {
        match outcome {
            Ok(success) => self.report_success(Some(success)),
            Err(error) => self.report(Level::Error, error),
        }
    }
}

/// Whether a file of this name is an image.
fn is_picture(path: &Path) -> bool {
    format_of(path).is_ok()
}

/// The path with the ending of what is written as JSON, after any other that it has: that would say something else.
fn as_json(path: PathBuf) -> PathBuf {
    if ending(&path) == "json" {
        return path;
    }
    let mut name = path.into_os_string();
    name.push(".json");
    name.into()
}

/// The same for a project. What has been called .json by the user, without more, is left so.
fn as_project(path: PathBuf) -> PathBuf {
    if ending(&path) == "json" {
        return path;
    }
    let is_kind = path.to_string_lossy().to_lowercase().ends_with(KIND);
    let mut name = path.into_os_string();
    name.push(if is_kind { "" } else { KIND });
    as_json(name.into())
}

/// The path, with an ending where it has none.
fn with_ending(path: PathBuf, ending: &str) -> PathBuf {
    if path.extension().is_some() {
        path
    } else {
        path.with_extension(ending)
    }
}
