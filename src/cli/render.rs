//! `glossmith render`: a document from arguments, a picture in a file.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::Context;
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::names;
use crate::document::parameter::{assign, parse_color};
use crate::document::preset;
use crate::document::{Background, Document, MaterialSettings, PixelFilter, Strategy};
use crate::optics::random::Sequence;
use crate::optics::tone::ToneCurve;
use crate::render::output::{self, format_of};
use crate::render::{EngineChoice, Progress, Session};
use crate::scene::ModelSource;
use crate::scene::environment::EnvironmentSource;

/// Step of the session between two looks at the clock and the progress bar.
const STEP: Duration = Duration::from_millis(200);

/// Arguments of `glossmith render`.
#[derive(Debug, Args)]
pub struct RenderArguments {
    /// What to render: a built-in model or a .glb or .gltf file.
    #[arg(long, default_value = "teapot", value_name = "FILE|teapot|sphere|plane|shaderball")]
    model: ModelSource,
    /// Put the model on a ground plane.
    #[arg(long)]
    ground: bool,
    /// Where the light comes from: a built-in environment or a .hdr or .exr file.
    #[arg(long, default_value = "studio", value_name = "FILE|studio|sky|furnace")]
    environment: EnvironmentSource,
    /// Turn the environment about the vertical axis, anticlockwise seen from above.
    #[arg(long, default_value_t = 0.0, value_name = "DEG", allow_negative_numbers = true)]
    environment_rotation: f32,
    /// Factor of the environment's radiance.
    #[arg(long, default_value_t = 1.0, value_name = "X")]
    environment_strength: f32,
    /// What the camera sees where it meets nothing.
    #[arg(long, default_value = "environment", value_name = "environment|transparent|#rrggbb", value_parser = parse_background)]
    background: Background,
    /// The material of everything: the name of a shipped one, or a .json file. Without it a file's own materials stay.
    #[arg(long, value_name = "FILE|NAME")]
    material: Option<String>,
    /// Set a parameter of every material, such as specular.roughness=0.2. May be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    assignments: Vec<String>,
    /// Where the camera is, in degrees around and above its target.
    #[arg(long, value_name = "YAW,PITCH", value_parser = parse_numbers::<2>, allow_hyphen_values = true, conflicts_with = "camera_position")]
    camera_orbit: Option<[f64; 2]>,
    /// How far the camera is from its target, in the model's units. Without it the model fills the picture.
    #[arg(long, value_name = "X", conflicts_with = "camera_position")]
    camera_distance: Option<f64>,
    /// What the camera looks at. Without it the centre of the model.
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_numbers::<3>, allow_hyphen_values = true)]
    camera_target: Option<[f64; 3]>,
    /// Where the camera is, instead of orbit and distance.
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_numbers::<3>, allow_hyphen_values = true)]
    camera_position: Option<[f64; 3]>,
    /// Vertical field of view.
    #[arg(long, value_name = "DEG")]
    fov: Option<f64>,
    /// Pixel filter: box (to compare with other renderers) or gaussian (smoother edges).
    #[arg(long, default_value = "gaussian", value_name = "box|gaussian", value_parser = names::filter)]
    filter: PixelFilter,
    /// Width and height in pixels.
    #[arg(long, default_value = "512x512", value_name = "WxH", value_parser = parse_size)]
    size: [u32; 2],
    /// Samples a pixel [default: 256, or no limit with --time].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    samples: Option<u32>,
    /// Stop after this time of rendering.
    #[arg(long, value_name = "SECONDS")]
    time: Option<f64>,
    /// Reflections that a path may have, 1 to 64.
    #[arg(long, default_value_t = 64, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=64))]
    bounces: u32,
    /// Random numbers: sobol (Owen-scrambled, less noise) or independent.
    #[arg(long, default_value = "sobol", value_name = "sobol|independent", value_parser = names::sequence)]
    sequence: Sequence,
    /// How light is found: by sampling the lobe, the light, or both weighed against each other.
    #[arg(long, default_value = "mis", value_name = "lobe|light|mis", value_parser = names::strategy)]
    strategy: Strategy,
    /// Changes all random numbers.
    #[arg(long, default_value_t = 0, value_name = "N")]
    seed: u32,
    /// The engine: a hardware GPU if there is one, else the faster one here; the GPU; the processor.
    #[arg(long, default_value = "auto", value_name = "auto|gpu|cpu")]
    engine: EngineChoice,
    /// Tone curve of .png pictures.
    #[arg(long, default_value = "agx", value_name = "agx|aces|pbr-neutral|none", value_parser = names::tone)]
    tone_map: ToneCurve,
    /// Exposure of .png pictures, in stops.
    #[arg(long, default_value_t = 0.0, value_name = "EV", allow_negative_numbers = true)]
    exposure: f32,
    /// Picture to write: .png (with exposure and tone curve), .exr or .hdr (linear). May be repeated [default:
    /// glossmith.png].
    #[arg(long = "output", value_name = "FILE")]
    outputs: Vec<PathBuf>,
    /// Write what was rendered, how and how fast, as JSON.
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
}

