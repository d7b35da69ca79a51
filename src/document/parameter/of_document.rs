//! The settings of a document: camera, light, view, sampling, and when rendering stops.

use std::ops::RangeInclusive;
use std::sync::LazyLock;

use super::accessors::{choice, field, optional};
use super::line::{real, single};
use super::{Kind, Parameter, Stage, Value, choices};
use crate::document::{
    Background, Denoise, DenoiseWhen, Document, GroundKind, LightPaths, PixelFilter, Strategy, range,
};
use crate::optics::random::Sequence;
use crate::optics::tone::ToneCurve;
use crate::scene::camera::Projection;

type Accessors = super::Accessors<Document>;

/// Every setting that is a value of its own, in the order of the panels. What names a file, the list of area lights, and
/// the rendered part of the image stand beside them.
pub static SETTINGS: LazyLock<Vec<Parameter<Document>>> = LazyLock::new(|| {
    let mut all = lighting();
    all.extend(camera());
    all.extend(view());
    all.extend(sampling());
    all.extend(stopping());
    all
});

#[rustfmt::skip]
fn lighting() -> Vec<Parameter<Document>> {
    use Stage::{Geometry, Lighting, Materials};
    vec![
        of("lighting.rotation", Lighting, "Rotation", "Turns the environment about the vertical axis, anticlockwise seen from above. In the viewport: drag with shift.", single(range::ROTATION_DEG, "°"), field!(Number lighting.rotation_deg))
            .named("Environment rotation").flag("environment-rotation").bar(-180.0, 180.0).decimals(1),
        of("lighting.strength", Lighting, "Strength", "Factor of the environment's radiance.", single(range::STRENGTH, ""), field!(Number lighting.strength))
            .named("Environment strength").flag("environment-strength").bar(0.0, 4.0),
        of("lighting.background_blur", Lighting, "Blur", "Blurs the environment where the camera sees it, over this angle; light and reflections stay sharp.", single(range::BACKGROUND_BLUR_DEG, "°"), field!(Number lighting.background_blur_deg))
            .named("Background blur").group("Background").flag("background-blur").bar(0.0, 45.0).decimals(1).applies(|document| document.lighting.background == Background::Environment),
        of("scene.unit", Stage::Display, "Scene unit", "Metres per scene unit. Used only to convert the power of lights.", real(range::UNIT_M, "m"), field!(Real unit_m))
            .named("Scene unit").group("Area lights").flag("scene-unit").applies(|document| !document.lighting.area_lights.is_empty()),
        of("lighting.light_groups", Stage::Sampling, "Separate", "Sums the light of each group apart: the mix changes without rendering again, and .exr images get a layer of each group.", Kind::Toggle, field!(Toggle lighting.light_groups))
            .named("Light groups").group("Light groups").flag("light-groups"),
        of("scene.ground", Geometry, "Ground", "A surface under the model that catches its shadow.", Kind::Toggle, field!(Toggle ground))
            .named("Ground").group("Ground").flag("ground"),
        of("lighting.ground.kind", Geometry, "Kind", "What the ground is.", choices::<GroundKind>(), choice!(lighting.ground.kind))
            .named("Kind of ground").group("Ground").flag("ground-kind").applies(|document| document.ground),
        of("lighting.ground_color", Materials, "Colour", "Albedo of the ground.", Kind::Color, field!(Color lighting.ground_color))
            .named("Ground colour").group("Ground").flag("ground-color").applies(|document| document.ground),
        of("lighting.ground.reflection", Materials, "Reflection", "How much of a varnish lies on the ground: it reflects as glass does, times this.", single(range::SHARE, ""), field!(Number lighting.ground.reflection))
            .named("Ground reflection").group("Ground").flag("ground-reflection").bar(0.0, 1.0).applies(|document| document.ground),
        of("lighting.ground.roughness", Materials, "Roughness", "How rough the reflection is.", single(range::SHARE, ""), field!(Number lighting.ground.roughness))
            .named("Ground roughness").group("Ground").flag("ground-roughness").bar(0.0, 1.0).applies(|document| document.ground && document.lighting.ground.reflection > 0.0),
        of("lighting.ground.yaw", Geometry, "Turn", "Which side of the cyclorama is open, as the yaw of a camera that looks at its wall.", real(range::YAW_DEG, "°"), field!(Real lighting.ground.yaw_deg))
            .named("Cyclorama turn").group("Ground").flag("cyclorama-turn").bar(-180.0, 180.0).decimals(1).applies(is_cyclorama),
        of("lighting.ground.wall_distance", Geometry, "Wall", "How far the cyclorama's wall is behind the model's centre, in bounding radii.", real(range::AREA_LENGTH, ""), field!(Real lighting.ground.wall_distance))
            .named("Cyclorama wall").group("Ground").flag("cyclorama-wall").bar(1.0, 10.0).decimals(2).applies(is_cyclorama),
        of("lighting.ground.bend_radius", Geometry, "Bend", "Radius of the cyclorama's bend from floor to wall, in bounding radii; no more than the wall's distance is used.", real(range::AREA_LENGTH, ""), field!(Real lighting.ground.bend_radius))
            .named("Cyclorama bend").group("Ground").flag("cyclorama-bend").bar(0.5, 10.0).decimals(2).applies(is_cyclorama),
    ]
}

