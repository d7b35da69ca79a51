//! The proof on this machine: what `glossmith check` does, as a table.

mod hard_cases;

use egui::Ui;

use hard_cases::HardState;

use super::Panel;
use crate::app::desk::Desk;
use crate::app::kit::widgets;
use crate::app::study::engine;
use crate::render::background::Background;
use crate::render::check::{Check, CheckOptions, GroupSummary, run, summaries};

/// How a run stands.
#[derive(Clone)]
enum Standing {
    Checking(String),
    Done(Vec<Check>),
    Failed(String),
}

/// The checks and the hard cases.
#[derive(Default)]
pub(super) struct CheckPanel {
    worker: Option<Background<CheckOptions, Standing>>,
    thorough: bool,
    hard: HardState,
}

impl Panel for CheckPanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        let engine = engine(desk);
        let state = self;
        widgets::note(
            ui,
            "Proves on this machine that the picture is right: samples against densities, energy, engines and strategies \
             against each other.",
        );
        if state.worker.is_none() {
            let ctx = ui.ctx().clone();
            state.worker = Background::spawn(
                "check",
                move || ctx.request_repaint(),
                |options, desk| {
                    let progress = |group: &str| desk.publish(Standing::Checking(group.to_owned()));
                    desk.publish(match run(options, progress) {
                        Ok(checks) => Standing::Done(checks),
                        Err(error) => Standing::Failed(error.to_string()),
                    });
                },
            )
            .ok();
        }
        let Some(worker) = &state.worker else {
            widgets::note(ui, "Cannot start a thread to check.");
            return;
        };
        ui.horizontal(|ui| {
            let button = ui.add_enabled(!worker.is_busy(), egui::Button::new("Check this machine"));
            if button.clicked() {
                worker.ask(CheckOptions {
                    engine,
                    thorough: state.thorough,
                });
            }
            ui.checkbox(&mut state.thorough, "Thorough")
                .on_hover_text("Every lobe at every roughness and angle, with more samples: takes minutes.");
        });
        widgets::comes_and_goes(ui, |ui| widgets::failure(ui, worker.failure()));
        widgets::comes_and_goes(ui, |ui| match worker.latest() {
            None => {}
            Some(Standing::Checking(_)) if !worker.is_busy() => {}
            Some(Standing::Checking(group)) => {
                ui.horizontal(|ui| {
                    ui.add(egui::Spinner::new().size(12.0));
                    ui.label(group);
                });
            }
            Some(Standing::Failed(why)) => {
                ui.colored_label(ui.visuals().error_fg_color, why);
            }
            Some(Standing::Done(checks)) => table(ui, &checks),
        });
        ui.separator();
        hard_cases::show(ui, &mut state.hard, engine);
    }
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
