//! Choosing files: the system's dialog on a thread of its own, or a sheet to type a path into: where there is no dialog,
//! where one does not answer, and where it was asked for.

use std::{
    path::{MAIN_SEPARATOR, Path},
    pin::Pin,
    sync::mpsc::{Receiver, TryRecvError, channel},
    time::{Duration, Instant},
};

use super::*;
use crate::{
    render::output::FORMATS,
    scene::texture::TextureTarget,
    sheets::question,
    store::exchange,
    store::file_kind::{FileKind, OPENED, PICTURE_KINDS, endings},
};

/// A dialog that returns empty-handed sooner than this never opened: no user cancels that fast.
const NO_DIALOG: Duration = Duration::from_millis(400);
/// Most completions that are listed.
const COMPLETIONS: usize = 12;
/// Most folders that are offered.
const FOLDERS: usize = 6;

/// What a file is chosen for.
#[derive(Clone, Copy, PartialEq)]
pub enum Purpose {
    Open,
    SaveProject,
    OpenMeasured,
    SaveMaterial,
    Export,
    SavePicture,
    SaveLayers,
    QueuePicture,
    SaveWindow,
    WatchFolder,
    Texture(TextureTarget),
    OpenLut,
    /// Of the area light of this number.
    LightProfile(usize),
    Reference,
}

/// The kinds of files that a dialog shows: their name, and their endings.
type Kinds = (&'static str, Vec<&'static str>);

impl Purpose {
    /// Title of its dialog, whether that saves, and the kinds of files.
    #[rustfmt::skip]
    fn traits(self) -> (&'static str, bool, Kinds) {
        let of_kind = |kind: FileKind| (kind.label(), kind.endings());
        let images = || ("Images", FORMATS.map(|(ending, _)| ending).to_vec());
        match self {
            Self::Open => ("Open", false, ("Projects, materials, models, environments, images with a document", endings(OPENED))),
            Self::SaveProject => ("Save the project", true, ("Projects", vec!["json"])),
            Self::OpenMeasured => ("Open a measured material", false, of_kind(FileKind::Measured)),
            Self::SaveMaterial => ("Save the material", true, ("Materials", vec!["json"])),
            Self::Export => ("Export for another program", true, ("Files of other programs", exchange::endings_written())),
            Self::SavePicture => ("Save the image", true, images()),
            Self::SaveLayers => ("Save the image with layers", true, ("OpenEXR images", vec!["exr"])),
            Self::QueuePicture => ("Render to an image", true, images()),
            Self::SaveWindow => ("Save a screenshot", true, ("PNG images", vec!["png"])),
            Self::WatchFolder => ("Watch a folder", false, ("Folders", Vec::new())),
            Self::Texture(_) => ("Choose a texture", false, ("Images", endings(PICTURE_KINDS))),
            Self::OpenLut => ("Choose a table of colours", false, of_kind(FileKind::ColorTable)),
            Self::LightProfile(_) => ("Choose a light profile", false, of_kind(FileKind::LightProfile)),
            Self::Reference => ("Choose a reference image", false, ("Images", endings(PICTURE_KINDS))),
        }
    }

    pub fn title(self) -> &'static str {
        self.traits().0
    }

    pub fn is_saving(self) -> bool {
        self.traits().1
    }

    fn kinds(self) -> Kinds {
        self.traits().2
    }
}

/// The dialog that is open, if any, and where the last one was.
#[derive(Default)]
pub struct Dialogs {
    pending: Option<Pending>,
    field: Option<PathField>,
    folder: Option<PathBuf>,
    /// Why paths are typed even where the system may have dialogs.
    typed: Option<Why>,
}

/// The system's dialog's, on a thread of its own.
type Answer = Receiver<Option<PathBuf>>;

struct Pending {
    purpose: Purpose,
    suggestion: String,
    answer: Answer,
    since: Instant,
}

/// Why a path is typed.
#[derive(Clone, Copy)]
enum Why {
    /// It was asked for.
    Asked,
    /// The system's dialog did not open.
    Missing,
    /// The system's dialog is still to answer.
    Waiting,
}

