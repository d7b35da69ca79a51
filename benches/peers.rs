//! Glossmith's processor engine beside Mitsuba 3 on the same scene, in turns of one run; quoted in docs/PERFORMANCE.md.
//!
//! `cargo bench --bench peers [-- --quick --rates --turns N --only WORDS]`: all lines of the table, or those that hold
//! these words, as `diffuse, 60k, ground`. Millions of samples a second, of the quickest render of each renderer, and (not
//! with `--rates`) seconds to a relative mean squared error of 0.003, from the mean time and the error of its renders. All
//! of them take turns, as a machine's pace changes. Our renders, with even samples and with adaptive ones, end about there;
//! Mitsuba's time is told from what was timed. From where a render ends to the goal its error is taken to fall as that of
//! independent samples does with their number (Sobol's falls faster). Errors are told from how far pictures with other
//! seeds are from each other, so no reference is as long as it would have to be for glass; a longer render of ours tells
//! what they are relative to. With `--quick` pictures are small, and what it takes to begin one counts for much. Mitsuba is
//! run by `scripts/peers`, with the Python that `scripts/setup test` installs; where it is not there, a line says so and
//! only Glossmith is measured.

use std::{error::Error, path::Path, path::PathBuf, process::Command, time::Duration, time::Instant};

use glossmith::{
    analysis::error::{RELATIVE_FLOOR, relative_mean_squared_error},
    document::Document,
    job::film::Image,
    render::{EngineChoice, Session},
    study::benchmark::GOAL,
    study::benchmark::scene::{DEPTH, EYE, FOV_DEG, GOLD, Scene, TARGET},
};
use serde_json::{Value, json};

/// Linear RGB of its pixels.
type Picture = Vec<[f32; 3]>;
/// Seconds of a render, and its picture.
type Render = (f64, Picture);

/// How much is measured.
struct Extent {
    /// Side of the picture, pixels.
    size: u32,
    /// Samples of the renders whose rates are told; Mitsuba's tell its error, too.
    samples: u32,
    /// Samples of the render that errors are relative to, if any are measured.
    reference: Option<u32>,
    /// Renders of each renderer, at least two for errors.
    turns: u32,
}

const FULL: Extent = Extent {
    size: 512,
    samples: 64,
    reference: Some(512),
    turns: 3,
};
const QUICK: Extent = Extent {
    size: 256,
    samples: 16,
    reference: Some(256),
    turns: 2,
};
/// Samples that adaptive renders begin with.
const ADAPTIVE_SAMPLES_MIN: u32 = 16;
/// About as many seconds our renders to the goal take at most: what is left then is told from the error there.
const SECONDS_MAX: f64 = 12.0;
/// Seeds of what errors are relative to, and of the renders that look for the effort: none is that of a render that counts.
const REFERENCE_SEED: u32 = 1000;
const SCOUT_SEED: u32 = 999;
/// Renders that look for the effort that the goal takes, at most, and how near to it is near enough.
const SCOUTS: u32 = 5;
const NEAR: f64 = 0.1;

fn main() -> Result<(), Box<dyn Error>> {
    let is_asked = |option: &str| std::env::args().any(|argument| argument == option);
    let given = |option: &str| std::env::args().skip_while(|argument| argument != option).nth(1);
    let mut extent = if is_asked("--quick") { QUICK } else { FULL };
    if is_asked("--rates") {
        extent.reference = None;
    }
    if let Some(turns) = given("--turns") {
        extent.turns = turns.parse()?;
    }
    let only = given("--only").unwrap_or_default();
    let folder = tempfile::tempdir()?;
    Scene::write_files(folder.path())?;
    let peer = mitsuba(folder.path(), &json!({ "what": "variant" }));
    match &peer {
        Ok(answer) => println!("Mitsuba {}, {}", answer["version"], answer["variant"]),
        Err(reason) => println!("Mitsuba is not measured: {reason}"),
    }
    println!(
        "| material | triangles | M samples/s | Mitsuba's | ratio | s to relMSE {GOAL} | Mitsuba's | ratio | adaptive | ratio |"
    );
    println!("|{}", " --- |".repeat(10));
    for case in Scene::all().filter(|case| case.name().contains(&only)) {
        compare(folder.path(), &case, &extent, peer.is_ok())?;
    }
    Ok(())
}

