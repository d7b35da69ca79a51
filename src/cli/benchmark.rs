//! `glossmith benchmark`: this machine in numbers, to hand on and to compare.

use std::path::PathBuf;

use anyhow::bail;
use clap::Args;

use super::{answer::Answer, study::watched};
use crate::{
    console::output,
    render::EngineChoice,
    study::benchmark::{BenchmarkOptions, SECONDS, benchmark, compare::compare, report::Report},
};

/// Arguments of `glossmith benchmark`.
#[derive(Debug, Args)]
pub struct BenchmarkArguments {
    /// The engine to measure; auto stands for the CPU and every adapter of the machine.
    #[arg(long, default_value = "auto", value_name = "auto|gpu|cpu")]
    engine: EngineChoice,
    /// About how long to measure [default: 120, with --quick 20].
    #[arg(long, value_name = "SECONDS", value_parser = super::parse::number_in(1.0..=36_000.0), allow_negative_numbers = true)]
    seconds: Option<f64>,
    /// Measure little and small: to see that it works.
    #[arg(long)]
    quick: bool,
    /// Measure nothing, and print two results side by side, with ratios and what of them is noise.
    #[arg(long, value_names = ["A.json", "B.json"], num_args = 2, conflicts_with_all = ["engine", "seconds", "quick"])]
    compare: Option<Vec<PathBuf>>,
    #[command(flatten)]
    answer: Answer,
}

/// Measures this machine, or compares two results.
///
/// # Errors
/// A file that cannot be read or written, or is no result.
pub fn run(arguments: &BenchmarkArguments) -> anyhow::Result<()> {
    arguments.answer.check_writable()?;
    let (text, is_written) = match &arguments.compare {
        Some(paths) => {
            let reports = paths
                .iter()
                .map(|path| Report::read(path))
                .collect::<Result<Vec<_>, _>>()?;
            let comparison = compare(&reports[0], &reports[1]);
            if comparison.rows.is_empty() {
                bail!("the results have no measurement in common; compare two of the same engine");
            }
            (comparison.text(), arguments.answer.write(&comparison))
        }
        None => {
            let report = measured(arguments)?;
            (report.text(), arguments.answer.write(&report))
        }
    };
    if arguments.answer.has_words() {
        output!("{}", text.trim_end());
    }
    is_written
}

fn measured(arguments: &BenchmarkArguments) -> anyhow::Result<Report> {
    let options = BenchmarkOptions {
        engine: arguments.engine,
        seconds: arguments.seconds.unwrap_or(SECONDS[usize::from(arguments.quick)]),
        quick: arguments.quick,
    };
    watched(|watch| benchmark(&options, watch))
}
