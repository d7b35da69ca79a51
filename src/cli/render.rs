//! `glossmith render`: a document from arguments, an image in a file.

use std::io::IsTerminal;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::bail;
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::answer::{Destination, file_names, write_json};
use super::parse;
use super::scene::SceneArguments;
use super::signals::Signals;
use super::waiting::Waiting;
use crate::console::message;
use crate::document::{Denoise, Document};
use crate::render::denoise::Denoised;
use crate::render::output::{self, Format, Rendered};
use crate::render::{EngineChoice, Progress, Session, StepDenoiser, StopReason, to_end};

/// Time limit of the image that is rendered where no window can be opened, seconds.
const DEFAULT_SCENE_SECONDS: f64 = 8.0;

/// Arguments of `glossmith render`.
#[derive(Debug, Args)]
pub struct RenderArguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// Image to write: .png (with exposure and tone curve, the document inside), .exr or .hdr (linear). May be repeated.
    #[arg(long = "output", default_value = "glossmith.png", value_name = "FILE", value_parser = parse::picture())]
    outputs: Vec<PathBuf>,
    /// Write albedo, normal, depth, number of samples and variance as layers into .exr images.
    #[arg(long)]
    aovs: bool,
    /// Write the sums behind the image into .exr images, so that `glossmith merge` can join it with others.
    #[arg(long)]
    keep_sums: bool,
    /// The number of each pixel's first sample: parts of an image's samples can be rendered apart and joined.
    #[arg(long, value_name = "N", default_value_t = 0)]
    samples_from: u32,
    /// The number after the last; overrides --samples.
    #[arg(long, value_name = "N")]
    samples_to: Option<u32>,
    /// Write what was rendered, how and how fast, as JSON; - is standard output.
    #[arg(long, visible_alias = "json", value_name = "FILE|-")]
    report: Option<Destination>,
}

impl RenderArguments {
    /// Takes the part of the samples that is asked for.
    fn put_samples(&self, document: &mut Document) -> anyhow::Result<()> {
        let (from, render) = (self.samples_from, &mut document.render);
        if let Some(to) = self.samples_to {
            if to <= from {
                bail!("--samples-to {to} must be above --samples-from {from}");
            }
            render.samples = to - from;
        } else if from.checked_add(render.samples).is_none() {
            bail!("--samples-from {from} leaves no numbers for the samples; give --samples-to");
        }
        render.first_sample = from;
        let is_part = from > 0 || self.samples_to.is_some();
        if is_part && document.view.denoise != Denoise::Off && !self.scene.settings.has("view.denoise") {
            document.view.denoise = Denoise::Off;
            message!("a part of the samples is not denoised; `glossmith merge --denoise auto` does that to the whole");
        }
        if from > 0 && (self.aovs || document.view.denoise != Denoise::Off) {
            bail!("--samples-from {from}: layers and the denoiser need the first samples; merge, then denoise");
        }
        Ok(())
    }
}

/// Renders as the arguments say.
///
/// # Errors
/// One line that names the file, what is wrong and what to do.
pub fn run(arguments: &RenderArguments) -> anyhow::Result<()> {
    for path in arguments.outputs.iter().chain(&arguments.scene.import_report) {
        parse::check_writable(path)?;
    }
    arguments.report.iter().try_for_each(Destination::check_writable)?;
    if arguments.aovs {
        check_takes("--aovs", &arguments.outputs)?;
    }
    if arguments.keep_sums {
        check_takes("--keep-sums", &arguments.outputs)?;
    }
    let begun = Instant::now();
    let scene = &arguments.scene;
    let mut session = Session::open(scene.engine)?;
    let waiting = Waiting::on(session.assets().loading());
    let mut document = scene.document(&mut session)?;
    drop(waiting);
    arguments.put_samples(&mut document)?;
    let targets = Targets {
        outputs: &arguments.outputs,
        has_layers: arguments.aovs,
        has_sums: arguments.keep_sums,
        report: arguments.report.as_ref(),
    };
    render(session, scene.engine, &document, begun, &targets)
}

/// What is written.
struct Targets<'a> {
    outputs: &'a [PathBuf],
    /// .exr images have layers.
    has_layers: bool,
    /// .exr images have the film's sums.
    has_sums: bool,
    report: Option<&'a Destination>,
}

