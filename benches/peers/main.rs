//! Glossmith's processor engine beside Mitsuba 3 on the same scene, in turns of one run; quoted in docs/PERFORMANCE.md.
//!
//! `cargo bench --bench peers [-- --quick --rates]`. Millions of samples a second, and (not with `--rates`) seconds to a
//! relative mean squared error of 0.003. Our renders, with even samples and with adaptive ones, go on until they are there;
//! Mitsuba's time is told from the error of what was timed, as that of independent samples falls with their number (Sobol's
//! falls faster). Errors are told from how far pictures with other seeds are from each other, so no reference is as long as it
//! would have to be for glass; a longer render of ours tells what they are relative to. With `--quick` pictures are small, and
//! what it takes to begin one counts for much. Mitsuba is run by `scripts/peers`, with the Python that `scripts/setup test`
//! installs; where it is not there, a line says so and only Glossmith is measured.

mod scene;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use glossmith::analysis::error::{RELATIVE_FLOOR, relative_mean_squared_error};
use glossmith::document::{Document, MaterialSettings};
use glossmith::job::film::Image;
use glossmith::optics::fresnel::Fresnel;
use glossmith::optics::lobe::Lobe;
use glossmith::render::{EngineChoice, Session};
use glossmith::scene::camera::PixelFilter;
use glossmith::scene::environment::EnvironmentSource;
use glossmith::scene::{ModelSource, teapot};
use serde_json::{Value, json};

/// Segments of a patch of the teapot, and how many triangles these make.
const MESHES: [(u32, &str); 3] = [(9, "6k"), (28, "60k"), (90, "600k")];
/// What the error is to come down to.
const GOAL: f64 = 0.003;
/// Indices of refraction of gold.
const GOLD: [[f32; 3]; 2] = [[0.143, 0.375, 1.442], [3.983, 2.386, 1.603]];
const EYE: [f64; 3] = [3.744_755_1, 4.459_777_26, 7.494_526_51];
const TARGET: [f64; 3] = [0.25, 1.45, 0.0];
const FOV_DEG: f64 = 45.0;
/// About as large as the ground that Glossmith adds.
const GROUND_HALF_SIDE: f64 = 64.0;
/// Segments of a path, the camera's ray among them.
const DEPTH: u32 = 8;

/// Linear RGB of its pixels.
type Picture = Vec<[f32; 3]>;
/// Seconds of a render, and its picture.
type Render = (f64, Picture);

