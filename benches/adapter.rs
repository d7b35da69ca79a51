//! What the host does beside a fast adapter: a model of one of 10⁹ samples per second, with the program's own scheduler, sums
//! and error estimate; quoted in docs/PERFORMANCE.md.
//!
//! `cargo bench --bench adapter`. The model's dispatch takes 10 µs and its samples' time, a read-back 0.2 ms. The host's parts
//! run and are timed on this machine; the model's time is added to theirs.

mod bumpy;

use std::{hint::black_box, time::Duration, time::Instant};

use bumpy::bumpy_sphere;
use bytemuck::Zeroable;
use glossmith::{
    analysis::adaptive::{Round, next_goals},
    analysis::noise::noise,
    document::{AreaLight, Document, ViewSettings},
    gpu::{
        FLUSH_SAMPLES,
        budget::{Budget, DISPATCH, DISPATCH_SOFTWARE},
        layout::{PixelColors, PixelStatistics, Tile},
        merge_sums,
    },
    job::film::Film,
    job::tiles::{Order, Schedule, SliceLimits, TileGrid},
    render::{EngineChoice, Session, display::display},
    scene::{Model, ModelSource, Slot},
};

/// The model's rate in samples per second, and its times in seconds.
const RATE: f64 = 1e9;
const DISPATCH_S: f64 = 10e-6;
const READ_S: f64 = 0.2e-3;
/// Reads of a band: colours and statistics.
const READS: f64 = 2.0;
/// Pixels per read.
const READ_PIXELS: usize = 1 << 19;
/// Images that are measured: a window's viewport, a small image, 4K.
const SIZES: [[u32; 2]; 3] = [[512, 512], [806, 780], [3840, 2160]];
/// Time of the window between two publications of its image, in seconds.
const PUBLISH_S: f64 = 0.1;
/// Share of the time that the session allows error estimates, which come ever more rarely.
const LOOK_SHARE: f64 = 0.03;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("## A long render\n");
    println!("| image | dispatch at most, ms | M samples per dispatch | host, µs per dispatch | kernels' share |");
    println!("| --- | --- | --- | --- | --- |");
    for [width, height] in SIZES {
        for longest in [DISPATCH, DISPATCH_SOFTWARE] {
            let Render {
                dispatches,
                host_s,
                samples,
                busy,
            } = render(width, height, longest);
            println!(
                "| {width} × {height} | {} | {:.2} | {:.0} | {:.1} % |",
                longest.as_millis(),
                samples / dispatches / 1e6,
                1e6 * host_s / dispatches,
                100.0 * busy
            );
        }
    }
    println!("\n## What else the host does\n");
    println!(
        "| image | merge sums, ms | read-back, ms | error, ms | goals, ms | display, ms | published every 100 ms |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    SIZES.into_iter().for_each(other_work);
    println!(
        "\nLight moved over 600 000 triangles: {:.1} ms until the job is compiled",
        light_moved()?
    );
    Ok(())
}

/// A render of 1024 samples per pixel.
struct Render {
    dispatches: f64,
    host_s: f64,
    samples: f64,
    /// Share of the time in which kernels run.
    busy: f64,
}

fn render(width: u32, height: u32, longest: Duration) -> Render {
    let mut schedule = Schedule::new(width, height, 0);
    let grid = schedule.grid();
    let goals = vec![FLUSH_SAMPLES; grid.tiles()];
    let mut budget = Budget::new(longest);
    let mut outcome = Render {
        dispatches: 0.0,
        host_s: 0.0,
        samples: 0.0,
        busy: 0.0,
    };
    loop {
        let begun = Instant::now();
        schedule.set_goals(&goals);
        let affordable = budget.affordable(Duration::from_secs(1));
        let limits = SliceLimits {
            pass_samples: [
                Budget::least_pass_samples(affordable, schedule.samples_per_pixel()),
                FLUSH_SAMPLES,
            ],
            tiles: [1, 65_535],
            order: Order::Spread,
        };
        let works = schedule.slice(affordable, limits);
        if works.is_empty() {
            break;
        }
        let tile = |work: &glossmith::job::tiles::Work| Tile {
            origin: grid.origin(work.tile),
            first_sample: work.first_sample,
            sample_count: work.count,
        };
        black_box(works.iter().map(tile).collect::<Vec<Tile>>());
        let samples = grid.pixel_samples(&works);
        let kernel_s = samples as f64 / RATE;
        budget.note(samples, Duration::from_secs_f64(DISPATCH_S + kernel_s));
        schedule.finish(&works);
        outcome.host_s += begun.elapsed().as_secs_f64();
        outcome.dispatches += 1.0;
        outcome.samples += samples as f64;
    }
    let kernels_s = outcome.samples / RATE;
    let sums_s = merged(width, height).1 + reads(width, height);
    outcome.busy = kernels_s / (kernels_s + outcome.host_s + outcome.dispatches * DISPATCH_S + sums_s);
    outcome
}

