//! What the panels that measure share: a study beside the window, which can be stopped and shows how far it has come.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use egui::Ui;

use crate::app::actions::Command;
use crate::app::desk::Desk;
use crate::app::kit::start_stop::{Pressed, start_or_stop};
use crate::app::kit::widgets;
use crate::document::{Change, Document};
use crate::render::EngineChoice;
use crate::render::background::Background;
use crate::render::study::{StudyError, StudyProgress, Watch};

/// What is to be done.
type Work<R> = Box<dyn FnOnce(&mut Watch<'_>) -> Result<R, StudyError> + Send>;

/// How a study stands.
#[derive(Clone)]
enum Standing<R> {
    Running(StudyProgress),
    Done(Arc<R>),
    Stopped,
    Failed(String),
}

/// A study and its thread.
pub(super) struct StudyWorker<R> {
    worker: Option<Background<Work<R>, Standing<R>>>,
    stop: Arc<AtomicBool>,
    /// It was started, and its end has not been noticed.
    has_begun: bool,
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
            worker: None,
            stop: Arc::default(),
            has_begun: false,
            holds_renderer: false,
            is_requested: false,
            asked: Vec::new(),
        }
    }
}

impl<R: Clone + Send + Sync + 'static> StudyWorker<R> {
    /// Whether it runs.
    pub(super) fn is_running(&self) -> bool {
        self.worker.as_ref().is_some_and(Background::is_busy)
    }

    /// Notices that the study has ended, and has the viewport's renderer go on where it was stopped for it. To be called
    /// in each frame, whether its panel is seen or not.
    pub(super) fn tick(&mut self, desk: &mut Desk<'_>) {
        if !self.has_begun || self.is_running() {
            return;
        }
        self.has_begun = false;
        desk.shared.is_measuring = false;
        if std::mem::take(&mut self.holds_renderer) && desk.shared.is_paused {
            desk.act(Command::Pause);
        }
    }

    /// Starts the study when its controls are shown next, unless it runs.
    pub(super) fn request(&mut self) {
        self.is_requested = true;
    }

    /// A button that starts the study, and while it runs what it does and a button that stops it. The viewport's
    /// renderer rests meanwhile: it would take part of the time that is measured. `begin` makes the work.
    pub(super) fn controls(
        &mut self,
        ui: &mut Ui,
        desk: &mut Desk<'_>,
        label: &str,
        help: &str,
        begin: impl FnOnce(&Desk<'_>) -> Work<R>,
    ) {
        let is_busy = self.is_running();
        // Two at once would take each other's time.
        let is_free = !desk.shared.is_measuring;
        let is_requested = is_free && std::mem::take(&mut self.is_requested);
        ui.horizontal(|ui| {
            let dress = |button: egui::Response| {
                let button = button.on_hover_text(help);
                button.on_disabled_hover_text("Something else is being measured.")
            };
            let pressed = start_or_stop(ui, label, is_busy, is_free, dress);
            if pressed == Pressed::Stop {
                self.stop.store(true, Ordering::Relaxed);
            } else if pressed == Pressed::Start || (is_requested && !is_busy) {
                self.asked = vec![desk.document.clone()];
                let work = begin(desk);
                self.begin(ui, work);
                self.has_begun = true;
                desk.shared.is_measuring = true;
                if !desk.shared.is_paused {
                    self.holds_renderer = true;
                    desk.act(Command::Pause);
                }
            }
        });
        let standing = self.worker.as_ref().and_then(Background::latest);
        widgets::comes_and_goes(ui, |ui| match standing {
            Some(Standing::Running(progress)) if is_busy => {
                ui.add(egui::ProgressBar::new(progress.share as f32).desired_height(6.0));
                widgets::note(ui, progress.what);
            }
            Some(Standing::Failed(why)) => {
                ui.colored_label(ui.visuals().error_fg_color, why);
            }
            Some(Standing::Stopped) => widgets::note(ui, "Stopped."),
            _ => {}
        });
        widgets::comes_and_goes(ui, |ui| {
            widgets::failure(ui, self.worker.as_ref().and_then(Background::failure))
        });
        let is_stale = self.found().is_some() && self.is_stale(desk);
        widgets::comes_and_goes(ui, |ui| {
            if is_stale {
                widgets::note(ui, "Measured before the last changes.");
            }
        });
    }

    /// Whether the document is another one by now than what was asked about.
    pub(super) fn is_stale(&self, desk: &Desk<'_>) -> bool {
        let is_it = |asked: &Document| !Change::between(asked, desk.document).restarts();
        !self.asked.iter().any(is_it)
    }

    /// Takes note of what the outcome made of the document: it holds for that, too.
    pub(super) fn holds_for(&mut self, document: &Document) {
        self.asked.push(document.clone());
    }

    fn begin(&mut self, ui: &Ui, work: Work<R>) {
        self.stop.store(false, Ordering::Relaxed);
        if self.worker.is_none() {
            let (ctx, stop) = (ui.ctx().clone(), self.stop.clone());
            let body = move |work: Work<R>, desk: &crate::render::background::Responder<'_, Work<R>, Standing<R>>| {
                let mut watch = |progress| {
                    desk.publish(Standing::Running(progress));
                    !stop.load(Ordering::Relaxed) && !desk.is_superseded()
                };
                desk.publish(match work(&mut watch) {
                    Ok(result) => Standing::Done(Arc::new(result)),
                    Err(StudyError::Stopped) => Standing::Stopped,
                    Err(error) => Standing::Failed(error.to_string()),
                });
            };
            // Without a thread the button does nothing; the log says why.
            match Background::spawn("study", move || ctx.request_repaint(), body) {
                Ok(worker) => self.worker = Some(worker),
                Err(error) => log::error!("cannot start a thread to measure on: {error}"),
            }
        }
        if let Some(worker) = &self.worker {
            worker.ask(work);
        }
    }

    /// What was found last.
    pub(super) fn found(&self) -> Option<Arc<R>> {
        match self.worker.as_ref()?.latest()? {
            Standing::Done(found) => Some(found),
            _ => None,
        }
    }
}

/// The engine that the viewport renders with.
pub(super) fn engine(desk: &Desk<'_>) -> EngineChoice {
    let engine = desk.snapshot.engine.as_ref();
    engine.map_or(EngineChoice::Cpu, |engine| engine.kind.into())
}

/// The document as it is rendered, so small that a race is short.
pub(super) fn small_document(desk: &Desk<'_>, side_max: u32) -> Document {
    let mut document = desk.document.clone();
    let size = desk.snapshot.scene.as_ref().map(|scene| scene.job.settings.image_size);
    let [width, height] = size.unwrap_or([document.render.width, document.render.height]);
    let scale = f64::from(side_max) / f64::from(width.max(height).max(side_max));
    let side = |length: u32| ((f64::from(length) * scale).round() as u32).max(1);
    (document.render.width, document.render.height) = (side(width), side(height));
    document
}
