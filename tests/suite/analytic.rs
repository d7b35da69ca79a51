//! Pictures whose value is known in closed form, as one table (`analytic_scenes.rs`): both engines, every strategy that
//! finds the light, few samples of many pixels and many of few, with and without adaptive sampling.
//!
//! All pixels of a case have the same expected value, so that their spread tells the error of their mean whatever the
//! sequence; of bodies seen whole the spread of several pictures does. A case may be off by four of its own standard errors
//! and [`ROUNDING`], together at most [`BOUND`].

use std::{sync::LazyLock, time::Duration, time::Instant};

use glossmith::{
    document::{Document, Strategy, effect::EffectSwitches},
    render::{EngineChoice, Session},
};

use crate::analytic_scenes::{Case, cases};

/// The most that a picture may be off, relative to its value: a fault of 0.5 % is 7.1 standard errors and [`ROUNDING`] then,
/// which is seen with 99.9 %.
const BOUND: f64 = 0.003;
/// What f32, albedo tables and the picture's small angle may add to the noise, relative.
const ROUNDING: f64 = 0.0003;
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
    /// So many times fewer samples: of other strategies than the first a fault of 1 % is seen.
    fewer: u32,
}

impl Run {
    fn plain(strategy: Strategy) -> Self {
        Self {
            strategy,
            spread: 1,
            is_adaptive: false,
            fewer: 1,
        }
    }
}

/// Mean colour, with its standard error.
fn mean(session: &mut Session, case: &Case, run: Run, more: u32) -> [[f64; 2]; 3] {
    let mut document = case.document.clone();
    let render = &mut document.render;
    (render.width, render.height) = (16 * run.spread, 16 * run.spread);
    render.samples = (more * case.samples_of(run.strategy) / (run.spread * run.spread * run.fewer)).max(1);
    render.strategy = run.strategy;
    render.noise = run.is_adaptive.then_some(NOISE);
    // One kernel for the whole table.
    render.effects = EffectSwitches::all_on();
    case.keep(session.assets());
    session.reset();
    spread(&pixels(session, &document, &case.name))
}

/// The colours of a picture's pixels.
fn pixels(session: &mut Session, document: &Document, name: &str) -> Vec<[f64; 3]> {
    session.submit(document).unwrap();
    while !session.step(Duration::from_secs(1)).unwrap().is_done {}
    let film = session.film().unwrap();
    assert_eq!(film.dropped(), 0, "{name}");
    let color = |pixel| {
        let mean = film.mean(pixel);
        [0, 1, 2].map(|channel| mean[channel])
    };
    (0..film.pixel_count()).map(color).collect()
}

/// The mean of colours that are expected to be alike, with its standard error.
fn spread(colors: &[[f64; 3]]) -> [[f64; 2]; 3] {
    let count = colors.len() as f64;
    [0, 1, 2].map(|channel| {
        let values = || colors.iter().map(|color| color[channel]);
        let mean = values().sum::<f64>() / count;
        let variance = values().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
        [mean, (variance / count).sqrt()]
    })
}

/// What is wrong with a case, or nothing.
fn faults(session: &mut Session, case: &Case, run: Run, more: u32) -> Option<String> {
    let found = mean(session, case, run, more);
    for (channel, ([mean, error], expected)) in found.into_iter().zip(case.expected).enumerate() {
        let allowed = SIGMAS * error + ROUNDING * expected.abs() + 1e-9;
        // Adaptive renders stop by the luminance of all pixels, whatever is left in a channel.
        let bound = BOUND
            * if run.is_adaptive {
                4.0
            } else {
                f64::from(run.fewer).sqrt()
            };
        let is_sharp = allowed <= bound * expected.abs() + 1e-9;
        if !is_sharp && more == 1 {
            // Only a few scenes need more samples.
            return faults(session, case, run, 3);
        }
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

/// Every other case of the table, which two tests render beside each other.
fn assert_half(choice: EngineChoice, half: usize) {
    let mut session = Session::open(choice).expect("an engine: install mesa-vulkan-drivers");
    let mut found = Vec::new();
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);
    for case in CASES.iter().skip(half).step_by(2) {
        let begun = Instant::now();
        let mut runs = runs(case);
        if choice == EngineChoice::Gpu {
            // Engines trace the same paths by every strategy (scenes.rs): what one alone gets wrong is seen by 1 %.
            runs.truncate(1);
            runs[0].fewer = 4;
        }
        found.extend(runs.into_iter().filter_map(|run| faults(&mut session, case, run, 1)));
        println!("{choice:?} {}: {:.2} s", case.name, begun.elapsed().as_secs_f64());
    }
    assert!(found.is_empty(), "{} are off:\n{}", found.len(), found.join("\n"));
}

/// By every strategy, and by the first one with the samples spread over more pixels and where they are needed most.
fn runs(case: &Case) -> Vec<Run> {
    let mut runs: Vec<_> = case.strategies.iter().map(|&strategy| Run::plain(strategy)).collect();
    let first = runs[0];
    runs[1..].iter_mut().for_each(|run| run.fewer = 4);
    if !case.is_dear() {
        runs.push(Run {
            spread: 2,
            fewer: 4,
            ..first
        });
        runs.push(Run {
            is_adaptive: true,
            ..first
        });
    }
    runs
}

#[test]
fn one_half_on_the_processor() {
    assert_half(EngineChoice::Cpu, 0);
}

#[test]
fn the_other_half_on_the_processor() {
    assert_half(EngineChoice::Cpu, 1);
}

#[test]
fn one_half_on_the_gpu() {
    assert_half(EngineChoice::Gpu, 0);
}

#[test]
fn the_other_half_on_the_gpu() {
    assert_half(EngineChoice::Gpu, 1);
}
