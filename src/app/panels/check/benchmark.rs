//! The benchmark: what `glossmith benchmark` does, as a table, and its result for the clipboard.

use super::*;
use crate::{
    measuring::StudyWorker,
    render::EngineChoice,
    study::benchmark::{
        BenchmarkOptions, SECONDS, benchmark,
        report::{EngineReport, Report, number},
    },
};

/// State of the section.
#[derive(Default)]
pub struct BenchmarkState {
    pub worker: StudyWorker<Report>,
    quick: bool,
}

pub fn show(ui: &mut Ui, state: &mut BenchmarkState, desk: &mut Desk) {
    widgets::note(
        ui,
        "Measures every engine and adapter: rates and time to a clean image.",
    );
    ui.checkbox(&mut state.quick, "Quick")
        .on_hover_text("Small images and few scenes, to see that it works.");
    let quick = state.quick;
    let help = "Pauses the viewport and measures this machine.";
    let takes = (!quick).then(|| "takes two minutes".to_owned());
    state
        .worker
        .controls(ui, desk, ("Run the benchmark", help, true), takes, |_| {
            let options = BenchmarkOptions {
                engine: EngineChoice::Auto,
                seconds: SECONDS[usize::from(quick)],
                quick,
            };
            Box::new(move |watch| benchmark(&options, watch))
        });
    let Some(report) = state.worker.found() else { return };
    let help = "Copies the result as JSON, to hand on and to compare.";
    if widgets::pressed(ui, "Copy the result", help)
        && let Ok(text) = serde_json::to_string_pretty(&*report)
    {
        ui.ctx().copy_text(text);
    }
    report.engines.iter().for_each(|engine| table(ui, engine));
}

fn table(ui: &mut Ui, engine: &EngineReport) {
    ui.add_space(4.0);
    ui.strong(engine.name());
    let grid = Grid::new(("benchmark", engine.name())).num_columns(3);
    grid.striped(true).show(ui, |ui| {
        for row in &engine.rows {
            ui.label(format!("{}, {}", row.step, row.case));
            let [low, high] = row.value.quartiles.map(number);
            ui.label(number(row.value.median))
                .on_hover_text(format!("quartiles {low} to {high}"));
            ui.weak(&row.unit);
            ui.end_row();
        }
    });
    for left in &engine.left_out {
        widgets::note(ui, format!("{} {}: {}", left.step, left.case, left.why));
    }
}
