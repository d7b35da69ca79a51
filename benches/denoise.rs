//! What denoised pictures are worth, and what they cost.
//!
//! `cargo bench --bench denoise [-- PART… quick]`, all parts without one:
//!
//! - `told`: over scenes and numbers of samples the true errors of the samples' mean, the denoised picture and the mixture of
//!   both, against a long render; the told error over the true one and how often the latter lies in the band.
//! - `edit`: seconds from an edit to a picture below a relative mean squared error of 0.003, in the worker behind the
//!   window, without denoiser and with either quality.
//! - `steps`: seconds of each step on the way to the first denoised picture, and to one of two halves.
//! - `cost`: what the guides take of the samples, and what denoising while rendering takes after the first second.
//!
//! `shared` leads both halves by the guides of both, as it was once done: the told error is then too low where guides are noisy.
//! `quick` does the same small; the beginning of a scene's name takes that scene alone; `side=`, `renders=`, `reference=`,
//! `samples=` change the extent. The processor's engine.

use std::{path::Path, sync::Arc, time::Duration, time::Instant};

use glossmith::{
    analysis::{error::RELATIVE_FLOOR, halves::Distance, halves::Halves},
    document::{Denoise, Document, assign},
    job::film::{Film, HalfSums, Image},
    optics::random::{Sequence, random_pair, random_state},
    render::{
        EngineChoice, Session,
        denoise::Denoiser,
        denoise::Noisy,
        worker::{Pace, Picture, Worker},
    },
    scene::{ModelSource, environment::EnvironmentSource, texture::TextureTarget, texture::UserTexture},
};
use image::{Luma, Rgb};

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
    samples: &[1, 2, 4, 16, 64, 128, 256, 1024, 4096],
};
const QUICK: Extent = Extent {
    side: 64,
    renders: 4,
    reference_samples: 1024,
    samples: &[1, 4, 16],
};

/// Makes a film's parts into what is denoised.
type Reader = fn(&Film) -> Noisy;

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().collect();
    let has = |name: &str| arguments.iter().any(|argument| argument == name);
    if has("edit") {
        // As in the window.
        glossmith::render::priority::let_rendering_give_way();
    }
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
    let folder = tempfile::tempdir()?;
    let [mut scenes, mut hard] = [scenes()?, hard_scenes(folder.path())?];
    let all = || scenes.iter().chain(&hard).map(|(name, _)| *name);
    if let Some(only) = arguments
        .iter()
        .find(|argument| all().any(|name| name.starts_with(argument.as_str())))
    {
        scenes.retain(|(name, _)| name.starts_with(only));
        hard.retain(|(name, _)| name.starts_with(only));
    }
    let is_wanted = |part: &str| has(part) || !["told", "edit", "steps", "cost"].iter().any(|other| has(other));
    if is_wanted("cost") {
        guides_cost(&mut session, &scenes, has("quick"))?;
        denoising_cost(&scenes)?;
    }
    if is_wanted("steps") {
        steps(&mut session, &scenes, if has("quick") { 128 } else { 512 })?;
    }
    if is_wanted("edit") {
        edits(&mut session, &scenes, has("quick"))?;
    }
    if is_wanted("told") {
        let read: Reader = if has("shared") {
            led_by_all
        } else {
            |film| Noisy::of(film, None)
        };
        scenes.extend(hard);
        truth(&mut session, &mut denoiser, &scenes, &extent, (most, read))?;
    }
    Ok(())
}

