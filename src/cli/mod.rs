//! The command line: one module a subcommand.
//!
//! Exit codes: 0 done; 1 something could not be read, rendered or written (one line on stderr says what and what to
//! do); 2 the arguments are wrong; 3 of several things some were done and others could not be; 129, 130 and 143 a signal
//! ended a render, and what there was of it is written.

mod answer;
mod batch;
mod benchmark;
mod check;
mod convert;
mod evaluate;
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
mod signals;
mod study;
mod textures;
mod turntable;

use std::{iter, path::PathBuf};

use clap::{Arg, CommandFactory, FromArgMatches, Parser, Subcommand};

use crate::{
    document::parameter::nearest,
    instructions::Instructions,
    render::{EngineChoice, RayQueries, denoise::DenoiseDevice},
    store::file_kind::what_is_opened,
};

fn long_about() -> String {
    format!(
        "Glossmith: a material editor around the geometric lobe.\n\nWithout a subcommand the editor opens, with the files \
         given: {}. Saved images have the document inside.",
        what_is_opened()
    )
}

/// Glossmith: a material editor around the geometric lobe.
#[derive(Debug, Parser)]
#[command(name = "glossmith", version, long_about = long_about(), args_conflicts_with_subcommands = true, after_help = EXIT_CODES)]
pub struct Arguments {
    /// What to do instead of opening the editor.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Files to open in the editor.
    #[arg(value_parser = parse::opened())]
    pub files: Vec<PathBuf>,
    /// The engine that renders: a hardware GPU if there is one, else the CPU; the GPU; the CPU.
    #[arg(long, default_value = "auto", value_name = "auto|gpu|cpu")]
    pub engine: EngineChoice,
    /// The instructions that the CPU engine computes with. They change how fast it is, and nothing else.
    #[arg(long, global = true, default_value = "auto", value_name = "auto|avx512|avx2|neon|portable", value_parser = parse::instructions)]
    pub instructions: Instructions,
    /// Whether the GPU engine uses hardware ray tracing: on a hardware GPU; on any adapter that has it; never.
    #[arg(long, global = true, default_value = "auto", value_name = "auto|on|off")]
    pub ray_queries: RayQueries,
    /// The device that denoises: the fastest; a GPU (CUDA, HIP, SYCL, Metal), or the CPU where none works; the CPU.
    #[arg(long, global = true, default_value = "auto", value_name = "auto|gpu|cpu")]
    pub denoise_device: DenoiseDevice,
    /// Read what files name wherever it lies. Without it they may name what is in the folder above their own, and below.
    #[arg(long, global = true)]
    pub allow_outside: bool,
}

const EXIT_CODES: &str = "Exit codes: 0 done; 1 something could not be read, rendered or written; 2 wrong \
                          arguments; 3 some of several were done. 129, 130, 143: a signal (SIGHUP, SIGINT, SIGTERM) \
                          ended a render, and what there was is written.";

