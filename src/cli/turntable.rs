//! `glossmith turntable`: a document turned once, as numbered pictures.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;

use super::answer::{Destination, write_json};
use super::names;
use super::render::bar;
use super::scene::SceneArguments;
use crate::document::turntable::Turn;
use crate::render::Session;
use crate::render::turntable::{Turntable, frame_path, render};

/// Arguments of `glossmith turntable`.
#[derive(Debug, Args)]
pub struct TurntableArguments {
    /// Frames of a whole turn, 1 to 9999.
    #[arg(long, default_value_t = 36, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=9999))]
    frames: u32,
    /// What turns, anticlockwise seen from above.
    #[arg(long, default_value = "camera", value_name = "camera|model|light", value_parser = names::choice::<Turn>)]
    turn: Turn,
    /// The folder for the pictures frame-0001.png, frame-0002.png and so on; made where it is not there.
    #[arg(long, default_value = "turntable", value_name = "FOLDER")]
    output: PathBuf,
    /// Write what was rendered, how and how fast, as JSON; - is standard output.
    #[arg(long, visible_alias = "json", value_name = "FILE|-")]
    report: Option<Destination>,
    #[command(flatten)]
    scene: SceneArguments,
}

/// Renders the frames as the arguments say.
///
/// # Errors
/// One line that names the file, what is wrong and what to do.
pub fn run(arguments: &TurntableArguments) -> anyhow::Result<()> {
    const BAR_STEPS: f64 = 1000.0;
    arguments.report.iter().try_for_each(Destination::check_writable)?;
    let begun = Instant::now();
    let mut session = Session::open(arguments.scene.engine)?;
    let table = Turntable {
        document: arguments.scene.document(&mut session)?,
        turn: arguments.turn,
        frames: arguments.frames,
        folder: arguments.output.clone(),
    };
    eprintln!("{} ({})", session.engine(), session.engine().reason);
    let bar = bar(
        "{bar:40} frame {msg}, {eta} left",
        u64::from(table.frames) * BAR_STEPS as u64,
    )?;
    let outcome = render(&mut session, &table, &mut |progress| {
        bar.set_position((BAR_STEPS * (f64::from(progress.done) + progress.share)) as u64);
        bar.set_message(format!("{} of {}", progress.done + 1, table.frames));
        true
    })?;
    bar.finish_and_clear();
    let last = frame_path(&table.folder, table.frames);
    eprintln!("wrote {} frames up to {}", outcome.frames, last.display());
    if outcome.dropped > 0 {
        eprintln!("{} samples were left out because they were not finite", outcome.dropped);
    }
    let Some(destination) = &arguments.report else {
        return Ok(());
    };
    let render = &table.document.render;
    let engine = session.engine().clone();
    let report = serde_json::json!({
        "version": env!("CARGO_PKG_VERSION"),
        "engine": engine.kind.name(),
        "adapter": engine.adapter,
        "driver": engine.driver,
        "width": render.width,
        "height": render.height,
        "frames": outcome.frames,
        "turn": table.turn.name(),
        "samples_per_pixel": session.progress().samples_per_pixel,
        "total_seconds": begun.elapsed().as_secs_f64(),
        "render_seconds": outcome.render_seconds,
        "dropped_samples": outcome.dropped,
        "seed": render.seed,
        "files": (1..=outcome.frames).map(|frame| frame_path(&table.folder, frame)).collect::<Vec<_>>(),
    });
    write_json(destination, &report)
}