/// The five materials of the comparison with other renderers, and the default scene on a ground.
fn scenes() -> Result<Vec<(&'static str, Document)>, Failure> {
    let of = |assignments: &[&str]| -> Result<Document, Failure> {
        let mut document = Document::default();
        document.lighting.environment = EnvironmentSource::Studio;
        // Guides are kept where a denoised picture is wanted.
        document.view.denoise = Denoise::High;
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

/// Where guides are as noisy as the light: textures, edges, bumps, blur, clear glass.
fn hard_scenes(folder: &Path) -> Result<Vec<(&'static str, Document)>, Failure> {
    let (squares, bumps) = (folder.join("squares.png"), folder.join("bumps.png"));
    let random = |x: u32, y: u32, seed: u32| {
        let state = random_state(x, y, seed, 0, Sequence::Independent);
        random_pair::<f64>(state, 0)
    };
    let square = |x: u32, y: u32| Luma([if random(x, y, 1)[0] < 0.5 { 0 } else { 255_u8 }]);
    image::GrayImage::from_fn(64, 64, square).save(&squares)?;
    let bump = |x: u32, y: u32| {
        let [along, across] = random(x, y, 2).map(|xi| (64.0 + 128.0 * xi) as u8);
        Rgb([along, across, 255])
    };
    image::RgbImage::from_fn(64, 64, bump).save(&bumps)?;
    let of = |model: ModelSource, assignments: &[&str]| -> Result<Document, Failure> {
        let mut document = Document {
            model,
            ..Document::default()
        };
        document.lighting.environment = EnvironmentSource::Studio;
        document.view.denoise = Denoise::High;
        document.camera.pitch_deg = 60.0;
        for assignment in assignments {
            assign(&mut document.materials[0], assignment)?;
        }
        Ok(document)
    };
    let pictured = |document: &mut Document, target: TextureTarget, file: &Path, scale: f32| {
        let texture = UserTexture {
            scale,
            ..UserTexture::of(file.to_owned())
        };
        document.materials[0].put_texture(target, texture);
    };
    const MATT: [&str; 2] = ["specular.weight=0", "base.metalness=0"];
    let textured = |scale: f32| -> Result<Document, Failure> {
        let mut document = of(ModelSource::Plane, &MATT)?;
        pictured(&mut document, TextureTarget::BaseColor, &squares, scale);
        Ok(document)
    };
    let mut even_light = textured(0.7)?;
    even_light.lighting.environment = EnvironmentSource::Furnace;
    let mut bumpy = of(ModelSource::Plane, &["specular.roughness=0.3", "base.metalness=0"])?;
    pictured(&mut bumpy, TextureTarget::Normal, &bumps, 0.3);
    let mut blurred = textured(0.3)?;
    (blurred.camera.aperture, blurred.camera.focus_distance) = (0.1, Some(1.5));
    let mut glassy = of(
        ModelSource::Sphere,
        &[
            "specular.lobe=ggx",
            "specular.roughness=0",
            "base.metalness=0",
            "transmission.weight=1",
        ],
    )?;
    (glassy.ground, glassy.camera.pitch_deg) = (true, 20.0);
    Ok(vec![
        ("textured, even light", even_light),
        ("textured, studio", textured(0.7)?),
        ("edged", textured(0.12)?),
        ("bumpy", bumpy),
        ("blurred", blurred),
        ("clear glass", glassy),
    ])
}

fn finish(session: &mut Session, document: &Document) -> Result<Film, Failure> {
    session.reset();
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

/// All that the first samples saw, in both halves, with how many there are.
fn with_all_guides(film: &Film) -> (Film, Vec<[f64; 2]>) {
    let mut film = film.clone();
    let counts = (0..film.pixel_count()).map(|pixel| [film.guide_samples(pixel).iter().sum(); 2]);
    let counts = counts.collect();
    for halves in film.guides.chunks_exact_mut(2) {
        let odd = halves[1];
        halves[0].add(&odd);
        halves[1] = halves[0];
    }
    (film, counts)
}

/// Both halves led by the guides of both.
fn led_by_all(film: &Film) -> Noisy {
    let (film, counts) = with_all_guides(film);
    Noisy::of_samples(&film, |pixel| counts[pixel], None)
}

/// All samples in one half: denoised at once, as if there were no other.
fn undivided(film: &Film) -> Noisy {
    let (mut film, counts) = with_all_guides(film);
    for pixel in 0..film.pixel_count() {
        let all = film.sums(pixel);
        film.pixels[pixel] = [all, HalfSums::default()];
    }
    Noisy::of_samples(&film, |pixel| counts[pixel], None)
}

/// Sums over renders.
#[derive(Default)]
struct Told {
    true_squared: f64,
    estimated_squared: f64,
    inside: u32,
    count: u32,
}

impl Told {
    fn add(&mut self, true_squared: f64, estimate: Option<Distance>) {
        self.true_squared += true_squared;
        self.count += 1;
        let Some(estimate) = estimate else { return };
        self.estimated_squared += estimate.value.powi(2);
        self.inside += u32::from((estimate.low..=estimate.high).contains(&true_squared.max(0.0).sqrt()));
    }

    /// The true error in percent; told over true; percent inside the band.
    fn columns(&self) -> String {
        format!(
            "{:.3} | {:.2} | {:.0}",
            100.0 * (self.true_squared / f64::from(self.count)).sqrt(),
            (self.estimated_squared / self.true_squared).sqrt(),
            100.0 * f64::from(self.inside) / f64::from(self.count)
        )
    }
}

fn truth(
    session: &mut Session,
    denoiser: &mut Denoiser,
    scenes: &[(&str, Document)],
    extent: &Extent,
    (most, read): (u32, Reader),
) -> Result<(), Failure> {
    println!(
        "## Estimated and true errors, {0} x {0}, {1} renders",
        extent.side, extent.renders
    );
    println!(
        "| scene | samples | samples' error, % | at once, % | denoised, % | estimated/true | inside, % | auto, % | estimated/true | inside, % | auto/samples | relMSE |"
    );
    for (name, document) in scenes {
        let mut document = document.clone();
        (document.render.width, document.render.height) = (extent.side, extent.side);
        document.render.samples = extent.reference_samples;
        document.render.seed = u32::MAX;
        let begun = Instant::now();
        let reference_film = finish(session, &document)?;
        let reference = Halves::of(&reference_film);
        eprintln!("reference in {:.1} s", begun.elapsed().as_secs_f64());
        for samples in extent.samples.iter().filter(|samples| **samples <= most) {
            document.render.samples = *samples;
            let (mut noisy, mut whole, mut high, mut auto) = (0.0, 0.0, Told::default(), Told::default());
            let mut relative = 0.0;
            for seed in 0..extent.renders {
                document.render.seed = seed;
                let film = finish(session, &document)?;
                let halves = read(&film);
                noisy += squared_error(&halves.image, &reference);
                let at_once = denoiser.denoise(&undivided(&film), Denoise::High)?;
                whole += squared_error(&at_once.image, &reference);
                for (how, sums) in [(Denoise::High, &mut high), (Denoise::Auto, &mut auto)] {
                    let done = denoiser.denoise(&halves, how)?;
                    sums.add(squared_error(&done.image, &reference), done.error);
                    if how == Denoise::High {
                        relative += relative_error(&done.image, &reference_film);
                    }
                }
            }
            let percent = |sum: f64| 100.0 * (sum / f64::from(extent.renders)).sqrt();
            println!(
                "| {name} | {samples} | {:.3} | {:.3} | {} | {} | {:.3} | {:.5} |",
                percent(noisy),
                percent(whole),
                high.columns(),
                auto.columns(),
                (auto.true_squared / noisy).sqrt(),
                relative / f64::from(extent.renders)
            );
        }
    }
    Ok(())
}

/// Time of samples with guides over that without, in pairs that take turns: the median and the quartiles.
fn guides_cost(session: &mut Session, scenes: &[(&str, Document)], is_quick: bool) -> Result<(), Failure> {
    let (side, pairs) = if is_quick { (128, 6) } else { (256, 24) };
    println!("## Guides, {side} x {side}, {pairs} pairs of renders of 16 samples");
    println!("| scene | time with over time without | quartiles |");
    for (name, document) in scenes {
        let mut document = document.clone();
        (document.render.width, document.render.height, document.render.samples) = (side, side, 16);
        let mut seconds = |denoise: Denoise, seed: u32| -> Result<f64, Failure> {
            (document.view.denoise, document.render.seed) = (denoise, seed);
            session.reset();
            session.submit(&document)?;
            let begun = Instant::now();
            while !session.step(Duration::from_secs(10))?.is_done {}
            Ok(begun.elapsed().as_secs_f64())
        };
        let mut ratios = Vec::new();
        for pair in 0..pairs {
            let order = if pair % 2 == 0 {
                [Denoise::High, Denoise::Off]
            } else {
                [Denoise::Off, Denoise::High]
            };
            let [first, second] = [seconds(order[0], pair)?, seconds(order[1], pair)?];
            ratios.push(if pair % 2 == 0 { first / second } else { second / first });
        }
        ratios.sort_by(f64::total_cmp);
        let at = |share: f64| ratios[(share * ratios.len() as f64) as usize];
        println!("| {name} | {:.3} | {:.3} to {:.3} |", at(0.5), at(0.25), at(0.75));
    }
    Ok(())
}

/// Samples that a worker makes between the first and the sixth second, denoising over not denoising.
fn denoising_cost(scenes: &[(&str, Document)]) -> Result<(), Failure> {
    println!("## Denoising while rendering, 512 x 512: samples from the first second to the sixth, of those without");
    println!("| scene | fast | high | auto |");
    for (name, document) in scenes {
        let mut document = document.clone();
        (document.render.width, document.render.height) = (512, 512);
        document.render.samples = 1_000_000;
        let mut samples = |denoise: Denoise| -> Result<f64, Failure> {
            document.view.denoise = denoise;
            let worker = Worker::spawn(EngineChoice::Cpu, || {})?;
            worker.submit(&document, Pace::Still);
            let mut first = None;
            loop {
                std::thread::sleep(Duration::from_millis(5));
                let progress = worker.snapshot().progress;
                let first = *match progress.render_seconds {
                    seconds if seconds < 1.0 => continue,
                    seconds => first.get_or_insert((seconds, progress.mean_samples, Instant::now())),
                };
                if first.2.elapsed().as_secs_f64() >= 5.0 {
                    return Ok((progress.mean_samples - first.1) / first.2.elapsed().as_secs_f64());
                }
            }
        };
        // Twice without, before and after: the machine may do something else.
        let before = samples(Denoise::Off)?;
        let with = [Denoise::Fast, Denoise::High, Denoise::Auto].map(&mut samples);
        let without = (before + samples(Denoise::Off)?) / 2.0;
        let [fast, high, auto] = with.map(|with| with.map_or(f64::NAN, |with| with / without));
        println!("| {name} | {fast:.2} | {high:.2} | {auto:.2} |");
    }
    Ok(())
}

/// Seconds of what an edit waits for, each by itself.
fn steps(session: &mut Session, scenes: &[(&str, Document)], side: u32) -> Result<(), Failure> {
    println!(
        "## Steps to a denoised picture of one sample and of two halves, {side} x {side}, s; the library made ready first"
    );
    println!("| scene | sample | film read | new filter, fast | fast | high | film of two halves read | fast | high |");
    let seconds = |work: &mut dyn FnMut() -> Result<(), Failure>| -> Result<String, Failure> {
        let begun = Instant::now();
        work()?;
        Ok(format!("{:.3}", begun.elapsed().as_secs_f64()))
    };
    for (name, document) in scenes {
        let mut document = document.clone();
        (document.render.width, document.render.height) = (side, side);
        let mut columns = vec![(*name).to_owned()];
        for samples in [1, 2] {
            document.render.samples = samples;
            let film = if samples == 1 {
                let mut film = None;
                columns.push(seconds(&mut || {
                    film = Some(finish(session, &document)?);
                    Ok(())
                })?);
                film.expect("rendered above")
            } else {
                finish(session, &document)?
            };
            let mut noisy = None;
            columns.push(seconds(&mut || {
                noisy = Some(Noisy::of(&film, None));
                Ok(())
            })?);
            let noisy = noisy.expect("read above");
            let mut denoiser = Denoiser::open()?;
            for how in [Denoise::Fast, Denoise::Fast, Denoise::High]
                .into_iter()
                .skip(samples as usize - 1)
            {
                columns.push(seconds(&mut || {
                    denoiser.denoise(&noisy, how)?;
                    Ok(())
                })?);
            }
        }
        println!("| {} |", columns.join(" | "));
    }
    Ok(())
}

/// The picture that is good enough.
const CLEAN: f64 = 0.003;
/// Seconds after which an edit is given up.
const PATIENCE: Duration = Duration::from_secs(30);

/// Relative mean squared error against a reference, whose noise is taken out by its halves.
fn relative_error(image: &Image, reference: &Film) -> f64 {
    let of_pixel = |pixel: usize| -> f64 {
        let [even, odd] = reference.pixels[pixel].map(|half| half.color.map(|sum| sum / half.samples));
        let of_channel = |c: usize| {
            let x = f64::from(image.pixels[pixel][c]);
            let mean = 0.5 * (even[c] + odd[c]);
            (x - even[c]) * (x - odd[c]) / (mean * mean + RELATIVE_FLOOR)
        };
        (0..3).map(of_channel).sum()
    };
    (0..image.pixels.len()).map(of_pixel).sum::<f64>() / (3 * image.pixels.len()) as f64
}

/// Seconds from an edit of the material to the first full picture below [`CLEAN`], in the worker behind the window.
fn edits(session: &mut Session, scenes: &[(&str, Document)], is_quick: bool) -> Result<(), Failure> {
    let (side, reference_samples) = if is_quick { (128, 64) } else { (512, 256) };
    println!("## From an edit to a relative mean squared error of {CLEAN}, {side} x {side}, s (samples per pixel)");
    println!("| scene | without | fast | high | first picture denoised (high): s, error |");
    for (name, document) in scenes {
        let mut document = document.clone();
        (document.render.width, document.render.height) = (side, side);
        (document.render.samples, document.render.seed) = (reference_samples, u32::MAX);
        document.view.denoise = Denoise::Off;
        let reference = finish(session, &document)?;
        (document.render.samples, document.render.seed) = (100_000, 1);
        let mut first = None;
        let mut clean = |denoise: Denoise| -> Result<String, Failure> {
            document.view.denoise = denoise;
            let worker = Worker::spawn(EngineChoice::Cpu, || {})?;
            // Another look before, which has been shown when the edit comes.
            let mut before = document.clone();
            before.materials[0].roughness *= 0.8;
            before.materials[0].base_color = [0.5; 3];
            before.render.samples = 4;
            let revision = worker.submit(&before, Pace::Still);
            await_picture(&worker, revision, |picture| picture.samples_per_pixel >= 4)?;
            let begun = Instant::now();
            let revision = worker.submit(&document, Pace::Still);
            let mut seen = None;
            let good = await_picture(&worker, revision, |picture| {
                let error = relative_error(&picture.image, &reference);
                seen.get_or_insert((begun.elapsed().as_secs_f64(), error));
                error < CLEAN
            });
            if denoise == Denoise::High {
                first = seen;
            }
            Ok(match good {
                Ok((at, picture)) => {
                    let seconds = at.duration_since(begun).as_secs_f64();
                    format!("{seconds:.2} ({})", picture.samples_per_pixel)
                }
                Err(_) => "not reached".to_owned(),
            })
        };
        let [off, fast, high] = [clean(Denoise::Off)?, clean(Denoise::Fast)?, clean(Denoise::High)?];
        let (seconds, error) = first.unwrap_or((f64::NAN, f64::NAN));
        println!("| {name} | {off} | {fast} | {high} | {seconds:.2}, {error:.4} |");
    }
    Ok(())
}

/// The first picture at full resolution that is good enough, and when it was there.
fn await_picture(
    worker: &Worker,
    revision: u64,
    mut is_good: impl FnMut(&Picture) -> bool,
) -> Result<(Instant, Arc<Picture>), Failure> {
    let (begun, mut last) = (Instant::now(), 0);
    while begun.elapsed() < PATIENCE {
        let shown = worker.snapshot().picture.clone();
        let at = Instant::now();
        let news =
            shown.filter(|picture| (picture.revision, picture.reduction) == (revision, 1) && picture.serial != last);
        if let Some(picture) = news {
            last = picture.serial;
            if is_good(&picture) {
                return Ok((at, picture));
            }
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    Err("no picture is good enough".into())
}