/// Renders as the arguments say.
///
/// # Errors
/// One line that names the file, what is wrong and what to do.
pub fn run(arguments: &RenderArguments) -> anyhow::Result<()> {
    let default_output = [PathBuf::from("glossmith.png")];
    let outputs = if arguments.outputs.is_empty() {
        &default_output
    } else {
        arguments.outputs.as_slice()
    };
    // Before the work, not after it.
    for path in outputs {
        format_of(path)?;
    }
    let begun = Instant::now();
    let mut session = Session::open(arguments.engine)?;
    let document = document(arguments, &mut session)?;
    session.submit(&document)?;
    render(session, &document, begun, outputs, arguments.report.as_deref())
}

/// Renders the default document to `glossmith.png`.
///
/// # Errors
/// Where the picture can't be written.
pub fn run_default(engine: EngineChoice) -> anyhow::Result<()> {
    let begun = Instant::now();
    let mut session = Session::open(engine)?;
    let document = Document::default();
    session.submit(&document)?;
    render(session, &document, begun, &[PathBuf::from("glossmith.png")], None)
}

/// Renders a submitted document to files.
fn render(
    mut session: Session,
    document: &Document,
    begun: Instant,
    outputs: &[PathBuf],
    report: Option<&Path>,
) -> anyhow::Result<()> {
    eprintln!("{}: {}", session.engine(), session.engine().reason);
    let setup_seconds = begun.elapsed().as_secs_f64();
    let progress = step_to_end(&mut session, document)?;
    let image = session.image()?;
    for path in outputs {
        output::write(path, &image, &document.view)?;
        eprintln!("wrote {}", path.display());
    }
    if let Some(path) = report {
        let text = serde_json::to_string_pretty(&json_report(&mut session, document, setup_seconds, progress)?)?;
        std::fs::write(path, text + "\n")
            .with_context(|| format!("{}: the report could not be written", path.display()))?;
    }
    Ok(())
}

/// Steps until the session is done, with a progress bar on a terminal.
fn step_to_end(session: &mut Session, document: &Document) -> anyhow::Result<Progress> {
    let bar = if std::io::stderr().is_terminal() && document.render.time_s.is_none() {
        let style = ProgressStyle::with_template("{bar:40} {pos}/{len} samples a pixel, {eta} left")?;
        ProgressBar::new(u64::from(document.render.samples)).with_style(style)
    } else {
        ProgressBar::hidden()
    };
    let mut progress = session.progress();
    while !progress.is_done {
        progress = session.step(STEP)?;
        bar.set_position(u64::from(progress.samples_per_pixel));
    }
    bar.finish_and_clear();
    Ok(progress)
}

