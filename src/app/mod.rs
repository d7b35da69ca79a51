//! The editor window.
//!
//! State is the document with its history, what panels remember, and a worker that renders. A frame shows the panels,
//! which change the document or push actions; then actions are applied, the edit is recorded, and a document that
//! differs from the one last submitted is submitted.

#![deny(clippy::print_stdout, clippy::print_stderr)]

use glossmith_engine::{analysis, job, named, optics, panics, scene};
use glossmith_files::{document, in_words, matching, plot, store};
use glossmith_import as import;
use glossmith_session::{render, study};

pub mod actions;
pub mod book;
mod desk;
mod handlers;
mod kit;
pub mod layout;
mod lights;
mod measuring;
mod pane;
mod panels;
mod services;
mod settings;
mod sheets;
mod viewport;
pub mod workspaces;

use std::{io, path::Path, path::PathBuf, sync::Arc, time::Duration, time::Instant};

use egui::Ui;
use egui_tiles::Tree;

use actions::Action;
use desk::{Desk, Shared, VIEW_ANGLE_DEG};
use handlers::models::{self, ENVIRONMENT_CHANGED};
use kit::{keys, theme};
use layout::Pane;
use panels::Panels;
use services::{
    autosave::{self, Autosave, Leftover},
    edits::Edits,
    library::{Change, Folder},
    messages,
    messages::LogEntry,
    pictures::Pictures,
    recent::Recent,
    selection::Selection,
    viewing::{Rendering, Viewing},
};
pub use services::{compare, crash::report_panics, library, viewing::Resolution};
use sheets::{
    book::Manual, dialogs::Dialogs, export::ExportSheet, menu, menu::Sheet, status, turntable::TurntableSheet,
    unsaved::Unsaved,
};
use viewport::Viewport;
use workspaces::Workspaces;

use crate::{
    document::{Denoise, Document, MaterialSettings, of_model::import_report},
    render::{
        EngineChoice,
        queue::Queue,
        worker::{Activity, Event, Level, Scene, Snapshot, Worker},
    },
    scene::{ModelSource, environment::EnvironmentSource},
    store::examples::still_life,
};

/// A finished image that has cost this much time keeps its size while nothing but the viewport's size changes.
const KEPT_FROM: Duration = Duration::from_secs(10);
/// Changes that follow each other within this are rendered as moving.
const MOVING: Duration = Duration::from_millis(150);

/// Opens the editor with files: models, environments, materials, projects. Returns when the window is closed.
pub fn run(files: Vec<PathBuf>, engine: EngineChoice, pages: book::Pages) -> anyhow::Result<()> {
    let [data, cache] = settings::folders().map_or([None, None], |folders| folders.map(Some));
    let options = Options {
        files,
        engine,
        pages,
        data,
        cache,
        offers_downloads: true,
        ..Options::default()
    };
    crate::render::priority::let_rendering_give_way();
    report_panics();
    let open = |backends| {
        let options = options.clone();
        let create: eframe::AppCreator<'_> = Box::new(move |creation| Ok(Box::new(App::new(creation, options)?)));
        eframe::run_native("Glossmith", settings::native_options(backends), create)
    };
    // OpenGL only as a last resort: its driver takes memory beside the one in use.
    let opened = match open(wgpu::Backends::PRIMARY) {
        Err(eframe::Error::Wgpu(_)) => open(wgpu::Backends::GL),
        opened => opened,
    };
    opened.map_err(|error| {
        anyhow::anyhow!(
            "the window can't be opened: {error}. `glossmith render` works without one; a window needs a display and a \
             Vulkan or OpenGL driver (on Debian and Ubuntu: apt install mesa-vulkan-drivers)"
        )
    })
}

