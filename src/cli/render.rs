//! `glossmith render`: a document from arguments, a picture in a file.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::{names, parse};
use crate::document::effect::EffectSwitches;
use crate::document::of_model::materials_of;
use crate::document::{AreaLight, Background, Denoise, Document, ImportLobe, PixelFilter, Strategy, range};
use crate::optics::random::Sequence;
use crate::optics::tone::ToneCurve;
use crate::render::denoise::{Attendant, Denoised};
use crate::render::output::{self, Format, Layers, Rendered};
use crate::render::{EngineChoice, Progress, Session, SessionError, StopReason};
use crate::scene::environment::{ENDINGS, EnvironmentEncoding, EnvironmentSource};
use crate::scene::{Model, ModelOptions, ModelSource, is_model};
use crate::store::file::{self, Opened};
use crate::store::preset;

/// Step of the session between two looks at the clock and the progress bar.
const STEP: Duration = Duration::from_millis(200);
/// How long the picture may take that is rendered in the window's place, seconds: as long as one waits gladly.
const DEFAULT_SCENE_SECONDS: f64 = 8.0;

/// Arguments of `glossmith render`.
#[derive(Debug, Args)]
pub struct RenderArguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// Picture to write: .png (with exposure and tone curve, the document inside), .exr or .hdr (linear). May be repeated.
    #[arg(long = "output", default_value = "glossmith.png", value_name = "FILE", value_parser = parse::picture)]
    outputs: Vec<PathBuf>,
    /// Write albedo, normal, depth, number of samples and variance as layers into .exr pictures.
    #[arg(long)]
    aovs: bool,
    /// Write what was rendered, how and how fast, as JSON.
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
}

