//! Clouds of samples for plots, drawn on a thread of their own by the function that the engine renders with.

use std::io;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use super::engine::{EngineChoice, Sampler};
use crate::analysis::fit::{Measure, Nearest, nearest_roughness};
use crate::analysis::histogram::{angle_density, angle_histogram};
use crate::analysis::lobe_model::{LobeModel, NORMAL, view_direction};
use crate::analysis::scatter::{ScatterCloud, ScatterRequest};
use crate::optics::curve::Curve;
use crate::optics::frame::frame_from_normal;
use crate::optics::lobe::{Horizon, Lobe};
use crate::optics::vector::Vec3;

/// Bins of the angle's histogram over [0, π].
const ANGLE_BINS: usize = 180;
/// Azimuths over which a density is averaged.
const AZIMUTHS: u32 = 48;
/// Samples from which the share below the surface is counted.
const BELOW_COUNT: u32 = 1 << 16;

/// What to draw and to compute.
#[derive(Clone, Debug, PartialEq)]
pub struct SampleQuery {
    /// The engine whose function draws.
    pub engine: EngineChoice,
    /// The samples.
    pub request: ScatterRequest,
    /// Whether to look for the Phong and GGX lobes of equal look, which takes a second.
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
    /// Which.
    pub lobe: Lobe,
    /// At what roughness, and how far apart the two still are.
    pub nearest: Nearest,
    /// (α in radians, density per radian).
    pub analytic: Vec<[f64; 2]>,
}

/// What came of a query.
#[derive(Clone, Debug)]
pub struct SampleReport {
    /// What was asked for.
    pub query: SampleQuery,
    /// The samples.
    pub cloud: ScatterCloud,
    /// Share of the samples that point below the surface before the horizon policy, in [0, 1].
    pub below_share: f64,
    /// The angle to the mirror direction.
    pub angle: AnglePlot,
}

#[derive(Default)]
struct Shared {
    orders: Mutex<Orders>,
    ordered: Condvar,
    answer: Mutex<Option<Result<Arc<SampleReport>, String>>>,
}

#[derive(Default)]
struct Orders {
    query: Option<SampleQuery>,
    quit: bool,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Draws samples on a thread of its own; the latest query wins.
pub struct SampleWorker {
    shared: Arc<Shared>,
    _thread: JoinHandle<()>,
}

impl SampleWorker {
    /// Starts the thread; `repaint` is called when there is something new to show.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn spawn(repaint: impl Fn() + Send + 'static) -> io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let of_thread = shared.clone();
        let thread = std::thread::Builder::new()
            .name("samples".to_owned())
            .spawn(move || run(&of_thread, &repaint))?;
        Ok(Self {
            shared,
            _thread: thread,
        })
    }

    /// Asks; a query that has not been begun is forgotten.
    pub fn ask(&self, query: SampleQuery) {
        lock(&self.shared.orders).query = Some(query);
        self.shared.ordered.notify_one();
    }

    /// The latest report, or why there is none.
    pub fn latest(&self) -> Option<Result<Arc<SampleReport>, String>> {
        lock(&self.shared.answer).clone()
    }
}

impl Drop for SampleWorker {
    fn drop(&mut self) {
        lock(&self.shared.orders).quit = true;
        self.shared.ordered.notify_one();
    }
}

fn run(shared: &Shared, repaint: &dyn Fn()) {
    let mut sampler: Option<(EngineChoice, Sampler)> = None;
    while let Some(query) = next(shared) {
        let publish = |answer| {
            *lock(&shared.answer) = Some(answer);
            repaint();
        };
        let report = match draw(&mut sampler, &query) {
            Ok(report) => report,
            Err(why) => {
                sampler = None;
                publish(Err(why));
                continue;
            }
        };
        publish(Ok(Arc::new(report.clone())));
        if query.compare {
            compare(shared, report, publish);
        }
    }
}