/// What the editor starts with.
#[derive(Clone, Debug, Default)]
pub struct Options {
    pub files: Vec<PathBuf>,
    pub engine: EngineChoice,
    /// The document instead of the default one.
    pub document: Option<Document>,
    /// The size of the image instead of the one remembered.
    pub resolution: Option<Resolution>,
    /// The folder for what belongs to the user: materials, and unsaved edits for after a crash. Without one neither is
    /// kept.
    pub data: Option<PathBuf>,
    /// The folder for what can be made again: thumbnails of materials. Without one none are made.
    pub cache: Option<PathBuf>,
    /// At least so long between two copies of unsaved edits, instead of 5 s.
    pub autosave_interval: Option<Duration>,
    /// The render time from which a finished image keeps its size when the viewport gets another, instead of 10 s.
    pub keep_pictures_from: Option<Duration>,
    /// Files are chosen by typing a path that begins with this folder, even where the system has a dialog for it.
    pub typed_paths: Option<PathBuf>,
    /// Whether the window may offer to download what it lacks.
    pub offers_downloads: bool,
    /// The name of the workspace instead of the one that was left.
    pub workspace: Option<String>,
    /// Pages of the manual.
    pub pages: book::Pages,
}

/// The editor.
pub struct App {
    document: Document,
    edits: Edits,
    worker: Worker,
    /// The document as last submitted, with its size.
    submitted: Option<Document>,
    /// What its size followed from.
    submitted_resolution: Resolution,
    keep_pictures_from: Duration,
    submitted_at: Instant,
    revision: u64,
    queue: Vec<Action>,
    /// Files given at the start that are still being loaded: rendering waits for them.
    awaited: usize,
    shared: Shared,
    panels: Panels,
    workspaces: Workspaces,
    layout: Tree<Pane>,
    is_maximised: bool,
    viewport: Viewport,
    dialogs: Dialogs,
    sheet: Sheet,
    manual: Manual,
    turntable: TurntableSheet,
    export: ExportSheet,
    files: handlers::files::Files,
    autosave: Autosave,
    /// What crashes left and the user has not decided about.
    leftovers: Vec<Leftover>,
    unsaved: Unsaved,
    /// The file that a screenshot is wanted for.
    window_picture: Option<PathBuf>,
    title: String,
    theme: egui::ThemePreference,
}

/// What a new document is: the still life, or for files to come the default document.
fn new_document(denoise: Denoise, is_for_files: bool) -> Document {
    let mut document = if is_for_files {
        Document::default()
    } else {
        still_life()
    };
    document.view.denoise = denoise;
    document
}

impl App {
    /// The editor in a window.
    pub fn new(creation: &eframe::CreationContext<'_>, options: Options) -> io::Result<Self> {
        theme::install(&creation.egui_ctx);
        let kept = settings::KeptSettings::load(creation);
        creation.egui_ctx.set_theme(kept.theme);
        let ctx = creation.egui_ctx.clone();
        let repaint = || {
            let ctx = ctx.clone();
            move || ctx.request_repaint()
        };
        // The command line overrides what was chosen in the window.
        let engine = match options.engine {
            EngineChoice::Auto => kept.engine,
            given => given,
        };
        let worker = Worker::spawn(engine, repaint())?;
        let queue = Queue::new(worker.assets().clone(), repaint())?;
        let document = options
            .document
            .unwrap_or_else(|| new_document(kept.denoise, !options.files.is_empty()));
        let folder = |name: &str| options.data.as_ref().map(|data| data.join(name));
        let (workspaces, layout) = Workspaces::new(kept.workspaces, options.workspace);
        let mut app = Self {
            edits: Edits::new(document.clone()),
            document,
            worker,
            submitted: None,
            submitted_resolution: Resolution::default(),
            keep_pictures_from: options.keep_pictures_from.unwrap_or(KEPT_FROM),
            submitted_at: Instant::now(),
            revision: 0,
            queue: Vec::new(),
            awaited: 0,
            shared: Shared {
                selection: Selection::default(),
                messages: Vec::new(),
                pictures: Pictures::new(options.cache),
                recent: Recent::new(kept.recent),
                import_lobe: kept.import_lobe,
                rendering: Rendering {
                    engine,
                    kept_engine: kept.engine,
                    is_paused: false,
                    is_measuring: false,
                },
                viewing: Viewing {
                    resolution: options.resolution.unwrap_or(kept.resolution),
                    ..Viewing::default()
                },
                look: services::look::Look::default(),
                offers_downloads: options.offers_downloads,
                view_angle_deg: VIEW_ANGLE_DEG,
                measured: None,
                library: Folder::new(folder("materials")),
                shelves: services::shelves::Shelves::new(kept.shelves),
                snapshots: Folder::new(folder("snapshots")),
                compare: compare::Compare::default(),
                queue,
                reference: services::reference::ReferenceImage::default(),
            },
            panels: Panels::default(),
            workspaces,
            layout,
            is_maximised: false,
            viewport: Viewport::default(),
            dialogs: options.typed_paths.map(Dialogs::typed).unwrap_or_default(),
            sheet: Sheet::None,
            manual: Manual::new(options.pages),
            turntable: TurntableSheet::default(),
            export: ExportSheet::default(),
            files: handlers::files::Files::new(ctx.clone())?,
            autosave: match options.data {
                Some(data) => {
                    let interval = options.autosave_interval.unwrap_or(autosave::INTERVAL);
                    Autosave::begin(data.join("recovery"), interval, ctx)?
                }
                None => Autosave::default(),
            },
            leftovers: Vec::new(),
            unsaved: Unsaved::default(),
            window_picture: None,
            title: String::new(),
            theme: kept.theme,
        };
        app.change_library(Change::List);
        app.change_snapshots(Change::List);
        app.awaited += app.open_all(options.files);
        Ok(app)
    }