/// The report of `--report`.
fn json_report(
    session: &mut Session,
    document: &Document,
    setup_seconds: f64,
    progress: Progress,
) -> anyhow::Result<serde_json::Value> {
    let engine = session.engine().clone();
    let effects = session.job().map(|job| job.plan.effects()).unwrap_or_default();
    let film = session.film()?;
    let seconds = progress.render_seconds.max(1e-9);
    let samples = film.samples() + film.dropped;
    Ok(serde_json::json!({
        "version": env!("CARGO_PKG_VERSION"),
        "engine": engine.kind,
        "adapter": engine.adapter,
        "driver": engine.driver,
        "engine_reason": engine.reason,
        "width": film.width,
        "height": film.height,
        "samples_per_pixel": progress.samples_per_pixel,
        "setup_seconds": setup_seconds,
        "render_seconds": progress.render_seconds,
        "samples_per_second": samples as f64 / seconds,
        "rays": film.rays,
        "rays_per_second": film.rays as f64 / seconds,
        "dropped_samples": film.dropped,
        "effects": effects,
        "seed": document.render.seed,
    }))
}

/// The document that the arguments describe.
fn document(arguments: &RenderArguments, session: &mut Session) -> anyhow::Result<Document> {
    let model = session.assets().model(&arguments.model)?;
    let mut document = Document {
        model: arguments.model.clone(),
        ground: arguments.ground,
        ..Document::default()
    };
    if let Some(name) = &arguments.material {
        let material = preset::find(name)?;
        material.warnings.iter().for_each(|warning| log::warn!("{warning}"));
        document.materials = vec![material.value];
    } else if matches!(arguments.model, ModelSource::File(_)) {
        document.materials = model.slots.iter().map(MaterialSettings::from_slot).collect();
    }
    for assignment in &arguments.assignments {
        for material in &mut document.materials {
            assign(material, assignment).with_context(|| format!("--set {assignment}"))?;
        }
    }
    let lighting = &mut document.lighting;
    lighting.environment = arguments.environment.clone();
    lighting.rotation_deg = arguments.environment_rotation;
    lighting.strength = arguments.environment_strength;
    lighting.background = arguments.background;
    let camera = &mut document.camera;
    if let Some([yaw_deg, pitch_deg]) = arguments.camera_orbit {
        (camera.yaw_deg, camera.pitch_deg) = (yaw_deg, pitch_deg);
    }
    camera.target = arguments.camera_target;
    camera.distance = arguments.camera_distance;
    camera.position = arguments.camera_position;
    camera.fov_deg = arguments.fov.unwrap_or(camera.fov_deg);
    document.view.tone_map = arguments.tone_map;
    document.view.exposure_ev = arguments.exposure;
    let render = &mut document.render;
    [render.width, render.height] = arguments.size;
    // With a time limit only, samples are not limited.
    render.samples = arguments.samples.unwrap_or(if arguments.time.is_some() {
        u32::MAX
    } else {
        render.samples
    });
    render.time_s = arguments.time;
    render.bounces = arguments.bounces;
    render.sequence = arguments.sequence;
    render.strategy = arguments.strategy;
    render.seed = arguments.seed;
    render.filter = arguments.filter;
    document.check()?;
    Ok(document)
}

fn parse_background(text: &str) -> Result<Background, String> {
    match text {
        "environment" => Ok(Background::Environment),
        "transparent" => Ok(Background::Transparent),
        color => parse_color(color)
            .map(Background::Color)
            .map_err(|error| error.to_string()),
    }
}

fn parse_numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let parts: Vec<&str> = text.split(',').collect();
    let numbers: Vec<f64> = parts
        .iter()
        .filter_map(|part| part.trim().parse().ok())
        .filter(|x: &f64| x.is_finite())
        .collect();
    let count = parts.len();
    <[f64; N]>::try_from(numbers)
        .ok()
        .filter(|_| count == N)
        .ok_or_else(|| {
            format!(
                "{N} numbers with commas between them are expected, such as {}",
                ["1"; N].join(",")
            )
        })
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let parsed = text
        .split_once(['x', 'X'])
        .and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    parsed
        .filter(|size: &[u32; 2]| size.iter().all(|side| (1..=65_535).contains(side)))
        .ok_or_else(|| "a width and a height are expected, such as 640x480".to_owned())
}
