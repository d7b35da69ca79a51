//! The proof on this machine: what `glossmith check` does, as a table.

mod benchmark;
mod hard_cases;

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use egui::Ui;

use benchmark::BenchmarkState;
use hard_cases::HardState;

use super::Panel;
use crate::app::desk::Desk;
use crate::app::kit::start_stop::{Pressed, start_or_stop};
use crate::app::kit::widgets;
use crate::app::kit::words::time_left;
use crate::app::services::beside::{Repaint, started};
use crate::app::study::engine;
use crate::render::background::Background;
use crate::render::priority::work_apart;
use crate::study::check::{Check, CheckOptions, GroupSummary, run, summaries};

/// How a run stands.
#[derive(Clone)]
enum Status {
    /// What is checked, and the share that is done.
    Checking(String, f64),
    Done(Vec<Check>),
    Stopped,
    Failed(String),
}

/// The checks, the hard cases and the benchmark.
#[derive(Default)]
pub struct CheckPanel {
    worker: Option<Background<CheckOptions, Status>>,
    stop: Arc<AtomicBool>,
    /// When it was started.
    begun: Option<Instant>,
    thorough: bool,
    hard: HardState,
    benchmark: BenchmarkState,
}

impl Drop for CheckPanel {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

impl Panel for CheckPanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        let engine = engine(desk);
        let state = self;
        widgets::note(
            ui,
            "Proves on this machine that the image is right: samples against densities, energy, engines and strategies \
             against each other. The viewport goes on meanwhile.",
        );
        let Some(worker) = started(&mut state.worker, ui.ctx(), |repaint| spawn(repaint, &state.stop)) else {
            widgets::note(ui, "Cannot start a thread to check.");
            return;
        };
        ui.checkbox(&mut state.thorough, "Thorough")
            .on_hover_text("Every lobe at every roughness and angle, with more samples: takes minutes.");
        // Stopped, it has ended as far as the window is concerned, though its thread may still be at a last step.
        let is_stopped = state.stop.load(Ordering::Relaxed);
        let is_running = worker.is_busy() && !is_stopped;
        let dress =
            |button: egui::Response| button.on_disabled_hover_text("The last step of the check is still ending.");
        let is_free = !worker.is_busy();
        let row = ui.horizontal(|ui| start_or_stop(ui, "Check this machine", is_running, is_free, dress));
        match row.inner {
            Pressed::Start => {
                state.stop.store(false, Ordering::Relaxed);
                state.begun = Some(Instant::now());
                let thorough = state.thorough;
                worker.ask(CheckOptions { engine, thorough });
            }
            Pressed::Stop => state.stop.store(true, Ordering::Relaxed),
            Pressed::Nothing => {}
        }
        widgets::comes_and_goes(ui, |ui| widgets::failure(ui, worker.failure()));
        widgets::comes_and_goes(ui, |ui| match worker.latest() {
            None => {}
            _ if is_stopped => widgets::note(ui, "Stopped."),
            Some(Status::Checking(..)) if !worker.is_busy() => {}
            Some(Status::Checking(group, share)) => {
                let seconds = state.begun.map_or(0.0, |begun| begun.elapsed().as_secs_f64());
                let left = time_left(share, seconds).map_or_else(String::new, |left| format!(" {left}"));
                widgets::note(ui, format!("Checking {group} …{left}"));
            }
            Some(Status::Stopped) => widgets::note(ui, "Stopped."),
            Some(Status::Failed(why)) => {
                ui.colored_label(ui.visuals().error_fg_color, why);
            }
            Some(Status::Done(checks)) => table(ui, &checks),
        });
        ui.separator();
        widgets::comes_and_goes(ui, |ui| hard_cases::show(ui, &mut state.hard, engine));
        ui.separator();
        benchmark::show(ui, &mut state.benchmark, desk);
    }

    fn tick(&mut self, desk: &mut Desk<'_>) {
        self.benchmark.tick(desk);
    }
}

/// The thread that checks, apart from those that render.
fn spawn(repaint: Repaint, stop: &Arc<AtomicBool>) -> io::Result<Background<CheckOptions, Status>> {
    let stop = stop.clone();
    Background::spawn("check", repaint, move |options, responder| {
        work_apart();
        let progress = |group: &str, share: f64| responder.publish(Status::Checking(group.to_owned(), share));
        responder.publish(match run(options, &stop, progress) {
            Ok(Some(checks)) => Status::Done(checks),
            Ok(None) => Status::Stopped,
            Err(error) => Status::Failed(error.to_string()),
        });
    })
}

fn table(ui: &mut Ui, checks: &[Check]) {
    let failed = checks.iter().filter(|check| !check.passed).count();
    ui.add_space(4.0);
    if failed == 0 {
        ui.strong(format!("All {} checks passed.", checks.len()));
    } else {
        let text = format!("{failed} of {} checks failed.", checks.len());
        ui.colored_label(ui.visuals().error_fg_color, text);
    }
    egui::Grid::new("checks").num_columns(3).striped(true).show(ui, |ui| {
        for heading in ["Group", "Passed", "Failed"] {
            ui.weak(heading);
        }
        ui.end_row();
        for GroupSummary {
            group,
            passed,
            failed,
            worst,
        } in summaries(checks)
        {
            ui.label(group).on_hover_text(format!("Worst: {worst}"));
            ui.label(passed.to_string());
            ui.label(failed.to_string());
            ui.end_row();
        }
    });
    for check in checks.iter().filter(|check| !check.passed) {
        ui.colored_label(ui.visuals().error_fg_color, format!("{}: {check}", check.group));
    }
}