/// Arguments that describe what is rendered, and how.
#[derive(Debug, Args)]
pub struct SceneArguments {
    /// What to render: a built-in model, a file (.glb, .gltf, .obj, .ply, .stl, .zip), or a folder with one.
    #[arg(long, default_value = "teapot", value_name = "FILE|teapot|sphere|plane|shaderball")]
    model: ModelSource,
    /// Which scene of the model's file, counted from 0. Without it the file's default one.
    #[arg(long, value_name = "N")]
    scene: Option<usize>,
    /// Which variant of the model's materials. Without it the file's own materials.
    #[arg(long, value_name = "NAME")]
    variant: Option<String>,
    /// Pose the model as its first animation does at this time. Without it as the file has it at rest.
    #[arg(long, value_name = "SECONDS", value_parser = parse::number_in(range::POSE_TIME_S), allow_negative_numbers = true)]
    time_of_pose: Option<f64>,
    /// The longest side of a model's textures in texels; larger ones are halved until they fit.
    #[arg(long, default_value = "8192", value_name = "N", value_parser = parse::number_in(range::TEXTURE_SIDE))]
    texture_size: f64,
    /// Write what became of the parts of the model's file (used, approximated, ignored, missing), as JSON.
    #[arg(long, value_name = "FILE")]
    import_report: Option<PathBuf>,
    /// Put the model on a ground plane.
    #[arg(long)]
    ground: bool,
    /// Where the light comes from: a built-in environment, a picture of the whole sphere (.hdr, .exr, .png, .jpg, .tif,
    /// .webp; lat-long or cube map), or a folder with the six faces of a cube.
    #[arg(long, default_value = "studio", value_name = "FILE|studio|sky|furnace")]
    environment: EnvironmentSource,
    /// What the numbers of a .png, .jpg, .tif or .webp environment stand for: colours of a screen, or light.
    #[arg(long, default_value = "display", value_name = "display|linear", value_parser = parse::environment_encoding)]
    environment_encoding: EnvironmentEncoding,
    /// Turn the environment about the vertical axis, anticlockwise seen from above.
    #[arg(long, default_value = "0", value_name = "DEG", value_parser = parse::number_in(range::ROTATION_DEG), allow_negative_numbers = true)]
    environment_rotation: f64,
    /// Factor of the environment's radiance.
    #[arg(long, default_value = "1", value_name = "X", value_parser = parse::number_in(range::STRENGTH), allow_negative_numbers = true)]
    environment_strength: f64,
    /// A rectangle (or triangle) that shines, looking at the middle of the model: its direction in degrees, then distance, sides (all
    /// in bounding radii of the model) and radiance. May be repeated up to 8 times.
    #[arg(long = "area-light", value_name = "YAW,PITCH,DISTANCE,WIDTH,HEIGHT,STRENGTH[,triangle][,#rrggbb]", value_parser = parse::area_light, allow_hyphen_values = true)]
    area_lights: Vec<AreaLight>,
    /// What the camera sees where it meets nothing.
    #[arg(long, default_value = "environment", value_name = "environment|transparent|#rrggbb", value_parser = parse::background)]
    background: Background,
    /// Blur the environment where the camera sees it, over this angle; light and reflections stay sharp.
    #[arg(long, default_value = "0", value_name = "DEG", value_parser = parse::number_in(range::BACKGROUND_BLUR_DEG), allow_negative_numbers = true)]
    background_blur: f64,
    /// The material of everything: the name of a shipped one, or a .json file. Without it a file's own materials stay.
    #[arg(long, value_name = "FILE|NAME")]
    material: Option<String>,
    /// The lobe of a file's own materials: geometric, its roughness matched to the look of the file's, or ggx.
    #[arg(long, default_value = "geometric", value_name = "geometric|ggx", value_parser = names::choice::<ImportLobe>)]
    import_lobe: ImportLobe,
    /// Set a parameter of every material, such as specular.roughness=0.2, or a setting, such as camera.fov=40. Stands over
    /// all other options. May be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse::assignment)]
    assignments: Vec<String>,
    /// Where the camera is, in degrees around and above its target.
    #[arg(long, value_name = "YAW,PITCH", value_parser = parse::orbit, allow_hyphen_values = true, conflicts_with = "camera_position")]
    camera_orbit: Option<[f64; 2]>,
    /// How far the camera is from its target, in the model's units. Without it the model fills the picture.
    #[arg(long, value_name = "X", value_parser = parse::number_in(range::DISTANCE), allow_negative_numbers = true, conflicts_with = "camera_position")]
    camera_distance: Option<f64>,
    /// What the camera looks at. Without it the centre of the model.
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::place, allow_hyphen_values = true)]
    camera_target: Option<[f64; 3]>,
    /// Where the camera is, instead of orbit and distance.
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::place, allow_hyphen_values = true)]
    camera_position: Option<[f64; 3]>,
    /// Vertical field of view.
    #[arg(long, default_value = "30", value_name = "DEG", value_parser = parse::number_in(range::FOV_DEG), allow_negative_numbers = true)]
    fov: f64,
    /// Radius of the lens, in bounding radii of the model; 0 is a pinhole, with which everything is sharp.
    #[arg(long, default_value = "0", value_name = "X", value_parser = parse::number_in(range::APERTURE), allow_negative_numbers = true)]
    aperture: f64,
    /// How far away things are sharp, in the model's units. Without it at the target.
    #[arg(long, value_name = "X", value_parser = parse::number_in(range::DISTANCE), allow_negative_numbers = true)]
    focus_distance: Option<f64>,
    /// Pixel filter: box (to compare with other renderers) or gaussian (smoother edges).
    #[arg(long, default_value = "gaussian", value_name = "box|gaussian", value_parser = names::choice::<PixelFilter>)]
    filter: PixelFilter,
    /// Width and height in pixels. A picture takes some 100 bytes of memory a pixel, 130 more where it is denoised; one that
    /// does not fit the memory is refused before it is begun.
    #[arg(long, default_value = "512x512", value_name = "WxH", value_parser = parse::size)]
    size: [u32; 2],
    /// Render this part of the picture only, the rest staying transparent: shares of width and height.
    #[arg(long, value_name = "LEFT,TOP,RIGHT,BOTTOM", value_parser = parse::region)]
    region: Option<[f64; 4]>,
    /// Samples a pixel; with --adaptive on the most of a pixel [default: 256, or no limit with --time or --noise].
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..))]
    samples: Option<u32>,
    /// Stop after this time of rendering.
    #[arg(long, value_name = "SECONDS", value_parser = parse::number_in(range::TIME_S), allow_negative_numbers = true)]
    time: Option<f64>,
    /// Stop at this relative error of the picture: 0.02 is 2 %.
    #[arg(long, value_name = "X", value_parser = parse::number_in(range::NOISE), allow_negative_numbers = true)]
    noise: Option<f64>,
    /// Samples that each pixel has before its error is believed, so that small lights are not missed.
    #[arg(long, default_value_t = 16, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(2..=65536))]
    min_samples: u32,
    /// Whether samples go where the error is, or evenly over the picture [default: on with --noise, else off].
    #[arg(long, value_name = "on|off", value_parser = parse::on_or_off)]
    adaptive: Option<bool>,
    /// Reflections that a path may have, 1 to 64.
    #[arg(long, default_value_t = 64, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=64))]
    bounces: u32,
    /// Limit the radiance of light that was reflected twice or more; the report tells how much energy that takes
    /// (`clamped_energy`). Off unless given.
    #[arg(long, value_name = "X", value_parser = parse::number_in(range::FIREFLY_CLAMP), allow_negative_numbers = true)]
    firefly_clamp: Option<f64>,
    /// Random numbers: sobol (Owen-scrambled, less noise) or independent.
    #[arg(long, default_value = "sobol", value_name = "sobol|independent", value_parser = names::choice::<Sequence>)]
    sequence: Sequence,
    /// How light is found: by sampling the lobe, the light, or both weighed against each other.
    #[arg(long, default_value = "mis", value_name = "lobe|light|mis", value_parser = names::choice::<Strategy>)]
    strategy: Strategy,
    /// Which effects are simulated: those that the scene calls for; all, needed or not; or these alone (names of
    /// `glossmith plan`, with commas between; +NAME and -NAME change what the scene calls for).
    #[arg(
        long,
        default_value = "auto",
        value_name = "auto|all|LIST",
        allow_hyphen_values = true
    )]
    effects: EffectSwitches,
    /// Changes all random numbers.
    #[arg(long, default_value_t = 0, value_name = "N", allow_negative_numbers = true)]
    seed: u32,
    /// The engine: a hardware GPU if there is one, else the faster one here; the GPU; the processor.
    #[arg(long, default_value = "auto", value_name = "auto|gpu|cpu")]
    pub(super) engine: EngineChoice,
    /// Tone curve of .png pictures.
    #[arg(long, default_value = "agx", value_name = "agx|aces|pbr-neutral|none", value_parser = names::choice::<ToneCurve>)]
    tone_map: ToneCurve,
    /// Exposure of .png pictures, in stops.
    #[arg(long, default_value = "0", value_name = "EV", value_parser = parse::number_in(range::EXPOSURE_EV), allow_negative_numbers = true)]
    exposure: f64,
    /// Expose .png pictures so that their mean brightness is middle grey; --exposure is added.
    #[arg(long)]
    auto_exposure: bool,
    /// Take the picture's noise out with Open Image Denoise: quickly, as well as can be, or (auto) the less the nearer the
    /// samples alone are to the truth. With --noise and auto rendering stops at the error of the denoised picture.
    #[arg(long, default_value = "off", value_name = "off|fast|high|auto", value_parser = names::choice::<Denoise>)]
    denoise: Denoise,
}