macro_rules! subcommands {
    ($($(#[$doc:meta])* $name:ident($arguments:ty) => $run:path;)*) => {
        /// The subcommands.
        #[derive(Debug, Subcommand)]
        pub enum Command {
            $($(#[$doc])* $name($arguments),)*
        }

        impl Command {
            /// Runs the subcommand.
            ///
            /// # Errors
            /// One line that names the file, what is wrong and what to do.
            pub fn run(self) -> anyhow::Result<()> {
                match self {
                    $(Self::$name(arguments) => $run(&arguments),)*
                }
            }
        }
    };
}

// In the order of the help text, which quotes the comments.
subcommands! {
    /// Render an image.
    Render(Box<render::RenderArguments>) => render::run;
    /// Show which effects a scene calls for, and why.
    Plan(Box<plan::PlanArguments>) => plan::run;
    /// Explain every event of one sample of one pixel.
    Explain(Box<explain::ExplainArguments>) => explain::run;
    /// Render a turntable as a video or numbered images.
    Turntable(Box<turntable::TurntableArguments>) => turntable::run;
    /// Verify the renderer on this machine.
    Check(check::CheckArguments) => check::run;
    /// Measure every engine and adapter of this machine in three minutes, or compare two such measurements.
    Benchmark(benchmark::BenchmarkArguments) => benchmark::run;
    /// Draw samples of a lobe, as the renderer draws them.
    Scatter(scatter::ScatterArguments) => scatter::run;
    /// Evaluate a material: values and densities for pairs of directions, or albedos.
    Evaluate(Box<evaluate::EvaluateArguments>) => evaluate::run;
    /// Match the look of another lobe or of a measured material.
    Fit(fit::FitArguments) => fit::run;
    /// Convert materials to other programs and back, with a loss report.
    Convert(convert::ConvertArguments) => convert::run;
    /// Render all combinations of models, materials, environments, cameras and settings.
    Batch(batch::BatchArguments) => batch::run;
    /// Merge films of one image that were rendered separately.
    Merge(merge::MergeArguments) => merge::run;
    /// Plot lobes: slices, surfaces, densities, albedo, reciprocity, losses.
    Lobe(lobe::LobeArguments) => lobe::run;
    /// Measure what accuracy costs in time.
    Study(study::StudyArguments) => study::run;
    /// Print a script that completes these arguments in a shell.
    Completions(shell::CompletionsArguments) => shell::completions;
    /// Print a manual page.
    Manual(shell::ManualArguments) => shell::manual;
}

/// Headings with the options below them, by their names in the program; those with a plus are in the short help.
const HEADINGS: [(&str, &str); 7] = [
    (
        "Model",
        "+model scene variant time_of_pose texture_size import_report import_lobe",
    ),
    (
        "Light",
        "+environment environment_encoding environment-rotation environment-strength area_lights spots suns light_mix \
         light-groups scene-unit background background-blur +ground ground-kind ground-color ground-reflection \
         ground-roughness cyclorama-turn cyclorama-wall cyclorama-bend",
    ),
    ("Material", "+material textures +assignments"),
    (
        "Camera and image",
        "+camera_orbit fov projection camera-distance camera-target camera-position camera-roll aperture focus-distance \
         +size region lut tone-map exposure auto-exposure white-balance contrast saturation vignette glare +denoise",
    ),
    (
        "Rendering",
        "+samples time +noise min-samples adaptive bounces strategy light-paths sequence filter firefly-clamp seed \
         effects +engine",
    ),
    ("Layers and parts", "aovs keep_sums samples_from samples_to"),
    ("Machine", "instructions ray_queries denoise_device allow_outside"),
];

/// Options of the machine, with the commands that have no use for them.
const UNUSED: [(&str, &str); 4] = [
    (
        "instructions",
        "scatter evaluate fit convert merge lobe completions manual",
    ),
    (
        "ray_queries",
        "plan explain scatter evaluate fit convert merge lobe completions manual",
    ),
    (
        "denoise_device",
        "plan explain check scatter evaluate fit convert lobe completions manual",
    ),
    ("allow_outside", "check benchmark scatter merge lobe completions manual"),
];

/// The arguments as they are given; ends the program where they are wrong.
pub fn parse() -> Arguments {
    Arguments::from_arg_matches(&command().get_matches()).unwrap_or_else(|error| error.exit())
}

/// The program with its options under headings.
fn command() -> clap::Command {
    let program = Arguments::command().mut_args(arranged);
    let program = program.mut_subcommands(|command| command.mut_args(arranged));
    UNUSED.into_iter().fold(program, |program, (name, commands)| {
        let option = program.get_arguments().find(|option| option.get_id() == name).cloned();
        let hidden = option.map(|option| option.hide(true));
        commands.split(' ').fold(program, |program, command| {
            program.mut_subcommand(command, |command| command.args(hidden.clone()))
        })
    })
}

/// An option under its heading; the short help has its first sentence, where it has it at all.
fn arranged(option: Arg) -> Arg {
    let name = option.get_id().to_string();
    let help = option.get_help().map(ToString::to_string).unwrap_or_default();
    let first = help.split(". ").next().unwrap_or_default().to_owned();
    let is_output = option.get_long() == Some("output");
    let mut option = option.help(first).long_help(help);
    for (heading, names) in HEADINGS {
        if let Some(found) = names.split(' ').find(|found| found.trim_start_matches('+') == name) {
            option = option.help_heading(heading).hide_short_help(!found.starts_with('+'));
        }
    }
    if is_output { option.short('o') } else { option }
}

/// Commands by names that they do not have.
const OTHER_NAMES: [(&str, &str); 10] = [
    ("animate", "turntable"),
    ("bench", "benchmark"),
    ("export", "convert"),
    ("import", "convert"),
    ("match", "fit"),
    ("race", "study accuracy"),
    ("test", "check"),
    ("trace", "explain"),
    ("verify", "check"),
    ("video", "turntable"),
];

/// The command that was probably meant by a word, as a hint.
fn meant(word: &str) -> String {
    let program = Arguments::command();
    let commands = program.get_subcommands().flat_map(|command| {
        let name = command.get_name();
        let of_it = command.get_subcommands().map(clap::Command::get_name);
        let of_it = of_it.map(move |study| (study, format!("{name} {study}")));
        iter::once((name, name.to_owned())).chain(of_it)
    });
    let others = OTHER_NAMES.map(|(other, name)| (other, name.to_owned()));
    match nearest(&word.to_lowercase(), others.into_iter().chain(commands)) {
        Some(near) => format!("did you mean `glossmith {near}`?"),
        None => "`glossmith --help` lists the commands".to_owned(),
    }
}

/// Of several things some were done and others could not be.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
struct PartialFailure(String);

/// The exit code of a subcommand that failed.
pub fn exit_code(error: &anyhow::Error) -> u8 {
    match error.downcast_ref::<signals::EndedBySignal>() {
        Some(signal) => signal.exit_code(),
        None if error.is::<PartialFailure>() => 3,
        None => 1,
    }
}

/// Renders the default scene, with these files in the place of its parts, to an image and says where it is: what the
/// program does where no window can be opened.
///
/// # Errors
/// One line that names the file, what is wrong and what to do.
pub fn render_default_scene(files: &[PathBuf], engine: EngineChoice) -> anyhow::Result<()> {
    render::run_default(files, engine)
}