impl Why {
    fn note(self) -> &'static str {
        match self {
            Self::Asked => "Type a path; Tab completes it.",
            Self::Missing if cfg!(target_os = "linux") => {
                "This system offers no file dialog: install xdg-desktop-portal-gtk or zenity to get one. Here a path is \
                 typed; Tab completes it."
            }
            Self::Missing => "The system's file dialog did not open: type a path. Tab completes it.",
            Self::Waiting => {
                "The system's file dialog has not answered: choose a file there, or type its path here. Tab completes it."
            }
        }
    }
}

struct PathField {
    purpose: Purpose,
    text: String,
    why: Why,
    /// To begin with; filled before the field has had the keyboard focus.
    folders: Vec<PathBuf>,
    /// It has had the keyboard focus: before, what is typed goes nowhere.
    has_had_focus: bool,
}

impl Dialogs {
    /// Paths are typed, never chosen in the system's dialog; they begin in a folder.
    pub fn typed(folder: PathBuf) -> Self {
        Self {
            folder: Some(folder),
            typed: Some(Why::Asked),
            ..Self::default()
        }
    }

    /// Changes between typed paths and the system's dialogs; true where paths are typed from now on.
    pub fn toggle_typed(&mut self) -> bool {
        self.typed = self.typed.is_none().then_some(Why::Asked);
        self.typed.is_some()
    }

    /// The folder of the file that was chosen last, if any.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// Whether the path field is open.
    pub fn is_open(&self) -> bool {
        self.field.is_some()
    }

    /// Whether a file is being chosen, in the path field or in the system's dialog.
    pub fn is_asking(&self) -> bool {
        self.field.is_some() || self.pending.is_some()
    }

    /// Asks for a file; `suggestion` is a file's name to save under. While the system's dialog is open, or does as if it
    /// were, the path field opens beside it.
    pub fn ask(&mut self, purpose: Purpose, suggestion: String, ctx: &Context) {
        if self.field.is_some() {
            return;
        }
        let waits = self.pending.is_some().then_some(Why::Waiting);
        if let Some(why) = waits.or(self.typed) {
            return self.open_field(purpose, &suggestion, why);
        }
        let Some(answer) = self.open_dialog(purpose, &suggestion, ctx) else {
            return self.open_field(purpose, &suggestion, Why::Missing);
        };
        self.pending = Some(Pending {
            purpose,
            suggestion,
            answer,
            since: Instant::now(),
        });
    }

    /// Opens the system's dialog, which answers on a thread of its own; `None` where there can be no thread.
    fn open_dialog(&self, purpose: Purpose, suggestion: &str, ctx: &Context) -> Option<Answer> {
        let (name, endings) = purpose.kinds();
        let mut dialog = rfd::AsyncFileDialog::new().set_title(purpose.title());
        if !endings.is_empty() {
            dialog = dialog.add_filter(name, &endings);
        }
        if let Some(folder) = &self.folder {
            dialog = dialog.set_directory(folder);
        }
        let (sender, answer) = channel();
        let ctx = ctx.clone();
        // The future must be made here: some systems have dialogs only on this thread.
        let chosen: Pin<Box<dyn Future<Output = Option<rfd::FileHandle>> + Send>> = match purpose {
            Purpose::WatchFolder => Box::pin(dialog.pick_folder()),
            _ if purpose.is_saving() => Box::pin(dialog.set_file_name(suggestion).save_file()),
            _ => Box::pin(dialog.pick_file()),
        };
        let spawned = std::thread::Builder::new()
            .name("file dialog".to_owned())
            .spawn(move || {
                let chosen = pollster::block_on(chosen);
                // Nobody listens where the window was closed meanwhile.
                let _ = sender.send(chosen.map(|file| file.path().to_owned()));
                ctx.request_repaint();
            });
        spawned.is_ok().then_some(answer)
    }

    fn open_field(&mut self, purpose: Purpose, suggestion: &str, why: Why) {
        let folder = self.folder.clone().or_else(|| std::env::current_dir().ok());
        self.field = Some(PathField {
            purpose,
            text: in_folder(&folder.unwrap_or_default(), suggestion),
            why,
            folders: Vec::new(),
            has_had_focus: false,
        });
    }