/// Renders as the arguments say.
///
/// # Errors
/// One line that names the file, what is wrong and what to do.
pub fn run(arguments: &RenderArguments) -> anyhow::Result<()> {
    for path in arguments
        .outputs
        .iter()
        .chain(&arguments.report)
        .chain(&arguments.scene.import_report)
    {
        parse::check_writable(path)?;
    }
    let takes_layers = |path: &PathBuf| output::format_of(path).is_ok_and(|format| format == Format::Exr);
    if arguments.aovs && !arguments.outputs.iter().any(takes_layers) {
        bail!("--aovs writes layers into .exr pictures; give --output FILE.exr");
    }
    let begun = Instant::now();
    let scene = &arguments.scene;
    let mut session = Session::open(scene.engine)?;
    let document = scene.document(&mut session)?;
    let targets = Targets {
        outputs: &arguments.outputs,
        has_layers: arguments.aovs,
        report: arguments.report.as_deref(),
    };
    render(session, scene.engine, &document, begun, &targets)
}

/// What is written.
struct Targets<'a> {
    outputs: &'a [PathBuf],
    /// .exr pictures have layers.
    has_layers: bool,
    report: Option<&'a Path>,
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
    let mut document = Document::default();
    for file in files {
        open(file, &mut document, &mut session)?;
    }
    document.render.time_s = Some(DEFAULT_SCENE_SECONDS);
    let targets = Targets {
        outputs: &[path],
        has_layers: false,
        report: None,
    };
    render(session, engine, &document, begun, &targets)
}

/// Puts what a file holds in the document: a model, an environment, a material or a whole project.
fn open(path: &Path, document: &mut Document, session: &mut Session) -> anyhow::Result<()> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    match ending.to_ascii_lowercase().as_str() {
        _ if is_model(path) || path.is_dir() => {
            document.model = ModelSource::File(path.to_owned());
            let model = session.assets().model(&document.model, &document.import)?;
            document.materials = materials_of(&model, ImportLobe::default());
            document.add_lights_and_cameras(&model);
        }
        ending if ending != "png" && ENDINGS.contains(&ending) => {
            document.lighting.environment = EnvironmentSource::File(path.to_owned())
        }
        "json" | "png" => match file::open(path)? {
            Opened::Material(material) => {
                warn(&material.warnings);
                document.materials = vec![material.value];
            }
            Opened::Document(project) | Opened::Picture(project) => {
                warn(&project.warnings);
                *document = project.value;
            }
        },
        _ if !path.exists() => bail!(
            "{}: no such command or file; `glossmith --help` lists what there is",
            path.display()
        ),
        _ => bail!(
            "{}: neither a model (.glb, .gltf) nor an environment (.hdr, .exr), material or project (.json), or a \
             picture saved here (.png); give one of these",
            path.display()
        ),
    }
    Ok(())
}

