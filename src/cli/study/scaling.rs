//! `glossmith study scaling`: how time grows.

use std::time::Duration;

use clap::Args;

use super::folder::Folder;
use super::{Bar, CommonArguments, digits};
use crate::console::output;
use crate::plot::line_plot_file;
use crate::plot::lobe_view::{Axis, LinePlot, Series};
use crate::study::scaling::{Growing, ScalingOptions, ScalingPoint, ScalingReport, scaling};

/// Arguments of `glossmith study scaling`.
#[derive(Debug, Args)]
pub(super) struct ScalingArguments {
    #[command(flatten)]
    common: CommonArguments,
}

pub(super) fn run(arguments: &ScalingArguments) -> anyhow::Result<()> {
    let common = &arguments.common;
    common.prepare()?;
    let document = common.document()?;
    let mut options = ScalingOptions::new(common.scene.engine);
    if common.quick {
        (options.turns, options.slice, options.is_quick) = (2, Duration::from_millis(5), true);
    }
    let report = {
        let bar = Bar::new()?;
        scaling(&document, &options, &mut |progress| bar.show(progress))?
    };
    let path = &common.output;
    let folder = Folder { path, name: "scaling" };
    folder.json(&report, &common.answer)?;
    let head = ["growing", "size", "ns_per_sample", "ns_low", "ns_high", "setup_seconds"];
    let row = |point: &ScalingPoint| {
        let numbers = [
            point.ns_per_sample,
            point.ns_quartiles[0],
            point.ns_quartiles[1],
            point.setup_seconds,
        ];
        let mut cells = vec![point.growing.name().to_owned(), point.size.to_string()];
        cells.extend(numbers.map(digits));
        cells
    };
    folder.csv(&head, report.points.iter().map(row))?;
    for &growing in Growing::ALL {
        let name = format!("scaling-{}", growing.name());
        Folder { path, name: &name }.plots(&plot(&report, growing), line_plot_file)?;
    }
    if common.answer.has_words() {
        print(&report);
    }
    Ok(())
}

fn print(report: &ScalingReport) {
    for point in &report.points {
        output!(
            "{:10} {:>9}  {:9.1} ns a sample  {:7.3} s to set up",
            point.growing.name(),
            point.size,
            point.ns_per_sample,
            point.setup_seconds
        );
    }
}

fn plot(report: &ScalingReport, growing: Growing) -> LinePlot {
    let of_kind: Vec<&ScalingPoint> = report.points.iter().filter(|point| point.growing == growing).collect();
    let sizes = of_kind.iter().map(|point| point.size as f64);
    let (least, most) = (sizes.clone().fold(f64::INFINITY, f64::min), sizes.fold(0.0, f64::max));
    let slowest = of_kind.iter().map(|point| point.ns_per_sample).fold(0.0, f64::max);
    LinePlot {
        title: format!("Time against {}: {}", growing.name(), report.machine.adapter),
        x: Axis {
            label: growing.label().to_owned(),
            range: [0.8 * least, 1.25 * most],
            is_logarithmic: true,
        },
        y: Axis {
            label: "Time of a sample (ns)".to_owned(),
            range: [0.0, 1.1 * slowest.max(1e-9)],
            is_logarithmic: false,
        },
        is_polar: false,
        x_column: "size",
        series: vec![Series {
            lobe: "a sample".to_owned(),
            view_angle_deg: None,
            quantity: "ns",
            group: 0,
            points: of_kind
                .iter()
                .map(|point| [point.size as f64, point.ns_per_sample])
                .collect(),
        }],
    }
}