    /// The document as edited.
    pub fn document(&self) -> &Document {
        &self.document
    }

    pub fn snapshot(&self) -> Arc<Snapshot> {
        self.worker.snapshot()
    }

    /// What is rendered.
    fn scene(&self) -> Option<Arc<Scene>> {
        self.worker.snapshot().scene.clone()
    }

    /// Whether the image shown is the finished one of the document as it is.
    pub fn is_settled(&self) -> bool {
        let snapshot = self.worker.snapshot();
        self.submitted.is_some()
            && snapshot.activity == Activity::Done
            && snapshot
                .picture
                .as_deref()
                .is_some_and(|picture| self.is_whole(picture))
    }

    /// Whether a file, a model or an environment that was asked for is still being opened: an edit to come.
    pub fn is_opening(&self) -> bool {
        self.files.is_reading() || self.worker.is_opening()
    }

    /// Has something done in the next frame, as if it had been chosen from a menu.
    pub fn request(&mut self, action: Action) {
        self.queue.push(action);
    }

    /// Brings a panel to the front.
    pub fn reveal(&mut self, pane: Pane) {
        self.maximise(false);
        layout::reveal(&mut self.layout, pane);
    }

    fn maximise(&mut self, is_maximised: bool) {
        if std::mem::replace(&mut self.is_maximised, is_maximised) != is_maximised {
            layout::set_maximised(&mut self.layout, is_maximised);
        }
    }

    /// What was said so far, oldest first.
    pub fn messages(&self) -> Vec<String> {
        self.shared.messages.iter().map(|entry| entry.text.clone()).collect()
    }

    fn report(&mut self, level: Level, text: impl Into<String>) {
        self.say(LogEntry::new(level, text.into()));
    }

    fn note(&mut self, text: impl Into<String>) {
        self.report(Level::Info, text);
    }

    fn warn(&mut self, text: impl Into<String>) {
        self.report(Level::Warning, text);
    }

    fn fail(&mut self, error: impl ToString) {
        self.report(Level::Error, error.to_string());
    }

    /// What was asked for; where there is none, the reason is reported.
    fn taken<T>(&mut self, outcome: Result<T, impl ToString>) -> Option<T> {
        outcome.map_err(|error| self.fail(error)).ok()
    }

    fn say(&mut self, entry: LogEntry) {
        messages::add(&mut self.shared.messages, entry);
    }

    fn say_all(&mut self, entries: impl IntoIterator<Item = LogEntry>) {
        entries.into_iter().for_each(|entry| self.say(entry));
    }

