//! What the error that is told is worth, what adaptive sampling gains and what looking at the error costs.
//!
//! `cargo bench --bench noise [-- quick]`: how often the true error, against a long render, lies in the band that is told,
//! over scenes, sequences and numbers of samples; the time to a noise with adaptive sampling on and off, in turns, for
//! every scene of the list: the noise is what so many samples of every pixel come to; the share of the time that the looks
//! take; the true error of both, from how far renders with other seeds are from each other. Then the true error of
//! renders that stop at 2 %. `quick` does the same small, to see that it works; `coverage`, `adaptive` or `stopping` one
//! of the parts. The processor engine; `gpu` as a further argument
//! takes the GPU, and the beginning of a scene's name that scene alone.

use std::time::Duration;

use glossmith::{
    analysis::noise::noise,
    document::{AreaLight, Document},
    job::film::Film,
    optics::random::Sequence,
    render::{EngineChoice, Progress, Session},
    scene::{ModelSource, environment::EnvironmentSource},
    store::preset,
};

type Failure = Box<dyn std::error::Error>;

type Part = fn(&mut Session, &[(&str, Document)], &Extent) -> Result<(), Failure>;

/// How much is done.
struct Extent {
    side: u32,
    renders: u32,
    reference_samples: u32,
    samples: &'static [u32],
    samples_even: u32,
    rounds: u32,
}

const FULL: Extent = Extent {
    side: 64,
    renders: 64,
    reference_samples: 65_536,
    samples: &[16, 64, 256],
    samples_even: 512,
    rounds: 3,
};
const QUICK: Extent = Extent {
    side: 24,
    renders: 8,
    reference_samples: 1024,
    samples: &[16],
    samples_even: 64,
    rounds: 2,
};

/// The error at which renders are to stop, and how many.
const STOP_NOISE: f64 = 0.02;
const STOP_RENDERS: u32 = 8;

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().collect();
    let has = |name: &str| arguments.iter().any(|argument| argument == name);
    let extent = if has("quick") { QUICK } else { FULL };
    let mut session = Session::open(if has("gpu") {
        EngineChoice::Gpu
    } else {
        EngineChoice::Cpu
    })?;
    println!("{}", session.engine());
    let mut scenes = scenes()?;
    if let Some(only) = arguments
        .iter()
        .find(|argument| scenes.iter().any(|(name, _)| name.starts_with(*argument)))
    {
        scenes.retain(|(name, _)| name.starts_with(only));
    }
    let parts = [
        ("coverage", coverage as Part),
        ("adaptive", adaptive as Part),
        ("stopping", stopping as Part),
    ];
    let is_named = parts.iter().any(|(name, _)| has(name));
    for (_, part) in parts.iter().filter(|(name, _)| has(name) || !is_named) {
        part(&mut session, &scenes, &extent)?;
    }
    Ok(())
}

fn scenes() -> Result<Vec<(&'static str, Document)>, Failure> {
    let scene = |model: ModelSource, environment: EnvironmentSource, material: &str| -> Result<Document, Failure> {
        let mut document = Document {
            model,
            materials: vec![preset::find(material)?.value],
            ..Document::default()
        };
        document.lighting.environment = environment;
        Ok(document)
    };
    let mut lit = scene(ModelSource::Sphere, EnvironmentSource::Studio, "gold")?;
    lit.ground = true;
    lit.lighting.strength = 0.1;
    lit.lighting.area_lights = vec![AreaLight {
        width: 0.3,
        height: 0.3,
        strength: 100.0,
        ..AreaLight::default()
    }];
    let default = Document::default();
    Ok(vec![
        ("teapot, studio", default),
        (
            "teapot, sky, gold",
            scene(ModelSource::Teapot, EnvironmentSource::Sky, "gold")?,
        ),
        (
            "sphere, studio, glass",
            scene(ModelSource::Sphere, EnvironmentSource::Studio, "glass")?,
        ),
        (
            "plane, studio, gold",
            scene(ModelSource::Plane, EnvironmentSource::Studio, "gold")?,
        ),
        ("gold ball, ground, small light", lit),
    ])
}

fn finish(session: &mut Session, document: &Document) -> Result<(Film, Progress), Failure> {
    session.reset();
    session.submit(document)?;
    while !session.step(Duration::from_millis(100))?.is_done {}
    let progress = session.progress();
    Ok((session.film()?.clone(), progress))
}

/// Root mean square difference of the luminances over the mean of the reference's.
fn true_error(film: &Film, reference: &[f64]) -> f64 {
    let squares = film
        .luminance()
        .iter()
        .zip(reference)
        .map(|(x, y)| (x - y).powi(2))
        .sum::<f64>();
    (squares / reference.len() as f64).sqrt() / (reference.iter().sum::<f64>() / reference.len() as f64)
}

