//! `glossmith render`: a document from arguments, an image in a file.

use std::{fmt, io::IsTerminal, path::PathBuf, time::Duration, time::Instant};

use anyhow::bail;
use clap::Args;
use indicatif::{ProgressBar, ProgressState, ProgressStyle};

use super::{
    answer::{Destination, file_names, write_json},
    parse,
    scene::SceneArguments,
    signals::Signals,
};
use crate::{
    console::message,
    document::{Denoise, Document, ViewSettings},
    job::film::Image,
    render::{
        EngineChoice, Progress, Session, StepDenoiser, StopReason, beyond_bounces,
        denoise::Denoised,
        display::display,
        light_layers::LightLayer,
        output::{self, Format, Layers, Rendered},
        to_end,
    },
    scene::Loading,
    store::examples,
};

/// Time limit of the image that is rendered where no window can be opened, seconds.
const DEFAULT_SCENE_SECONDS: f64 = 8.0;

/// Arguments of `glossmith render`.
#[derive(Debug, Default, Args)]
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
    #[arg(long = "json", alias = "report", value_name = "FILE|-")]
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
    for path in &arguments.outputs {
        parse::check_writable(path)?;
    }
    let mut answers = arguments.report.iter().chain(&arguments.scene.import_report);
    answers.try_for_each(Destination::check_writable)?;
    if arguments.aovs {
        check_takes("--aovs", &arguments.outputs)?;
    }
    if arguments.keep_sums {
        check_takes("--keep-sums", &arguments.outputs)?;
    }
    let begun = Instant::now();
    let scene = &arguments.scene;
    let mut session = Session::open(scene.engine)?;
    let waiting = Bar::waiting(session.assets().loading())?;
    let mut document = scene.document(&mut session)?;
    drop(waiting);
    arguments.put_samples(&mut document)?;
    render(session, &document, begun, arguments)
}

/// Renders the still life, or the default scene with these files in the place of its parts, for some seconds.
pub fn run_default(files: &[PathBuf], engine: EngineChoice) -> anyhow::Result<()> {
    let path = std::path::absolute("glossmith.png")?;
    parse::check_writable(&path)?;
    let begun = Instant::now();
    let mut session = Session::open(engine)?;
    let scene = SceneArguments::of_files(files, engine);
    let mut document = match files {
        [] => examples::still_life(),
        _ => scene.document(&mut session)?,
    };
    document.render.time_s = Some(DEFAULT_SCENE_SECONDS);
    render(
        session,
        &document,
        begun,
        &RenderArguments {
            scene,
            outputs: vec![path],
            ..RenderArguments::default()
        },
    )
}

/// Renders a document to files.
fn render(mut session: Session, document: &Document, begun: Instant, targets: &RenderArguments) -> anyhow::Result<()> {
    let engine = targets.scene.engine;
    if targets.aovs {
        session.keep_guides("layers of the image are written");
    } else if targets.keep_sums {
        session.keep_guides("sums of the image are kept");
    }
    if !targets.keep_sums {
        session.guides = 1;
    }
    let waiting = Bar::waiting(session.assets().loading())?;
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
    let lights = session.light_layers()?;
    let sums = targets.keep_sums.then(|| session.kept_film()).transpose()?;
    let film = session.film()?;
    let (cut, dropped) = (film.cut_share(), film.dropped());
    let mut report = || json_report(&mut session, document, setup_seconds, progress, targets.aovs);
    let report = targets.report.as_ref().map(|_| report()).transpose()?;
    // The session's sums are not needed while the image is written.
    let layers = if targets.aovs {
        session.into_layers()?
    } else {
        let image = session.image()?;
        drop(session);
        Layers {
            image,
            ..Layers::default()
        }
    };
    let rendered = rendered(&layers.image, denoised.as_ref(), &lights);
    let rendered = Rendered {
        layers: targets.aovs.then_some(&layers),
        sums: sums.as_ref(),
        ..rendered
    };
    write_pictures(&targets.outputs, rendered, document)?;
    // Words come after the image: who does not read them must not hold it up.
    message!("{}{}", summary(&progress), beyond_bounces(cut, document.render.bounces));
    report_written(&targets.outputs);
    if let (Some(destination), Some(mut report)) = (&targets.report, report) {
        add_denoised(&mut report, document, denoised.as_ref());
        report["files"] = serde_json::json!(file_names(&targets.outputs));
        if ended_by.is_some() {
            report["stopped_by"] = "signal".into();
        }
        write_json(destination, &report)?;
    }
    if dropped > 0 {
        message!("{dropped} samples were left out: not finite, negative, or above 1e18");
    }
    ended_by.map_or(Ok(()), |signal| Err(signal.into()))
}

