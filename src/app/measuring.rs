//! What the panels that measure share: a study beside the window, which can be stopped and shows how far it has come.

use std::{
    sync::Arc,
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, Instant},
};

use egui::Ui;

use crate::{
    actions::Command,
    desk::Desk,
    document::Change,
    document::Document,
    kit::{start_stop::Pressed, start_stop::start_or_stop, widgets, words::time_left},
    render::EngineChoice,
    services::beside::Beside,
    study::{StudyError, StudyProgress, Watch},
};

/// How often what is left is updated.
const REPORT_INTERVAL: Duration = Duration::from_millis(500);

/// What is to be done.
type Work<R> = Box<dyn FnOnce(&mut Watch<'_>) -> Result<R, StudyError> + Send>;

/// How a study stands.
#[derive(Clone)]
enum Status<R> {
    Running(StudyProgress),
    Done(Arc<R>),
    Failed(String),
}

/// A study and its thread.
pub struct StudyWorker<R> {
    worker: Beside<Work<R>, Status<R>>,
    /// Stops it; another for each start after a stop.
    pub stop: Arc<AtomicBool>,
    /// When it was started, where its end has not been noticed.
    begun: Option<Instant>,
    /// It was stopped: its thread may still be at a step that can't be interrupted, and is left behind.
    is_stopped: bool,
    /// The viewport's renderer was stopped for it.
    holds_renderer: bool,
    /// It is to be started as soon as it is shown.
    is_requested: bool,
    /// The document that it was asked about last, and what its outcome made of it.
    asked: Vec<Document>,
}

impl<R> Default for StudyWorker<R> {
    fn default() -> Self {
        Self {
            worker: Beside::default(),
            stop: Arc::default(),
            begun: None,
            is_stopped: false,
            holds_renderer: false,
            is_requested: false,
            asked: Vec::new(),
        }
    }
}

impl<R> Drop for StudyWorker<R> {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

impl<R: Clone + Send + Sync + 'static> StudyWorker<R> {
    /// Whether it runs, as far as the window is concerned.
    pub fn is_running(&self) -> bool {
        self.worker.is_busy()
    }

    /// Notices that the study has ended, and has the viewport's renderer go on where it was stopped for it. To be called
    /// in each frame, whether its panel is seen or not.
    pub fn tick(&mut self, desk: &mut Desk<'_>) {
        if self.begun.is_none() || self.is_running() {
            return;
        }
        self.begun = None;
        desk.shared.rendering.is_measuring = false;
        if std::mem::take(&mut self.holds_renderer) && desk.shared.rendering.is_paused {
            desk.act(Command::Pause);
        }
    }

    /// Starts the study when its controls are shown next, unless it runs.
    pub fn request(&mut self) {
        self.is_requested = true;
    }

    /// A button that starts the study with what it will take, and while it runs what it does, what is left of it, and a
    /// button that stops it. The viewport's renderer `rests` meanwhile where it would take part of the time that is measured.
    /// `takes` says how long the study takes, as far as that is known; `begin` makes the work.
    pub fn controls(
        &mut self,
        ui: &mut Ui,
        desk: &mut Desk<'_>,
        (label, help, rests): (&str, &str, bool),
        takes: Option<String>,
        begin: impl FnOnce(&Desk<'_>) -> Work<R>,
    ) {
        let is_busy = self.is_running();
        // Two at once would take each other's time.
        let is_free = !desk.shared.rendering.is_measuring;
        let is_requested = is_free && std::mem::take(&mut self.is_requested);
        ui.horizontal_wrapped(|ui| {
            let dress = |button: egui::Response| {
                let button = widgets::explained(button, help);
                button.on_disabled_hover_text("Something else is being measured.")
            };
            let pressed = start_or_stop(ui, label, is_busy, is_free, dress);
            if pressed == Pressed::Stop {
                self.stop.store(true, Ordering::Relaxed);
                (self.stop, self.worker, self.is_stopped) = (Arc::default(), Beside::default(), true);
            } else if pressed == Pressed::Start || (is_requested && !is_busy) {
                self.asked = vec![desk.document.clone()];
                let work = begin(desk);
                self.begin(ui, work);
                self.begun = Some(Instant::now());
                desk.shared.rendering.is_measuring = true;
                if rests && !desk.shared.rendering.is_paused {
                    self.holds_renderer = true;
                    desk.act(Command::Pause);
                }
            }
            if let Some(takes) = takes.filter(|_| !is_busy) {
                ui.weak(takes);
            }
        });
        let standing = self.worker.latest();
        widgets::comes_and_goes(ui, |ui| match standing {
            _ if self.is_stopped => widgets::note(ui, "Stopped."),
            Some(Status::Running(progress)) if is_busy => self.progress(ui, &progress),
            Some(Status::Failed(why)) => {
                ui.colored_label(ui.visuals().error_fg_color, why);
            }
            _ => {}
        });
        widgets::comes_and_goes(ui, |ui| widgets::failure(ui, self.worker.failure()));
        let is_stale = rests && self.found().is_some() && self.is_stale(desk);
        widgets::comes_and_goes(ui, |ui| {
            if is_stale {
                widgets::note(ui, "Measured before the last changes.");
            }
        });
    }

    /// How far it is, and what becomes of the viewport meanwhile.
    fn progress(&self, ui: &mut Ui, progress: &StudyProgress) {
        ui.add(egui::ProgressBar::new(progress.share as f32).desired_height(6.0));
        let seconds = self.begun.map_or(0.0, |begun| begun.elapsed().as_secs_f64());
        let left = time_left(progress.share, seconds).map_or_else(String::new, |left| format!(" · {left}"));
        widgets::note(ui, format!("{}{left}", progress.what));
        let text = "You can go on editing: this measures the scene as it was at the start. Until it ends the viewport shows \
             edits with one sample.";
        if self.holds_renderer {
            widgets::note(ui, text);
        }
        ui.ctx().request_repaint_after(REPORT_INTERVAL);
    }

    /// Whether the document is another one by now than what was asked about.
    pub fn is_stale(&self, desk: &Desk<'_>) -> bool {
        let is_it = |asked: &Document| !Change::between(asked, desk.document).restarts();
        !self.asked.iter().any(is_it)
    }

    /// Takes note of what the outcome made of the document: it holds for that, too.
    pub fn holds_for(&mut self, document: &Document) {
        self.asked.push(document.clone());
    }

    fn begin(&mut self, ui: &Ui, work: Work<R>) {
        self.is_stopped = false;
        let stop = self.stop.clone();
        self.worker
            .ask_again(ui.ctx(), "study", work, move |work: Work<R>, responder| {
                let mut watch = |progress| {
                    responder.publish(Status::Running(progress));
                    !stop.load(Ordering::Relaxed) && !responder.is_superseded()
                };
                match work(&mut watch) {
                    Ok(result) => responder.publish(Status::Done(Arc::new(result))),
                    Err(StudyError::Stopped) => {}
                    Err(error) => responder.publish(Status::Failed(error.to_string())),
                }
            });
    }

    /// What was found last.
    pub fn found(&self) -> Option<Arc<R>> {
        match self.worker.latest()? {
            Status::Done(found) => Some(found),
            _ => None,
        }
    }
}

/// The engine that the viewport renders with.
pub fn engine(desk: &Desk<'_>) -> EngineChoice {
    let engine = desk.snapshot.engine.as_ref();
    engine.map_or(EngineChoice::Cpu, |engine| engine.kind.into())
}

/// The document as it is rendered, so small that a race is short.
pub fn small_document(desk: &Desk<'_>, side_max: u32) -> Document {
    let mut document = desk.document.clone();
    let size = desk.snapshot.scene.as_ref().map(|scene| scene.job.settings.image_size);
    let [width, height] = size.unwrap_or([document.render.width, document.render.height]);
    let scale = f64::from(side_max) / f64::from(width.max(height).max(side_max));
    let side = |length: u32| ((f64::from(length) * scale).round() as u32).max(1);
    (document.render.width, document.render.height) = (side(width), side(height));
    document
}
