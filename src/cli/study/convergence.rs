//! `glossmith study convergence`: error against time.

use super::{ReferenceArguments, watched};
use crate::{
    console::output,
    plot::lobe_view::{Axis, LinePlot, Series},
    study::{ConvergencePoint, ConvergenceReport, DenoisedPoint, convergence},
};

/// Longest time for the reference where none is given, seconds; the same quickly.
const REFERENCE_SECONDS: f64 = 60.0;
const QUICK_REFERENCE_SECONDS: f64 = 0.3;
/// Samples per pixel of `--quick`.
const QUICK_SAMPLES: u32 = 64;

const COLUMNS: &str = "seconds,samples_per_pixel,noise,noise_low,noise_high,noise_from_spread";

pub fn run(arguments: &ReferenceArguments) -> anyhow::Result<()> {
    let common = &arguments.common;
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
    let report = watched(|watch| convergence(&document, common.scene.engine, seconds, watch))?;
    common.write("convergence", &report, ["points", COLUMNS], &plot(&report))?;
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
    let points = report
        .points
        .iter()
        .filter(|point| point.noise > 0.0 && point.seconds > 0.0);
    let last = report.points.last().copied();
    let line = |name: &str, group, points: Vec<[f64; 2]>| Series {
        lobe: name.to_owned(),
        view_angle_deg: None,
        quantity: "noise",
        group,
        points,
    };
    let error = |name, group, value: &dyn Fn(&ConvergencePoint) -> f64| {
        line(
            name,
            group,
            points
                .clone()
                .map(|point| [point.seconds, 100.0 * value(point)])
                .collect(),
        )
    };
    let law = |point: &ConvergencePoint| last.map_or(0.0, |last| last.noise * (last.seconds / point.seconds).sqrt());
    let mut series = vec![
        error("error", 0, &|point| point.noise),
        error("95 % band", 6, &|point| point.noise_low),
        error("", 6, &|point| point.noise_high),
        error("by the spread", 1, &|point| point.noise_from_spread),
        error("1/√t", 2, &law),
    ];
    if !report.denoised.is_empty() {
        #[expect(clippy::type_complexity, reason = "a table")]
        let values: [(_, fn(&DenoisedPoint) -> f64); 3] = [
            ("denoised", |point| point.error),
            ("", |point| point.error_low),
            ("", |point| point.error_high),
        ];
        series.extend(values.map(|(name, value)| {
            line(
                name,
                3,
                report
                    .denoised
                    .iter()
                    .map(|point| [point.seconds, 100.0 * value(point)])
                    .collect(),
            )
        }));
    }
    let values = |axis: usize| {
        series
            .iter()
            .flat_map(move |line| line.points.iter().map(move |point| point[axis]))
    };
    LinePlot {
        title: format!("Error against time: {}", report.machine.adapter),
        x: Axis::logarithmic("Time of the engine (s)", values(0)),
        y: Axis::logarithmic("Relative error (%)", values(1)),
        is_polar: false,
        x_column: "seconds",
        series,
    }
}