/// Renders the default scene, with the files given in the place of its parts, to `glossmith.png` in the working folder.
///
/// # Errors
/// One line that names the file, what is wrong and what to do.
pub fn run_default(files: &[PathBuf], engine: EngineChoice) -> anyhow::Result<()> {
    let path = std::path::absolute("glossmith.png")?;
    parse::check_writable(&path)?;
    let begun = Instant::now();
    let mut session = Session::open(engine)?;
    let mut document = SceneArguments::of_files(files, engine).document(&mut session)?;
    document.render.time_s = Some(DEFAULT_SCENE_SECONDS);
    let targets = Targets {
        outputs: &[path],
        has_layers: false,
        has_sums: false,
        report: None,
    };
    render(session, engine, &document, begun, &targets)
}

/// Renders a document to files.
fn render(
    mut session: Session,
    engine: EngineChoice,
    document: &Document,
    begun: Instant,
    targets: &Targets<'_>,
) -> anyhow::Result<()> {
    if targets.has_layers {
        session.keep_guides("layers of the image are written");
    } else if targets.has_sums {
        session.keep_guides("sums of the image are kept");
    }
    let waiting = Waiting::on(session.assets().loading());
    to_end::submit(&mut session, engine, document)?;
    drop(waiting);
    let signals = Signals::watch()?;
    message!("{} ({})", session.engine(), session.engine().reason);
    let setup_seconds = begun.elapsed().as_secs_f64();
    let (progress, denoised) = step_to_end(&mut session, engine, document, &|| signals.received().is_none())?;
    let ended_by = signals.received().filter(|_| !progress.is_done);
    if let (Some(signal), true) = (ended_by, progress.mean_samples == 0.0) {
        return Err(anyhow::Error::new(signal).context("nothing was rendered yet, and nothing is written"));
    }
    let (image, lights) = (session.image()?, session.light_layers()?);
    let layers = targets.has_layers.then(|| session.layers()).transpose()?;
    let sums = targets.has_sums.then(|| session.kept_film()).transpose()?;
    let rendered = Rendered {
        denoised: denoised.as_ref().map(|denoised| denoised.image.as_ref()),
        layers: layers.as_ref(),
        lights: &lights,
        sums: sums.as_ref(),
        ..Rendered::from(&image)
    };
    write_pictures(targets.outputs, rendered, document)?;
    // Words come after the image: who does not read them must not hold it up.
    message!("{}", summary(&progress));
    report_written(targets.outputs);
    if let Some(destination) = targets.report {
        let mut report = json_report(&mut session, document, setup_seconds, progress, targets.has_layers)?;
        add_denoised(&mut report, document, denoised.as_ref());
        report["files"] = serde_json::json!(file_names(targets.outputs));
        if ended_by.is_some() {
            report["stopped_by"] = "signal".into();
        }
        write_json(destination, &report)?;
    }
    let dropped = session.film()?.dropped();
    if dropped > 0 {
        message!("{dropped} samples were left out because they were not finite");
    }
    ended_by.map_or(Ok(()), |signal| Err(signal.into()))
}

/// Writes an image in all formats that are asked for.
pub(super) fn write_pictures(outputs: &[PathBuf], rendered: Rendered<'_>, document: &Document) -> anyhow::Result<()> {
    outputs
        .iter()
        .try_for_each(|path| Ok(output::write(path, rendered, document)?))
}

/// Says where images are.
pub(super) fn report_written(outputs: &[PathBuf]) {
    outputs.iter().for_each(|path| message!("wrote {}", path.display()));
}

/// Whether layers or sums have a place: in .exr images alone.
///
/// # Errors
/// Where none is written.
pub(super) fn check_takes(option: &str, outputs: &[PathBuf]) -> anyhow::Result<()> {
    let is_exr = |path: &PathBuf| output::format_of(path).is_ok_and(|format| format == Format::Exr);
    if !outputs.iter().any(is_exr) {
        bail!("{option} writes into .exr images; give --output FILE.exr");
    }
    Ok(())
}

/// A progress bar on a terminal, else none.
pub(super) fn bar(template: &str, steps: u64) -> anyhow::Result<ProgressBar> {
    if !std::io::stderr().is_terminal() {
        return Ok(ProgressBar::hidden());
    }
    Ok(ProgressBar::new(steps).with_style(ProgressStyle::with_template(template)?))
}

/// What became of the denoised image, for the report: which quality, null without; seconds; error with its band.
pub(super) fn add_denoised(report: &mut serde_json::Value, document: &Document, denoised: Option<&Denoised>) {
    let error = denoised.and_then(|denoised| denoised.error);
    report["denoised"] = denoised.map(|_| document.view.denoise.name()).into();
    report["denoise_seconds"] = denoised.map(|denoised| denoised.seconds).into();
    report["denoised_error"] = error.map(|error| error.value).into();
    report["denoised_error_low"] = error.map(|error| error.low).into();
    report["denoised_error_high"] = error.map(|error| error.high).into();
}