fn warn(warnings: &[String]) {
    warnings.iter().for_each(|warning| log::warn!("{warning}"));
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
        session.keep_guides("layers of the picture are written");
    }
    let submitted = session.submit(document).map(|_| ());
    or_fall_back(submitted, &mut session, engine, document)?;
    eprintln!("{} ({})", session.engine(), session.engine().reason);
    let setup_seconds = begun.elapsed().as_secs_f64();
    let (progress, denoised) = step_to_end(&mut session, engine, document)?;
    eprintln!("{}", told(&progress));
    let image = session.image()?;
    let shown = denoised.as_ref().map(|denoised| &denoised.image);
    for path in targets.outputs {
        if targets.has_layers && output::format_of(path)? == Format::Exr {
            let layers = Layers {
                denoised: shown.cloned(),
                ..session.layers()?
            };
            output::write_layers(path, &layers)?;
        } else {
            let rendered = Rendered {
                image: &image,
                denoised: shown.map(Arc::as_ref),
            };
            output::write(path, rendered, document)?;
        }
        eprintln!("wrote {}", path.display());
    }
    if let Some(path) = targets.report {
        let mut report = json_report(&mut session, document, setup_seconds, progress, targets.has_layers)?;
        add_denoised(&mut report, document, denoised.as_ref());
        let text = serde_json::to_string_pretty(&report)?;
        std::fs::write(path, text + "\n")
            .with_context(|| format!("{}: the report could not be written", path.display()))?;
    }
    let dropped = session.film()?.dropped();
    if dropped > 0 {
        eprintln!("{dropped} samples were left out because they were not finite");
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

/// What became of the denoised picture, for the report: which quality, null without; seconds; error with its band.
fn add_denoised(report: &mut serde_json::Value, document: &Document, denoised: Option<&Denoised>) {
    let error = denoised.and_then(|denoised| denoised.error);
    report["denoised"] = denoised.map(|_| document.view.denoise.name()).into();
    report["denoise_seconds"] = denoised.map(|denoised| denoised.seconds).into();
    report["denoised_error"] = error.map(|error| error.value).into();
    report["denoised_error_low"] = error.map(|error| error.low).into();
    report["denoised_error_high"] = error.map(|error| error.high).into();
}

/// Steps until the session is done, with a progress bar on a terminal, and denoises the picture where that is asked for.
fn step_to_end(
    session: &mut Session,
    engine: EngineChoice,
    document: &Document,
) -> anyhow::Result<(Progress, Option<Denoised>)> {
    const BAR_STEPS: f64 = 1000.0;
    let bar = bar("{bar:40} {msg}, {eta} left", BAR_STEPS as u64)?;
    let mut attendant = Attendant::new(document);
    loop {
        let budget = attendant.budget(&session.progress(), STEP);
        let stepped = session.step(budget).map(|_| ());
        or_fall_back(stepped, session, engine, document)?;
        attendant.attend(session, &session.progress())?;
        let progress = session.progress();
        bar.set_position((BAR_STEPS * progress.share_done(document.render.time_s)) as u64);
        let error = progress.noise.map_or(String::new(), |noise| {
            format!(", error {:.2} %", 100.0 * noise.relative)
        });
        bar.set_message(format!("{:.0} samples a pixel{error}", progress.mean_samples));
        if progress.is_done {
            bar.finish_and_clear();
            let denoised = attendant.finish(session)?;
            return Ok((session.progress(), denoised));
        }
    }
}

/// What came of a render, in a line.
fn told(progress: &Progress) -> String {
    let samples = format!(
        "{:.0} samples a pixel in {:.1} s",
        progress.mean_samples, progress.render_seconds
    );
    let Some(noise) = progress.noise else { return samples };
    let [error, low, high] = [noise.relative, noise.low, noise.high].map(|share| 100.0 * share);
    let denoised = progress.denoised.map_or(String::new(), |told| {
        let [error, low, high] = [told.value, told.low, told.high].map(|share| 100.0 * share);
        format!(", denoised {error:.2} % ({low:.2} to {high:.2} %)")
    });
    let why = match (progress.is_converged(), progress.noise_wanted, progress.stopped_by) {
        (_, None, _) => "",
        (true, ..) => ", as exact as was asked for",
        (false, _, Some(StopReason::Time)) => ", less exact than was asked for: the time was over",
        (false, ..) => ", less exact than was asked for: no more samples are allowed",
    };
    format!("{samples}: error {error:.2} % ({low:.2} to {high:.2} %){denoised}{why}")
}

/// Goes on with the processor where the GPU fails, unless the GPU was asked for by name.
fn or_fall_back(
    outcome: Result<(), SessionError>,
    session: &mut Session,
    engine: EngineChoice,
    document: &Document,
) -> Result<(), SessionError> {
    match outcome {
        Err(SessionError::Gpu(error)) if engine == EngineChoice::Auto => {
            log::warn!("{error}; going on with the processor");
            session.fall_back_to_cpu(&error.to_string());
            session.submit(document).map(|_| ())
        }
        outcome => outcome,
    }
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
        "effects": effects,
        "seed": document.render.seed,
    }))
}

