//! The CPU engine: the same path tracer as the GPU's, on all cores.

pub mod integrator;
pub mod oracle;
pub mod precision;
pub mod probe;
pub mod recorder;
mod tile_sums;

use std::{
    ops::Range,
    sync::{Arc, Mutex, atomic::AtomicUsize, atomic::Ordering},
    time::Duration,
    time::Instant,
};

pub use crate::instructions::instruction_set;
use crate::{
    instructions,
    job::{
        Job,
        film::Film,
        tiles::{Order, Schedule, SliceLimits, TileGrid, Work},
    },
    optics::elementary::Single,
    optics::lanes::{InLanes, in_lanes},
    panics::lock,
    parallel,
};
use integrator::{Integrator, PATHS, Tiles, WAVE_SAMPLES, Wave};
use tile_sums::TileSums;

/// The CPU engine. Its threads render one tile each at a time, or a run of neighbours with few samples.
#[derive(Default)]
pub struct CpuEngine {
    job: Option<Arc<Job>>,
    schedule: Schedule,
    film: Film,
    /// Pixel samples a second, to choose the samples of a pass; 0 before the first one.
    samples_per_second: f64,
}

/// Longest pass with more samples per pixel than a wave has.
const PASS: Duration = Duration::from_millis(30);
/// Runs of tiles per thread at least, so that no thread waits long for another's last.
const RUNS_PER_THREAD: usize = 8;
/// Tiles per slice: enough that threads seldom wait for each other, and few beside what a step renders.
const LISTED_TILES: usize = 4096;

impl CpuEngine {
    /// Starts a job over.
    pub fn submit(&mut self, job: Arc<Job>) {
        job.geometry.prepare();
        let [width, height] = job.settings.image_size;
        self.schedule = Schedule::new(width, height, job.settings.first_sample);
        // The old one goes first: two would take twice the memory.
        self.film = Film::default();
        self.film = Film::of(&job);
        self.job = Some(job);
    }

    /// Renders for about `budget`, at most up to `samples` a pixel; f32 in lanes.
    pub fn step(&mut self, budget: Duration, samples: u32) {
        let goals = vec![samples; self.schedule.grid().tiles()];
        self.step_towards(budget, &goals);
    }