/// Has a session render a document, to the end.
///
/// # Errors
/// What the engine says.
pub(super) fn render_to_end(
    session: &mut Session,
    engine: EngineChoice,
    document: &Document,
) -> anyhow::Result<(Progress, Option<Denoised>)> {
    to_end::submit(session, engine, document)?;
    step_to_end(session, engine, document, &|| true)
}

/// Steps until the session is done or `goes_on` says no, with a progress bar on a terminal, and denoises the image where
/// that is asked for.
fn step_to_end(
    session: &mut Session,
    engine: EngineChoice,
    document: &Document,
    keep_going: &dyn Fn() -> bool,
) -> anyhow::Result<(Progress, Option<Denoised>)> {
    const BAR_STEPS: f64 = 1000.0;
    let bar = bar("{bar:40} {msg}, {eta} left", BAR_STEPS as u64)?;
    let mut show_progress = |progress: &Progress| {
        bar.set_position((BAR_STEPS * progress.share_done(document.render.time_s)) as u64);
        let error = progress.noise.map_or(String::new(), |noise| {
            format!(", error {:.2} %", 100.0 * noise.relative)
        });
        bar.set_message(format!("{:.0} samples per pixel{error}", progress.mean_samples));
        keep_going()
    };
    let mut step_denoiser = StepDenoiser::new(document);
    let ended = to_end::step_to_end(session, engine, document, &mut step_denoiser, &mut show_progress)?;
    bar.finish_and_clear();
    if ended.progress.is_done {
        return Ok((ended.progress, ended.denoised));
    }
    // What there is of an image that was stopped is denoised as well.
    let denoised = step_denoiser.finish(session)?;
    Ok((session.progress(), denoised))
}

/// What came of a render, in a line.
fn summary(progress: &Progress) -> String {
    let samples = format!(
        "{:.0} samples per pixel in {:.1} s",
        progress.mean_samples, progress.render_seconds
    );
    let Some(noise) = progress.noise else { return samples };
    let [error, low, high] = [noise.relative, noise.low, noise.high].map(|share| 100.0 * share);
    let denoised = progress.denoised.map_or(String::new(), |estimate| {
        let [error, low, high] = [estimate.value, estimate.low, estimate.high].map(|share| 100.0 * share);
        format!(", denoised {error:.2} % ({low:.2} to {high:.2} %)")
    });
    let why = match (progress.is_converged(), progress.noise_wanted, progress.stopped_by) {
        (_, None, _) => "",
        (true, ..) => ", as exact as was asked for",
        (false, _, Some(StopReason::Time)) => ", less exact than was asked for: the time was over",
        (false, _, Some(_)) => ", less exact than was asked for: no more samples are allowed",
        (false, _, None) => ", less exact than was asked for: it was ended early",
    };
    format!("{samples}: error {error:.2} % ({low:.2} to {high:.2} %){denoised}{why}")
}

/// The report of `--report`.
fn json_report(
    session: &mut Session,
    document: &Document,
    setup_seconds: f64,
    progress: Progress,
    has_layers: bool,
) -> anyhow::Result<serde_json::Value> {
    let engine = session.engine().clone();
    let mut effects = session.job().map(|job| job.plan.effects()).unwrap_or_default();
    if has_layers {
        effects.push("picture-layers");
    }
    let film = session.film()?;
    let seconds = progress.render_seconds.max(1e-9);
    let samples = film.samples() + film.dropped();
    let rays = film.total_rays();
    Ok(serde_json::json!({
        "version": env!("CARGO_PKG_VERSION"),
        "engine": engine.kind.name(),
        "adapter": engine.adapter,
        "driver": engine.driver,
        "traversal": engine.traversal.name(),
        "width": film.width,
        "height": film.height,
        "samples_per_pixel": progress.samples_per_pixel,
        "mean_samples_per_pixel": progress.mean_samples,
        "noise": progress.noise.map(|noise| noise.relative),
        "noise_low": progress.noise.map(|noise| noise.low),
        "noise_high": progress.noise.map(|noise| noise.high),
        "converged": progress.is_converged(),
        "stopped_by": progress.stopped_by,
        "setup_seconds": setup_seconds,
        "render_seconds": progress.render_seconds,
        "samples_per_second": samples as f64 / seconds,
        "rays": rays,
        "rays_per_second": rays as f64 / seconds,
        "dropped_samples": film.dropped(),
        "clamped_energy": film.clamped_share(),
        "cut_energy": film.cut_share(),
        "effects": effects,
        "seed": document.render.seed,
    }))
}