/// What became of the parts of a model's file, as JSON.
fn write_import_report(path: &Path, model: &Model) -> anyhow::Result<()> {
    let json = serde_json::json!({
        "model": model.name,
        "entries": model.report.entries,
        "scenes": model.scenes,
        "variants": model.variants,
        "animation_seconds": model.duration_s,
    });
    let text = serde_json::to_string_pretty(&json)?;
    file::save_atomically(path, text.as_bytes())?;
    Ok(())
}

impl SceneArguments {
    /// The document that the arguments describe.
    ///
    /// # Errors
    /// One line that names the file, what is wrong and what to do.
    pub(super) fn document(&self, session: &mut Session) -> anyhow::Result<Document> {
        let mut document = Document {
            model: self.model.clone(),
            import: ModelOptions {
                scene: self.scene,
                variant: self.variant.clone(),
                time_s: self.time_of_pose.map(|time| time as f32),
                texture_side_max: self.texture_size as u32,
                pictures: Vec::new(),
            },
            ground: self.ground,
            ..Document::default()
        };
        let model = session.assets().model(&self.model, &document.import)?;
        if let Some(path) = &self.import_report {
            write_import_report(path, &model)?;
        }
        if let Some(name) = &self.material {
            let material = preset::find(name)?;
            warn(&material.warnings);
            document.materials = vec![material.value];
        } else if matches!(self.model, ModelSource::File(_)) {
            document.materials = materials_of(&model, self.import_lobe);
        }
        let lighting = &mut document.lighting;
        lighting.environment = self.environment.clone();
        lighting.environment_encoding = self.environment_encoding;
        lighting.rotation_deg = self.environment_rotation as f32;
        lighting.strength = self.environment_strength as f32;
        lighting.background = self.background;
        lighting.background_blur_deg = self.background_blur as f32;
        lighting.area_lights = self.area_lights.clone();
        document.add_lights_and_cameras(&model);
        let camera = &mut document.camera;
        if let Some([yaw_deg, pitch_deg]) = self.camera_orbit {
            (camera.yaw_deg, camera.pitch_deg) = (yaw_deg, pitch_deg);
        }
        camera.target = self.camera_target;
        camera.distance = self.camera_distance;
        camera.position = self.camera_position;
        camera.fov_deg = self.fov;
        camera.aperture = self.aperture;
        camera.focus_distance = self.focus_distance;
        document.view.tone_map = self.tone_map;
        document.view.exposure_ev = self.exposure as f32;
        document.view.auto_exposure = self.auto_exposure;
        document.view.denoise = self.denoise;
        let render = &mut document.render;
        [render.width, render.height] = self.size;
        // With a time or noise to reach only, samples are not limited.
        let is_limited = self.time.or(self.noise).is_some();
        render.samples = self
            .samples
            .unwrap_or(if is_limited { u32::MAX } else { render.samples });
        render.region = self.region;
        render.time_s = self.time;
        render.noise = self.noise;
        render.min_samples = self.min_samples;
        render.adaptive = self.adaptive;
        render.bounces = self.bounces;
        render.firefly_clamp = self.firefly_clamp.map(|limit| limit as f32);
        render.sequence = self.sequence;
        render.strategy = self.strategy;
        render.seed = self.seed;
        render.filter = self.filter;
        render.effects = self.effects;
        for assignment in &self.assignments {
            document.assign(assignment)?;
        }
        document.check()?;
        Ok(document)
    }
}