    /// The same up to a number of samples per pixel of each tile.
    pub fn step_towards(&mut self, budget: Duration, goals: &[u32]) {
        /// The step, generic over the SIMD lanes.
        struct Step<'a>(&'a mut CpuEngine, Duration, &'a [u32]);
        impl InLanes for Step<'_> {
            type Output = ();
            fn run<T: Single>(self) {
                self.0.step_towards_in::<T>(self.1, self.2);
            }
        }
        in_lanes(instructions::level(), Step(self, budget, goals));
    }

    /// Renders up to a number of samples per pixel for each tile with shading in `T`.
    fn step_towards_in<T: Single>(&mut self, budget: Duration, goals: &[u32]) {
        let Some(job) = self.job.clone() else { return };
        let integrator = Integrator::<T>::new(&job);
        let mut waves: Vec<_> = (0..rayon::current_num_threads()).map(|_| None).collect();
        self.schedule.set_goals(goals);
        let start = Instant::now();
        loop {
            let left = budget.saturating_sub(start.elapsed());
            let limits = SliceLimits {
                pass_samples: [self.least_pass_samples(left), u32::MAX],
                tiles: [LISTED_TILES; 2],
                order: Order::Rows,
            };
            let pass_seconds = left.min(PASS).as_secs_f64();
            let works = self.schedule.slice(self.samples_per_second * pass_seconds, limits);
            if works.is_empty() {
                break;
            }
            let pass_start = Instant::now();
            let done = &works[..self.render(&integrator, &mut waves, &works, left)];
            let seconds = pass_start.elapsed().as_secs_f64().max(1e-9);
            self.samples_per_second = self.schedule.grid().pixel_samples(done) as f64 / seconds;
            self.schedule.finish(done);
            if start.elapsed() >= budget {
                break;
            }
        }
    }

    /// Smallest number of samples per pixel in a pass. More samples per wave are cheaper. But the first image must come
    /// soon, and at the end of a step no part of it may have more than twice the samples of the rest.
    fn least_pass_samples(&self, left: Duration) -> u32 {
        let samples = self.schedule.samples_per_pixel();
        if samples == 0 {
            return 1;
        }
        let TileGrid { width, height } = self.schedule.grid();
        let pixels = f64::from(width) * f64::from(height);
        let by_the_end = (self.samples_per_second * left.as_secs_f64() / pixels) as u32;
        samples.max(by_the_end).min(WAVE_SAMPLES)
    }

    /// Renders tiles until the time is up, at least one. Returns their number. Each thread has its own wave, made on first
    /// use, and takes the next run of tiles when it is done with one. Background tiles take a fifth of the time of others, so
    /// the number cannot be planned. Each run is copied out of the film and back, so that no two threads write to the same
    /// memory; that costs a thousandth of the time.
    fn render<T: Single>(
        &mut self,
        integrator: &Integrator<'_, T>,
        waves: &mut [Option<Wave>],
        works: &[Work],
        time: Duration,
    ) -> usize {
        let grid = self.schedule.grid();
        let runs = runs(grid, works, works.len() / (RUNS_PER_THREAD * waves.len()));
        let film = Mutex::new(&mut self.film);
        let film = || lock(&film);
        let (start, taken) = (Instant::now(), AtomicUsize::new(0));
        parallel::for_rows(waves, 1, |_, wave| {
            while let Some(run) = runs.get(taken.fetch_add(1, Ordering::Relaxed)) {
                let wave = wave[0].get_or_insert_with(|| Wave::new(PATHS, T::LANES, integrator.sequence()));
                let (first, last) = (&works[run.start], &works[run.end - 1]);
                let origin = grid.origin(first.tile);
                let [width, height] = grid.size(last.tile);
                let mut sums = film().part(origin, [grid.origin(last.tile)[0] - origin[0] + width, height]);
                render_tiles(integrator, wave, origin, first, &mut sums);
                film().place(origin, &sums);
                if start.elapsed() >= time {
                    break;
                }
            }
        });
        let last = taken.into_inner().min(runs.len()).checked_sub(1);
        last.map_or(0, |last| runs[last].end)
    }

    pub fn film(&self) -> &Film {
        &self.film
    }

    /// The samples rendered per tile.
    pub fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    /// Continues from another engine's film of the same job.
    pub fn take_over(&mut self, film: Film, schedule: Schedule) {
        (self.film, self.schedule) = (film, schedule);
    }

    /// The film and schedule, for another engine to continue.
    pub fn hand_over(self) -> (Film, Schedule) {
        (self.film, self.schedule)
    }
}

/// Works in runs of at most `most` neighbouring tiles with the same samples: together they fill a wave.
fn runs(grid: TileGrid, works: &[Work], most: usize) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for (index, work) in works.iter().enumerate() {
        let most = most.min((WAVE_SAMPLES / work.count.max(1)) as usize);
        let follows = |before: &Work| {
            let next = Work {
                tile: before.tile + 1,
                ..*before
            };
            next == *work && grid.origin(before.tile)[1] == grid.origin(work.tile)[1]
        };
        match runs.last_mut() {
            Some(run) if run.len() < most && follows(&works[index - 1]) => run.end += 1,
            _ => runs.push(index..index + 1),
        }
    }
    runs
}

/// Adds the samples of a run of tiles to their sums.
fn render_tiles<T: Single>(
    integrator: &Integrator<'_, T>,
    wave: &mut Wave,
    origin: [u32; 2],
    work: &Work,
    sums: &mut Film,
) {
    let tiles = Tiles::new(origin, [sums.width, sums.height]);
    let mut sums = TileSums::of(sums, &tiles);
    integrator.trace_tiles(&tiles, wave, [work.first_sample, work.count], |samples, results| {
        sums.add::<T>(samples, results);
    });
    sums.finish();
}
