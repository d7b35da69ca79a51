//! The hard cases, a line each with its verdict and, where it renders one, its image.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use egui::{ColorImage, TextureHandle, TextureOptions, Ui, vec2};

use crate::app::kit::start_stop::{Pressed, start_or_stop};
use crate::app::kit::widgets;
use crate::app::kit::words::time_left;
use crate::app::services::beside::{Repaint, started};
use crate::document::ViewSettings;
use crate::render::EngineChoice;
use crate::render::background::Background;
use crate::render::display::display;
use crate::render::priority::work_apart;
use crate::study::hard::{HardError, HardOptions, HardRow, Stage, catalogue};

/// Side of a case's image in points.
const PICTURE_SIDE: f32 = 40.0;

/// How a run stands: the rows so far, and what is being run or went wrong.
#[derive(Clone, Default)]
struct Status {
    rows: Vec<HardRow>,
    running: Option<&'static str>,
    error: Option<String>,
    /// When it began; `None` once it has ended.
    begun: Option<Instant>,
}

impl Status {
    /// What is being run, which it is of how many, and what is left.
    fn doing(&self, name: &str) -> String {
        let (done, all) = (self.rows.len(), catalogue().count());
        let seconds = self.begun.map_or(0.0, |begun| begun.elapsed().as_secs_f64());
        let left = time_left(done as f64 / all as f64, seconds).map_or_else(String::new, |left| format!(", {left}"));
        format!("{} ({} of {all}{left})", in_words(name), done + 1)
    }
}

/// What the page remembers.
#[derive(Default)]
pub struct HardState {
    worker: Option<Background<HardOptions, Status>>,
    stop: Arc<AtomicBool>,
    /// What a run that was stopped had found.
    stopped: Option<Status>,
    /// Images by case, as textures of this run.
    textures: Vec<(&'static str, TextureHandle)>,
}

impl HardState {
    /// Ends a run at once as far as the window is concerned: its thread ends at its next look, and is not waited for, as a
    /// driver that compiles can't be interrupted.
    fn stop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        self.stopped = self.worker.take().map(|worker| worker.latest().unwrap_or_default());
        self.stop = Arc::default();
    }
}

impl Drop for HardState {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

/// The page, for the engine that renders.
pub fn show(ui: &mut Ui, state: &mut HardState, engine: EngineChoice) {
    widgets::note(
        ui,
        "Places where naive code breaks, each with what it does here: measured against its limit.",
    );
    let Some(worker) = started(&mut state.worker, ui.ctx(), |repaint| spawn(repaint, &state.stop)) else {
        widgets::note(ui, "Cannot start a thread to check.");
        return;
    };
    let row = ui.horizontal(|ui| start_or_stop(ui, "Run the hard cases", worker.is_busy(), true, |button| button));
    widgets::comes_and_goes(ui, |ui| widgets::failure(ui, worker.failure()));
    let standing = worker.latest();
    match row.inner {
        Pressed::Start => {
            state.textures.clear();
            state.stopped = None;
            worker.ask(HardOptions {
                engine,
                thorough: false,
                only: String::new(),
            });
        }
        Pressed::Stop => state.stop(),
        Pressed::Nothing => {}
    }
    let is_stopped = state.stopped.is_some();
    let Some(standing) = state.stopped.clone().or(standing) else {
        return;
    };
    widgets::comes_and_goes(ui, |ui| match standing.running {
        _ if is_stopped => widgets::note(ui, "Stopped."),
        Some(name) => widgets::note(ui, standing.doing(name)),
        None => {}
    });
    if let Some(error) = &standing.error {
        ui.colored_label(ui.visuals().error_fg_color, error);
    }
    egui::Grid::new("hard cases")
        .num_columns(3)
        .striped(true)
        .show(ui, |ui| {
            for row in &standing.rows {
                line(ui, row, &mut state.textures);
                ui.end_row();
            }
        });
}

/// The thread that runs the cases, apart from those that render.
fn spawn(repaint: Repaint, stop: &Arc<AtomicBool>) -> io::Result<Background<HardOptions, Status>> {
    let stop = stop.clone();
    Background::spawn("hard cases", repaint, move |options, responder| {
        work_apart();
        run(&options, &stop, &|standing| responder.publish(standing));
    })
}

/// Runs case after case, publishing after each, until it is stopped.
fn run(options: &HardOptions, stop: &Arc<AtomicBool>, publish: &dyn Fn(Status)) {
    let mut standing = Status {
        begun: Some(Instant::now()),
        ..Status::default()
    };
    let mut stage = match Stage::open(options.engine, options.thorough) {
        Ok(stage) => stage.until(stop.clone()),
        Err(error) => {
            standing.error = Some(error.to_string());
            return publish(standing);
        }
    };
    for case in catalogue() {
        standing.running = Some(case.name);
        publish(standing.clone());
        match case.run(&mut stage) {
            Ok(row) => standing.rows.push(row),
            Err(HardError::Stopped) => return,
            Err(error) => standing.error = Some(error.to_string()),
        }
    }
    standing.running = None;
    publish(standing);
}

fn line(ui: &mut Ui, row: &HardRow, textures: &mut Vec<(&'static str, TextureHandle)>) {
    let HardRow {
        case, check, picture, ..
    } = row;
    match picture {
        Some(image) => {
            let known = textures.iter().find(|(name, _)| *name == case.name);
            let texture = known.map(|(_, texture)| texture.clone()).unwrap_or_else(|| {
                let pixels = display(image, &ViewSettings::default());
                let size = [image.width as usize, image.height as usize];
                let image = ColorImage::from_rgba_unmultiplied(size, &pixels);
                let texture = ui.ctx().load_texture(case.name, image, TextureOptions::NEAREST);
                textures.push((case.name, texture.clone()));
                texture
            });
            ui.add(egui::Image::new(&texture).fit_to_exact_size(vec2(PICTURE_SIDE, PICTURE_SIDE)));
        }
        None => {
            ui.weak(case.group);
        }
    }
    let tooltip = format!("{}\n\n{}\n\n{}", case.danger, case.made, case.must);
    ui.label(in_words(case.name)).on_hover_text(tooltip);
    let [value, most] = check.texts();
    let verdict = format!("{} {value}", check.measure);
    let hover = format!("at most {most}; naive: {}", (case.naive)());
    if check.passed {
        ui.label(format!("✔ {verdict}")).on_hover_text(hover);
    } else {
        ui.colored_label(ui.visuals().error_fg_color, format!("✖ {verdict}"))
            .on_hover_text(hover);
    }
}

/// A case's name as a person would write it.
fn in_words(name: &str) -> String {
    name.replace('-', " ")
}
