//! `glossmith study`: what accuracy costs in time, as numbers and plots for papers and for regression.

mod accuracy;
mod convergence;
mod folder;
mod ledger;

use std::path::PathBuf;

use clap::{Args, Subcommand};
use indicatif::ProgressBar;

use super::answer::Answer;
use super::render::bar;
use super::scene::SceneArguments;
use crate::document::Document;
use crate::render::{EngineChoice, Session};
use crate::study::StudyProgress;

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
    Convergence(Box<convergence::ConvergenceArguments>),
    /// Report what each effect and setting costs in time and does to noise and image.
    Ledger(Box<ledger::LedgerArguments>),
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

impl CommonArguments {
    /// Makes sure that there is a place for what is measured.
    fn prepare(&self) -> anyhow::Result<()> {
        folder::prepare(&self.output, &self.answer)
    }

    /// What the arguments describe, no larger than is quick where that is asked for.
    fn document(&self) -> anyhow::Result<Document> {
        let mut session = Session::open(EngineChoice::Cpu)?;
        let mut document = self.scene.document(&mut session)?;
        if self.quick {
            let render = &mut document.render;
            (render.width, render.height) = (render.width.min(QUICK_SIDE), render.height.min(QUICK_SIDE));
        }
        Ok(document)
    }
}

/// A bar that shows how far a study has come, on a terminal.
pub(super) struct Bar(ProgressBar);

/// Steps of the bar.
const BAR_STEPS: f64 = 1000.0;

impl Bar {
    pub(super) fn new() -> anyhow::Result<Self> {
        bar("{bar:40} {msg}", BAR_STEPS as u64).map(Self)
    }

    pub(super) fn show(&self, progress: StudyProgress) -> bool {
        self.0.set_position((BAR_STEPS * progress.share) as u64);
        self.0.set_message(progress.what);
        true
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// The value as text for a table: enough digits to calculate with.
fn digits(value: f64) -> String {
    format!("{value:.6e}")
}