    /// Shows the path field where it is open. What a file was chosen for, in either way, with the file; without one
    /// where the system's dialog was left without a choice. `recent` are the folders of files opened and saved last.
    pub fn show(&mut self, ui: &mut Ui, recent: &[PathBuf]) -> Option<(Purpose, Option<PathBuf>)> {
        let chosen = self.poll().or_else(|| self.show_field(ui, recent))?;
        if let Some(folder) = chosen.1.as_ref().and_then(|path| path.parent()) {
            self.folder = Some(folder.to_owned());
        }
        Some(chosen)
    }

    /// Takes the system's dialog's answer. A dialog that could not be opened answers as if it had been cancelled, soon.
    fn poll(&mut self) -> Option<(Purpose, Option<PathBuf>)> {
        let answer = self.pending.as_ref()?.answer.try_recv();
        if answer == Err(TryRecvError::Empty) {
            return None;
        }
        let pending = self.pending.take()?;
        let path = answer.ok().flatten();
        if path.is_some() {
            // The same file need not be typed any more.
            self.field.take_if(|field| field.purpose == pending.purpose);
        } else if pending.since.elapsed() < NO_DIALOG {
            self.typed = Some(Why::Missing);
            if self.field.is_none() {
                self.open_field(pending.purpose, &pending.suggestion, Why::Missing);
            }
            return None;
        } else if self.field.is_some() {
            return None;
        }
        Some((pending.purpose, path))
    }

    fn show_field(&mut self, ui: &mut Ui, recent: &[PathBuf]) -> Option<(Purpose, Option<PathBuf>)> {
        let field = self.field.as_mut()?;
        if !field.has_had_focus {
            field.folders = to_begin_with(self.folder.as_deref(), recent);
        }
        let chosen = question(ui.ctx(), "path field", None, |ui| {
            ui.set_width(520.0_f32.min(0.9 * ui.ctx().content_rect().width()));
            field.show(ui)
        })?;
        let purpose = field.purpose;
        self.field = None;
        chosen.map(|path| (purpose, Some(path)))
    }
}

/// The folders that a path may begin with and that are there, each once: the last one, those of recent files, the user's.
fn to_begin_with(last: Option<&Path>, recent: &[PathBuf]) -> Vec<PathBuf> {
    let recent = recent.iter().filter_map(|file| file.parent());
    let home = std::env::home_dir();
    let mut folders: Vec<PathBuf> = Vec::new();
    for folder in last.into_iter().chain(recent).chain(home.as_deref()) {
        if folders.len() < FOLDERS && !folders.iter().any(|known| known == folder) && folder.is_dir() {
            folders.push(folder.to_owned());
        }
    }
    folders
}

/// The path that a text names: `~` stands for the user's folder.
fn path_of(text: &str) -> PathBuf {
    let text = text.trim();
    match (text.strip_prefix("~/"), std::env::home_dir()) {
        (Some(rest), Some(home)) => home.join(rest),
        _ => PathBuf::from(text),
    }
}

/// The folder that a text begins with, with its separator, and what follows.
fn parted(text: &str) -> (&str, &str) {
    text.split_at(text.rfind(['/', MAIN_SEPARATOR]).map_or(0, |end| end + 1))
}

/// The text of a file's path.
fn in_folder(folder: &Path, file: &str) -> String {
    folder.join("").display().to_string() + file
}

