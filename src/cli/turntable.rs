//! `glossmith turntable`: a document turned once, as numbered images or a video.

use std::{path::PathBuf, time::Instant};

use clap::Args;
use clap::builder::{ArgPredicate, PathBufValueParser, TypedValueParser};

use super::{
    answer::{Destination, file_names, write_json},
    names, parse,
    render::Bar,
    scene::SceneArguments,
    signals::Signals,
};
use crate::{
    console::message,
    document::turntable::Turn,
    render::Session,
    render::turntable::{FPS, Turntable, frame_path, render},
    scene::path_text::path_text,
    store::{video, video::VideoFormat},
};

/// Arguments of `glossmith turntable`.
#[derive(Debug, Args)]
pub struct TurntableArguments {
    /// Frames of a whole turn, 1 to 9999.
    #[arg(long, default_value_t = 36, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=9999))]
    frames: u32,
    /// What turns, anticlockwise seen from above.
    #[arg(long, default_value = "camera", value_name = "camera|model|light", value_parser = names::choice::<Turn>)]
    turn: Turn,
    /// The folder for the images frame-0001.png, frame-0002.png and so on; made where it is not there. With --video they
    /// are only written where this is given.
    #[arg(
        long,
        default_value = "turntable",
        value_name = "FOLDER",
        default_value_if("video", ArgPredicate::IsPresent, None)
    )]
    output: Option<PathBuf>,
    /// Write a video: .mp4 (H.264) or .gif, which repeats for ever.
    #[arg(long, value_name = "FILE", value_parser = video_file())]
    video: Option<PathBuf>,
    /// Frames a second of the video, 1 to 120.
    #[arg(long, default_value_t = FPS, value_name = "N", allow_negative_numbers = true, value_parser = parse::number_in(video::FPS))]
    fps: f64,
    /// Write what was rendered, how and how fast, as JSON; - is standard output.
    #[arg(long = "json", alias = "report", value_name = "FILE|-")]
    report: Option<Destination>,
    #[command(flatten)]
    scene: SceneArguments,
}

/// The name of a video; its ending is one of those that are written.
fn video_file() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| VideoFormat::of(&path).map(|_| path))
}

/// Renders the frames as the arguments say.
///
/// # Errors
/// One line that names the file, what is wrong and what to do.
pub fn run(arguments: &TurntableArguments) -> anyhow::Result<()> {
    arguments.report.iter().try_for_each(Destination::check_writable)?;
    arguments
        .video
        .iter()
        .try_for_each(|path| parse::check_writable(path))?;
    let begun = Instant::now();
    let mut session = Session::open(arguments.scene.engine)?;
    let table = Turntable {
        document: arguments.scene.document(&mut session)?,
        turn: arguments.turn,
        frames: arguments.frames,
        folder: arguments.output.clone(),
        video: arguments.video.clone(),
        fps: arguments.fps,
        keeps_part: true,
    };
    let signals = Signals::watch()?;
    message!("{} ({})", session.engine(), session.engine().reason);
    let bar = Bar::new("{bar:40} frame {msg}, {eta} left", table.frames)?;
    let outcome = render(&mut session, arguments.scene.engine, &table, &mut |progress| {
        let message = format!("{} of {}", progress.done + 1, table.frames);
        bar.show(f64::from(progress.done) + progress.share, message);
        signals.received().is_none()
    })?;
    drop(bar);
    let pictures: Vec<PathBuf> = match &table.folder {
        Some(folder) => (1..=outcome.frames).map(|frame| frame_path(folder, frame)).collect(),
        None => Vec::new(),
    };
    if let Some(last) = pictures.last() {
        message!("wrote {} frames up to {}", outcome.frames, last.display());
    }
    let video = table.video.as_ref().filter(|_| outcome.frames > 0);
    if let Some(path) = video {
        message!("wrote {}: {} frames", path.display(), outcome.frames);
    }
    if outcome.dropped > 0 {
        message!("{} samples were left out because they were not finite", outcome.dropped);
    }
    let ended_by = signals.received().filter(|_| outcome.frames < table.frames);
    let ended = ended_by.map_or(Ok(()), |signal| Err(signal.into()));
    let Some(destination) = &arguments.report else {
        return ended;
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
        "files": file_names(pictures.iter().chain(video)),
        "video": video.map(|video| path_text(video)),
        "fps": video.map(|_| table.fps),
        "stopped_by": ended_by.map(|_| "signal"),
    });
    write_json(destination, &report)?;
    ended
}