/// How much is measured.
struct Extent {
    /// Side of the picture, pixels.
    size: u32,
    /// Samples of the renders that are timed, and whose error is told.
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
/// Samples that adaptive renders begin with; seconds after which the error is first looked at, and by how much these grow
/// from look to look.
const ADAPTIVE_SAMPLES_MIN: u32 = 16;
const LOOK_S: f64 = 0.1;
const LOOK_GROWTH: f64 = 1.2;
/// Seconds after which the rest is told from the error there, as it falls with the number of samples.
const SECONDS_MAX: f64 = 20.0;
/// The share of the goal below which one render's error is when all of them have surely come down to it.
const SURE: f64 = 0.7;

/// A line of the table.
struct Case {
    material: &'static str,
    mesh: &'static str,
    ground: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    let is_asked = |option: &str| std::env::args().any(|argument| argument == option);
    let mut extent = if is_asked("--quick") { QUICK } else { FULL };
    if is_asked("--rates") {
        extent.reference = None;
    }
    let folder = tempfile::tempdir()?;
    scene::write_sky(&folder.path().join("sky.exr"))?;
    for (segments, name) in MESHES {
        scene::write_ply(&folder.path().join(format!("{name}.ply")), &teapot::mesh(segments))?;
    }
    scene::write_ply(&folder.path().join("ground.ply"), &scene::ground(GROUND_HALF_SIDE))?;
    let peer = mitsuba(folder.path(), &json!({ "what": "variant" }));
    match &peer {
        Ok(answer) => println!("Mitsuba {}, {}", answer["version"], answer["variant"]),
        Err(reason) => println!("Mitsuba is not measured: {reason}"),
    }
    println!(
        "| material | triangles | M samples/s | Mitsuba's | ratio | s to relMSE {GOAL} | Mitsuba's | ratio | adaptive | ratio |"
    );
    println!("|{}", " --- |".repeat(10));
    let materials = ["metal 0.09", "metal 0.25", "diffuse", "plastic", "glass"];
    let case = |material, mesh, ground| Case { material, mesh, ground };
    let of_materials = materials.into_iter().map(|material| case(material, "60k", false));
    let of_meshes = ["6k", "600k"].into_iter().map(|mesh| case(materials[0], mesh, false));
    let on_ground = [materials[0], "diffuse"]
        .into_iter()
        .map(|material| case(material, "60k", true));
    for case in of_materials.chain(of_meshes).chain(on_ground) {
        compare(folder.path(), &case, &extent, peer.is_ok())?;
    }
    Ok(())
}

fn compare(folder: &Path, case: &Case, extent: &Extent, with_peer: bool) -> Result<(), Box<dyn Error>> {
    let mut our_seconds = f64::INFINITY;
    let mut theirs = Measured::default();
    for turn in 0..extent.turns {
        our_seconds = our_seconds.min(glossmith(folder, case, extent.size, extent.samples, turn + 1)?.0);
        if with_peer {
            theirs.add(peer(folder, case, extent.size, extent.samples, turn + 1)?);
        }
    }
    let pixels = f64::from(extent.size * extent.size * extent.samples);
    let rate = |seconds: f64| pixels / seconds / 1e6;
    let ground = if case.ground { ", ground" } else { "" };
    let of_peer = |number: f64| {
        if with_peer {
            format!("{number:.2}")
        } else {
            "–".to_owned()
        }
    };
    let beside = |ours: f64, theirs: f64| format!(" {ours:.2} | {} | {} |", of_peer(theirs), of_peer(ours / theirs));
    let mut line = format!("| {} | {}{ground} |", case.material, case.mesh);
    line += &beside(rate(our_seconds), rate(theirs.seconds));
    if let Some(samples) = extent.reference {
        let reference = glossmith(folder, case, extent.size, samples, 1000)?.1;
        let their_time = theirs.time_to_goal(&reference);
        line += &beside(time_to_goal(folder, case, extent, &reference, false)?, their_time);
        let adaptive = time_to_goal(folder, case, extent, &reference, true)?;
        line += &format!(" {adaptive:.2} | {} |", of_peer(adaptive / their_time));
    } else {
        line += &" – |".repeat(5);
    }
    println!("{line}");
    Ok(())
}

/// Renders of Mitsuba: the quickest one's seconds, and all pictures.
struct Measured {
    seconds: f64,
    pictures: Vec<Picture>,
}

impl Default for Measured {
    fn default() -> Self {
        Self {
            seconds: f64::INFINITY,
            pictures: Vec::new(),
        }
    }
}

impl Measured {
    fn add(&mut self, (seconds, picture): Render) {
        self.seconds = self.seconds.min(seconds);
        self.pictures.push(picture);
    }

