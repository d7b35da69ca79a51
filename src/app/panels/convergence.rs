//! Error against time: how exact the image is, and what more would cost.

use egui_plot::{HLine, LineStyle, Points};

use super::*;
use crate::{
    analysis::noise::Noise,
    document::RenderSettings,
    kit::charts::{height, line, log_log},
    kit::words::{duration, error, percent, percent_short},
    render::{Measurement, Progress},
};

/// The errors that are aimed at where the document names none.
const STEPS: [f64; 10] = [0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 0.0005];

/// Error against time.
#[derive(Default)]
pub struct ConvergencePanel;

impl Panel for ConvergencePanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk) {
        let history = &desk.snapshot.history;
        let Some(last) = history.last() else {
            widgets::note(ui, unknown(&desk.document.render));
            return;
        };
        let progress = &desk.snapshot.progress;
        // Their number changes by itself.
        widgets::comes_and_goes(ui, |ui| words(ui, last, progress));
        plot(ui, history, progress.noise_wanted);
        widgets::note(
            ui,
            "Dots: the estimated relative error against the engine's own time, thin lines its 95 % band, dashed the law \
             1/√t through the last one.",
        );
    }
}

/// When the error is known for the first time.
fn unknown(render: &RenderSettings) -> String {
    let is_aimed = render.noise.is_some() || render.is_adaptive();
    let least = if is_aimed { render.least_samples().max(2) } else { 2 };
    format!("The error is known once every pixel has {least} samples.")
}

fn words(ui: &mut Ui, last: &Measurement, progress: &Progress) {
    ui.label(format!(
        "Error {} after {} and {:.0} samples per pixel",
        with_band(&last.noise),
        duration(last.engine_seconds),
        last.samples_per_pixel,
    ));
    if let Some(text) = forecast(last, progress.noise_wanted) {
        ui.strong(text);
    }
}

/// An error with its interval, as far as they are known.
fn with_band(noise: &Noise) -> String {
    let value = error(noise.relative);
    if noise.high >= 1.0 {
        return value;
    }
    format!("{value} ({} to {})", percent(noise.low), percent(noise.high))
}

/// What the next step takes: "1 % in 12 s more".
fn forecast(last: &Measurement, wanted: Option<f64>) -> Option<String> {
    let error = last.noise.relative;
    let next = || STEPS.into_iter().find(|step| *step < error);
    let goal = wanted.or_else(next)?;
    let name = percent_short(goal);
    if error <= goal {
        return Some(format!("{name} reached"));
    }
    let seconds = last.engine_seconds * ((error / goal).powi(2) - 1.0);
    Some(format!("{name} in {} more", duration(seconds)))
}

fn plot(ui: &mut Ui, history: &[Measurement], wanted: Option<f64>) {
    let mut visible = history.to_vec();
    visible.retain(|seen| seen.noise.relative > 0.0 && seen.engine_seconds > 0.0);
    let Some(last) = visible.last() else { return };
    let accent = theme::accent(ui);
    let weak = ui.visuals().weak_text_color();
    let points = |name: &'static str, value: &dyn Fn(&Noise) -> f64| {
        let place = |seen: &Measurement| [seen.engine_seconds.log10(), value(&seen.noise).log10()];
        (name, visible.iter().map(place).collect::<Vec<_>>())
    };
    // Over the time seen and a decade more.
    let law = [visible[0].engine_seconds, 10.0 * last.engine_seconds].map(|seconds| {
        let error = last.noise.relative * (last.engine_seconds / seconds).sqrt();
        [seconds.log10(), error.log10()]
    });
    let height = height(ui, 0.7, 130.0);
    let shown = log_log("convergence", ["Render time", "Relative error"], height, [0.04, 0.08]).show(ui, |plot_ui| {
        let dashed = LineStyle::dashed_dense();
        plot_ui.line(line("1/√t", law.to_vec(), weak, 1.5).style(dashed));
        for (name, end) in [
            points("upper end", &|noise| noise.high),
            points("lower end", &|noise| noise.low),
        ] {
            plot_ui.line(line(name, end, accent.gamma_multiply(0.5), 1.0));
        }
        let (name, errors) = points("error", &|noise| noise.relative);
        plot_ui.points(Points::new(name, errors).color(accent).radius(2.5));
        if let Some(wanted) = wanted {
            plot_ui.hline(HLine::new("to reach", wanted.log10()).color(weak).width(1.0));
        }
    });
    shown.response.accessible_name("Error against time");
}
