//! What denoised pictures are worth: how true the error is that is told of them.
//!
//! `cargo bench --bench denoise [-- quick]`: over scenes and numbers of samples the true errors of the samples' mean, the
//! denoised picture and the mixture of both, against a long render; the told error over the true one and how often the
//! latter lies in the band. `quick` does the same small; the beginning of a scene's name takes that scene alone. The
//! processor's engine.

use std::time::{Duration, Instant};

use glossmith::analysis::halves::Distance;
use glossmith::analysis::halves::Halves;
use glossmith::document::{Denoise, Document, assign};
use glossmith::job::film::{Film, Image};
use glossmith::render::denoise::{Denoiser, Noisy};
use glossmith::render::{EngineChoice, Session};

type Failure = Box<dyn std::error::Error>;

/// How much is done.
struct Extent {
    side: u32,
    renders: u32,
    reference_samples: u32,
    samples: &'static [u32],
}

const FULL: Extent = Extent {
    side: 128,
    renders: 64,
    reference_samples: 16_384,
    samples: &[1, 4, 16, 64, 256, 1024, 4096],
};
const QUICK: Extent = Extent {
    side: 64,
    renders: 4,
    reference_samples: 1024,
    samples: &[1, 4, 16],
};

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().collect();
    let has = |name: &str| arguments.iter().any(|argument| argument == name);
    let number = |name: &str| -> Option<u32> {
        arguments
            .iter()
            .find_map(|argument| argument.strip_prefix(name)?.parse().ok())
    };
    let mut extent = if has("quick") { QUICK } else { FULL };
    extent.side = number("side=").unwrap_or(extent.side);
    extent.renders = number("renders=").unwrap_or(extent.renders);
    extent.reference_samples = number("reference=").unwrap_or(extent.reference_samples);
    let most = number("samples=").unwrap_or(u32::MAX);
    let mut session = Session::open(EngineChoice::Cpu)?;
    let mut denoiser = Denoiser::open()?;
    println!("{}, {}", session.engine(), glossmith::render::denoise::Library::get()?);
    let mut scenes = scenes()?;
    if let Some(only) = arguments
        .iter()
        .find(|argument| scenes.iter().any(|(name, _)| name.starts_with(*argument)))
    {
        scenes.retain(|(name, _)| name.starts_with(only));
    }
    truth(&mut session, &mut denoiser, &scenes, &extent, most)
}

/// The five materials of the comparison with other renderers, and the default scene on a ground.
fn scenes() -> Result<Vec<(&'static str, Document)>, Failure> {
    let of = |assignments: &[&str]| -> Result<Document, Failure> {
        let mut document = Document::default();
        for assignment in assignments {
            assign(&mut document.materials[0], assignment)?;
        }
        Ok(document)
    };
    let conductor = |roughness: &'static str| {
        of(&[
            "specular.lobe=ggx",
            "specular.fresnel=conductor",
            "base.metalness=1",
            roughness,
        ])
    };
    let mut default = of(&[])?;
    default.ground = true;
    Ok(vec![
        ("conductor 0.09", conductor("specular.roughness=0.3")?),
        ("conductor 0.25", conductor("specular.roughness=0.5")?),
        (
            "diffuse",
            of(&["specular.weight=0", "base.metalness=0", "base.color=0.6,0.3,0.2"])?,
        ),
        (
            "plastic",
            of(&[
                "specular.lobe=ggx",
                "specular.roughness=0.316",
                "base.metalness=0",
                "base.color=0.1,0.3,0.6",
            ])?,
        ),
        (
            "glass",
            of(&[
                "specular.lobe=ggx",
                "specular.roughness=0.5",
                "base.metalness=0",
                "transmission.weight=1",
            ])?,
        ),
        ("default, ground", default),
    ])
}

fn finish(session: &mut Session, document: &Document) -> Result<Film, Failure> {
    session.forget();
    session.submit(document)?;
    while !session.step(Duration::from_millis(100))?.is_done {}
    Ok(session.film()?.clone())
}

/// Relative error against a reference, whose own noise is taken out; squared.
fn squared_error(image: &Image, reference: &Halves) -> f64 {
    let luminances = image.luminance();
    let n = luminances.len() as f64;
    let products = luminances
        .iter()
        .zip(&reference.even)
        .zip(&reference.odd)
        .map(|((x, a), b)| (x - a) * (x - b));
    products.sum::<f64>() / n / reference.mean_luminance().powi(2)
}

/// The film with all samples in one half: denoised at once, as if there were no other.
fn undivided(film: &Film) -> Film {
    let mut film = film.clone();
    film.odd_color.fill([0.0; 3]);
    film.odd_statistics.fill([0.0; 2]);
    film
}

/// Sums over renders.
#[derive(Default)]
struct Told {
    true_squared: f64,
    told_squared: f64,
    inside: u32,
    count: u32,
}

impl Told {
    fn add(&mut self, true_squared: f64, told: Option<Distance>) {
        self.true_squared += true_squared;
        self.count += 1;
        let Some(told) = told else { return };
        self.told_squared += told.value.powi(2);
        self.inside += u32::from((told.low..=told.high).contains(&true_squared.max(0.0).sqrt()));
    }

    /// The true error in percent; told over true; percent inside the band.
    fn columns(&self) -> String {
        format!(
            "{:.3} | {:.2} | {:.0}",
            100.0 * (self.true_squared / f64::from(self.count)).sqrt(),
            (self.told_squared / self.true_squared).sqrt(),
            100.0 * f64::from(self.inside) / f64::from(self.count)
        )
    }
}

fn truth(
    session: &mut Session,
    denoiser: &mut Denoiser,
    scenes: &[(&str, Document)],
    extent: &Extent,
    most: u32,
) -> Result<(), Failure> {
    println!(
        "## Errors told and true, {0} x {0}, {1} renders",
        extent.side, extent.renders
    );
    println!(
        "| scene | samples | samples' error, % | at once, % | denoised, % | told/true | inside, % | auto, % | told/true | inside, % | auto/samples |"
    );
    for (name, document) in scenes {
        let mut document = document.clone();
        (document.render.width, document.render.height) = (extent.side, extent.side);
        document.render.samples = extent.reference_samples;
        document.render.seed = u32::MAX;
        let begun = Instant::now();
        let reference = Halves::of(&finish(session, &document)?);
        eprintln!("reference in {:.1} s", begun.elapsed().as_secs_f64());
        for samples in extent.samples.iter().filter(|samples| **samples <= most) {
            document.render.samples = *samples;
            let (mut noisy, mut whole, mut high, mut auto) = (0.0, 0.0, Told::default(), Told::default());
            for seed in 0..extent.renders {
                document.render.seed = seed;
                let film = finish(session, &document)?;
                let halves = Noisy::of(&film, None);
                noisy += squared_error(&halves.image, &reference);
                let at_once = denoiser.denoise(&Noisy::of(&undivided(&film), None), Denoise::High)?;
                whole += squared_error(&at_once.image, &reference);
                for (how, sums) in [(Denoise::High, &mut high), (Denoise::Auto, &mut auto)] {
                    let done = denoiser.denoise(&halves, how)?;
                    sums.add(squared_error(&done.image, &reference), done.error);
                }
            }
            let percent = |sum: f64| 100.0 * (sum / f64::from(extent.renders)).sqrt();
            println!(
                "| {name} | {samples} | {:.3} | {:.3} | {} | {} | {:.3} |",
                percent(noisy),
                percent(whole),
                high.columns(),
                auto.columns(),
                (auto.true_squared / noisy).sqrt()
            );
        }
    }
    Ok(())
}
