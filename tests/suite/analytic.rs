//! Pictures whose value is known in closed form, as one table (`analytic_scenes.rs`): both engines, every strategy that
//! finds the light, few samples of many pixels and many of few, with and without adaptive sampling.
//!
//! All pixels of a case have the same expected value, so that their spread tells the error of their mean whatever the
//! sequence. A case may be off by four of its own standard errors and [`ROUNDING`], together at most [`BOUND`].

use std::time::{Duration, Instant};

use glossmith::document::Strategy;
use glossmith::document::effect::EffectSwitches;
use glossmith::render::{EngineChoice, Session};

use crate::analytic_scenes::{Case, cases};

/// The most that a picture may be off, relative to its value.
const BOUND: f64 = 3e-3;
/// What f32, albedo tables and the picture's small angle may add to the noise, relative.
const ROUNDING: f64 = 3e-4;
/// The relative error at which adaptive renders stop: a pixel's, sixteen times that of the pixels' mean.
const NOISE: f64 = 0.008;
/// Standard errors within which a picture must lie: one in sixteen thousand falls outside by chance.
const SIGMAS: f64 = 4.0;

/// How a case is rendered.
#[derive(Clone, Copy, Debug)]
struct Run {
    strategy: Strategy,
    /// The picture's sides are so many times 16 pixels, with as many fewer samples: the same in all.
    spread: u32,
    is_adaptive: bool,
}

impl Run {
    fn plain(strategy: Strategy) -> Self {
        Self {
            strategy,
            spread: 1,
            is_adaptive: false,
        }
    }
}

/// Mean colour over the pixels, with its standard error.
fn mean(session: &mut Session, case: &Case, run: Run) -> [[f64; 2]; 3] {
    let mut document = case.document.clone();
    let render = &mut document.render;
    (render.width, render.height) = (16 * run.spread, 16 * run.spread);
    render.samples = (case.samples_of(run.strategy) / (run.spread * run.spread)).max(1);
    render.strategy = run.strategy;
    render.noise = run.is_adaptive.then_some(NOISE);
    // One kernel for the whole table.
    render.effects = EffectSwitches::all_on();
    case.keep(session.assets());
    session.forget();
    session.submit(&document).unwrap();
    while !session.step(Duration::from_secs(1)).unwrap().is_done {}
    let film = session.film().unwrap();
    assert_eq!(film.dropped(), 0, "{}", case.name);
    let pixels = film.pixel_count() as f64;
    [0, 1, 2].map(|channel| {
        let values = || (0..film.pixel_count()).map(|pixel| film.mean(pixel)[channel]);
        let mean = values().sum::<f64>() / pixels;
        let variance = values().map(|value| (value - mean).powi(2)).sum::<f64>() / (pixels - 1.0);
        [mean, (variance / pixels).sqrt()]
    })
}

/// What is wrong with a case, or nothing.
fn faults(session: &mut Session, case: &Case, run: Run) -> Option<String> {
    let found = mean(session, case, run);
    for (channel, ([mean, error], expected)) in found.into_iter().zip(case.expected).enumerate() {
        let allowed = SIGMAS * error + ROUNDING * expected.abs() + 1e-9;
        // Adaptive renders stop by the luminance of all pixels, whatever is left in a channel.
        let bound = if run.is_adaptive { 4.0 * BOUND } else { BOUND };
        let is_sharp = allowed <= bound * expected.abs() + 1e-9;
        if (mean - expected).abs() > allowed || !is_sharp {
            return Some(format!(
                "{}, {run:?}, channel {channel}: {mean:.6}, expected {expected:.6}, off by {:+.3} %; allowed {:.3} %",
                case.name,
                100.0 * (mean / expected - 1.0),
                100.0 * allowed / expected,
            ));
        }
    }
    None
}

fn assert_all(choice: EngineChoice, runs: impl Fn(&Case) -> Vec<Run>) {
    let mut session = Session::open(choice).expect("an engine: install mesa-vulkan-drivers");
    let mut found = Vec::new();
    for case in cases() {
        let begun = Instant::now();
        let runs = runs(&case);
        found.extend(runs.iter().filter_map(|run| faults(&mut session, &case, *run)));
        println!("{choice:?} {}: {:.2} s", case.name, begun.elapsed().as_secs_f64());
    }
    assert!(
        found.is_empty(),
        "{} of the table are off:\n{}",
        found.len(),
        found.join("\n")
    );
}

#[test]
fn analytic_scenes_on_the_processor() {
    assert_all(EngineChoice::Cpu, |case| {
        let mut runs: Vec<_> = case.strategies.iter().map(|&strategy| Run::plain(strategy)).collect();
        let first = runs[0];
        if !case.is_dear {
            runs.push(Run { spread: 2, ..first });
            runs.push(Run {
                is_adaptive: true,
                ..first
            });
        }
        runs
    });
}

/// By one strategy: sample by sample the engines agree in all (`same_paths.rs`).
#[test]
fn analytic_scenes_on_the_gpu() {
    assert_all(EngineChoice::Gpu, |case| {
        let first = (!case.is_dear).then(|| Run::plain(case.strategies[0]));
        first.into_iter().collect()
    });
}