fn is_cyclorama(document: &Document) -> bool {
    document.ground && document.lighting.ground.kind == GroundKind::Cyclorama
}

#[rustfmt::skip]
fn camera() -> Vec<Parameter<Document>> {
    use Stage::Camera;
    vec![
        of("camera.fov", Camera, "Field of view", "Vertical field of view; small is a telephoto lens.", real(range::FOV_DEG, "°"), field!(Real camera.fov_deg))
            .named("Field of view").flag("fov").bar(5.0, 120.0).decimals(1),
        of("camera.projection", Camera, "Projection", "Perspective as in an eye, or parallel rays as in a drawing.", choices::<Projection>(), choice!(camera.projection))
            .named("Projection").flag("projection"),
        of("camera.yaw", Camera, "Yaw", "Turns the camera about the vertical axis. In the viewport: drag.", real(range::YAW_DEG, "°"), field!(Real camera.yaw_deg))
            .named("Yaw").bar(-180.0, 180.0).decimals(1),
        of("camera.pitch", Camera, "Pitch", "Height of the camera above the target's horizon. In the viewport: drag.", real(range::PITCH_DEG, "°"), field!(Real camera.pitch_deg))
            .named("Pitch").bar(-90.0, 90.0).decimals(1),
        of("camera.distance", Camera, "Distance", "Distance from the target in scene units; auto: the model fills the image.", auto(real(range::DISTANCE, "")), optional!(Real camera.distance))
            .named("Distance").flag("camera-distance"),
        of("camera.target", Camera, "Target", "What the camera looks at; auto: the centre of the model.", auto(place()), optional!(Place camera.target))
            .named("Target").flag("camera-target"),
        of("camera.position", Camera, "Position", "Where the camera is; replaces yaw, pitch and distance unless auto.", auto(place()), optional!(Place camera.position))
            .named("Position").flag("camera-position"),
        of("camera.roll", Camera, "Roll", "Turns the camera about the line to its target, clockwise: what it sees turns the other way.", real(range::YAW_DEG, "°"), field!(Real camera.roll_deg))
            .named("Roll").flag("camera-roll").bar(-180.0, 180.0).decimals(1),
        of("camera.aperture", Camera, "Aperture", "Radius of the lens in bounding radii of the model; at 0 it is a pinhole, with which everything is sharp.", real(range::APERTURE, ""), field!(Real camera.aperture))
            .named("Aperture").flag("aperture").bar(0.0, 0.2).decimals(4),
        of("camera.focus_distance", Camera, "Focus", "How far away things are sharp, in scene units; auto: at the target. In the viewport: click with ctrl.", auto(real(range::DISTANCE, "")), optional!(Real camera.focus_distance))
            .named("Focus distance").flag("focus-distance").decimals(4).applies(|document| document.camera.aperture > 0.0),
    ]
}

