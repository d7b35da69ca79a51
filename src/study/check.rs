//! Proof on the user's own machine: samples against densities, energy, engines and strategies against each other.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use serde::Serialize;

use crate::{
    analysis::chi_square::{PolarGrid, sidak_level, test_samples},
    document::{AreaLight, Background, CustomCurve, Document, Strategy},
    job::film::Film,
    job::scatter::{ScatterCloud, ScatterRequest},
    optics::{
        curve::Curve,
        frame::frame_from_normal,
        lobe::{Facets, Horizon, Lobe, LobeSample, lobe_evaluate, lobe_sample, model::LobeModel},
        random::{Sequence, random_pair, random_state},
        vector::Vec3,
    },
    parallel,
    render::{EngineChoice, Prober, Session, SessionError},
    scene::{ModelSource, environment::EnvironmentSource},
    study::small_document,
};

/// Probability that a run fails by chance although everything is right, for each group of tests.
const LEVEL: f64 = 0.001;
/// Roughness and view angles of the full grid.
const ROUGHNESS: [f32; 7] = [0.02, 0.1, 0.3, 0.6, 0.9, 0.999, 1.0];
const VIEW_ANGLES_DEG: [f32; 5] = [0.0, 30.0, 60.0, 80.0, 89.0];

/// Render time between two checks for a stop.
pub(super) const STEP: Duration = Duration::from_millis(200);

/// Cases of the χ² tests between two reports of progress, for each thread.
const CASES_PER_THREAD: usize = 4;

/// Relative tolerance of an f64 sample's weight against evaluate / density.
const WEIGHT_ERROR: f64 = 1e-9;

/// Kinds of cases: horizon policy, relative index of refraction (0 for reflection), and the stride of a quick check through
/// the grid.
const KINDS: [(Horizon, f32, usize); 4] = [
    (Horizon::Mirror, 0.0, 5),
    (Horizon::Absorb, 0.0, 5),
    (Horizon::Mirror, 1.5, 15),
    (Horizon::Absorb, 1.0 / 1.5, 15),
];

/// One thing that was checked.
#[derive(Clone, Debug, Serialize)]
pub struct Check {
    /// Group of the check: `samples`, `energy`, `weights`, `furnace`, `engines`, `strategies`, `soundness`.
    pub group: &'static str,
    /// Name of the case.
    pub name: String,
    /// Measure of the value: `p`, `error`, `sigma`, `count`.
    pub measure: &'static str,
    pub value: f64,
    /// Limit of the value.
    pub limit: f64,
    /// Whether it is on the right side of it.
    pub passed: bool,
}

impl Check {
    /// A value held against a limit: a probability `p` must be above it, anything else at most that.
    pub fn new(group: &'static str, name: impl Into<String>, measure: &'static str, value: f64, limit: f64) -> Self {
        Self {
            group,
            name: name.into(),
            measure,
            value,
            limit,
            passed: if measure == "p" { value > limit } else { value <= limit },
        }
    }

    /// Value and limit: counts as they are, other numbers in three digits, or in as many as show which is larger.
    pub fn texts(&self) -> [String; 2] {
        let both = [self.value, self.limit];
        if self.measure == "count" {
            return both.map(|count| count.to_string());
        }
        let rounded = |digits: usize| both.map(|x| format!("{x:.digits$e}").parse().unwrap_or(x));
        let order = |[value, limit]: [f64; 2]| value.partial_cmp(&limit);
        // Enough digits that the comparison can be seen.
        let digits = (2..16)
            .find(|digits| order(rounded(*digits)) == order(both))
            .unwrap_or(16);
        [format!("{:.digits$e}", self.value), format!("{:e}", rounded(digits)[1])]
    }
}

impl std::fmt::Display for Check {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let comparison = if self.measure == "p" { "above" } else { "at most" };
        let [value, limit] = self.texts();
        write!(f, "{}: {} {value}, {comparison} {limit}", self.name, self.measure)
    }
}

/// The checks of a group.
#[derive(Clone, Debug)]
pub struct GroupSummary {
    /// Name of the group.
    pub group: &'static str,
    /// Number of passed checks.
    pub passed: usize,
    /// Number of failed checks.
    pub failed: usize,
    /// The one closest to failing, or furthest beyond.
    pub worst: Check,
}

/// The checks by group.
pub fn summaries(checks: &[Check]) -> Vec<GroupSummary> {
    // The smallest p, else the largest value.
    let badness = |check: &Check| {
        if check.measure == "p" {
            -check.value
        } else {
            check.value
        }
    };
    let summary = |of_group: &[Check]| {
        let passed = of_group.iter().filter(|check| check.passed).count();
        let worst = of_group.iter().max_by(|a, b| badness(a).total_cmp(&badness(b)))?;
        Some(GroupSummary {
            group: worst.group,
            passed,
            failed: of_group.len() - passed,
            worst: worst.clone(),
        })
    };
    checks.chunk_by(|a, b| a.group == b.group).filter_map(summary).collect()
}