    fn take_events(&mut self, ctx: &egui::Context) {
        self.take_files(ctx);
        self.take_autosave_reports();
        for ended in self.shared.queue.take_news() {
            self.report_outcome(ended.map(LogEntry::done));
        }
        if self.awaited > 0 && self.files.is_reading() {
            // Projects and materials first, whichever is read faster: a model given beside a project changes it.
            return;
        }
        for event in self.worker.take_events() {
            let is_start = self.awaited > 0 && self.edits.is_saved(&self.document);
            match event {
                Event::Message(level, text) => {
                    self.report(level, text);
                    continue;
                }
                Event::ModelOpened(source, options, model) => {
                    if let ModelSource::File(path) = &source {
                        self.note_opened(path);
                    }
                    let report = import_report(&model, self.shared.import_lobe);
                    messages::add_import(&mut self.shared.messages, &model.name, &report);
                    self.adopt_model(source, options, &model);
                    self.use_dropped_with(&model);
                    self.count_as_start(is_start);
                }
                Event::EnvironmentOpened(source, _) => {
                    if let EnvironmentSource::File(path) = &source {
                        self.note_opened(path);
                    }
                    self.document.lighting.environment = source;
                    self.match_ground();
                    self.edits.did(ENVIRONMENT_CHANGED);
                    self.count_as_start(is_start);
                }
                Event::Reloaded(before, model) => {
                    self.adopt_reloaded(before, model);
                    continue;
                }
                Event::Cancelled => {
                    self.take_back_cancelled(ctx);
                    continue;
                }
                Event::OpenFailed(_, level, why) => self.report(level, why),
            }
            self.awaited = self.awaited.saturating_sub(1);
        }
    }

    fn note_opened(&mut self, path: &Path) {
        self.note(format!("opened {}", path.display()));
        self.shared.recent.add(path);
    }

    fn desk_material(&self) -> MaterialSettings {
        self.document.material(self.shared.selection.slot)
    }

    /// Records what was edited since this was last done.
    fn record(&mut self, is_dragging: bool) {
        if self.edits.record(&self.document, is_dragging) {
            let label = self.edits.history.undo_label().unwrap_or("an edit undone");
            self.autosave.witness.note(label);
        }
    }

    /// Thumbnails of materials wait until the image is there, and while something is being changed; so do renders.
    fn hold_thumbnails(&self, ctx: &egui::Context) {
        let has_picture = self.worker.snapshot().picture.is_some();
        let is_changing = is_dragging(ctx) || self.edits.is_in_flow();
        self.shared.pictures.hold(!has_picture || is_changing);
        self.shared.queue.give_way(is_changing);
        // The release of a button is a frame of its own.
        if is_changing && !is_dragging(ctx) {
            ctx.request_repaint_after(MOVING);
        }
    }

    fn show(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        let snapshot = self.worker.snapshot();
        let frame = |fill, across| {
            egui::Frame::new()
                .fill(fill)
                .inner_margin(egui::Margin::symmetric(across, 3))
        };
        let bar = frame(ui.visuals().panel_fill, 8);
        egui::Panel::top("menu")
            .frame(bar)
            .show_separator_line(false)
            .show(ui, |ui| {
                // With the viewport alone all of them can be brought back.
                let is_open = |pane| !self.is_maximised && layout::is_open(&self.layout, pane);
                let chosen = (self.shared.import_lobe, self.shared.rendering.engine);
                let names: Vec<&str> = self.workspaces.names().collect();
                let panels = ((names.as_slice(), self.workspaces.current()), is_open);
                menu::bar(ui, &self.edits, &mut self.shared.recent, chosen, panels, actions);
            });
        egui::Panel::bottom("status")
            .frame(bar)
            .show_separator_line(false)
            .exact_size(theme::BAR_HEIGHT)
            .show(ui, |ui| {
                status::show(ui, &snapshot, self.shared.viewing.measures, actions);
            });
        let ground = frame(theme::ground(ui.visuals().dark_mode), 0);
        egui::CentralPanel::default().frame(ground).show(ui, |ui| {
            let mut desk = Desk {
                document: &mut self.document,
                snapshot: &snapshot,
                edits: &mut self.edits,
                actions,
                shared: &mut self.shared,
            };
            desk.shared.viewing.measures = self.workspaces.current() == workspaces::MEASURE;
            self.panels.tick(&mut desk);
            let mut panes = layout::Panes {
                hidden: layout::hidden_tabs(ui, &self.layout),
                desk: &mut desk,
                panels: &mut self.panels,
                viewport: &mut self.viewport,
            };
            self.layout.ui(&mut panes, ui);
        });
        let material = self.desk_material();
        let scene = self.scene().filter(|scene| scene.document.model == self.document.model);
        let scene = scene.as_ref();
        let model = (scene.map(|scene| scene.model.as_ref()), self.shared.import_lobe);
        menu::sheet(ui.ctx(), &mut self.sheet, (&self.document, &material), model, actions);
        match self.dialogs.show(ui, &self.shared.recent.paths) {
            Some((purpose, Some(path))) => self.chosen(purpose, path),
            Some((purpose, None)) if purpose.is_saving() => self.report_unsaved(purpose),
            _ => {}
        }
        self.show_turntable(ui.ctx());
        self.show_export(ui.ctx());
        self.show_recovery(ui.ctx());
        self.show_question(ui.ctx());
        self.show_queue_question(ui.ctx());
        let is_covered = self.is_covered();
        self.manual.show(ui.ctx(), is_covered);
    }