fn compare(folder: &Path, case: &Scene, extent: &Extent, with_peer: bool) -> Result<(), Box<dyn Error>> {
    let (size, samples) = (extent.size, extent.samples);
    let reference = match extent.reference {
        Some(samples) => Some(glossmith(folder, case, size, samples, REFERENCE_SEED)?.1),
        None => None,
    };
    let mut to_goal = Vec::new();
    for is_adaptive in [false, true] {
        if let Some(reference) = &reference {
            to_goal.push(ToGoal::new(folder, case, size, is_adaptive, reference)?);
        }
    }
    let (mut our_seconds, mut theirs) = (f64::INFINITY, Vec::new());
    for seed in 1..=extent.turns {
        our_seconds = our_seconds.min(glossmith(folder, case, size, samples, seed)?.0);
        if with_peer {
            theirs.push(peer(folder, case, size, samples, seed)?);
        }
        for ours in &mut to_goal {
            let render = ours.render(seed)?;
            ours.renders.push(render);
        }
    }
    let their_seconds = theirs.iter().map(|render| render.0).fold(f64::INFINITY, f64::min);
    let rate = |seconds: f64| f64::from(size * size * samples) / seconds / 1e6;
    let of_peer = |number: f64| {
        if with_peer {
            format!("{number:.2}")
        } else {
            "–".to_owned()
        }
    };
    let beside = |ours: f64, theirs: f64| format!(" {ours:.2} | {} | {} |", of_peer(theirs), of_peer(ours / theirs));
    let mut line = format!(
        "| {} |{}",
        case.name().replacen(", ", " | ", 1),
        beside(rate(our_seconds), rate(their_seconds))
    );
    if let ([even, adaptive], Some(reference)) = (&to_goal[..], &reference) {
        let their_time = seconds_to_goal(&theirs, reference);
        line += &beside(seconds_to_goal(&even.renders, reference), their_time);
        let seconds = seconds_to_goal(&adaptive.renders, reference);
        line += &format!(" {seconds:.2} | {} |", of_peer(seconds / their_time));
    } else {
        line += &" – |".repeat(5);
    }
    println!("{line}");
    Ok(())
}

/// Seconds to the goal of renders that end before or after it, as the error of independent samples falls with their number.
fn seconds_to_goal(renders: &[Render], reference: &Picture) -> f64 {
    let pictures: Vec<&Picture> = renders.iter().map(|render| &render.1).collect();
    let seconds = renders.iter().map(|render| render.0).sum::<f64>() / renders.len() as f64;
    seconds * relative_error(&pictures, reference) / GOAL
}

/// The mean squared error of a picture over (reference² + 0.01), from how far pictures that differ in nothing but their seed
/// are from each other. NaN where there are fewer than two.
fn relative_error(pictures: &[&Picture], reference: &Picture) -> f64 {
    let count = pictures.len() as f64;
    let of = |pixel: usize, channel: usize| {
        let values = || pictures.iter().map(|picture| f64::from(picture[pixel][channel]));
        let mean = values().sum::<f64>() / count;
        let variance = values().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
        variance / (f64::from(reference[pixel][channel]).powi(2) + RELATIVE_FLOOR)
    };
    let channels = (0..reference.len()).flat_map(|pixel| (0..3).map(move |channel| (pixel, channel)));
    channels.map(|(pixel, channel)| of(pixel, channel)).sum::<f64>() / (3 * reference.len()) as f64
}

/// Our renders to the goal: with as many samples everywhere as it takes, or adaptive ones to the noise that it takes.
struct ToGoal<'a> {
    folder: &'a Path,
    case: &'a Scene,
    size: u32,
    is_adaptive: bool,
    /// Samples per pixel, or one over the square of the noise: the error is about inverse to it.
    effort: f64,
    renders: Vec<Render>,
}

