//! What shading costs in lanes against one number at a time, stage by stage, on each instruction set that has lanes; quoted in
//! docs/PERFORMANCE.md.
//!
//! `cargo bench --bench lanes`. Nanoseconds a sample on one core, the best of some turns, both ways in turns of one run. A
//! function that is not inlined into code compiled for the lanes' instructions falls out of lanes: it stays right and costs
//! ten times as much. So a stage that is not at least [`RATIO_MIN`] times as fast in lanes is named, and the benchmark fails.

use std::{hint::black_box, process::ExitCode, time::Instant};

use fearless_simd::Level;
use glossmith::{
    import::environment::load,
    instructions::Instructions,
    optics::{
        curve::Curve,
        frame::frame_from_normal,
        fresnel::fresnel_conductor,
        lanes::{InLanes, in_lanes},
        lobe::{Horizon, Lobe, LobeShape, lobe_evaluate, lobe_sample},
        random::{Sequence, random_pairs},
        real::{Real, Scalar},
        vector::{Vec3, vec3},
    },
    scene::environment::{
        Environment, EnvironmentSource, environment_density, environment_radiance, environment_sample,
    },
};

/// Samples of a turn.
const COUNT: usize = 1 << 14;
const TURNS: usize = 15;
/// The least that lanes must gain in each stage. What waits for memory gains the least.
const RATIO_MIN: f64 = 1.3;

/// A part of a sample's work: numbers in [0, 1) in, a number out.
trait Stage {
    fn name(&self) -> String;
    fn run<T: Real>(&self, xi: [T; 3]) -> T;
}

/// Two pairs of points of a Sobol sequence.
struct Numbers;

impl Stage for Numbers {
    fn name(&self) -> String {
        "random numbers, two pairs".into()
    }
    #[inline(always)]
    fn run<T: Real>(&self, xi: [T; 3]) -> T {
        let keys = xi[0].to_each();
        let keys = T::each(|lane| (keys.as_ref()[lane].to_f64() * 4_294_967_296.0) as u32);
        let samples = T::each(|lane| lane as u32);
        let mut sum = T::ZERO;
        for dimension in 0..2 {
            let [a, b] = random_pairs::<T>(&keys, &samples, Sequence::Sobol, dimension);
            sum += a + b;
        }
        sum
    }
}

/// A direction drawn from a lobe, with its value and density.
struct OfLobe(Lobe, Curve);

impl Stage for OfLobe {
    fn name(&self) -> String {
        match self.0.has_curves() {
            true => format!("{}, {}: draw, value, density", self.0.name(), self.1.name()),
            false => format!("{}: draw, value, density", self.0.name()),
        }
    }
    #[inline(always)]
    fn run<T: Real>(&self, xi: [T; 3]) -> T {
        let shape = LobeShape {
            lobe: self.0,
            curve: self.1,
            horizon: Horizon::Mirror,
            roughness: T::from_f64(0.3),
            anisotropy: T::ZERO,
            eta: T::ZERO,
            table: &[],
        };
        let up = vec3(T::ZERO, T::ZERO, T::ONE);
        let frame = frame_from_normal(up);
        let wo = Vec3::from_f64([0.6, 0.0, 0.8]);
        let drawn = lobe_sample(&shape, &frame, up, wo, xi);
        let [value, density] = lobe_evaluate(&shape, &frame, up, wo, drawn.wi);
        drawn.weight + value + density
    }
}

/// Fresnel's equations for gold.
struct OfMetal;

impl Stage for OfMetal {
    fn name(&self) -> String {
        "Fresnel of a metal, three colours".into()
    }
    #[inline(always)]
    fn run<T: Real>(&self, [cosine, _, _]: [T; 3]) -> T {
        let c = T::from_f64;
        fresnel_conductor(cosine, c(0.143), c(3.983))
            + fresnel_conductor(cosine, c(0.375), c(2.386))
            + fresnel_conductor(cosine, c(1.442), c(1.603))
    }
}