/// Seconds of the read-backs of a whole image.
fn reads(width: u32, height: u32) -> f64 {
    let pixels = width as usize * height as usize;
    READS * pixels.div_ceil(READ_PIXELS) as f64 * READ_S
}

/// A film with samples, and the seconds that merging them took: the least of several times.
fn merged(width: u32, height: u32) -> (Film, f64) {
    let pixels = width as usize * height as usize;
    let colors: Vec<PixelColors> = (0..pixels)
        .map(|pixel| PixelColors {
            all: [8.0 + (pixel % 7) as f32, 8.0, 8.0, 16.0],
            odd: [4.0, 4.0, 4.0 + (pixel % 5) as f32 * 0.1, 8.0],
        })
        .collect();
    let statistics = PixelStatistics {
        luminance_squared: [8.0, 4.0],
        kept_dropped: [16.0, 0.0],
        ..PixelStatistics::zeroed()
    };
    let statistics = vec![statistics; pixels];
    let mut film = Film::new(width, height);
    let seconds = least(|| merge_sums(&mut film, 0, &colors, &statistics));
    (film, seconds)
}

/// The least of several times, in seconds.
fn least<A>(mut work: impl FnMut() -> A) -> f64 {
    let timed = |_| {
        let begun = Instant::now();
        black_box(work());
        begun.elapsed().as_secs_f64()
    };
    (0..7).map(timed).fold(f64::INFINITY, f64::min)
}

fn other_work([width, height]: [u32; 2]) {
    let (film, merge_s) = merged(width, height);
    let noise_s = least(|| noise(&film));
    let samples = vec![112; TileGrid { width, height }.tiles()];
    let round = Round {
        growth: [1.1, 1.25],
        noise: None,
        samples_max: u32::MAX,
        region: None,
    };
    let goals_s = least(|| next_goals(&film, &samples, round));
    let image = film.image();
    let display_s = least(|| (film.image(), display(&image, &ViewSettings::default())));
    let reads_s = reads(width, height);
    let published_s = merge_s + reads_s + display_s;
    // Publishing takes at most a twelfth of the time; where an image costs more, it comes more rarely.
    let left = (1.0 - published_s / PUBLISH_S.max(12.0 * published_s)) * (1.0 - LOOK_SHARE);
    let milliseconds = [merge_s, reads_s, noise_s, goals_s, display_s].map(|seconds| format!("{:.2}", 1e3 * seconds));
    println!(
        "| {width} × {height} | {} | {:.1} % left |",
        milliseconds.join(" | "),
        100.0 * left
    );
}

/// Milliseconds until the job of a document is there whose light has moved.
fn light_moved() -> Result<f64, Box<dyn std::error::Error>> {
    let mut session = Session::open(EngineChoice::Cpu)?;
    let mut document = Document {
        model: ModelSource::File("bumpy sphere of 600 000 triangles".into()),
        ..Document::default()
    };
    let model = Model {
        mesh: bumpy_sphere(600_000),
        slots: vec![Slot::neutral("sphere")],
        ..Model::default()
    };
    session.assets().keep_model(document.model.clone(), model);
    document.lighting.area_lights = vec![AreaLight::default()];
    (document.render.width, document.render.height) = (8, 8);
    session.submit(&document)?;
    session.step(Duration::from_millis(1))?;
    let mut seconds = f64::INFINITY;
    for degrees in 1..8 {
        document.lighting.area_lights[0].yaw_deg = f64::from(degrees);
        let begun = Instant::now();
        session.submit(&document)?;
        seconds = seconds.min(begun.elapsed().as_secs_f64());
    }
    Ok(1e3 * seconds)
}
