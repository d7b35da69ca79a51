//! The engine on the processor: the same path tracer as the GPU's, on all cores.

pub mod integrator;
pub mod precision;
pub mod probe;
pub mod recorder;
pub mod sampling;
pub mod scatter;

use std::sync::Arc;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::job::Job;
use crate::job::features::GUIDE_SAMPLES;
use crate::job::film::Film;
use crate::job::tiles::{Schedule, SliceLimits, TileGrid, Work};
use crate::optics::real::Real;
use integrator::{Integrator, is_sound};

/// Renders on the processor's cores, which take a tile each at a time.
#[derive(Default)]
pub struct CpuEngine {
    job: Option<Arc<Job>>,
    schedule: Schedule,
    /// The sums of each tile, so that no two cores write to the same memory; of no size before its first sample.
    tiles: Vec<Film>,
    /// All of them in one, made when asked for.
    film: Film,
    is_film_made: bool,
    /// Pixel samples a second, to cut work to a budget; 0 before the first slice.
    samples_per_second: f64,
}

/// Longest time between looks at the clock.
const SLICE: Duration = Duration::from_millis(30);
/// Tiles of a slice for each core, at least: one waits for the other no longer than for a tile.
const CORE_TILES: usize = 4;

impl CpuEngine {
    /// Starts a job over.
    pub fn submit(&mut self, job: Arc<Job>) {
        let [width, height] = job.settings.image_size;
        self.schedule = Schedule::new(width, height);
        self.tiles = vec![Film::default(); self.schedule.grid().tiles()];
        self.film = Film::new(width, height);
        self.is_film_made = true;
        self.job = Some(job);
    }

    /// Renders for about `budget`, at most up to `samples` a pixel; f32.
    pub fn step(&mut self, budget: Duration, samples: u32) {
        self.step_in::<f32>(budget, samples);
    }

    /// The same with shading in `T`; rays meet the geometry in f32 in either case.
    pub fn step_in<T: Real>(&mut self, budget: Duration, samples: u32) {
        let goals = vec![samples; self.tiles.len()];
        self.step_towards::<T>(budget, &goals);
    }

    /// The same up to a number of samples a pixel for each tile.
    pub fn step_towards<T: Real>(&mut self, budget: Duration, goals: &[u32]) {
        let Some(job) = self.job.clone() else { return };
        let integrator = Integrator::<T>::new(&job);
        self.schedule.aim(goals);
        let start = Instant::now();
        loop {
            let limits = SliceLimits {
                // The first picture is there as soon as can be.
                pass_samples_max: if self.samples_per_pixel() == 0 { 1 } else { u32::MAX },
                tiles: [CORE_TILES * rayon::current_num_threads(), usize::MAX],
            };
            let left = budget.saturating_sub(start.elapsed()).min(SLICE).as_secs_f64();
            let works = self.schedule.slice(self.samples_per_second * left, limits);
            if works.is_empty() {
                break;
            }
            let slice_start = Instant::now();
            self.render(&integrator, &works);
            let grid = self.schedule.grid();
            let seconds = slice_start.elapsed().as_secs_f64().max(1e-9);
            self.samples_per_second = grid.pixel_samples(&works) as f64 / seconds;
            self.schedule.finish(&works);
            if start.elapsed() >= budget {
                break;
            }
        }
    }

    /// Renders tiles, in the order of their numbers.
    fn render<T: Real>(&mut self, integrator: &Integrator<'_, T>, works: &[Work]) {
        let grid = self.schedule.grid();
        let mut works = works.iter().peekable();
        let with_sums = |(tile, sums)| works.next_if(|work| work.tile == tile).map(|work| (work, sums));
        let jobs: Vec<_> = self.tiles.iter_mut().enumerate().filter_map(with_sums).collect();
        jobs.into_par_iter()
            .for_each(|(work, sums)| render_tile(integrator, grid, work, sums));
        self.is_film_made = false;
    }

    /// What has been accumulated.
    pub fn film(&mut self) -> &Film {
        if !self.is_film_made {
            let grid = self.schedule.grid();
            (self.film.dropped, self.film.clamped) = (0, 0.0);
            for (tile, sums) in self.tiles.iter().enumerate() {
                self.film.place(grid.origin(tile), sums);
            }
            self.is_film_made = true;
        }
        &self.film
    }

    /// What has been rendered of each tile.
    pub fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    /// What has been rendered, for another engine to go on with.
    pub fn hand_over(mut self) -> (Film, Schedule) {
        self.film();
        (self.film, self.schedule)
    }

    /// Completed samples a pixel.
    pub fn samples_per_pixel(&self) -> u32 {
        self.schedule.samples_per_pixel()
    }
}

fn render_tile<T: Real>(integrator: &Integrator<'_, T>, grid: TileGrid, work: &Work, sums: &mut Film) {
    let origin = grid.origin(work.tile);
    if sums.color.is_empty() {
        let [width, height] = grid.size(work.tile);
        *sums = Film::new(width, height);
    }
    for pixel in 0..sums.color.len() {
        let place = [pixel as u32 % sums.width, pixel as u32 / sums.width];
        let place = [origin[0] + place[0], origin[1] + place[1]];
        for sample in work.first_sample..work.first_sample + work.count {
            let path = integrator.trace_path(place, sample);
            sums.rays[pixel] += f64::from(path.rays);
            if is_sound(path.radiance) {
                let [r, g, b] = path.radiance.to_f64();
                sums.add(pixel, sample, [r, g, b, path.alpha.to_f64()]);
                sums.clamped += path.clamped.to_f64();
                if sample < GUIDE_SAMPLES {
                    sums.guides[pixel].add(&path.seen);
                }
            } else {
                sums.dropped += 1;
            }
        }
    }
}