#[rustfmt::skip]
fn view() -> Vec<Parameter<Document>> {
    use Stage::Display;
    vec![
        of("view.tone_map", Display, "Tone map", "How radiance beyond what a screen can show is brought into its range.", choices::<ToneCurve>(), choice!(view.tone_map))
            .named("Tone map").flag("tone-map"),
        of("view.exposure", Display, "Exposure", "Brightness in stops: +1 doubles it.", single(range::EXPOSURE_EV, "EV"), field!(Number view.exposure_ev))
            .named("Exposure").flag("exposure").bar(-6.0, 6.0).decimals(2),
        of("view.auto_exposure", Display, "Automatic", "Brings the image's mean brightness to middle grey; the exposure is added to that.", Kind::Toggle, field!(Toggle view.auto_exposure))
            .named("Automatic exposure").flag("auto-exposure"),
        of("view.white_balance", Display, "White balance", "Temperature of the light that appears white: lower is cooler, higher is warmer.", single(range::WHITE_K, "K"), field!(Number view.white_k))
            .named("White balance").flag("white-balance").bar(2500.0, 12_000.0).decimals(0),
        of("view.contrast", Display, "Contrast", "Contrast around middle grey, applied before the tone map.", single(range::CONTRAST, ""), field!(Number view.contrast))
            .named("Contrast").flag("contrast").bar(0.5, 2.0).decimals(2),
        of("view.saturation", Display, "Saturation", "Distance of colours from grey, applied before the tone map. At 0 everything is grey.", single(range::SATURATION, ""), field!(Number view.saturation))
            .named("Saturation").flag("saturation").bar(0.0, 2.0).decimals(2),
        of("view.vignette", Display, "Vignette", "Darkens the corners as a lens does. At 0 it is off.", single(range::VIGNETTE, ""), field!(Number view.vignette))
            .named("Vignette").flag("vignette").bar(0.0, 1.0).decimals(2),
        of("view.glare", Display, "Glare", "Share of the light that spreads around where it falls, as in a lens: highlights glow. At 0 it is off.", single(range::GLARE, ""), field!(Number view.glare))
            .named("Glare").flag("glare").bar(0.0, 0.5).decimals(2),
        of("view.denoise", Stage::Goal, "Denoise", "Denoises with Open Image Denoise and estimates the remaining error. Auto blends with the raw render and applies the noise limit to the result.", choices::<Denoise>(), choice!(view.denoise))
            .named("Denoise").flag("denoise"),
        of("view.denoise_when", Display, "Denoise when", "When the window denoises: from the first sample on, or at the end.", choices::<DenoiseWhen>(), choice!(view.denoise_when))
            .named("Denoise when").applies(|document| document.view.denoise != Denoise::Off),
    ]
}

