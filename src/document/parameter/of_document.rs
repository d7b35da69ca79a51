//! The settings of a document: camera, light, view, sampling, and when rendering stops.

use std::sync::LazyLock;

use super::{
    Kind, Parameter, Stage, Takes, Value,
    accessors::{choice, color, field, rows, toggle},
    line::{count, ends, real, single},
};
use crate::{
    document::{Background, Denoise, DenoiseWhen, Document, GroundKind, LightPaths, PixelFilter, Strategy, range},
    optics::{random::Sequence, tone::ToneCurve},
    scene::camera::Projection,
};

/// Every setting that is a value of its own, in the order of the panels. What names a file, the list of area lights, and
/// the rendered part of the image stand beside them.
pub static SETTINGS: LazyLock<Vec<Parameter<Document>>> = LazyLock::new(|| {
    rows! {
        "lighting.rotation" Lighting "Rotation" "Turns the environment about the vertical axis, anticlockwise seen from above. In the viewport: drag with shift." field(lighting.rotation_deg, single(range::ROTATION_DEG, "°"))
            .named("Environment rotation").flag("environment-rotation").bar(-180.0, 180.0).decimals(1);
        "lighting.strength" Lighting "Strength" "Factor of the environment's radiance." field(lighting.strength, single(range::STRENGTH, ""))
            .named("Environment strength").flag("environment-strength").bar(0.0, 4.0);
        "lighting.background_blur" Lighting "Blur" "Blurs the environment where the camera sees it, over this angle; light and reflections stay sharp." field(lighting.background_blur_deg, single(range::BACKGROUND_BLUR_DEG, "°"))
            .named("Background blur").group("Background").bar(0.0, 45.0).decimals(1).applies(|document| document.lighting.background == Background::Environment);
        "scene.unit" Display "Scene unit" "Metres per scene unit: for the power of lights, and for the f-number." field(unit_m, real(1e-6..=1e6, "m"))
            .group("Area lights").flag("scene-unit");
        "lighting.light_groups" Sampling "Split by group" "Sums the light of each group apart: the mix changes without rendering again, and .exr images get a layer of each group." toggle(lighting.light_groups)
            .named("Light groups").group("Light groups");
        "scene.ground" Geometry "Ground" "A surface under the model that catches its shadow." toggle(ground);
        "lighting.ground.kind" Geometry "Kind" "What the ground is." choice(GroundKind lighting.ground.kind)
            .named("Kind of ground").flag("ground-kind").applies(|document| document.ground);
        "lighting.ground_color" Materials "Colour" "Albedo of the ground." color(lighting.ground_color)
            .named("Ground colour").applies(|document| document.ground);
        "lighting.ground.reflection" Materials "Reflection" "How much of a varnish lies on the ground: it reflects as glass does, times this." field(lighting.ground.reflection, single(range::SHARE, ""))
            .named("Ground reflection").flag("ground-reflection").bar(0.0, 1.0).applies(|document| document.ground);
        "lighting.ground.roughness" Materials "Roughness" "How rough the reflection is." field(lighting.ground.roughness, single(range::SHARE, ""))
            .named("Ground roughness").flag("ground-roughness").bar(0.0, 1.0).applies(|document| document.ground && document.lighting.ground.reflection > 0.0);
        "lighting.ground.yaw" Geometry "Turn" "Which side of the cyclorama is open, as the yaw of a camera that looks at its wall." field(lighting.ground.yaw_deg, real(range::YAW_DEG, "°"))
            .named("Cyclorama turn").flag("cyclorama-turn").bar(-180.0, 180.0).decimals(1).applies(is_cyclorama);
        "lighting.ground.wall_distance" Geometry "Wall" "How far the cyclorama's wall is behind the model's centre, in bounding radii." field(lighting.ground.wall_distance, real(range::AREA_LENGTH, ""))
            .named("Cyclorama wall").flag("cyclorama-wall").bar(1.0, 10.0).decimals(2).applies(is_cyclorama);
        "lighting.ground.bend_radius" Geometry "Bend" "Radius of the cyclorama's bend from floor to wall, in bounding radii; no more than the wall's distance is used." field(lighting.ground.bend_radius, real(range::AREA_LENGTH, ""))
            .named("Cyclorama bend").flag("cyclorama-bend").bar(0.5, 10.0).decimals(2).applies(is_cyclorama);
        "camera.fov" Camera "Field of view" "Vertical field of view; small is a telephoto lens." field(camera.fov_deg, real(range::FOV_DEG, "°"))
            .bar(5.0, 120.0).decimals(1);
        "camera.projection" Camera "Projection" "Perspective as in an eye, or parallel rays as in a drawing." choice(Projection camera.projection);
        "camera.yaw" Camera "Yaw" "Turns the camera about the vertical axis. In the viewport: drag." field(camera.yaw_deg, real(range::YAW_DEG, "°"))
            .bar(-180.0, 180.0).decimals(1).hidden();
        "camera.pitch" Camera "Pitch" "Height of the camera above the target's horizon. In the viewport: drag." field(camera.pitch_deg, real(range::PITCH_DEG, "°"))
            .bar(-90.0, 90.0).decimals(1).hidden();
        "camera.distance" Camera "Distance" "Distance from the target in scene units; auto: the model fills the image." field(camera.distance, auto(real(range::DISTANCE, "")))
            .flag("camera-distance");
        "camera.target" Camera "Target" "What the camera looks at; auto: the centre of the model." field(camera.target, auto(place()))
            .flag("camera-target");
        "camera.position" Camera "Position" "Where the camera is; replaces yaw, pitch and distance unless auto." field(camera.position, auto(place()))
            .flag("camera-position");
        "camera.roll" Camera "Roll" "Turns the camera about the line to its target, clockwise: what it sees turns the other way." field(camera.roll_deg, real(range::YAW_DEG, "°"))
            .flag("camera-roll").bar(-180.0, 180.0).decimals(1);
        "camera.aperture" Camera "Aperture" "Radius of the lens in bounding radii of the model; at 0 it is a pinhole, with which everything is sharp." field(camera.aperture, real(range::APERTURE, ""))
            .bar(0.0, 0.2).decimals(4);
        "camera.focus_distance" Camera "Focus" "How far away things are sharp, in scene units; auto: at the target. In the viewport: click with ctrl." field(camera.focus_distance, auto(real(range::DISTANCE, "")))
            .named("Focus distance").decimals(4).applies(|document| document.camera.aperture > 0.0);
        "view.tone_map" Display "Tone map" "How radiance beyond what a screen can show is brought into its range." choice(ToneCurve view.tone_map);
        "view.exposure" Display "Exposure" "Brightness in stops: +1 doubles it." field(view.exposure_ev, single(range::EXPOSURE_EV, "EV"))
            .bar(-6.0, 6.0).decimals(2);
        "view.auto_exposure" Display "Auto exposure" "Brings the image's mean brightness to middle grey; the exposure is added to that." toggle(view.auto_exposure)
            .named("Automatic exposure");
        "view.white_balance" Display "White balance" "Temperature of the light that appears white: lower is cooler, higher is warmer." field(view.white_k, single(2000.0..=20_000.0, "K"))
            .bar(2500.0, 12_000.0).decimals(0);
        "view.contrast" Display "Contrast" "Contrast around middle grey, applied before the tone map." field(view.contrast, single(0.1..=4.0, ""))
            .bar(0.5, 2.0).decimals(2);
        "view.saturation" Display "Saturation" "Distance of colours from grey, applied before the tone map. At 0 everything is grey." field(view.saturation, single(0.0..=4.0, ""))
            .bar(0.0, 2.0).decimals(2);
        "view.vignette" Display "Vignette" "Darkens the corners as a lens does. At 0 it is off." field(view.vignette, single(0.0..=2.0, ""))
            .bar(0.0, 1.0).decimals(2);
        "view.glare" Display "Glare" "Share of the light that spreads around where it falls, as in a lens: highlights glow. At 0 it is off." field(view.glare, single(0.0..=1.0, ""))
            .bar(0.0, 0.5).decimals(2);
        "view.denoise" Goal "Denoise" "Denoises with Open Image Denoise and estimates the remaining error. Auto blends with the raw render and applies the noise limit to the result." choice(Denoise view.denoise);
        "view.denoise_when" Display "Denoise when" "When the window denoises: from the first sample on, or at the end." choice(DenoiseWhen view.denoise_when)
            .applies(|document| document.view.denoise != Denoise::Off).hidden();
        "render.width" Size "Width" "Columns of pixels." field(render.width, count(range::SIZE))
            .group("Image size").hidden();
        "render.height" Size "Height" "Rows of pixels." field(render.height, count(range::SIZE))
            .group("Image size").hidden();
        "render.bounces" Sampling "Bounces" "Reflections that a path may have." field(render.bounces, count(range::BOUNCES))
            .bar(1.0, 64.0);
        "render.strategy" Sampling "Light sampling" "BSDF sampling, light sampling, or both (MIS). All converge to the same image." choice(Strategy render.strategy);
        "render.light_paths" Sampling "Light shown" "Renders all light, direct light only, or indirect light only." choice(LightPaths render.light_paths);
        "render.sequence" Sampling "Sequence" "The random numbers that are drawn." choice(Sequence render.sequence);
        "render.filter" Sampling "Pixel filter" "How samples are spread over a pixel and its neighbours." choice(PixelFilter render.filter);
        "render.firefly_clamp" Sampling "Firefly clamp" "Clamps the radiance of indirect light. The report gives the energy removed (clamped_energy)." field(render.firefly_clamp, off(single(range::FIREFLY_CLAMP, ""), Value::Number(10.0)));
        "render.seed" Sampling "Seed" "Random seed." field(render.seed, count(0.0..=f64::from(u32::MAX)));
        "render.samples" Goal "Samples" "Samples per pixel at which rendering stops: noise halves with four times as many. With adaptive sampling, the most that a pixel gets." field(render.samples, count(range::SAMPLES))
            .group("Stop when");
        "render.time" Goal "Time limit" "Stops rendering after this time." field(render.time_s, off(real(range::TIME_S, "s"), Value::Number(60.0)))
            .group("Stop when");
        "render.noise" Goal "Noise limit" "Stops at this estimated relative error (RMS pixel error over mean luminance); 0.01 is 1 %." field(render.noise, off(real(range::NOISE, ""), Value::Number(0.01)))
            .group("Stop when").percent();
        "render.min_samples" Goal "Min. samples" "Samples that each pixel has before its error is believed, so that small lights are not missed." field(render.min_samples, count(range::MIN_SAMPLES))
            .group("Stop when");
        "render.adaptive" Goal "Adaptive" "Adaptive or uniform sampling; auto: adaptive if there is a noise limit." field(render.adaptive, auto(Kind::Toggle))
            .named("Adaptive sampling").group("Stop when");
    }
});

fn is_cyclorama(document: &Document) -> bool {
    document.ground && document.lighting.ground.kind == GroundKind::Cyclorama
}

fn of(
    key: &'static str,
    stage: Stage,
    label: &'static str,
    help: &'static str,
    takes: Takes<Document>,
) -> Parameter<Document> {
    let group = match key.split('.').next() {
        _ if key.contains("ground") => "Ground",
        Some("lighting") => "Environment",
        Some("camera") => "Camera",
        Some("render") => "Sampling",
        _ => "View",
    };
    let mut parameter = Parameter::plain(key, label, help, takes, stage);
    (parameter.group, parameter.name, parameter.row.step) = (group, label, 1.0);
    // Its option is called as the last word of its key, unless its line says otherwise.
    parameter.flag = key.rsplit('.').next().map(|word| &*word.replace('_', "-").leak());
    parameter
}

fn place() -> Kind {
    Kind::Place {
        range: ends(range::COORDINATE),
    }
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
