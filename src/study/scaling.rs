//! Scaling of time with size: triangles, pixels, bounces, the environment.

use std::time::{Duration, Instant};

use serde::Serialize;

use super::{Machine, Steps, StudyError, Watch, median, quantile, warmed, without_target};
use crate::document::Document;
use crate::import::environment::EnvironmentError;
use crate::named::named;
use crate::optics::vector::Vec3;
use crate::render::{EngineChoice, Session, SessionError};
use crate::scene::environment::{
    Environment, EnvironmentSource, MapError, environment_direction, environment_radiance,
};
use crate::scene::shapes::bumpy_sphere;
use crate::scene::{Model, ModelSource, Slot};

named! {
    /// The scaled quantity.
    Growing {
        Triangles, "triangles", "Triangles", "The triangles of the model.";
        Pixels, "pixels", "Pixels", "The pixels of the image.";
        Bounces, "bounces", "Bounces at most", "The longest path.";
        Texels, "texels", "Texels of the environment", "The texels of the environment.";
    }
}

impl Growing {
    /// The sizes that are tried.
    fn sizes(self, is_quick: bool) -> Vec<u64> {
        let all: &[u64] = match self {
            Self::Triangles => &[1_000, 10_000, 100_000, 1_000_000, 10_000_000],
            Self::Pixels => &[1 << 12, 1 << 14, 1 << 16, 1 << 18, 1 << 20, 1 << 22],
            Self::Bounces => &[1, 2, 4, 8, 16, 32, 64],
            Self::Texels => &[1 << 13, 1 << 15, 1 << 17, 1 << 19, 1 << 21, 1 << 23, 1 << 25],
        };
        all[..if is_quick { 2 } else { all.len() }].to_vec()
    }
}

/// Options of the measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScalingOptions {
    /// Engine to measure.
    pub engine: EngineChoice,
    /// Turns of each size.
    pub turns: usize,
    /// Length of a trial.
    pub slice: Duration,
    /// The two smallest sizes alone, to see that it works.
    pub is_quick: bool,
}

impl ScalingOptions {
    /// A second for each size.
    pub fn new(engine: EngineChoice) -> Self {
        Self {
            engine,
            turns: 7,
            slice: Duration::from_millis(150),
            is_quick: false,
        }
    }
}

/// The time at a size.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ScalingPoint {
    /// The scaled quantity.
    pub growing: Growing,
    /// Value of the scaled quantity.
    pub size: u64,
    /// Engine time of a pixel sample, nanoseconds.
    pub ns_per_sample: f64,
    /// The quartiles of that over the turns.
    pub ns_quartiles: [f64; 2],
    /// Set-up time in seconds from the document to the first sample: loading, hierarchy, tables, upload, kernel.
    pub setup_seconds: f64,
}

/// Report of all times.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScalingReport {
    /// Machine of the measurement.
    pub machine: Machine,
    /// Width in pixels, if not scaled.
    pub width: u32,
    /// Height in pixels, if not scaled.
    pub height: u32,
    /// Times by quantity.
    pub points: Vec<ScalingPoint>,
}

/// Measures a document with one quantity scaled at a time. The scaled model is a bumpy sphere in the document's material.
/// `watch` receives the progress and may stop it.
///
/// # Errors
///
/// Errors of rendering; [`StudyError::Stopped`].
pub fn scaling(
    document: &Document,
    options: &ScalingOptions,
    watch: &mut Watch<'_>,
) -> Result<ScalingReport, StudyError> {
    let mut session = Session::open(options.engine)?;
    let document = without_target(document);
    let cases: Vec<_> = Growing::ALL
        .iter()
        .copied()
        .flat_map(|growing| {
            growing
                .sizes(options.is_quick)
                .into_iter()
                .map(move |size| (growing, size))
        })
        .collect();
    let mut steps = Steps::new(watch, cases.len() as f64);
    let mut points = Vec::new();
    for (growing, size) in cases {
        steps.report(format!("{}: {size}", growing.label()), 0.0)?;
        let (grown, size) = grow(&document, growing, size, &session)?;
        points.push(measure(&mut session, &grown, growing, size, options)?);
        steps.finish(1.0);
    }
    Ok(ScalingReport {
        machine: Machine::of(session.engine()),
        width: document.render.width,
        height: document.render.height,
        points,
    })
}

/// The document with one thing of this size, and the size that it has in fact.
fn grow(document: &Document, growing: Growing, size: u64, session: &Session) -> Result<(Document, u64), StudyError> {
    let mut grown = document.clone();
    match growing {
        Growing::Triangles => {
            let mesh = bumpy_sphere(size);
            let triangles = mesh.triangles.len() as u64;
            let source = ModelSource::File(format!("sphere of {triangles} triangles").into());
            let model = Model {
                name: source.to_string(),
                mesh,
                slots: vec![Slot::neutral("sphere")],
                ..Model::default()
            };
            session.assets().keep_model(source.clone(), model);
            grown.model = source;
            let camera = &mut grown.camera;
            (camera.target, camera.distance, camera.position) = (None, None, None);
            return Ok((grown, triangles));
        }
        Growing::Pixels => {
            let side = (size as f64).sqrt().round() as u32;
            (grown.render.width, grown.render.height) = (side, side);
            return Ok((grown, u64::from(side).pow(2)));
        }
        Growing::Bounces => grown.render.bounces = size as u32,
        Growing::Texels => {
            let height = (size as f64 / 2.0).sqrt().round() as u32;
            let source = EnvironmentSource::File(format!("{} x {height} texels", 2 * height).into());
            let original = session
                .assets()
                .environment(&document.lighting.environment, document.lighting.environment_encoding)
                .map_err(SessionError::from)?;
            let resampled = resampled(&original, height)
                .map_err(|error| SessionError::Asset(EnvironmentError::from(error).into()))?;
            session.assets().keep_environment(source.clone(), resampled);
            grown.lighting.environment = source;
            return Ok((grown, 2 * u64::from(height).pow(2)));
        }
    }
    Ok((grown, size))
}

/// The same environment at another resolution.
fn resampled(environment: &Environment, height: u32) -> Result<Environment, MapError> {
    let width = 2 * height;
    let texel = |index: u32| {
        let place = [index % width, index / width].map(|i| f64::from(i) + 0.5);
        let direction: Vec3<f64> = environment_direction([place[0] / f64::from(width), place[1] / f64::from(height)]);
        let [r, g, b] = environment_radiance(environment, direction).to_f32();
        [r, g, b, 1.0]
    };
    let texels = (0..width * height).map(texel).collect();
    Environment::from_texels(environment.name.clone(), width, height, texels)
}

fn measure(
    session: &mut Session,
    document: &Document,
    growing: Growing,
    size: u64,
    options: &ScalingOptions,
) -> Result<ScalingPoint, StudyError> {
    let begun = Instant::now();
    session.submit(document)?;
    session.step(Duration::from_millis(1))?;
    let setup_seconds = begun.elapsed().as_secs_f64();
    warmed(session, document)?;
    let pixels = f64::from(document.render.width) * f64::from(document.render.height);
    let mut times = Vec::new();
    for _ in 0..options.turns {
        let before = session.progress();
        let after = session.step(options.slice)?;
        let samples = (after.mean_samples - before.mean_samples) * pixels;
        times.push(1e9 * (after.engine_seconds - before.engine_seconds) / samples.max(1.0));
    }
    Ok(ScalingPoint {
        growing,
        size,
        ns_per_sample: median(&times),
        ns_quartiles: [quantile(&times, 0.25), quantile(&times, 0.75)],
        setup_seconds,
    })
}
