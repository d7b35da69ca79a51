//! The engine on the processor: the same path tracer as the GPU's, on all cores.

pub mod integrator;
pub mod probe;
pub mod scatter;

use std::sync::Arc;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::analysis::film::Film;
use crate::document::job::Job;
use crate::optics::real::Real;
use integrator::{Integrator, is_sound};

/// Pixels of a work item: small enough to spread over the cores and to stop in time.
const CHUNK_PIXELS: usize = 256;

/// Renders on the processor's cores.
#[derive(Default)]
pub struct CpuEngine {
    job: Option<Arc<Job>>,
    film: Film,
    /// The first pixel that has not had its sample of the pass in progress.
    next_pixel: usize,
    /// Passes begun and completed.
    next_sample: u32,
    /// Pixels a second, to cut work to a budget.
    pixels_per_second: f64,
}

impl CpuEngine {
    /// Starts a job over.
    pub fn submit(&mut self, job: Arc<Job>) {
        let [width, height] = job.settings.image_size;
        self.film = Film::new(width, height);
        self.next_pixel = 0;
        self.next_sample = 0;
        self.job = Some(job);
    }

    /// Renders for about `budget`, at most up to `samples` a pixel; f32.
    pub fn step(&mut self, budget: Duration, samples: u32) {
        self.step_in::<f32>(budget, samples);
    }

    /// The same with shading in `T`; rays meet the geometry in f32 in either case.
    pub fn step_in<T: Real>(&mut self, budget: Duration, samples: u32) {
        let Some(job) = self.job.clone() else { return };
        let integrator = Integrator::<T>::new(&job);
        let start = Instant::now();
        let pixels = self.film.color.len();
        while self.next_sample < samples && pixels > 0 {
            let left = budget.saturating_sub(start.elapsed()).as_secs_f64();
            let count = (self.pixels_per_second * left) as usize;
            let count = count
                .max(CHUNK_PIXELS * rayon::current_num_threads())
                .min(pixels - self.next_pixel);
            let slice_start = Instant::now();
            self.render(&integrator, job.settings.image_size[0], self.next_pixel, count);
            self.pixels_per_second = count as f64 / slice_start.elapsed().as_secs_f64().max(1e-9);
            self.next_pixel += count;
            if self.next_pixel == pixels {
                self.next_pixel = 0;
                self.next_sample += 1;
            }
            if start.elapsed() >= budget {
                break;
            }
        }
    }

    /// One sample for each of `count` pixels from `first` on.
    fn render<T: Real>(&mut self, integrator: &Integrator<'_, T>, width: u32, first: usize, count: usize) {
        let sample = self.next_sample;
        let colors = self.film.color[first..first + count].par_chunks_mut(CHUNK_PIXELS);
        let statistics = self.film.statistics[first..first + count].par_chunks_mut(CHUNK_PIXELS);
        let chunks = colors.zip(statistics).enumerate().map(|(chunk, (colors, statistics))| {
            let (mut dropped, mut rays, mut clamped) = (0, 0, 0.0);
            for (i, (color, statistics)) in colors.iter_mut().zip(statistics).enumerate() {
                let index = (first + chunk * CHUNK_PIXELS + i) as u32;
                let path = integrator.trace_path([index % width, index / width], sample);
                rays += u64::from(path.rays);
                if is_sound(path.radiance) {
                    let [r, g, b] = path.radiance.to_f64();
                    let luminance = path.radiance.luminance().to_f64();
                    for (sum, x) in color.iter_mut().zip([r, g, b, path.alpha.to_f64()]) {
                        *sum += x;
                    }
                    statistics[0] += luminance * luminance;
                    statistics[1] += 1.0;
                    clamped += path.clamped.to_f64();
                } else {
                    dropped += 1;
                }
            }
            (dropped, rays, clamped)
        });
        let (dropped, rays, clamped) = chunks.reduce(|| (0, 0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1, a.2 + b.2));
        self.film.clamped += clamped;
        self.film.dropped += dropped;
        self.film.rays += rays;
    }

    /// What has been accumulated.
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// Completed samples a pixel.
    pub fn samples_per_pixel(&self) -> u32 {
        self.next_sample
    }
}