/// Options of the checks.
#[derive(Clone, Copy, Debug)]
pub struct CheckOptions {
    /// The engine to check.
    pub engine: EngineChoice,
    /// The whole grid of lobes, roughnesses and angles with more samples, not a part of it.
    pub thorough: bool,
}

/// Cases of the χ² tests: every lobe and curve, anisotropic if supported, reflecting and refracting.
pub fn sample_cases(thorough: bool) -> Vec<ScatterRequest> {
    let mut cases = Vec::new();
    for (horizon, eta, quick_part) in KINDS {
        // A quick check tests each lobe at some grid points, and each grid point with some lobes.
        let part = if thorough { 1 } else { quick_part };
        for (number, (lobe, curve, anisotropy)) in shapes().into_iter().enumerate() {
            for (i, &roughness) in ROUGHNESS.iter().enumerate() {
                for (j, &view_angle_deg) in VIEW_ANGLES_DEG.iter().enumerate() {
                    // Beyond the critical angle, narrow microfacet lobes refract almost nothing.
                    let is_dark =
                        eta < 1.0 && view_angle_deg > 41.0 && roughness < 0.3 && lobe.facets() != Facets::None;
                    if !(i + 2 * j + number).is_multiple_of(part) || (eta != 0.0 && is_dark) {
                        continue;
                    }
                    cases.push(ScatterRequest {
                        model: LobeModel {
                            horizon,
                            anisotropy: f64::from(anisotropy),
                            eta: f64::from(eta),
                            table: if curve.has_table() {
                                CustomCurve::default().table()
                            } else {
                                Vec::new()
                            },
                            ..LobeModel::new(lobe, f64::from(roughness), curve)
                        },
                        view_angle_deg,
                        count: if thorough { 60_000 } else { 20_000 },
                        seed: cases.len() as u32,
                    });
                }
            }
        }
    }
    cases
}

/// Every lobe, curve and stretch.
pub(super) fn shapes() -> Vec<(Lobe, Curve, f32)> {
    let mut shapes = Vec::new();
    for &lobe in Lobe::ALL {
        let stretched: &[f32] = if lobe.is_anisotropic() { &[0.0, 0.7] } else { &[0.0] };
        for &curve in lobe.curves() {
            shapes.extend(stretched.iter().map(|&anisotropy| (lobe, curve, anisotropy)));
        }
    }
    shapes
}

/// The p-value of a cloud of samples under the density of the f64 twin, times `density_factor` (1, but for tests of the
/// test itself).
pub fn chi_square(
    request: &ScatterRequest,
    cloud: &ScatterCloud,
    density_factor: impl Fn(Vec3<f64>) -> f64 + Sync,
) -> f64 {
    let shape = request.model.shape::<f64>();
    let frame = ScatterRequest::frame::<f64>();
    let wo = request.wo::<f64>();
    // The rings follow the lobe: equal shares of a pilot drawn by the twin.
    let pilot = twin_samples(request, 4000, Sequence::Independent).map(|drawn| drawn.wi);
    let grid = PolarGrid::following(frame_from_normal(request.middle()), 12, 12, pilot);
    let mut samples: Vec<_> = cloud
        .samples
        .iter()
        .map(|&[x, y, z, _]| Some(Vec3::from_f32([x, y, z]).normalize()))
        .collect();
    samples.resize(samples.len() + cloud.absorbed as usize, None);
    let density = |wi: Vec3<f64>| {
        // The model's own loss below the horizon counts as absorbed, not as density.
        let [value, density] = lobe_evaluate(&shape, &frame, frame.normal, wo, wi);
        if value > 0.0 { density * density_factor(wi) } else { 0.0 }
    };
    test_samples(&grid, &samples, &[frame.normal], density).p_value
}

