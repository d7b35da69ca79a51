//! Speed of the engines, printed as ratios of one run: quoted in docs/PERFORMANCE.md.
//!
//! `cargo bench --bench render`. The scene of issue and design: 512 × 512, a teapot of about 40 000 triangles that fills
//! the frame, metal, 6 bounces, studio light.

use std::{hint::black_box, time::Duration, time::Instant};

use glossmith::{
    document::{Document, Strategy},
    job::scatter::ScatterRequest,
    optics::{
        curve::Curve,
        lobe::{Horizon, Lobe, model::LobeModel, raw_density, raw_sample},
        random::{Sequence, random_pair, random_state},
    },
    render::{EngineChoice, Session},
    scene::environment::EnvironmentSource,
};

/// How long each case is measured.
const DURATION: Duration = Duration::from_secs(3);

fn main() {
    println!("## Rendering: 512 x 512, teapot, metal, roughness 0.3, 6 bounces, studio");
    println!("| engine | strategy | M rays/s | M samples/s | against cpu lobe |");
    println!("| --- | --- | --- | --- | --- |");
    let mut first = None;
    for choice in [EngineChoice::Cpu, EngineChoice::Gpu] {
        for strategy in [Strategy::Lobe, Strategy::Mis] {
            match measure(choice, strategy) {
                Ok((name, rays, samples)) => {
                    let ratio = samples / *first.get_or_insert(samples);
                    let strategy = strategy.name();
                    println!(
                        "| {name} | {strategy} | {:.2} | {:.2} | {ratio:.2} |",
                        rays / 1e6,
                        samples / 1e6
                    );
                }
                Err(error) => println!("| {choice:?} | {} | {error} |||", strategy.name()),
            }
        }
    }
    lobes();
}

/// (engine, rays a second, samples a second).
fn measure(choice: EngineChoice, strategy: Strategy) -> Result<(String, f64, f64), Box<dyn std::error::Error>> {
    let mut document = Document::default();
    document.lighting.environment = EnvironmentSource::Studio;
    (document.render.width, document.render.height) = (512, 512);
    document.render.samples = u32::MAX;
    document.render.bounces = 6;
    document.render.strategy = strategy;
    let mut session = Session::open(choice)?;
    session.submit(&document)?;
    // Warm: shaders compiled, caches filled.
    session.step(Duration::from_secs(2))?;
    document.render.seed = 1;
    session.submit(&document)?;
    let begun = Instant::now();
    session.step(DURATION)?;
    let seconds = begun.elapsed().as_secs_f64();
    let name = session.engine().to_string();
    let film = session.film()?;
    Ok((
        name,
        film.total_rays() as f64 / seconds,
        film.samples() as f64 / seconds,
    ))
}

/// Nanoseconds a sample and a density of each lobe, scalar Rust in f32, the cost of the random numbers taken off.
fn lobes() {
    println!("\n## Lobes, scalar Rust f32, one core, roughness 0.3, view 45 degrees");
    println!("| lobe | ns a sample | ns a density | density against ggx |");
    println!("| --- | --- | --- | --- |");
    let numbers = per_call(|i| xi(i)[0]);
    let mut ggx = 0.0;
    let mut lobes = vec![Lobe::Ggx];
    lobes.extend(Lobe::ALL.iter().copied().filter(|lobe| *lobe != Lobe::Ggx));
    for lobe in lobes {
        let curves: &[Curve] = if lobe == Lobe::Geometric {
            &[Curve::Sqrt, Curve::Cbrt, Curve::Smooth, Curve::Linear, Curve::LongTail]
        } else {
            &[Curve::Sqrt]
        };
        for &curve in curves {
            let request = ScatterRequest {
                model: LobeModel {
                    horizon: Horizon::None,
                    ..LobeModel::new(lobe, 0.3, curve)
                },
                view_angle_deg: 45.0,
                count: 0,
                seed: 0,
            };
            let (shape, frame, wo) = (
                request.model.shape::<f32>(),
                ScatterRequest::frame::<f32>(),
                request.wo::<f32>(),
            );
            let sample = per_call(|i| raw_sample(&shape, &frame, wo, xi(i)).x) - numbers;
            let directions: Vec<_> = (0..4096).map(|i| raw_sample(&shape, &frame, wo, xi(i))).collect();
            let density = per_call(|i| raw_density(&shape, &frame, wo, directions[i as usize % 4096]));
            if lobe == Lobe::Ggx {
                ggx = density;
            }
            let name = if lobe == Lobe::Geometric {
                format!("geometric/{}", curve.name())
            } else {
                lobe.name().to_owned()
            };
            println!("| {name} | {sample:.1} | {density:.1} | {:.2} |", density / ggx);
        }
    }
    println!("random numbers: {numbers:.1} ns a triple");
}

fn xi(i: u32) -> [f32; 3] {
    let state = random_state(0, 0, 0, i, Sequence::Independent);
    let ([a, b], [c, _]) = (random_pair(state, 0), random_pair::<f32>(state, 1));
    [a, b, c]
}

/// Nanoseconds a call: the least of five rounds.
fn per_call(f: impl Fn(u32) -> f32) -> f64 {
    const CALLS: u32 = 1_000_000;
    let round = || {
        let begun = Instant::now();
        let mut sum = 0.0;
        for i in 0..CALLS {
            sum += f(black_box(i));
        }
        black_box(sum);
        begun.elapsed().as_secs_f64() / f64::from(CALLS) * 1e9
    };
    (0..5).map(|_| round()).fold(f64::INFINITY, f64::min)
}