/// Waits for a query; `None` when it is time to go.
fn next(shared: &Shared) -> Option<SampleQuery> {
    let mut orders = lock(&shared.orders);
    loop {
        if orders.quit {
            return None;
        }
        if let Some(query) = orders.query.take() {
            return Some(query);
        }
        orders = shared.ordered.wait(orders).unwrap_or_else(PoisonError::into_inner);
    }
}

fn draw(sampler: &mut Option<(EngineChoice, Sampler)>, query: &SampleQuery) -> Result<SampleReport, String> {
    let opened = match sampler.take() {
        Some((choice, opened)) if choice == query.engine => opened,
        _ => Sampler::open(query.engine).map_err(|error| error.to_string())?,
    };
    let (_, opened) = sampler.insert((query.engine, opened));
    let request = &query.request;
    let cloud = opened.draw(request).map_err(|error| error.to_string())?;
    let free = ScatterRequest {
        horizon: Horizon::None,
        count: BELOW_COUNT,
        ..request.clone()
    };
    let raw = opened.draw(&free).map_err(|error| error.to_string())?;
    let below = raw.samples.iter().filter(|[_, _, z, _]| *z < 0.0).count();
    let mirror: Vec3<f64> = mirror_direction(request);
    let directions = cloud.samples.iter().map(|&[x, y, z, _]| Vec3::from_f32([x, y, z]));
    let mut counted = angle_histogram(directions, mirror, ANGLE_BINS).density();
    // Absorbed samples count as drawn, as in the density.
    let kept = cloud.samples.len() as f64 / f64::from(request.count.max(1));
    counted.iter_mut().for_each(|[_, density]| *density *= kept);
    let model = model(request);
    let angle = AnglePlot {
        counted,
        analytic: analytic(&model, request),
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
fn compare(shared: &Shared, mut report: SampleReport, publish: impl Fn(Result<Arc<SampleReport>, String>)) {
    let request = report.query.request.clone();
    let target = model(&request);
    if !target.has_density() {
        return;
    }
    for lobe in [Lobe::Phong, Lobe::Ggx]
        .into_iter()
        .filter(|lobe| *lobe != request.lobe)
    {
        let is_over = {
            let orders = lock(&shared.orders);
            orders.quit || orders.query.is_some()
        };
        if is_over {
            return;
        }
        // Looks are matched head-on, where every model is at its most comparable.
        let wo = view_direction(0.0);
        let profile = |wi: Vec3<f64>| Measure::Density.of(&target, wo, wi);
        let other = LobeModel::new(lobe, 0.5, Curve::Smooth);
        let nearest = nearest_roughness(&profile, &other, 0.0, Measure::Density);
        let matched = other.with_roughness(nearest.roughness);
        report.angle.others.push(OtherLobe {
            lobe,
            nearest,
            analytic: analytic(&matched, &request),
        });
        publish(Ok(Arc::new(report.clone())));
    }
}

/// The mirror direction of a request.
pub fn mirror_direction(request: &ScatterRequest) -> Vec3<f64> {
    request.wo::<f64>().mirrored_about(NORMAL)
}

fn model(request: &ScatterRequest) -> LobeModel {
    LobeModel {
        horizon: request.horizon,
        anisotropy: f64::from(request.anisotropy),
        table: request.table.clone(),
        ..LobeModel::new(request.lobe, f64::from(request.roughness), request.curve)
    }
}

/// The density of the angle to the mirror direction; nothing where the lobe is a mirror.
fn analytic(model: &LobeModel, request: &ScatterRequest) -> Vec<[f64; 2]> {
    if !model.has_density() {
        return Vec::new();
    }
    let wo = request.wo();
    let around_mirror = frame_from_normal(mirror_direction(request));
    let density = |wi: Vec3<f64>| model.evaluate(wo, wi)[1];
    let step = std::f64::consts::PI / ANGLE_BINS as f64;
    (0..ANGLE_BINS)
        .map(|bin| step * (bin as f64 + 0.5))
        .map(|alpha_rad| [alpha_rad, angle_density(&around_mirror, alpha_rad, AZIMUTHS, density)])
        .collect()
}
