//! The proof on this machine: what `glossmith check` does, as a table.

mod benchmark;
mod hard_cases;
mod run;

use benchmark::BenchmarkState;
use hard_cases::HardState;
use run::Run;

use super::*;
use crate::app::study::engine;
use crate::study::check::{Check, CheckOptions, GroupSummary, run, summaries};

/// How a run stands.
#[derive(Clone)]
enum Status {
    /// What is checked, and the share that is done.
    Checking(String, f64),
    Done(Vec<Check>),
    Failed(String),
}

/// The checks, the hard cases and the benchmark.
#[derive(Default)]
pub struct CheckPanel {
    run: Run<Status>,
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
        let thorough = self.thorough;
        let standing = self.run.show(ui, "Check this machine", || {
            Box::new(move |stop, publish| {
                let progress = |group: &str, share: f64| publish(Status::Checking(group.to_owned(), share));
                match run(CheckOptions { engine, thorough }, &stop, progress) {
                    Ok(checks) => checks.into_iter().for_each(|checks| publish(Status::Done(checks))),
                    Err(error) => publish(Status::Failed(error.to_string())),
                }
            })
        });
        widgets::comes_and_goes(ui, |ui| match standing {
            None => {}
            Some(Status::Checking(..)) if self.run.is_stopped() => {}
            Some(Status::Checking(group, share)) => {
                let left = self.run.left(" ", share);
                widgets::note(ui, format!("Checking {group} …{left}"));
            }
            Some(Status::Failed(why)) => widgets::failure(ui, why),
            Some(Status::Done(checks)) => table(ui, &checks),
        });
        ui.separator();
        widgets::comes_and_goes(ui, |ui| hard_cases::show(ui, &mut self.hard, engine));
        ui.separator();
        benchmark::show(ui, &mut self.benchmark, desk);
    }

    fn tick(&mut self, desk: &mut Desk) {
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
