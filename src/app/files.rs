//! Opening and saving: projects, materials, pictures. What takes long happens on threads.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};

use super::App;
use super::actions::Command;
use super::dialogs::Purpose;
use crate::document::file::Opened;
use crate::document::{Document, file, preset, save_document, save_material};
use crate::render::output;
use crate::render::worker::Level;
use crate::scene::ModelSource;
use crate::scene::environment::EnvironmentSource;

/// The project's file, and what threads that save have to say.
pub(super) struct Files {
    ctx: egui::Context,
    project: Option<PathBuf>,
    sender: Sender<(Level, String)>,
    receiver: Receiver<(Level, String)>,
}

impl Files {
    pub(super) fn new(ctx: egui::Context) -> Self {
        let (sender, receiver) = channel();
        Self {
            ctx,
            project: None,
            sender,
            receiver,
        }
    }

    pub(super) fn take_messages(&self) -> Vec<(Level, String)> {
        self.receiver.try_iter().collect()
    }

    /// What to call the project.
    pub(super) fn project_name(&self) -> String {
        let stem = self.project.as_ref().and_then(|path| path.file_stem());
        stem.map_or_else(|| "untitled".to_owned(), |stem| stem.to_string_lossy().into_owned())
    }

    /// Does something that takes long, and says how it went.
    fn beside(&self, work: impl FnOnce() -> Result<String, String> + Send + 'static) -> Result<(), String> {
        let (sender, ctx) = (self.sender.clone(), self.ctx.clone());
        let body = move || {
            let message = match work() {
                Ok(text) => (Level::Info, text),
                Err(text) => (Level::Error, text),
            };
            // Nobody listens where the window was closed meanwhile.
            let _ = sender.send(message);
            ctx.request_repaint();
        };
        let spawned = std::thread::Builder::new().name("save".to_owned()).spawn(body);
        spawned
            .map(|_| ())
            .map_err(|error| format!("the system gives no thread to save on: {error}"))
    }
}

/// What a file's ending says that it is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum FileKind {
    Model,
    Environment,
    Json,
    Unknown,
}

fn kind_of(path: &Path) -> FileKind {
    let ending = path
        .extension()
        .and_then(|ending| ending.to_str())
        .unwrap_or_default()
        .to_ascii_lowercase();
    match ending.as_str() {
        "glb" | "gltf" => FileKind::Model,
        "hdr" | "exr" => FileKind::Environment,
        "json" => FileKind::Json,
        _ => FileKind::Unknown,
    }
}

impl App {
    /// Opens a file by its ending; true where the worker was asked to load it.
    pub(super) fn open(&mut self, path: PathBuf) -> bool {
        match kind_of(&path) {
            FileKind::Model => self.worker.open_model(ModelSource::File(path)),
            FileKind::Environment => self.worker.open_environment(EnvironmentSource::File(path)),
            FileKind::Json => {
                self.open_json(&path);
                return false;
            }
            FileKind::Unknown => {
                let text = "opened are models (.glb, .gltf), environments (.hdr, .exr), materials and projects (.json)";
                self.say(
                    Level::Error,
                    format!("{}: not a kind of file that can be opened; {text}", path.display()),
                );
                return false;
            }
        }
        true
    }

    fn open_json(&mut self, path: &Path) {
        let (warnings, label) = match file::open(path) {
            Ok(Opened::Material(loaded)) => {
                self.use_material(loaded.value);
                (loaded.warnings, None)
            }
            Ok(Opened::Document(loaded)) => {
                self.document = loaded.value;
                self.panels.slot = 0;
                self.files.project = Some(path.to_owned());
                (loaded.warnings, Some(format!("Open {}", self.files.project_name())))
            }
            Err(error) => {
                self.say(Level::Error, error.to_string());
                return;
            }
        };
        for warning in warnings {
            self.say(Level::Warning, warning);
        }
        if let Some(label) = label {
            self.edits.note(label, "");
            self.edits.record(&self.document, false);
            self.edits.mark_saved();
        }
    }