impl PathField {
    /// `Some(None)`: cancelled.
    fn show(&mut self, ui: &mut Ui) -> Option<Option<PathBuf>> {
        ui.heading(self.purpose.title());
        widgets::note(ui, self.why.note());
        ui.add_space(theme::GAP);
        let (_, endings) = self.purpose.kinds();
        let completions = completions(&self.text, &endings);
        let id = ui.make_persistent_id("path");
        // The field is to have the keys, behind its text.
        let mut is_continued = false;
        let completes =
            ui.memory(|memory| memory.has_focus(id)) && ui.input_mut(|i| i.consume_key(Modifiers::NONE, Key::Tab));
        if let Some(first) = completions.first().filter(|_| completes) {
            self.text.clone_from(first);
            is_continued = true;
        }
        let edit = TextEdit::singleline(&mut self.text).id(id).lock_focus(true);
        let response = ui.add(edit.desired_width(f32::INFINITY)).accessible_name("Path");
        if !self.has_had_focus && response.has_focus() {
            self.has_had_focus = true;
            log::debug!("no file dialog: a path is asked for");
        } else if !self.has_had_focus {
            is_continued = true;
            ui.ctx().request_repaint();
        }
        let is_entered = response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        // Folders to begin with: the file's name stays.
        ui.horizontal_wrapped(|ui| {
            for folder in &self.folders {
                let full = folder.display().to_string();
                let name = folder.file_name().unwrap_or(folder.as_os_str()).to_string_lossy();
                let button = ui.small_button(name).on_hover_text(&full);
                if button.clicked() {
                    self.text = in_folder(folder, parted(&self.text).1);
                    is_continued = true;
                }
                button.accessible_name(format!("Begin in {full}"));
            }
        });
        let height = 22.0 * COMPLETIONS as f32;
        let area = ScrollArea::vertical().max_height(height).min_scrolled_height(height);
        area.show(ui, |ui| {
            ui.set_min_size(vec2(ui.available_width(), height));
            for completion in completions {
                let name = completion.trim_end_matches(MAIN_SEPARATOR);
                let end = if name == completion { "" } else { "/" };
                if ui.selectable_label(false, format!("{}{end}", parted(name).1)).clicked() {
                    self.text = completion;
                    is_continued = true;
                }
            }
        });
        let outcome = self.outcome(ui, is_entered);
        if is_continued || (is_entered && outcome.is_none()) {
            response.request_focus();
            widgets::select(ui.ctx(), id, [self.text.chars().count(); 2]);
        }
        outcome
    }

    /// The buttons, and what is to be known of the path.
    fn outcome(&self, ui: &mut Ui, is_entered: bool) -> Option<Option<PathBuf>> {
        let path = path_of(&self.text);
        // A bare name stands for one in the current folder.
        let is_folder = |folder: &Path| folder.as_os_str().is_empty() || folder.is_dir();
        let has_folder = path.parent().is_some_and(is_folder);
        let (verb, is_usable) = match self.purpose {
            Purpose::WatchFolder => ("Watch", path.is_dir()),
            purpose if purpose.is_saving() => ("Save", path.file_name().is_some() && !path.is_dir() && has_folder),
            _ => ("Open", path.is_file()),
        };
        let replaces = self.purpose.is_saving() && path.is_file();
        let buttons = |ui: &mut Ui| {
            let confirms = widgets::pressed_if(ui, is_usable, verb, "", "") || (is_entered && is_usable);
            let cancels = ui.button("Cancel").clicked();
            let warning = match (replaces, has_folder) {
                (true, _) => "This file will be replaced",
                (_, false) => "There is no such folder",
                _ => "",
            };
            widgets::warning(ui, warning);
            (confirms || cancels).then(|| Some(path).filter(|_| !cancels))
        };
        ui.horizontal(buttons).inner
    }
}

/// Folders, and files with one of the endings, that begin with a path.
fn completions(text: &str, endings: &[&str]) -> Vec<String> {
    let (folder, start) = parted(text);
    let start = start.to_lowercase();
    let folder_path = if folder.is_empty() {
        PathBuf::from(".")
    } else {
        path_of(folder)
    };
    let entries = std::fs::read_dir(folder_path).into_iter().flatten().flatten();
    let found = entries.filter_map(|entry| {
        let name = entry.file_name().into_string().ok()?;
        let is_hidden = name.starts_with('.') && !start.starts_with('.');
        if is_hidden || !name.to_lowercase().starts_with(&start) {
            return None;
        }
        if entry.path().is_dir() {
            return Some(format!("{folder}{name}{MAIN_SEPARATOR}"));
        }
        let ending = Path::new(&name).extension()?.to_str()?.to_lowercase();
        endings.contains(&ending.as_str()).then(|| format!("{folder}{name}"))
    });
    let mut found: Vec<String> = found.collect();
    found.sort_by_key(|path| (!path.ends_with(MAIN_SEPARATOR), path.to_lowercase()));
    found.truncate(COMPLETIONS);
    found
}