impl<'a> ToGoal<'a> {
    /// Finds what effort it takes, by renders that count for nothing else.
    fn new(
        folder: &'a Path,
        case: &'a Scene,
        size: u32,
        is_adaptive: bool,
        reference: &Picture,
    ) -> Result<Self, Box<dyn Error>> {
        let mut this = Self {
            folder,
            case,
            size,
            is_adaptive,
            effort: if is_adaptive { 1.0 / GOAL } else { 16.0 },
            renders: Vec::new(),
        };
        for _ in 0..SCOUTS {
            let (seconds, picture) = this.render(SCOUT_SEED)?;
            // The reference has an error of its own: so this is rather too much.
            let error = relative_mean_squared_error(picture.as_flattened(), reference.as_flattened());
            let growth = (error / GOAL).min(SECONDS_MAX / seconds);
            this.effort *= growth;
            if (growth - 1.0).abs() < NEAR {
                break;
            }
        }
        Ok(this)
    }

    fn render(&self, seed: u32) -> Result<Render, Box<dyn Error>> {
        if !self.is_adaptive {
            let samples = self.effort.round().max(1.0) as u32;
            return glossmith(self.folder, self.case, self.size, samples, seed);
        }
        let mut document = self.case.document(self.folder, self.size);
        let render = &mut document.render;
        (render.seed, render.adaptive, render.samples) = (seed, Some(true), u32::MAX);
        render.min_samples = ADAPTIVE_SAMPLES_MIN;
        (render.noise, render.time_s) = (Some(self.effort.recip().sqrt()), Some(SECONDS_MAX));
        timed(&document)
    }
}

/// A render with so many samples per pixel.
fn glossmith(folder: &Path, case: &Scene, size: u32, samples: u32, seed: u32) -> Result<Render, Box<dyn Error>> {
    let mut document = case.document(folder, size);
    document.render.samples = samples;
    document.render.seed = seed;
    timed(&document)
}

/// A render of a document.
fn timed(document: &Document) -> Result<Render, Box<dyn Error>> {
    let mut session = Session::open(EngineChoice::Cpu)?;
    session.submit(document)?;
    let begun = Instant::now();
    session.step(Duration::from_secs(3600))?;
    let seconds = begun.elapsed().as_secs_f64();
    let Image { pixels, .. } = session.image()?;
    Ok((seconds, pixels.into_iter().map(|[r, g, b, _]| [r, g, b]).collect()))
}

/// The same by Mitsuba.
fn peer(folder: &Path, case: &Scene, size: u32, samples: u32, seed: u32) -> Result<Render, Box<dyn Error>> {
    let picture = folder.join("mitsuba.exr");
    let question = json!({
        "what": "render", "material": case.material, "mesh": case.mesh, "size": size, "samples": samples, "seed": seed,
        "picture": picture, "eta": GOLD[0], "k": GOLD[1], "eye": EYE, "target": TARGET, "fov_deg": FOV_DEG,
        "depth": DEPTH, "ground": case.ground,
    });
    let answer = mitsuba(folder, &question)?;
    let seconds = answer["seconds"].as_f64().ok_or("no seconds")?;
    let image = exr::prelude::read_first_rgba_layer_from_file(
        &picture,
        |size, _| (vec![[0.0; 3]; size.area()], size.width()),
        |(pixels, width): &mut (Picture, usize), place, (r, g, b, _): (f32, f32, f32, f32)| {
            pixels[place.y() * *width + place.x()] = [r, g, b];
        },
    )?;
    Ok((seconds, image.layer_data.channel_data.pixels.0))
}

/// What `scripts/peers` answers.
fn mitsuba(folder: &Path, question: &Value) -> Result<Value, Box<dyn Error>> {
    let home = std::env::home_dir().unwrap_or_default();
    let data = std::env::var_os("XDG_DATA_HOME").map_or(home.join(".local/share"), PathBuf::from);
    let tools = std::env::var_os("GLOSSMITH_TOOLS").map_or(data.join("glossmith/format-tools"), PathBuf::from);
    let python = tools.join("bin/python");
    if !python.exists() {
        return Err(format!("{} is not there: scripts/setup test installs it", python.display()).into());
    }
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/scripts/peers");
    let run = Command::new(python)
        .arg(script)
        .arg(folder)
        .arg(question.to_string())
        .output()?;
    if !run.status.success() {
        let told = String::from_utf8_lossy(&run.stderr);
        return Err(told
            .lines()
            .last()
            .unwrap_or("it failed without a word")
            .to_owned()
            .into());
    }
    Ok(serde_json::from_slice(&run.stdout)?)
}