    /// Whether something lies over the window that takes the keys.
    fn is_covered(&self) -> bool {
        let is_asked = self.dialogs.is_open()
            || self.turntable.is_open
            || self.export.is_open()
            || self.unsaved.is_open()
            || !self.leftovers.is_empty();
        is_asked || self.sheet != Sheet::None
    }

    fn save_for_recovery(&mut self, ctx: &egui::Context) {
        if let Some(engine) = &self.worker.snapshot().engine {
            self.autosave.witness.known().engine = engine.to_string();
        }
        let is_saved = self.edits.is_saved(&self.document);
        let project = self.files.project.as_deref();
        if let Some(wait) = self.autosave.watch(&self.document, project, is_saved) {
            ctx.request_repaint_after(wait);
        }
    }

    fn set_title(&mut self, ctx: &egui::Context) {
        let mark = if self.edits.is_saved(&self.document) { "" } else { " *" };
        let title = format!("{}{mark} – Glossmith", self.files.project_name());
        if title != self.title {
            ctx.send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }
}

/// Whether a button of the pointer is held.
fn is_dragging(ctx: &egui::Context) -> bool {
    ctx.input(|input| input.pointer.any_down())
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        settings::fit_to_screen(&ctx);
        self.take_events(&ctx);
        self.watch_files(&ctx);
        self.picture_window(&ctx);
        let mut actions = std::mem::take(&mut self.queue);
        keys::hold_typing(&ctx);
        if !self.is_covered() {
            actions.extend(actions::pressed(&ctx, self.viewport.id()).map(Action::Do));
        } else if ctx.input_mut(|input| input.consume_key(egui::Modifiers::NONE, egui::Key::F1)) {
            actions.push(Action::Do(actions::Command::Manual));
        }
        self.shared.selection.begin_frame();
        self.shared.look.begin_frame();
        self.show(ui, &mut actions);
        let scene = self.scene();
        let loaded = scene
            .as_ref()
            .map(|scene| (&scene.document.lighting.environment, &scene.job.environment));
        self.shared.pictures.make(&ctx, loaded);
        let look = &self.shared.look;
        if look.is_shown != look.was_shown {
            self.worker.set_inspected(look.is_shown);
            ctx.request_repaint();
        }
        if self.shared.selection.is_news() {
            ctx.request_repaint();
        }
        // After the viewport, which selects what a file is dropped on.
        let focused = ctx.memory(|memory| memory.focused());
        let takes_text = !self.is_covered() && focused.is_none_or(|id| Some(id) == self.viewport.id());
        actions.extend(models::handed_over(&ctx, takes_text));
        for action in actions {
            self.apply(&ctx, action);
        }
        self.record_and_submit(&ctx);
        self.hand_over_pictures(&ctx);
        self.retake_snapshot();
        self.hold_thumbnails(&ctx);
        self.save_for_recovery(&ctx);
        self.guard_close(&ctx);
        self.set_title(&ctx);
    }

    fn on_exit(&mut self) {
        self.autosave.end();
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        let mut layout = self.layout.clone();
        layout::set_maximised(&mut layout, false);
        settings::KeptSettings {
            allowed: crate::import::limits::allowed(),
            theme: self.theme,
            workspaces: self.workspaces.with(layout),
            resolution: self.shared.viewing.resolution,
            import_lobe: self.shared.import_lobe,
            engine: self.shared.rendering.kept_engine,
            denoise: self.document.view.denoise,
            recent: self.shared.recent.paths.clone(),
            shelves: self.shared.shelves.kept.clone(),
        }
        .save(storage);
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        theme::ground(visuals.dark_mode).to_normalized_gamma_f32()
    }

    // Positions of panels are kept with the layout; egui's own memory would bring back open menus and old sizes.
    fn persist_egui_memory(&self) -> bool {
        false
    }
}
