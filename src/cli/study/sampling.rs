//! `glossmith study sampling`: the paper's Fig. 8.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;

use super::folder::{self, Folder};
use super::{Bar, digits};
use crate::cli::answer::Answer;
use crate::console::output;
use crate::plot::{BarPlot, bar_plot_file};
use crate::render::EngineChoice;
use crate::study::sampling::{PAPER, SAMPLES, SamplingOptions, SamplingReport, SamplingRow, sampling};

/// The image of `--quick`.
const QUICK_SIZE: [u32; 2] = [48, 32];

/// Arguments of `glossmith study sampling`.
#[derive(Debug, Args)]
pub(super) struct SamplingArguments {
    /// The folder for numbers (.json, .csv) and plots (.svg, .png); made where it is not there.
    #[arg(long, default_value = "study", value_name = "FOLDER")]
    output: PathBuf,
    /// Measure little and small, 48 x 32 pixels: to see that it works.
    #[arg(long)]
    quick: bool,
    /// Width and height of the image in pixels.
    #[arg(long, default_value = "1880x1812", value_name = "WxH", value_parser = super::super::parse::size)]
    size: [u32; 2],
    /// Roughness of all lobes.
    #[arg(long, default_value = "0.3", value_name = "R", value_parser = super::super::parse::number_in(0.01..=1.0), allow_negative_numbers = true)]
    roughness: f64,
    /// The engine: a hardware GPU if there is one, else the faster one here; the GPU; the CPU.
    #[arg(long, default_value = "auto", value_name = "auto|gpu|cpu")]
    engine: EngineChoice,
    #[command(flatten)]
    answer: Answer,
}

pub(super) fn run(arguments: &SamplingArguments) -> anyhow::Result<()> {
    folder::prepare(&arguments.output, &arguments.answer)?;
    let mut options = SamplingOptions {
        size: arguments.size,
        roughness: arguments.roughness as f32,
        ..SamplingOptions::new(arguments.engine)
    };
    if arguments.quick {
        (options.size, options.turns, options.budget) = (QUICK_SIZE, 9, Duration::from_millis(4));
    }
    let report = {
        let bar = Bar::new()?;
        sampling(&options, &mut |progress| bar.show(progress))?
    };
    let folder = Folder {
        path: &arguments.output,
        name: "sampling",
    };
    let paper: Vec<_> = PAPER
        .iter()
        .map(|(name, _, [one, hundred, frame])| {
            serde_json::json!({ "name": name, "sampling_ms": [one, hundred], "frame_ms": frame })
        })
        .collect();
    let mut json = serde_json::to_value(&report)?;
    json["paper"] = paper.into();
    folder.json(&json, &arguments.answer)?;
    let head = [
        "name",
        "samples",
        "sampling_ms",
        "with_rays_ms",
        "frame_ms",
        "against_geometric",
    ];
    let row = |row: &SamplingRow| {
        let numbers = [row.sampling_ms, row.with_rays_ms, row.frame_ms, row.against_geometric];
        let mut cells = vec![row.name.clone(), row.samples.to_string()];
        cells.extend(numbers.map(digits));
        cells
    };
    folder.csv(&head, report.rows.iter().map(row))?;
    folder.plots(&plot(&report), bar_plot_file)?;
    if arguments.answer.has_words() {
        print(&report);
    }
    Ok(())
}

fn plot(report: &SamplingReport) -> BarPlot {
    let samples = SAMPLES[SAMPLES.len() - 1];
    let rows = report.rows.iter().filter(|row| row.samples == samples);
    BarPlot {
        title: format!("Drawing {samples} directions a pixel: {}", report.machine.adapter),
        label: format!(
            "Milliseconds at {} x {}, random numbers left out",
            report.width, report.height
        ),
        series: vec!["directions alone".to_owned(), "with rays against a triangle".to_owned()],
        bars: rows
            .map(|row| (row.name.clone(), vec![row.sampling_ms, row.with_rays_ms]))
            .collect(),
    }
}

fn print(report: &SamplingReport) {
    output!(
        "{} on {}, {} x {}",
        report.machine.engine,
        report.machine.adapter,
        report.width,
        report.height
    );
    for (index, samples) in SAMPLES.into_iter().enumerate() {
        output!("\n{samples} a pixel, ms              alone  with rays  whole frame  against geometric/smooth");
        for row in report.rows.iter().filter(|row| row.samples == samples) {
            output!(
                "{:24} {:9.3}  {:9.3}  {:11.2}  {:.2}",
                row.name,
                row.sampling_ms,
                row.with_rays_ms,
                row.frame_ms,
                row.against_geometric
            );
        }
        output!("{:24} {:9.3}", "random numbers", report.numbers_ms[index]);
        if report.measured_share[index] < 1.0 {
            output!(
                "measured on {:.1} % of the rows, and scaled",
                100.0 * report.measured_share[index]
            );
        }
    }
    output!("");
    report.verdict.iter().for_each(|line| output!("{line}"));
}
