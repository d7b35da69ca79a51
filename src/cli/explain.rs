//! `glossmith explain`: everything that made one sample of one pixel.

use anyhow::{Context, bail};
use clap::Args;

use super::{answer::Answer, parse, scene::SceneArguments};
use crate::console;
use crate::study::explain::{PathAccount, explain};

/// Arguments of `glossmith explain`: a pixel, a sample, and those of `glossmith render` that describe the scene.
#[derive(Debug, Args)]
pub struct ExplainArguments {
    /// Column and row of the pixel, from 0,0 at the top left.
    #[arg(long, value_name = "X,Y", value_parser = parse::pixel)]
    pixel: [u32; 2],
    /// Number of the sample in its pixel, from 0.
    #[arg(long, default_value_t = 0, value_name = "N", allow_negative_numbers = true)]
    sample: u32,
    #[command(flatten)]
    answer: Answer,
    #[command(flatten)]
    scene: SceneArguments,
}

/// Traces the path on the CPU and prints its account.
///
/// # Errors
/// One line that names the file, what is wrong and what to do.
pub fn run(arguments: &ExplainArguments) -> anyhow::Result<()> {
    arguments.answer.check_writable()?;
    let account = account(arguments)?;
    if arguments.answer.has_words() {
        console::print(format_args!("{account}"));
    }
    arguments.answer.write(&account)
}

fn account(arguments: &ExplainArguments) -> anyhow::Result<PathAccount> {
    // Only the CPU reports what happens on a path.
    let (session, document) = arguments.scene.on_cpu()?;
    let size = [document.render.width, document.render.height];
    let [x, y] = arguments.pixel;
    if x >= size[0] || y >= size[1] {
        bail!(
            "--pixel {x},{y}: the image has {} x {} pixels; give a place in it, or another --size",
            size[0],
            size[1]
        );
    }
    let model = session.assets().model(&document.model, &document.import)?;
    let job = session.job().context("the scene has no job")?;
    Ok(explain(&document, &model, job, arguments.pixel, arguments.sample))
}
