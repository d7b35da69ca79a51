//! `glossmith study convergence`: error against time.

use clap::Args;

use super::folder::Folder;
use super::{Bar, CommonArguments, digits};
use crate::console::output;
use crate::plot::line_plot_file;
use crate::plot::lobe_view::{Axis, LinePlot, Series};
use crate::study::{ConvergencePoint, ConvergenceReport, DenoisedPoint, convergence};

/// Longest time for the reference where none is given, seconds; the same quickly.
const REFERENCE_SECONDS: f64 = 60.0;
const QUICK_REFERENCE_SECONDS: f64 = 0.3;
/// Samples per pixel of `--quick`.
const QUICK_SAMPLES: u32 = 64;

/// Arguments of `glossmith study convergence`.
#[derive(Debug, Args)]
pub(super) struct ConvergenceArguments {
    /// Longest time for one converged image.
    #[arg(long, value_name = "SECONDS", value_parser = crate::cli::parse::number_in(0.001..=1e6), allow_negative_numbers = true)]
    reference_time: Option<f64>,
    #[command(flatten)]
    common: CommonArguments,
}

pub(super) fn run(arguments: &ConvergenceArguments) -> anyhow::Result<()> {
    let common = &arguments.common;
    common.prepare()?;
    let mut document = common.document()?;
    if common.quick {
        document.render.samples = document.render.samples.min(QUICK_SAMPLES);
    }
    let seconds = if common.quick {
        QUICK_REFERENCE_SECONDS
    } else {
        REFERENCE_SECONDS
    };
    let seconds = arguments.reference_time.unwrap_or(seconds);
    let report = {
        let bar = Bar::new()?;
        convergence(&document, common.scene.engine, seconds, &mut |progress| {
            bar.show(progress)
        })?
    };
    let folder = Folder {
        path: &common.output,
        name: "convergence",
    };
    folder.json(&report, &common.answer)?;
    let head = [
        "seconds",
        "samples_per_pixel",
        "noise",
        "noise_low",
        "noise_high",
        "noise_from_spread",
    ];
    let row = |point: &ConvergencePoint| {
        let numbers = [
            point.seconds,
            point.samples_per_pixel,
            point.noise,
            point.noise_low,
            point.noise_high,
            point.noise_from_spread,
        ];
        numbers.map(digits).to_vec()
    };
    folder.csv(&head, report.points.iter().map(row))?;
    folder.plots(&plot(&report), line_plot_file)?;
    if let (true, Some(last), Some(slope)) = (common.answer.has_words(), report.points.last(), report.slope) {
        output!(
            "error {:.3} % ({:.3} to {:.3}) after {:.2} s; against a reference {:.3} %; it falls with the time to the \
             power of {slope:.2}",
            100.0 * last.noise,
            100.0 * last.noise_low,
            100.0 * last.noise_high,
            last.seconds,
            100.0 * report.true_error.value
        );
    }
    Ok(())
}

fn plot(report: &ConvergenceReport) -> LinePlot {
    let seen: Vec<&ConvergencePoint> = report
        .points
        .iter()
        .filter(|p| p.noise > 0.0 && p.seconds > 0.0)
        .collect();
    let series = |name: &str, group, value: &dyn Fn(&ConvergencePoint) -> f64| Series {
        lobe: name.to_owned(),
        view_angle_deg: None,
        quantity: "noise",
        group,
        points: seen.iter().map(|point| [point.seconds, 100.0 * value(point)]).collect(),
    };
    let last = seen.last().copied().copied();
    let law = |point: &ConvergencePoint| last.map_or(0.0, |last| last.noise * (last.seconds / point.seconds).sqrt());
    let of_denoised = |value: &dyn Fn(&DenoisedPoint) -> f64| -> Vec<[f64; 2]> {
        let points = report.denoised.iter();
        points.map(|point| [point.seconds, 100.0 * value(point)]).collect()
    };
    let denoised = |name: &str, value: &dyn Fn(&DenoisedPoint) -> f64| Series {
        points: of_denoised(value),
        ..series(name, 3, &|point| point.noise)
    };
    let mut lines = vec![
        series("error", 0, &|point| point.noise),
        series("95 % band", 6, &|point| point.noise_low),
        series("", 6, &|point| point.noise_high),
        series("by the spread", 1, &|point| point.noise_from_spread),
        series("1/√t", 2, &law),
    ];
    if !report.denoised.is_empty() {
        lines.push(denoised("denoised", &|point| point.error));
        lines.push(denoised("", &|point| point.error_low));
        lines.push(denoised("", &|point| point.error_high));
    }
    let values = |axis: usize| {
        lines
            .iter()
            .flat_map(move |line| line.points.iter().map(move |point| point[axis]))
    };
    let range = |axis: usize| {
        let positive = values(axis).filter(|x| *x > 0.0);
        let [low, high] = positive.fold([f64::INFINITY, 1e-9], |[low, high]: [f64; 2], x| {
            [low.min(x), high.max(x)]
        });
        [0.8 * low.min(high), 1.25 * high]
    };
    let axis = |label: &str, range| Axis {
        label: label.to_owned(),
        range,
        is_logarithmic: true,
    };
    LinePlot {
        title: format!("Error against time: {}", report.machine.adapter),
        x: axis("Time of the engine (s)", range(0)),
        y: axis("Relative error (%)", range(1)),
        is_polar: false,
        x_column: "seconds",
        series: lines,
    }
}