/// A direction drawn from an environment, then its radiance and density.
struct OfEnvironment<'a>(&'a Environment);

impl Stage for OfEnvironment<'_> {
    fn name(&self) -> String {
        "environment: draw, radiance, density".into()
    }
    #[inline(always)]
    fn run<T: Real>(&self, [x, y, z]: [T; 3]) -> T {
        let (direction, density) = environment_sample(self.0.distribution(false), vec3(x, y, z));
        environment_radiance(self.0, direction).luminance()
            + environment_density(self.0.distribution(false), direction)
            + density
    }
}

/// The best time of a sample, in nanoseconds.
struct Timed<'a, S>(&'a S, &'a [[f32; 3]]);

impl<S: Stage> InLanes for Timed<'_, S> {
    type Output = f64;
    fn run<T: Real<Scalar = f32>>(self) -> f64 {
        let Self(stage, numbers) = self;
        let begun = Instant::now();
        T::vectorize(
            #[inline(always)]
            || {
                let mut sum = T::ZERO;
                for xi in numbers.chunks_exact(T::LANES) {
                    let axis = |i: usize| T::each(|lane| xi[lane][i]);
                    sum += stage.run([T::from_each(&axis(0)), T::from_each(&axis(1)), T::from_each(&axis(2))]);
                }
                black_box(sum.to_each());
            },
        );
        1e9 * begun.elapsed().as_secs_f64() / numbers.len() as f64
    }
}

/// Prints a stage's row; false where it has fallen out of lanes.
fn compare<S: Stage>(stage: &S, sets: &[(&str, Level)], numbers: &[[f32; 3]]) -> bool {
    let mut alone = f64::INFINITY;
    let mut lanes = vec![f64::INFINITY; sets.len()];
    for _ in 0..TURNS {
        alone = alone.min(Timed(stage, numbers).run::<f32>());
        for ((_, level), lanes) in sets.iter().zip(&mut lanes) {
            *lanes = lanes.min(in_lanes(*level, Timed(stage, numbers)));
        }
    }
    let cells = lanes.iter().map(|ns| format!("{ns:.1} | {:.1}", alone / ns));
    println!(
        "| {} | {alone:.1} | {} |",
        stage.name(),
        cells.collect::<Vec<_>>().join(" | ")
    );
    lanes.iter().all(|ns| alone / ns >= RATIO_MIN)
}

fn main() -> ExitCode {
    let with_lanes = [Instructions::Avx512, Instructions::Avx2, Instructions::Neon];
    let sets: Vec<(&str, Level)> = with_lanes
        .iter()
        .filter_map(|set| Some((set.label(), set.level()?)))
        .collect();
    let heads: Vec<String> = sets.iter().map(|(name, _)| format!("{name} | ratio")).collect();
    println!("| stage, ns a sample | alone | {} |", heads.join(" | "));
    println!("|{}", " --- |".repeat(2 + 2 * sets.len()));
    let state = |i: u32| glossmith::optics::random::random_state(0, 0, 7, i, Sequence::Independent);
    let numbers: Vec<[f32; 3]> = (0..COUNT as u32)
        .map(|i| {
            let pair = |dimension| glossmith::optics::random::random_pair(state(i), dimension);
            let ([a, b], [c, _]): ([f32; 2], [f32; 2]) = (pair(0), pair(1));
            [a, b, c]
        })
        .collect();
    let environment = load(&EnvironmentSource::Studio).expect("the studio is built in");
    let mut rows = vec![
        compare(&Numbers, &sets, &numbers),
        compare(&OfMetal, &sets, &numbers),
        compare(&OfEnvironment(&environment), &sets, &numbers),
    ];
    for &lobe in Lobe::ALL {
        let curves = lobe.curves().iter().filter(|curve| !curve.has_table());
        rows.extend(curves.map(|&curve| compare(&OfLobe(lobe, curve), &sets, &numbers)));
    }
    if rows.contains(&false) {
        eprintln!("error: a stage is less than {RATIO_MIN} times as fast in lanes: it has fallen out of them");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}
