//! The turntable: what turns and how often it is taken, then a renderer of its own beside the window.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use egui::Ui;

use crate::app::kit::{theme, widgets};
use crate::document::Document;
use crate::document::turntable::Turn;
use crate::render::background::{self, Background};
use crate::render::turntable::{Turntable, TurntableProgress, render};
use crate::render::{EngineChoice, Session};

/// Frames at first.
const FRAMES: u32 = 36;

/// How a turntable stands.
#[derive(Clone, Debug)]
enum State {
    Progress(TurntableProgress),
    /// What to say in the end.
    Done(Result<String, String>),
}

/// What is rendered, with what, and whether it is to go on.
struct Order {
    table: Turntable,
    engine: EngineChoice,
    is_cancelled: Arc<AtomicBool>,
}

type Renderer = Background<Order, State>;

/// The sheet, and the turntable that is being rendered.
pub(in crate::app) struct TurntableSheet {
    pub(in crate::app) is_open: bool,
    frames: u32,
    turn: Turn,
    pub(in crate::app) samples: u32,
    pub(in crate::app) size: [u32; 2],
    pub(in crate::app) folder: String,
    pub(in crate::app) running: Option<Running>,
}

/// A turntable that is being rendered.
pub(in crate::app) struct Running {
    renderer: Renderer,
    is_cancelled: Arc<AtomicBool>,
    frames: u32,
}

impl Default for TurntableSheet {
    fn default() -> Self {
        Self {
            is_open: false,
            frames: FRAMES,
            turn: Turn::default(),
            samples: 0,
            size: [0; 2],
            folder: String::new(),
            running: None,
        }
    }
}

impl Drop for TurntableSheet {
    fn drop(&mut self) {
        if let Some(running) = &self.running {
            running.is_cancelled.store(true, Ordering::Relaxed);
        }
    }
}

impl TurntableSheet {
    /// Whether it lies over the window.
    pub(in crate::app) fn is_open(&self) -> bool {
        self.is_open
    }

    pub(in crate::app) fn order(&self, document: &Document) -> Turntable {
        let mut document = document.clone();
        [document.render.width, document.render.height] = self.size;
        document.render.samples = self.samples;
        document.render.time_s = None;
        Turntable {
            document,
            turn: self.turn,
            frames: self.frames,
            folder: PathBuf::from(self.folder.trim()),
        }
    }

    /// The settings; true to begin.
    pub(in crate::app) fn settings(&mut self, ui: &mut Ui) -> bool {
        let turns: Vec<_> = Turn::ALL
            .iter()
            .map(|turn| (*turn, turn.label(), turn.help()))
            .collect();
        let name = widgets::Name::new("Turntable turn", "Turn", "What turns, anticlockwise seen from above.");
        widgets::row(ui, name, |ui| {
            widgets::choice(ui, "turntable turn", &mut self.turn, &turns)
        });
        let mut number =
            |name: &str, label: &str, help: &str, value: &mut u32, range: std::ops::RangeInclusive<f64>| {
                let style = widgets::NumberStyle {
                    range,
                    bar: None,
                    unit: "",
                    speed: 0.2,
                    decimals: 0,
                };
                widgets::row(ui, widgets::Name::new(name, label, help), |ui| {
                    widgets::number(ui, value, &style)
                });
            };
        number(
            "Turntable frames",
            "Frames",
            "Pictures of a whole turn.",
            &mut self.frames,
            1.0..=9999.0,
        );
        number(
            "Turntable samples",
            "Samples",
            "Samples a pixel of each.",
            &mut self.samples,
            1.0..=65536.0,
        );
        let [width, height] = &mut self.size;
        number("Turntable width", "Width", "Columns of each.", width, 1.0..=8192.0);
        number("Turntable height", "Height", "Rows of each.", height, 1.0..=8192.0);
        let help =
            "For frame-0001.png, frame-0002.png and so on; made where it is not there. What is there is replaced.";
        widgets::row(ui, widgets::Name::new("Turntable folder", "Folder", help), |ui| {
            ui.add(
                egui::TextEdit::singleline(&mut self.folder)
                    .desired_width(f32::INFINITY)
                    .margin(egui::vec2(6.0, 4.0)),
            )
        });
        ui.add_space(theme::GAP);
        let mut begins = false;
        ui.horizontal(|ui| {
            let is_usable = !self.folder.trim().is_empty();
            begins = ui.add_enabled(is_usable, egui::Button::new("Render frames")).clicked();
            if ui.button("Close").clicked() {
                ui.close();
            }
        });
        begins
    }
}

impl Running {
    pub(in crate::app) fn begin(ctx: &egui::Context, table: Turntable, engine: EngineChoice) -> std::io::Result<Self> {
        let is_cancelled = Arc::new(AtomicBool::new(false));
        let repainting = ctx.clone();
        let work =
            |order: Order, desk: &background::Desk<'_, Order, State>| desk.publish(State::Done(run(&order, desk)));
        let renderer = Renderer::spawn("turntable", move || repainting.request_repaint(), work)?;
        let frames = table.frames;
        renderer.ask(Order {
            table,
            engine,
            is_cancelled: is_cancelled.clone(),
        });
        Ok(Self {
            renderer,
            is_cancelled,
            frames,
        })
    }

    /// What to say in the end, once it has come.
    pub(in crate::app) fn outcome(&self) -> Option<Result<String, String>> {
        match self.renderer.latest() {
            Some(State::Done(done)) => Some(done),
            _ => self.renderer.failure().map(|why| Err(format!("turntable: {why}"))),
        }
    }

    pub(in crate::app) fn show(&self, ui: &mut Ui) {
        let progress = match self.renderer.latest() {
            Some(State::Progress(progress)) => progress,
            _ => TurntableProgress::default(),
        };
        let share = (f64::from(progress.done) + progress.share) / f64::from(self.frames.max(1));
        let text = format!("Frame {} of {}", (progress.done + 1).min(self.frames), self.frames);
        ui.add(egui::ProgressBar::new(share as f32).text(text));
        ui.add_space(theme::GAP);
        ui.horizontal(|ui| {
            if ui.button("Cancel the turntable").clicked() {
                self.is_cancelled.store(true, Ordering::Relaxed);
            }
            if ui
                .button("Go on beside")
                .on_hover_text("Closes this; the frames go on being rendered.")
                .clicked()
            {
                ui.close();
            }
        });
    }
}

/// Renders all frames; the words for the end.
fn run(order: &Order, desk: &background::Desk<'_, Order, State>) -> Result<String, String> {
    let table = &order.table;
    let words = |error: &dyn std::fmt::Display| error.to_string();
    let mut session = Session::open(order.engine).map_err(|error| words(&error))?;
    let mut go_on = |progress| {
        desk.publish(State::Progress(progress));
        !order.is_cancelled.load(Ordering::Relaxed) && !desk.is_superseded()
    };
    let outcome = render(&mut session, table, &mut go_on).map_err(|error| words(&error))?;
    let folder = table.folder.display();
    Ok(if outcome.frames < table.frames {
        format!(
            "turntable cancelled: {} of {} frames are in {folder}",
            outcome.frames, table.frames
        )
    } else {
        format!("turntable: {} frames in {folder}", outcome.frames)
    })
}
