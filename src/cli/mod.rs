//! The command line: one module a subcommand.
//!
//! Exit codes: 0 done; 1 something could not be read, rendered or written (one line on stderr says what and what to
//! do); 2 the arguments are wrong; 3 of several things some were done and others could not be.

mod answer;
mod batch;
mod check;
mod convert;
mod explain;
mod fit;
mod lights;
mod lobe;
mod lobe_spec;
mod merge;
mod names;
mod parse;
mod plan;
mod render;
mod scatter;
mod scene;
mod settings;
mod shell;
mod study;
mod textures;
mod turntable;
mod waiting;

use std::path::PathBuf;

use clap::{Parser, Subcommand};

use crate::instructions::Instructions;
use crate::render::EngineChoice;

/// Glossmith: a material editor around the geometric lobe.
///
/// Without a subcommand the editor opens, with the files given: models (.glb, .gltf), environments (.hdr, .exr),
/// materials and projects (.json), pictures saved here (.png).
#[derive(Debug, Parser)]
#[command(version, args_conflicts_with_subcommands = true, after_help = EXIT_CODES)]
pub struct Arguments {
    /// What to do instead of opening the editor.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Files to open in the editor.
    pub files: Vec<PathBuf>,
    /// The engine that renders: a hardware GPU if there is one, else the faster one here; the GPU; the processor.
    #[arg(long, default_value = "auto", value_name = "auto|gpu|cpu")]
    pub engine: EngineChoice,
    /// The instructions that the processor's engine computes with. They change how fast it is, and nothing else.
    #[arg(long, global = true, default_value = "auto", value_name = "auto|avx512|avx2|neon|portable", value_parser = parse::instructions)]
    pub instructions: Instructions,
}

const EXIT_CODES: &str = "Exit codes: 0 done; 1 something could not be read, rendered or written; 2 wrong \
                          arguments; 3 some of several were done.";

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a picture.
    Render(Box<render::RenderArguments>),
    /// Show which effects a scene calls for, and why.
    Plan(Box<plan::PlanArguments>),
    /// Show everything that made one sample of one pixel.
    Explain(Box<explain::ExplainArguments>),
    /// Render a turn about the model as numbered pictures.
    Turntable(Box<turntable::TurntableArguments>),
    /// Prove on this machine that the renderer is right.
    Check(check::CheckArguments),
    /// Draw samples of a lobe, as the renderer draws them.
    Scatter(scatter::ScatterArguments),
    /// Match the look of another lobe or of a measured material.
    Fit(fit::FitArguments),
    /// Take materials to other programs and back, and tell what is lost.
    Convert(convert::ConvertArguments),
    /// Render all combinations of models, materials, environments, cameras and settings.
    Batch(batch::BatchArguments),
    /// Join films of the same picture, rendered apart.
    Merge(merge::MergeArguments),
    /// Show lobes: slices, bodies, densities, albedo, reciprocity, losses.
    Lobe(lobe::LobeArguments),
    /// Measure what accuracy costs in time.
    Study(study::StudyArguments),
    /// Print a script that completes these arguments in a shell.
    Completions(shell::CompletionsArguments),
    /// Print a manual page.
    Manual(shell::ManualArguments),
}

/// Of several things some were done and others could not be.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
struct PartialFailure(String);

/// The exit code of a subcommand that failed.
pub fn exit_code(error: &anyhow::Error) -> u8 {
    if error.is::<PartialFailure>() { 3 } else { 1 }
}

impl Command {
    /// Runs the subcommand.
    ///
    /// # Errors
    /// One line that names the file, what is wrong and what to do.
    pub fn run(self) -> anyhow::Result<()> {
        match self {
            Command::Render(arguments) => render::run(&arguments),
            Command::Plan(arguments) => plan::run(&arguments),
            Command::Explain(arguments) => explain::run(&arguments),
            Command::Turntable(arguments) => turntable::run(&arguments),
            Command::Check(arguments) => check::run(&arguments),
            Command::Scatter(arguments) => scatter::run(&arguments),
            Command::Fit(arguments) => fit::run(&arguments),
            Command::Convert(arguments) => convert::run(&arguments),
            Command::Batch(arguments) => batch::run(&arguments),
            Command::Merge(arguments) => merge::run(&arguments),
            Command::Lobe(arguments) => lobe::run(&arguments),
            Command::Study(arguments) => study::run(&arguments),
            Command::Completions(arguments) => shell::completions(&arguments),
            Command::Manual(arguments) => shell::manual(&arguments),
        }
    }
}

/// Renders the default scene, with these files in the place of its parts, to a picture and says where it is: what the
/// program does where no window can be opened.
///
/// # Errors
/// One line that names the file, what is wrong and what to do.
pub fn render_default_scene(files: &[PathBuf], engine: EngineChoice) -> anyhow::Result<()> {
    render::run_default(files, engine)
}
