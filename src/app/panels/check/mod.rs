//! The proof on this machine: what `glossmith check` does, as a table.

mod benchmark;
mod hard_cases;

use std::cell::RefCell;

use benchmark::BenchmarkState;
use hard_cases::HardState;

use super::*;
use crate::{
    measuring::{StudyWorker, engine},
    render::priority::work_apart,
    study::{
        StudyError, StudyProgress,
        check::{Check, CheckOptions, GroupSummary, run, summaries},
    },
};

/// The checks, the hard cases and the benchmark.
#[derive(Default)]
pub struct CheckPanel {
    worker: StudyWorker<Vec<Check>>,
    thorough: bool,
    hard: HardState,
    benchmark: BenchmarkState,
}

impl Panel for CheckPanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk) {
        let engine = engine(desk);
        widgets::note(
            ui,
            "Proves on this machine that the image is right: samples against densities, energy, engines and strategies \
             against each other. The viewport goes on meanwhile.",
        );
        ui.checkbox(&mut self.thorough, "Thorough")
            .on_hover_text("Every lobe at every roughness and angle, with more samples: takes minutes.");
        let (thorough, stop) = (self.thorough, self.worker.stop.clone());
        let label = ("Check this machine", "", false);
        self.worker.controls(ui, desk, label, None, |_| {
            Box::new(move |watch| {
                work_apart();
                let watch = RefCell::new(watch);
                let progress = |group: &str, share| {
                    let what = format!("Checking {group} …");
                    watch.borrow_mut()(StudyProgress { share, what });
                };
                run(CheckOptions { engine, thorough }, &stop, progress)?.ok_or(StudyError::Stopped)
            })
        });
        widgets::comes_and_goes(ui, |ui| {
            self.worker.found().iter().for_each(|checks| table(ui, checks));
        });
        ui.separator();
        widgets::comes_and_goes(ui, |ui| hard_cases::show(ui, desk, &mut self.hard, engine));
        ui.separator();
        benchmark::show(ui, &mut self.benchmark, desk);
    }

    fn tick(&mut self, desk: &mut Desk) {
        self.worker.tick(desk);
        self.hard.worker.tick(desk);
        self.benchmark.worker.tick(desk);
    }
}

fn table(ui: &mut Ui, checks: &[Check]) {
    let failed = || checks.iter().filter(|check| !check.passed);
    ui.add_space(4.0);
    match failed().count() {
        0 => _ = ui.strong(format!("All {} checks passed.", checks.len())),
        failed => widgets::failure(ui, format!("{failed} of {} checks failed.", checks.len())),
    }
    Grid::new("checks").num_columns(3).striped(true).show(ui, |ui| {
        for heading in ["Group", "Passed", "Failed"] {
            ui.weak(heading);
        }
        ui.end_row();
        for summary in summaries(checks) {
            let GroupSummary { group, worst, .. } = summary;
            ui.label(group).on_hover_text(format!("Worst: {worst}"));
            ui.label(summary.passed.to_string());
            ui.label(summary.failed.to_string());
            ui.end_row();
        }
    });
    failed().for_each(|check| widgets::failure(ui, format!("{}: {check}", check.group)));
}