#[rustfmt::skip]
fn sampling() -> Vec<Parameter<Document>> {
    use Stage::{Sampling, Size};
    vec![
        of("render.width", Size, "Width", "Columns of pixels.", count(range::SIZE), field!(Count render.width))
            .named("Width").group("Image size"),
        of("render.height", Size, "Height", "Rows of pixels.", count(range::SIZE), field!(Count render.height))
            .named("Height").group("Image size"),
        of("render.bounces", Sampling, "Bounces", "Reflections that a path may have.", count(range::BOUNCES), field!(Count render.bounces))
            .named("Bounces").group("Sampling").flag("bounces").bar(1.0, 64.0),
        of("render.strategy", Sampling, "Light sampling", "BSDF sampling, light sampling, or both (MIS). All converge to the same image.", choices::<Strategy>(), choice!(render.strategy))
            .named("Light sampling").group("Sampling").flag("strategy"),
        of("render.light_paths", Sampling, "Light shown", "Renders all light, direct light only, or indirect light only.", choices::<LightPaths>(), choice!(render.light_paths))
            .named("Light shown").group("Sampling").flag("light-paths"),
        of("render.sequence", Sampling, "Sequence", "The random numbers that are drawn.", choices::<Sequence>(), choice!(render.sequence))
            .named("Sequence").group("Sampling").flag("sequence"),
        of("render.filter", Sampling, "Pixel filter", "How samples are spread over a pixel and its neighbours.", choices::<PixelFilter>(), choice!(render.filter))
            .named("Pixel filter").group("Sampling").flag("filter"),
        of("render.firefly_clamp", Sampling, "Firefly clamp", "Clamps the radiance of indirect light. The report gives the energy removed (clamped_energy).", off(single(range::FIREFLY_CLAMP, ""), Value::Number(10.0)), optional!(Number render.firefly_clamp))
            .named("Firefly clamp").group("Sampling").flag("firefly-clamp"),
        of("render.seed", Sampling, "Seed", "Random seed.", Kind::Count { range: [0, u32::MAX] }, field!(Count render.seed))
            .named("Seed").group("Sampling").flag("seed"),
    ]
}

#[rustfmt::skip]
fn stopping() -> Vec<Parameter<Document>> {
    use Stage::Goal;
    vec![
        of("render.samples", Goal, "Samples", "Samples per pixel at which rendering stops: noise halves with four times as many. With adaptive sampling, the most that a pixel gets.", count(range::SAMPLES), field!(Count render.samples))
            .named("Samples").group("Image").flag("samples"),
        of("render.time", Goal, "Time limit", "Stops rendering after this time.", off(real(range::TIME_S, "s"), Value::Real(60.0)), optional!(Real render.time_s))
            .named("Time limit").group("Image").flag("time"),
        of("render.noise", Goal, "Noise limit", "Stops at this estimated relative error (RMS pixel error over mean luminance); 0.01 is 1 %.", off(real(range::NOISE, ""), Value::Real(0.01)), optional!(Real render.noise))
            .named("Noise limit").group("Accuracy").flag("noise").percent(),
        of("render.min_samples", Goal, "Least samples", "Samples that each pixel has before its error is believed, so that small lights are not missed.", count(range::MIN_SAMPLES), field!(Count render.min_samples))
            .named("Minimum samples").group("Accuracy").flag("min-samples"),
        of("render.adaptive", Goal, "Adaptive", "Adaptive or uniform sampling; auto: adaptive if there is a noise limit.", auto(Kind::Toggle), optional!(Toggle render.adaptive))
            .named("Adaptive sampling").group("Accuracy").flag("adaptive"),
    ]
}

fn of(
    key: &'static str,
    stage: Stage,
    label: &'static str,
    help: &'static str,
    kind: Kind,
    accessors: Accessors,
) -> Parameter<Document> {
    let group = match key.split('.').next() {
        Some("lighting") => "Environment",
        Some("camera") => "Camera",
        _ => "View",
    };
    let mut parameter = Parameter::plain(key, label, help, kind, stage, accessors);
    (parameter.group, parameter.row.step) = (group, 1.0);
    parameter
}

fn count(range: RangeInclusive<f64>) -> Kind {
    let (low, high) = range.into_inner();
    let range = [low as u32, high as u32];
    Kind::Count { range }
}

fn place() -> Kind {
    let (low, high) = range::COORDINATE.into_inner();
    Kind::Place { range: [low, high] }
}

/// What the program chooses where it is not given.
fn auto(kind: Kind) -> Kind {
    Kind::Optional {
        kind: Box::new(kind),
        word: "auto",
        at_first: None,
    }
}

/// What is left out where it is not given.
fn off(kind: Kind, at_first: Value) -> Kind {
    Kind::Optional {
        kind: Box::new(kind),
        word: "off",
        at_first: Some(at_first),
    }
}