pub fn rendered<'a>(image: &'a Image, denoised: Option<&'a Denoised>, lights: &'a [LightLayer]) -> Rendered<'a> {
    let denoised = denoised.map(|denoised| denoised.image.as_ref());
    Rendered {
        denoised,
        lights,
        ..Rendered::from(image)
    }
}

/// Writes an image in all formats that are asked for.
pub fn write_pictures(outputs: &[PathBuf], rendered: Rendered<'_>, document: &Document) -> anyhow::Result<()> {
    outputs
        .iter()
        .try_for_each(|path| Ok(output::write(path, rendered, document)?))
}

/// Says where images are.
pub fn report_written(outputs: &[PathBuf]) {
    outputs.iter().for_each(|path| message!("wrote {}", path.display()));
}

/// Whether layers or sums have a place: in .exr images alone.
///
/// # Errors
/// Where none is written.
pub fn check_takes(option: &str, outputs: &[PathBuf]) -> anyhow::Result<()> {
    let is_exr = |path: &PathBuf| output::format_of(path).is_ok_and(|format| format == Format::Exr);
    if !outputs.iter().any(is_exr) {
        bail!("{option} writes into .exr images; give --output FILE.exr");
    }
    Ok(())
}

/// A progress bar on a terminal, else none.
pub struct Bar(ProgressBar);

/// Steps of a part of the work.
const BAR_STEPS: f64 = 1000.0;

impl Bar {
    pub fn new(template: &str, parts: u32) -> anyhow::Result<Self> {
        if !std::io::stderr().is_terminal() {
            return Ok(Self(ProgressBar::hidden()));
        }
        let bar = ProgressBar::new(u64::from(parts) * BAR_STEPS as u64);
        Ok(Self(bar.with_style(ProgressStyle::with_template(template)?)))
    }

    /// A line that says what is being loaded.
    fn waiting(loading: &Loading) -> anyhow::Result<Self> {
        let loading = loading.clone();
        let doing = move |_: &ProgressState, text: &mut dyn fmt::Write| {
            // A terminal that takes no text shows none.
            let _ = write!(text, "{}", loading.doing());
        };
        let line = Self::new("{spinner} {doing}", 1)?;
        line.0.set_style(line.0.style().with_key("doing", doing));
        line.0.enable_steady_tick(Duration::from_millis(100));
        Ok(line)
    }

    /// Shows how many parts are done.
    pub fn show(&self, done: f64, message: String) {
        self.0.set_position((BAR_STEPS * done) as u64);
        self.0.set_message(message);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// A picture as it is displayed, its longer side at most this.
pub fn thumbnail(image: &Image, view: &ViewSettings, side: u32) -> Option<image::DynamicImage> {
    let pixels = image::RgbaImage::from_raw(image.width, image.height, display(image, view))?;
    let side = side.min(image.width.max(image.height));
    Some(image::DynamicImage::from(pixels).thumbnail(side, side))
}

/// What became of the denoised image, for the report: which quality, null without; seconds; error with its band.
pub fn add_denoised(report: &mut serde_json::Value, document: &Document, denoised: Option<&Denoised>) {
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
pub fn render_to_end(
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
    let bar = Bar::new("{bar:40} {msg}, {eta} left", 1)?;
    let mut show_progress = |progress: &Progress| {
        let error = progress.noise.map_or(String::new(), |noise| {
            format!(", error {:.2} %", 100.0 * noise.relative)
        });
        let message = format!("{:.0} samples per pixel{error}", progress.mean_samples);
        bar.show(progress.share_done(document.render.time_s), message);
        keep_going()
    };
    let mut step_denoiser = StepDenoiser::new(document);
    let ended = to_end::step_to_end(session, engine, document, &mut step_denoiser, &mut show_progress)?;
    drop(bar);
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
    let luminance: f64 = (0..film.pixel_count()).map(|pixel| film.luminance_of(pixel)).sum();
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
        "mean_luminance": luminance / film.pixel_count() as f64,
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