/// Runs the checks; `progress` receives the name of the group and the share of all that is done, which is estimated. `None`
/// if `stop` was set.
pub fn run(
    options: CheckOptions,
    stop: &AtomicBool,
    progress: impl Fn(&str, f64),
) -> Result<Option<Vec<Check>>, SessionError> {
    type Group = fn(CheckOptions, &AtomicBool, &dyn Fn(f64)) -> Result<Vec<Check>, SessionError>;
    // With the share of the time that each takes in a quick check.
    let groups: [(&str, f64, Group); 5] = [
        ("samples against densities", 0.89, samples),
        ("energy", 0.05, |_, stop, _| Ok(energy(stop))),
        ("weights", 0.01, |_, stop, _| Ok(weights(stop))),
        ("white furnace", 0.01, |options, stop, _| furnace(options, stop)),
        ("engines and strategies", 0.04, |options, stop, _| {
            pictures(options, stop)
        }),
    ];
    let mut checks = Vec::new();
    let mut done = 0.0;
    for (name, share, group) in groups {
        let told = |of_group: f64| progress(name, done + share * of_group);
        told(0.0);
        checks.extend(group(options, stop, &told)?);
        if stop.load(Ordering::Relaxed) {
            return Ok(None);
        }
        done += share;
    }
    Ok(Some(checks))
}

/// The result of `work`; `None` if the checks are stopped.
fn unless_stopped<T>(stop: &AtomicBool, work: impl FnOnce() -> T) -> Option<T> {
    (!stop.load(Ordering::Relaxed)).then(work)
}

fn samples(options: CheckOptions, stop: &AtomicBool, told: &dyn Fn(f64)) -> Result<Vec<Check>, SessionError> {
    let cases = sample_cases(options.thorough);
    let cases_total = cases.len();
    let prober = Prober::open(options.engine)?;
    let limit = sidak_level(LEVEL, cases.len());
    let check = |(case, cloud): (&ScatterRequest, &ScatterCloud)| {
        unless_stopped(stop, || {
            let value = chi_square(case, cloud, |_| 1.0);
            Check::new("samples", describe(case), "p", value, limit)
        })
    };
    // A few for each thread at a time: the stops between them cost little, and show what is left.
    let part = CASES_PER_THREAD * rayon::current_num_threads();
    let mut checks = Vec::with_capacity(cases.len());
    for cases in cases.chunks(part) {
        let clouds = cases
            .iter()
            .map_while(|case| unless_stopped(stop, || prober.scatter(case)));
        let clouds = clouds.collect::<Result<Vec<_>, _>>()?;
        let of_part = parallel::map(clouds.len(), |place| check((&cases[place], &clouds[place])));
        checks.extend(of_part.into_iter().flatten());
        if stop.load(Ordering::Relaxed) {
            break;
        }
        told(checks.len() as f64 / cases_total as f64);
    }
    Ok(checks)
}

/// The name of a case.
fn describe(case: &ScatterRequest) -> String {
    let model = &case.model;
    let mut text = model.lobe.name().to_owned();
    if model.lobe.has_curves() {
        text += &format!("/{}", model.curve.name());
    }
    text += &format!(" {} roughness {}", model.horizon.name(), model.roughness as f32);
    if model.anisotropy != 0.0 {
        text += &format!(" stretched {}", model.anisotropy as f32);
    }
    if model.eta != 0.0 {
        text += &format!(" refracted {:.3}", model.eta);
    }
    format!("{text} view {}°", case.view_angle_deg)
}

/// Checks of a group by their worst: only failures are listed one by one, the rest is summed up.
fn summed_up(group: &'static str, what: &str, all: Vec<Check>) -> Vec<Check> {
    let count = all.len();
    let worst = all.iter().map(|check| check.value / check.limit).fold(0.0, f64::max);
    let mut checks: Vec<Check> = all.into_iter().filter(|check| !check.passed).collect();
    let name = format!("{what} over {count} cases, worst share of its limit");
    checks.push(Check::new(group, name, "error", worst, 1.0));
    checks
}

/// Samples of the f64 twin of a case.
fn twin_samples(case: &ScatterRequest, count: u32, sequence: Sequence) -> impl Iterator<Item = LobeSample<f64>> + '_ {
    let frame = ScatterRequest::frame::<f64>();
    (0..count).map(move |i| {
        let state = random_state(1, 0, case.seed, i, sequence);
        let ([a, b], [c, _]) = (random_pair(state, 0), random_pair::<f64>(state, 1));
        lobe_sample(&case.model.shape(), &frame, frame.normal, case.wo(), [a, b, c])
    })
}

/// The mean weight of the samples: 1 for lobes that weigh 1 under the mirror policy, never above 1.
fn energy(stop: &AtomicBool) -> Vec<Check> {
    let check = |case: &ScatterRequest| {
        let mean = twin_samples(case, 4096, Sequence::Sobol)
            .map(|drawn| drawn.weight)
            .sum::<f64>()
            / 4096.0;
        let is_conserving = case.model.lobe.traits().weighs_one && case.model.horizon == Horizon::Mirror;
        let value = if is_conserving {
            (mean - 1.0).abs()
        } else {
            (mean - 1.0).max(0.0)
        };
        // Facets drawn whether or not they are seen have noisy weights at grazing angles.
        let limit = if case.model.lobe.facets() == Facets::All {
            0.15
        } else {
            0.002
        };
        Check::new("energy", describe(case), "error", value, limit)
    };
    summed_up("energy", "mean weight", of_all_cases(stop, check))
}

