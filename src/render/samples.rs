//! Clouds of samples for plots, drawn on a thread of their own by the function that the engine renders with.

use std::sync::Arc;

use super::{background::Responder, engine::EngineChoice, engine::Prober};
use crate::{
    analysis::fit::{Measure, Nearest, nearest_roughness},
    analysis::histogram::{angle_density, angle_histogram},
    job::scatter::{ScatterCloud, ScatterRequest},
    optics::{
        curve::Curve,
        frame::frame_from_normal,
        lobe::{
            Horizon, Lobe,
            model::{LobeModel, view_direction},
        },
        vector::Vec3,
    },
};

/// Bins of the angle's histogram over [0, π].
const ANGLE_BINS: usize = 180;
/// Azimuths over which a density is averaged.
const AZIMUTHS: u32 = 48;
/// Samples from which the share below the surface is counted.
const BELOW_COUNT: u32 = 1 << 16;

/// A query of lobe samples.
#[derive(Clone, Debug, PartialEq)]
pub struct SampleQuery {
    /// The engine whose function draws.
    pub engine: EngineChoice,
    pub request: ScatterRequest,
    /// Whether to match the Phong and GGX lobes, which takes a second.
    pub compare: bool,
}

/// The angle α between samples and the mirror direction.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AnglePlot {
    /// (α in radians, density per radian) counted.
    pub counted: Vec<[f64; 2]>,
    /// The same from the density.
    pub analytic: Vec<[f64; 2]>,
    /// Other lobes of equal look.
    pub others: Vec<OtherLobe>,
}

/// A lobe of equal look.
#[derive(Clone, Debug, PartialEq)]
pub struct OtherLobe {
    pub lobe: Lobe,
    /// Matched roughness and remaining distance.
    pub nearest: Nearest,
    /// (α in radians, density per radian).
    pub analytic: Vec<[f64; 2]>,
}

/// Answer to a query.
#[derive(Clone, Debug)]
pub struct SampleReport {
    /// The query that this answers.
    pub query: SampleQuery,
    pub cloud: ScatterCloud,
    /// Share of the samples that point below the surface before the horizon policy, in [0, 1].
    pub below_share: f64,
    /// The angle to the mirror direction.
    pub angle: AnglePlot,
}

/// The answer to a query so far, or why there is none.
pub type SampleAnswer = Result<Arc<SampleReport>, String>;

/// The work that answers queries.
pub fn answers() -> impl FnMut(SampleQuery, &Responder<'_, SampleAnswer>) + Send + 'static {
    let mut sampler: Option<(EngineChoice, Prober)> = None;
    move |query, responder| match draw(&mut sampler, &query) {
        Ok(report) => {
            responder.publish(Ok(Arc::new(report.clone())));
            if query.compare {
                compare(report, responder);
            }
        }
        Err(why) => {
            sampler = None;
            responder.publish(Err(why));
        }
    }
}

fn draw(sampler: &mut Option<(EngineChoice, Prober)>, query: &SampleQuery) -> Result<SampleReport, String> {
    let opened = match sampler.take() {
        Some((choice, opened)) if choice == query.engine => opened,
        _ => Prober::open(query.engine).map_err(crate::in_words)?,
    };
    let (_, opened) = sampler.insert((query.engine, opened));
    let request = &query.request;
    let cloud = opened.scatter(request).map_err(crate::in_words)?;
    let free = ScatterRequest {
        model: LobeModel {
            horizon: Horizon::None,
            ..request.model.clone()
        },
        count: BELOW_COUNT,
        ..request.clone()
    };
    let raw = opened.scatter(&free).map_err(crate::in_words)?;
    let mirror = request.middle();
    let below = raw
        .samples
        .iter()
        .filter(|[_, _, z, _]| *z * (mirror.z.signum() as f32) < 0.0)
        .count();
    let directions = cloud.samples.iter().map(|&[x, y, z, _]| Vec3::from_f32([x, y, z]));
    let mut counted = angle_histogram(directions, mirror, ANGLE_BINS).density();
    // Absorbed samples count as drawn, as in the density.
    let kept = cloud.samples.len() as f64 / f64::from(request.count.max(1));
    counted.iter_mut().for_each(|[_, density]| *density *= kept);
    let angle = AnglePlot {
        counted,
        analytic: analytic(&request.model, request),
        others: Vec::new(),
    };
    Ok(SampleReport {
        query: query.clone(),
        cloud,
        below_share: below as f64 / f64::from(BELOW_COUNT),
        angle,
    })
}

/// Adds the lobes of equal look, one after the other, unless something else is asked for meanwhile.
fn compare(mut report: SampleReport, responder: &Responder<'_, SampleAnswer>) {
    let request = report.query.request.clone();
    let target = &request.model;
    if !target.has_density() {
        return;
    }
    for lobe in [Lobe::Phong, Lobe::Ggx].into_iter().filter(|lobe| *lobe != target.lobe) {
        if responder.is_superseded() {
            return;
        }
        // Matched at normal incidence, where the models are most comparable.
        let wo = view_direction(0.0);
        let profile = |wi: Vec3<f64>| Measure::Density.of(target, wo, wi);
        let other = LobeModel::new(lobe, 0.5, Curve::Smooth);
        let nearest = nearest_roughness(&profile, &other, 0.0, Measure::Density);
        let matched = other.with_roughness(nearest.roughness);
        report.angle.others.push(OtherLobe {
            lobe,
            nearest,
            analytic: analytic(&matched, &request),
        });
        responder.publish(Ok(Arc::new(report.clone())));
    }
}

/// Density of the angle to the mirror direction; empty for a mirror.
fn analytic(model: &LobeModel, request: &ScatterRequest) -> Vec<[f64; 2]> {
    if !model.has_density() {
        return Vec::new();
    }
    let wo = request.wo();
    let around_mirror = frame_from_normal(request.middle());
    let density = |wi: Vec3<f64>| model.evaluate(wo, wi)[1];
    let step = std::f64::consts::PI / ANGLE_BINS as f64;
    (0..ANGLE_BINS)
        .map(|bin| step * (bin as f64 + 0.5))
        .map(|alpha_rad| [alpha_rad, angle_density(&around_mirror, alpha_rad, AZIMUTHS, density)])
        .collect()
}
