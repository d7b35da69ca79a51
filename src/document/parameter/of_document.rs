//! The settings of a document: camera, light, view, sampling, and when rendering stops.

use std::ops::RangeInclusive;
use std::sync::LazyLock;

use super::{Kind, Parameter, Stage, Value, choices};
use crate::document::{Denoise, Document, PixelFilter, Strategy, range};
use crate::named::Named;
use crate::optics::random::Sequence;
use crate::optics::tone::ToneCurve;

type Accessors = (fn(&Document) -> Value, fn(&mut Document, Value));

/// Reads and writes a field through the variant of [`Value`] that holds it.
macro_rules! field {
    ($variant:ident $($path:ident).+) => {
        (
            |document: &Document| Value::$variant(document.$($path).+),
            |document: &mut Document, value: Value| {
                if let Value::$variant(value) = value {
                    document.$($path).+ = value;
                }
            },
        )
    };
}

/// The same for a field that may be left to the program.
macro_rules! optional {
    ($variant:ident $($path:ident).+) => {
        (
            |document: &Document| document.$($path).+.map_or(Value::Absent, Value::$variant),
            |document: &mut Document, value: Value| {
                document.$($path).+ = match value {
                    Value::$variant(value) => Some(value),
                    _ => None,
                };
            },
        )
    };
}

/// Reads and writes a field that is one of a closed list.
macro_rules! choice {
    ($($path:ident).+) => {
        (
            |document: &Document| Value::Choice(document.$($path).+.name()),
            |document: &mut Document, value: Value| {
                if let Value::Choice(name) = value
                    && let Some(choice) = Named::by_name(name)
                {
                    document.$($path).+ = choice;
                }
            },
        )
    };
}

/// Every setting that is a value of its own, in the order of the panels. What names a file, the list of area lights, and
/// the rendered part of the picture stand beside them.
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
        of("scene.ground", Geometry, "Ground", "A plane under the model.", Kind::Toggle, field!(Toggle ground)),
        of("lighting.rotation", Lighting, "Rotation", "Turns the environment about the vertical axis, anticlockwise seen from above.", single(range::ROTATION_DEG, "°"), field!(Number lighting.rotation_deg)),
        of("lighting.strength", Lighting, "Strength", "Factor of the environment's radiance.", single(range::STRENGTH, ""), field!(Number lighting.strength)),
        of("lighting.background_blur", Lighting, "Background blur", "Blurs the environment where the camera sees it, over this angle; light and reflections stay sharp.", single(range::BACKGROUND_BLUR_DEG, "°"), field!(Number lighting.background_blur_deg)),
        of("lighting.ground_color", Materials, "Ground colour", "Albedo of the ground.", Kind::Color, field!(Color lighting.ground_color)),
    ]
}

#[rustfmt::skip]
fn camera() -> Vec<Parameter<Document>> {
    use Stage::Camera;
    vec![
        of("camera.target", Camera, "Target", "What the camera looks at; auto: the centre of the model.", auto(place()), optional!(Place camera.target)),
        of("camera.yaw", Camera, "Yaw", "Azimuth of the camera around its target.", real(range::YAW_DEG, "°"), field!(Real camera.yaw_deg)),
        of("camera.pitch", Camera, "Pitch", "Height of the camera above the target's horizon.", real(range::PITCH_DEG, "°"), field!(Real camera.pitch_deg)),
        of("camera.distance", Camera, "Distance", "Distance from the target in scene units; auto: the model fills the picture.", auto(real(range::DISTANCE, "")), optional!(Real camera.distance)),
        of("camera.position", Camera, "Position", "Where the camera is; replaces yaw, pitch and distance unless auto.", auto(place()), optional!(Place camera.position)),
        of("camera.fov", Camera, "Field of view", "Vertical field of view.", real(range::FOV_DEG, "°"), field!(Real camera.fov_deg)),
        of("camera.aperture", Camera, "Aperture", "Radius of the lens in bounding radii of the model; 0 is a pinhole, with which everything is sharp.", real(range::APERTURE, ""), field!(Real camera.aperture)),
        of("camera.focus_distance", Camera, "Focus distance", "How far away things are sharp, in scene units; auto: at the target.", auto(real(range::DISTANCE, "")), optional!(Real camera.focus_distance)),
    ]
}