    /// Seconds to the goal, as the squared error of independent samples falls with their number.
    fn time_to_goal(&self, reference: &Picture) -> f64 {
        let pictures: Vec<&Picture> = self.pictures.iter().collect();
        self.seconds * relative_error(&pictures, reference) / GOAL
    }
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

/// Seconds that our renders take until their error has come down to the goal: the mean of as many as there are turns. Each
/// goes on by itself and is only looked at; what it is worth is told afterwards, as that would take the caches from it.
fn time_to_goal(
    folder: &Path,
    case: &Case,
    extent: &Extent,
    reference: &Picture,
    is_adaptive: bool,
) -> Result<f64, Box<dyn Error>> {
    let mut renders: Vec<Vec<Render>> = Vec::new();
    for turn in 0..extent.turns {
        let mut document = document(folder, case, extent.size);
        let render = &mut document.render;
        (render.samples, render.min_samples) = (u32::MAX, ADAPTIVE_SAMPLES_MIN);
        (render.adaptive, render.seed) = (Some(is_adaptive), turn + 1);
        let mut session = Session::open(EngineChoice::Cpu)?;
        session.submit(&document)?;
        let looks = renders.first().map(Vec::len);
        renders.push(looked_at(&mut session, looks, reference)?);
    }
    let looks = (0..renders[0].len()).map(|look| {
        let seconds = renders.iter().map(|render| render[look].0).sum::<f64>();
        let pictures: Vec<&Picture> = renders.iter().map(|render| &render[look].1).collect();
        (seconds / renders.len() as f64, relative_error(&pictures, reference))
    });
    let mut before = (0.0, f64::NAN);
    for (seconds, error) in looks {
        if error <= GOAL {
            // Straight between the logarithms of both; back to where the error would be were there no look before.
            let (then, error_then) = before;
            let slope = if error_then > error {
                (seconds / then).ln() / (error_then / error).ln()
            } else {
                1.0
            };
            return Ok(seconds * (error / GOAL).powf(slope));
        }
        before = (seconds, error);
    }
    Ok(before.0 * before.1 / GOAL)
}

/// A render's pictures after more and more seconds of its own: so many, or until it is surely better than the goal.
fn looked_at(session: &mut Session, looks: Option<usize>, reference: &Picture) -> Result<Vec<Render>, Box<dyn Error>> {
    let (mut renders, mut seconds, mut until) = (Vec::new(), 0.0, LOOK_S);
    while until < SECONDS_MAX && looks.is_none_or(|looks| renders.len() < looks) {
        let begun = Instant::now();
        session.step(Duration::from_secs_f64((until - seconds).max(0.0)))?;
        seconds += begun.elapsed().as_secs_f64();
        let picture = picture(session)?;
        // The reference has an error of its own: so this is rather too much.
        let error = || relative_mean_squared_error(picture.as_flattened(), reference.as_flattened());
        let is_sure = looks.is_none() && error() < SURE * GOAL;
        renders.push((seconds, picture));
        if is_sure {
            break;
        }
        until *= LOOK_GROWTH;
    }
    Ok(renders)
}

fn picture(session: &mut Session) -> Result<Picture, Box<dyn Error>> {
    let Image { pixels, .. } = session.image()?;
    Ok(pixels.into_iter().map(|[r, g, b, _]| [r, g, b]).collect())
}

fn document(folder: &Path, case: &Case, size: u32) -> Document {
    let mut document = Document {
        model: ModelSource::File(folder.join(format!("{}.ply", case.mesh))),
        ground: case.ground,
        ..Document::default()
    };
    let metal = MaterialSettings {
        lobe: Lobe::Ggx,
        fresnel: Fresnel::Conductor,
        roughness: 0.3,
        eta: GOLD[0],
        k: GOLD[1],
        ..MaterialSettings::default()
    };
    let dielectric = MaterialSettings {
        metalness: 0.0,
        fresnel: Fresnel::Dielectric,
        ..metal.clone()
    };
    document.materials = vec![match case.material {
        "metal 0.25" => MaterialSettings {
            roughness: 0.5,
            ..metal
        },
        "diffuse" => MaterialSettings::diffuse("diffuse", [0.8; 3]),
        "plastic" => MaterialSettings {
            roughness: 0.1_f32.sqrt(),
            base_color: [0.6, 0.1, 0.1],
            ..dielectric
        },
        "glass" => MaterialSettings {
            transmission_weight: 1.0,
            base_color: [1.0; 3],
            ..dielectric
        },
        _ => metal,
    }];
    document.lighting.environment = EnvironmentSource::File(folder.join("sky.exr"));
    document.camera.position = Some(EYE);
    document.camera.target = Some(TARGET);
    document.camera.fov_deg = FOV_DEG;
    let render = &mut document.render;
    (render.width, render.height) = (size, size);
    render.bounces = DEPTH - 2;
    render.filter = PixelFilter::Box;
    render.adaptive = Some(false);
    document
}

/// Seconds of a render, and its picture.
fn glossmith(folder: &Path, case: &Case, size: u32, samples: u32, seed: u32) -> Result<Render, Box<dyn Error>> {
    let mut document = document(folder, case, size);
    document.render.samples = samples;
    document.render.seed = seed;
    let mut session = Session::open(EngineChoice::Cpu)?;
    session.submit(&document)?;
    let begun = Instant::now();
    session.step(Duration::from_secs(3600))?;
    let seconds = begun.elapsed().as_secs_f64();
    Ok((seconds, picture(&mut session)?))
}

/// The same by Mitsuba.
fn peer(folder: &Path, case: &Case, size: u32, samples: u32, seed: u32) -> Result<Render, Box<dyn Error>> {
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