    /// The commands of the file menu.
    pub(super) fn file_command(&mut self, ctx: &egui::Context, command: Command) {
        let material_file = || format!("{}.json", preset::command_line_name(&self.desk_material().name));
        let ask = match command {
            Command::New => {
                self.document = Document::default();
                self.files.project = None;
                self.edits.note("New", "");
                return;
            }
            Command::CopyPicture => {
                self.copy_picture(ctx);
                return;
            }
            Command::Save => match self.files.project.clone() {
                Some(path) => {
                    self.save_project(path);
                    return;
                }
                None => (Purpose::SaveProject, "untitled.json".to_owned()),
            },
            Command::SaveAs => (Purpose::SaveProject, format!("{}.json", self.files.project_name())),
            Command::Open => (Purpose::Open, String::new()),
            Command::OpenModel => (Purpose::OpenModel, String::new()),
            Command::OpenEnvironment => (Purpose::OpenEnvironment, String::new()),
            Command::OpenMaterial => (Purpose::OpenMaterial, String::new()),
            Command::OpenMeasured => (Purpose::OpenMeasured, String::new()),
            Command::SaveMaterial => (Purpose::SaveMaterial, material_file()),
            Command::SavePicture => (Purpose::SavePicture, format!("{}.png", self.files.project_name())),
            // The others are done where this is called.
            _ => return,
        };
        self.dialogs.ask(ask.0, ask.1, ctx);
    }

    /// A file was chosen in a dialog.
    pub(super) fn chosen(&mut self, purpose: Purpose, path: PathBuf) {
        match purpose {
            Purpose::Open | Purpose::OpenModel | Purpose::OpenEnvironment | Purpose::OpenMaterial => {
                self.open(path);
            }
            Purpose::OpenMeasured => self.panels.lobe.measured = Some(path),
            Purpose::SaveProject => self.save_project(with_ending(path, "json")),
            Purpose::SaveMaterial => {
                let path = with_ending(path, "json");
                let saved = save_material(&path, &self.desk_material());
                self.say_saved(&path, saved.map_err(|error| error.to_string()));
            }
            Purpose::SavePicture => self.save_picture(with_ending(path, "png")),
        }
    }

    fn save_project(&mut self, path: PathBuf) {
        let saved = save_document(&path, &self.document).map_err(|error| error.to_string());
        if saved.is_ok() {
            self.edits.mark_saved();
            self.files.project = Some(path.clone());
        }
        self.say_saved(&path, saved);
    }

    fn say_saved(&mut self, path: &Path, saved: Result<(), String>) {
        match saved {
            Ok(()) => self.say(Level::Info, format!("saved {}", path.display())),
            Err(error) => self.say(Level::Error, error),
        }
    }

    fn save_picture(&mut self, path: PathBuf) {
        let Some(picture) = self.worker.snapshot().picture.clone() else {
            self.say(Level::Warning, "there is no picture to save yet");
            return;
        };
        let view = self.document.view;
        let begun = self.files.beside(move || {
            output::write(&path, &picture.image, &view).map_err(|error| error.to_string())?;
            let size = format!("{} × {}", picture.width, picture.height);
            Ok(format!(
                "saved {} ({size}, {} samples a pixel)",
                path.display(),
                picture.samples_per_pixel
            ))
        });
        if let Err(error) = begun {
            self.say(Level::Error, error);
        }
    }

    fn copy_picture(&mut self, ctx: &egui::Context) {
        let Some(picture) = self.worker.snapshot().picture.clone() else {
            self.say(Level::Warning, "there is no picture to copy yet");
            return;
        };
        let size = [picture.width as usize, picture.height as usize];
        ctx.copy_image(egui::ColorImage::from_rgba_premultiplied(size, &picture.rgba));
        self.say(
            Level::Info,
            format!("copied the picture ({} × {})", picture.width, picture.height),
        );
    }
}

/// The path, with an ending where it has none.
fn with_ending(path: PathBuf, ending: &str) -> PathBuf {
    if path.extension().is_some() {
        path
    } else {
        path.with_extension(ending)
    }
}