#[rustfmt::skip]
fn view() -> Vec<Parameter<Document>> {
    use Stage::Display;
    vec![
        of("view.tone_map", Display, "Tone map", "How radiance beyond what a screen can show is brought into its range.", choices::<ToneCurve>(), choice!(view.tone_map)),
        of("view.exposure", Display, "Exposure", "Brightness in stops: +1 doubles it.", single(range::EXPOSURE_EV, "EV"), field!(Number view.exposure_ev)),
        of("view.auto_exposure", Display, "Automatic exposure", "Brings the picture's mean brightness to middle grey; the exposure is added.", Kind::Toggle, field!(Toggle view.auto_exposure)),
        of("view.denoise", Display, "Denoise", "How the picture's noise is taken out.", choices::<Denoise>(), choice!(view.denoise)),
    ]
}

#[rustfmt::skip]
fn sampling() -> Vec<Parameter<Document>> {
    use Stage::{Sampling, Size};
    vec![
        of("render.width", Size, "Width", "Columns of pixels.", count(range::SIZE), field!(Count render.width)),
        of("render.height", Size, "Height", "Rows of pixels.", count(range::SIZE), field!(Count render.height)),
        of("render.filter", Sampling, "Pixel filter", "How samples are spread over a pixel and its neighbours.", choices::<PixelFilter>(), choice!(render.filter)),
        of("render.bounces", Sampling, "Bounces", "Reflections that a path may have.", count(range::BOUNCES), field!(Count render.bounces)),
        of("render.firefly_clamp", Sampling, "Firefly clamp", "Limits the radiance of light that was reflected twice or more; the energy that this takes is told.", off(single(range::FIREFLY_CLAMP, "")), optional!(Number render.firefly_clamp)),
        of("render.sequence", Sampling, "Random numbers", "Which random numbers are drawn.", choices::<Sequence>(), choice!(render.sequence)),
        of("render.strategy", Sampling, "Light sampling", "How light is found: by sampling the lobe, the light, or both weighed against each other.", choices::<Strategy>(), choice!(render.strategy)),
        of("render.seed", Sampling, "Seed", "Changes all random numbers.", Kind::Count { range: [0, u32::MAX] }, field!(Count render.seed)),
    ]
}

#[rustfmt::skip]
fn stopping() -> Vec<Parameter<Document>> {
    use Stage::Goal;
    vec![
        of("render.samples", Goal, "Samples", "Samples a pixel after which rendering stops.", count(range::SAMPLES), field!(Count render.samples)),
        of("render.time", Goal, "Time", "Render time after which rendering stops earlier.", off(real(range::TIME_S, "s")), optional!(Real render.time_s)),
        of("render.noise", Goal, "Noise", "Relative error of the picture at which rendering stops earlier; 0.01 is 1 %.", off(real(range::NOISE, "")), optional!(Real render.noise)),
        of("render.min_samples", Goal, "Least samples", "Samples that each pixel has before its error is believed, so that small lights are not missed.", count(range::MIN_SAMPLES), field!(Count render.min_samples)),
        of("render.adaptive", Goal, "Adaptive", "Whether samples go where the error is; auto: where a noise is to be reached.", auto(Kind::Toggle), optional!(Toggle render.adaptive)),
    ]
}

fn of(
    key: &'static str,
    stage: Stage,
    label: &'static str,
    help: &'static str,
    kind: Kind,
    (get, set): Accessors,
) -> Parameter<Document> {
    let group = match key.split('.').next() {
        Some("scene") => "Scene",
        Some("lighting") => "Lighting",
        Some("camera") => "Camera",
        Some("view") => "View",
        _ => "Render",
    };
    Parameter {
        key,
        group,
        label,
        symbol: "",
        help,
        kind,
        stage,
        applies: |_| true,
        get,
        set,
    }
}

fn real(range: RangeInclusive<f64>, unit: &'static str) -> Kind {
    let (low, high) = range.into_inner();
    Kind::Real {
        range: [low, high],
        unit,
    }
}

/// A number in single precision.
fn single(range: RangeInclusive<f64>, unit: &'static str) -> Kind {
    let (low, high) = range.into_inner();
    let range = [low as f32, high as f32];
    Kind::Number {
        range,
        soft_range: range,
        unit,
        step: 0.01,
    }
}

fn count(range: RangeInclusive<f64>) -> Kind {
    let (low, high) = range.into_inner();
    Kind::Count {
        range: [low as u32, high as u32],
    }
}

fn place() -> Kind {
    let (low, high) = range::COORDINATE.into_inner();
    Kind::Place { range: [low, high] }
}

/// What the program chooses where it is not given.
fn auto(kind: Kind) -> Kind {
    Kind::Optional(Box::new(kind), "auto")
}

/// What is left out where it is not given.
fn off(kind: Kind) -> Kind {
    Kind::Optional(Box::new(kind), "off")
}