fn coverage(session: &mut Session, scenes: &[(&str, Document)], extent: &Extent) -> Result<(), Failure> {
    println!("## True error inside the 95 % band, of {} renders", extent.renders);
    println!("| scene | sequence | samples | true error | estimated over true | by the spread over true | inside |");
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for (name, document) in scenes {
        let mut document = document.clone();
        (document.render.width, document.render.height) = (extent.side, extent.side);
        document.render.samples = extent.reference_samples;
        document.render.seed = u32::MAX;
        let reference = finish(session, &document)?.0.luminance();
        for sequence in Sequence::ALL {
            document.render.sequence = *sequence;
            for samples in extent.samples {
                document.render.samples = *samples;
                let (mut inside, mut squares) = (0, [0.0; 3]);
                for seed in 0..extent.renders {
                    document.render.seed = seed;
                    let (film, _) = finish(session, &document)?;
                    let error = true_error(&film, &reference);
                    let estimate = noise(&film).ok_or("no error is estimated")?;
                    inside += u32::from((estimate.low..=estimate.high).contains(&error));
                    for (sum, x) in squares.iter_mut().zip([error, estimate.relative, estimate.from_spread]) {
                        *sum += x * x / f64::from(extent.renders);
                    }
                }
                let [error, estimate, spread] = squares.map(f64::sqrt);
                println!(
                    "| {name} | {} | {samples} | {:.2} % | {:.3} | {:.3} | {:.1} % |",
                    sequence.name(),
                    100.0 * error,
                    estimate / error,
                    spread / error,
                    100.0 * f64::from(inside) / f64::from(extent.renders)
                );
            }
        }
    }
    Ok(())
}

fn adaptive(session: &mut Session, scenes: &[(&str, Document)], extent: &Extent) -> Result<(), Failure> {
    let side = 4 * extent.side;
    println!(
        "## Time to the noise of {} samples of every pixel, {side} x {side}, medians of {}",
        extent.samples_even, extent.rounds
    );
    println!(
        "| scene | noise | even | adaptive | sooner by | samples adaptive | looks' share | true, even | true, adaptive |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for (name, document) in scenes {
        let mut document = document.clone();
        (document.render.width, document.render.height) = (side, side);
        let (mut ratios, mut seconds) = (Vec::new(), [Vec::new(), Vec::new()]);
        let (mut wanted, mut last) = (0.0, Progress::default());
        let mut films = [Vec::new(), Vec::new()];
        for round in 0..extent.rounds {
            document.render.seed = round;
            (document.render.adaptive, document.render.noise) = (Some(false), None);
            document.render.samples = extent.samples_even;
            let (film, even) = finish(session, &document)?;
            wanted = noise(&film).ok_or("no error is estimated")?.relative;
            (document.render.adaptive, document.render.noise) = (Some(true), Some(wanted));
            document.render.samples = u32::MAX;
            let (film_adaptive, progress) = finish(session, &document)?;
            last = progress;
            std::iter::zip(&mut films, [film, film_adaptive]).for_each(|(all, film)| all.push(film));
            let times = [even.render_seconds, last.render_seconds];
            std::iter::zip(&mut seconds, times).for_each(|(all, time)| all.push(time));
            ratios.push(times[0] / times[1]);
        }
        let [even, adaptive] = seconds.map(median);
        let [true_even, true_adaptive] = films.map(|films| format!("{:.2} %", 100.0 * spread(&films)));
        println!(
            "| {name} | {:.2} % | {even:.2} s | {adaptive:.2} s | {:.2} × | {:.1} | {:.1} % | {true_even} | {true_adaptive} |",
            100.0 * wanted,
            median(ratios),
            last.mean_samples,
            100.0 * last.measure_seconds / last.render_seconds
        );
    }
    Ok(())
}

fn stopping(session: &mut Session, scenes: &[(&str, Document)], extent: &Extent) -> Result<(), Failure> {
    println!(
        "## True error of renders that stop at {STOP_NOISE}, {0} x {0}",
        extent.side
    );
    println!("| scene | renders | samples per pixel | seconds each | least true error | most |");
    println!("| --- | --- | --- | --- | --- | --- |");
    for (name, document) in scenes {
        let mut document = document.clone();
        (document.render.width, document.render.height) = (extent.side, extent.side);
        (document.render.samples, document.render.noise) = (u32::MAX, Some(STOP_NOISE));
        let (mut pictures, mut last) = (Vec::new(), Progress::default());
        for seed in 0..STOP_RENDERS {
            document.render.seed = seed;
            let (film, progress) = finish(session, &document)?;
            pictures.push(film);
            last = progress;
        }
        let errors = true_errors(&pictures);
        let [least, most] = [errors[0], errors[errors.len() - 1]].map(|error| 100.0 * error);
        println!(
            "| {name} | {STOP_RENDERS} | {:.0} | {:.1} | {least:.2} % | {most:.2} % |",
            last.mean_samples, last.render_seconds
        );
    }
    Ok(())
}

/// The true errors of some independent pictures, the least first: from their mean, whose own error is taken out.
fn true_errors(films: &[Film]) -> Vec<f64> {
    let pictures: Vec<Vec<f64>> = films.iter().map(Film::luminance).collect();
    let count = films.len() as f64;
    let pixel = |i: usize| pictures.iter().map(|picture| picture[i]).sum::<f64>() / count;
    let mean: Vec<f64> = (0..pictures[0].len()).map(pixel).collect();
    let own = |film: &Film| true_error(film, &mean) / (1.0 - 1.0 / count).sqrt();
    let mut errors: Vec<f64> = films.iter().map(own).collect();
    errors.sort_by(f64::total_cmp);
    errors
}

/// The true error of each of some independent pictures, root mean square, from how far they are from each other.
fn spread(films: &[Film]) -> f64 {
    let pairs = films.windows(2).map(|pair| true_error(&pair[0], &pair[1].luminance()));
    let squares: Vec<f64> = pairs.map(|error| error.powi(2) / 2.0).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
