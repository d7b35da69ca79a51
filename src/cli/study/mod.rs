//! `glossmith study`: what accuracy costs in time, as numbers and plots for papers and for regression.

mod accuracy;
mod convergence;
mod ledger;

use std::path::PathBuf;

use anyhow::Context as _;
use clap::{Args, Subcommand};
use serde::Serialize;
use serde_json::Value as Json;

use super::{answer::Answer, parse::number_in, render::Bar, scene::SceneArguments};
use crate::{
    console::message,
    document::Document,
    plot::{Figure, plot_file},
    render::{EngineChoice, Session},
    store::replace::save_atomically,
    study::{StudyError, StudyProgress},
};

/// Largest side of an image of `--quick`.
const QUICK_SIDE: u32 = 48;

/// Arguments of `glossmith study`.
#[derive(Debug, Args)]
pub struct StudyArguments {
    /// What is measured.
    #[command(subcommand)]
    study: Study,
}

/// The studies.
#[derive(Debug, Subcommand)]
enum Study {
    /// Race techniques against each other: time to a given noise against bias, images of equal time and of equal error.
    Accuracy(Box<accuracy::AccuracyArguments>),
    /// Show the error of one image against time.
    Convergence(Box<ReferenceArguments>),
    /// Report what each effect and setting costs in time and does to noise and image.
    Ledger(Box<CommonArguments>),
}

/// Runs the study.
///
/// # Errors
/// One line that names the file, what is wrong and what to do.
pub fn run(arguments: &StudyArguments) -> anyhow::Result<()> {
    match &arguments.study {
        Study::Accuracy(arguments) => accuracy::run(arguments),
        Study::Convergence(arguments) => convergence::run(arguments),
        Study::Ledger(arguments) => ledger::run(arguments),
    }
}

/// What studies of a scene have in common.
#[derive(Debug, Args)]
struct CommonArguments {
    /// The folder for numbers (.json, .csv) and plots (.svg, .png); made where it is not there.
    #[arg(long, default_value = "study", value_name = "FOLDER")]
    output: PathBuf,
    /// Measure little and small, at most 48 pixels a side: to see that it works.
    #[arg(long)]
    quick: bool,
    #[command(flatten)]
    answer: Answer,
    #[command(flatten)]
    scene: SceneArguments,
}

/// The same, of those that need converged images.
#[derive(Debug, Args)]
struct ReferenceArguments {
    /// Longest time for one converged image.
    #[arg(long, value_name = "SECONDS", value_parser = number_in(0.001..=1e6), allow_negative_numbers = true)]
    reference_time: Option<f64>,
    #[command(flatten)]
    common: CommonArguments,
}

impl CommonArguments {
    /// What the arguments describe, no larger than is quick where that is asked for; makes sure first that there is a place
    /// for what is measured.
    fn document(&self) -> anyhow::Result<Document> {
        let path = self.output.display();
        std::fs::create_dir_all(&self.output)
            .with_context(|| format!("{path}: the folder could not be made; check its name and permissions"))?;
        self.answer.check_writable()?;
        let mut document = self.scene.document(&mut Session::open(EngineChoice::Cpu)?)?;
        if self.quick {
            let render = &mut document.render;
            (render.width, render.height) = (render.width.min(QUICK_SIDE), render.height.min(QUICK_SIDE));
        }
        Ok(document)
    }

    /// Writes a report whole, these columns of its rows as a table, and its plot; answers with it, too.
    fn write(
        &self,
        name: &str,
        report: &impl Serialize,
        [rows, columns]: [&str; 2],
        plot: &impl Figure,
    ) -> anyhow::Result<()> {
        let json = serde_json::to_value(report)?;
        self.write_file(
            &format!("{name}.json"),
            (serde_json::to_string_pretty(report)? + "\n").as_bytes(),
        )?;
        self.answer.write(report)?;
        let mut table = format!("{columns}\n");
        for row in json[rows].as_array().into_iter().flatten() {
            let cells: Vec<String> = columns.split(',').map(|column| cell(row, column)).collect();
            table += &(cells.join(",") + "\n");
        }
        self.write_file(&format!("{name}.csv"), table.as_bytes())?;
        for ending in ["svg", "png"] {
            let file = format!("{name}.{ending}");
            self.write_file(&file, &plot_file(file.as_ref(), plot)?)?;
        }
        Ok(())
    }

    fn write_file(&self, name: &str, contents: &[u8]) -> anyhow::Result<()> {
        let path = self.output.join(name);
        save_atomically(&path, contents)?;
        message!("wrote {}", path.display());
        Ok(())
    }
}

/// Runs a study beside a bar that shows how far it has come.
pub fn watched<T>(
    study: impl FnOnce(&mut dyn FnMut(StudyProgress) -> bool) -> Result<T, StudyError>,
) -> anyhow::Result<T> {
    let bar = Bar::new("{bar:40} {msg}", 1)?;
    Ok(study(&mut |progress| {
        bar.show(progress.share, progress.what);
        true
    })?)
}

/// A cell of a table; a column such as `bias_low` is the lower end of the row's bias.
fn cell(row: &Json, column: &str) -> String {
    let end = || {
        column
            .rsplit_once('_')
            .map_or(&Json::Null, |(name, end)| &row[name][end])
    };
    let found = row.get(column).unwrap_or_else(end);
    match found.get("value").unwrap_or(found) {
        Json::Null => String::new(),
        Json::Number(number) => format!("{:.6e}", number.as_f64().unwrap_or_default()),
        Json::String(text) if text.contains([',', '"', '\n']) => format!("\"{}\"", text.replace('"', "\"\"")),
        Json::String(text) => text.clone(),
        other => other.to_string(),
    }
}