/// A check of every case of the whole grid.
fn of_all_cases(stop: &AtomicBool, check: impl Fn(&ScatterRequest) -> Check + Sync) -> Vec<Check> {
    let checked = |case: &ScatterRequest| unless_stopped(stop, || check(case));
    parallel::map_each(&sample_cases(true), checked)
        .into_iter()
        .flatten()
        .collect()
}

/// Checks that a sample's weight equals evaluate / density of its direction.
fn weights(stop: &AtomicBool) -> Vec<Check> {
    let check = |case: &ScatterRequest| {
        let frame = ScatterRequest::frame::<f64>();
        let error = |drawn: LobeSample<f64>| {
            if drawn.weight <= 0.0 {
                return 0.0;
            }
            let [value, density] = lobe_evaluate(&case.model.shape(), &frame, frame.normal, case.wo(), drawn.wi);
            (value - drawn.weight * density).abs() / value.max(f64::MIN_POSITIVE)
        };
        let value = twin_samples(case, 256, Sequence::Sobol).map(error).fold(0.0, f64::max);
        Check::new("weights", describe(case), "error", value, WEIGHT_ERROR)
    };
    summed_up(
        "weights",
        "weight against evaluate / density",
        of_all_cases(stop, check),
    )
}

/// The finished render's film; `None` if the checks are stopped.
fn film(engine: EngineChoice, document: &Document, stop: &AtomicBool) -> Result<Film, SessionError> {
    let mut session = Session::open(engine)?;
    session.submit(document)?;
    while !stop.load(Ordering::Relaxed) && !session.step(STEP)?.is_done {}
    Ok(session.film()?.clone())
}

fn furnace(options: CheckOptions, stop: &AtomicBool) -> Result<Vec<Check>, SessionError> {
    let check = |roughness: f32| {
        let mut document = small_document(ModelSource::Teapot, EnvironmentSource::Furnace, 48, 4);
        document.materials[0].roughness = roughness;
        document.materials[0].fresnel = crate::optics::fresnel::Fresnel::None;
        let image = film(options.engine, &document, stop)?.image();
        let error = |pixel: &[f32; 4]| f64::from((pixel[1] - 1.0).abs());
        let value = image.pixels.iter().map(error).fold(0.0, f64::max);
        let name = format!("teapot, geometric, roughness {roughness}: worst pixel");
        Ok(Check::new("furnace", name, "error", value, 5e-3))
    };
    [0.0, 0.1, 0.5, 1.0].into_iter().map(check).collect()
}

fn pictures(options: CheckOptions, stop: &AtomicBool) -> Result<Vec<Check>, SessionError> {
    let samples = if options.thorough { 1024 } else { 128 };
    let mut subject = small_document(ModelSource::Teapot, EnvironmentSource::Studio, 48, samples);
    subject.materials[0].roughness = 0.5;
    subject.lighting.background = Background::Transparent;
    // Large enough for the lobe alone to find it often.
    subject.lighting.area_lights = vec![AreaLight {
        width: 2.0,
        height: 2.0,
        strength: 4.0,
        ..AreaLight::default()
    }];
    let with = |strategy: Strategy, seed: u32| {
        let mut document = subject.clone();
        (document.render.strategy, document.render.seed) = (strategy, seed);
        document
    };
    let film = |engine, strategy, seed| film(engine, &with(strategy, seed), stop);
    let mis = film(options.engine, Strategy::Mis, 0)?;
    let lobe = film(options.engine, Strategy::Lobe, 1)?;
    let light = film(options.engine, Strategy::Light, 2)?;
    let cpu = film(EngineChoice::Cpu, Strategy::Mis, 3)?;
    let compare = |group, name: &str, other: &Film| {
        let value = mis.difference_in_sigma(other).abs();
        Check::new(group, name, "sigma", value, 4.0)
    };
    let dropped = [&mis, &lobe, &light, &cpu]
        .iter()
        .map(|film| film.dropped())
        .sum::<u64>() as f64;
    Ok(vec![
        compare("engines", "this engine against the CPU, whole image", &cpu),
        compare("strategies", "mis against lobe, whole image", &lobe),
        compare("strategies", "mis against light, whole image", &light),
        Check::new(
            "soundness",
            "samples dropped because they were not finite",
            "count",
            dropped,
            0.0,
        ),
    ])
}
