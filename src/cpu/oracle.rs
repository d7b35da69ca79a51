//! Single paths and tiles by any instruction set, for records and tests. Nothing here is generic, so that the engine is
//! compiled once: a generic function would be compiled again in each crate that calls it.

use fearless_simd::Level;

use super::integrator::{Integrator, PATHS, PathResult, Tiles, Wave};
use super::recorder::Event;
use crate::{
    job::Job,
    optics::elementary::Single,
    optics::lanes::{InLanes, in_lanes},
    scene::PACKET,
};

/// A path tracer that follows one path at a time, in f32.
pub struct PathTracer<'a>(Integrator<'a, f32>);

impl<'a> PathTracer<'a> {
    /// A path tracer of a job.
    pub fn new(job: &'a Job) -> Self {
        Self(Integrator::new(job))
    }

    /// The result of one path.
    pub fn trace(&self, pixel: [u32; 2], sample: u32) -> PathResult {
        self.record(pixel, sample, &mut Vec::new())
    }

    /// The result of one path, a wave of its own, whose events are appended to a list.
    pub fn record(&self, pixel: [u32; 2], sample: u32, events: &mut Vec<Event>) -> PathResult {
        let mut wave = Wave::<Vec<Event>>::new(PACKET, 1, self.0.sequence());
        self.0.trace_wave(&Tiles::new(pixel, [1; 2]), [sample, 1], &mut wave);
        events.append(&mut wave.paths.outputs[0].recorder);
        self.0.result(&wave.paths, 0)
    }
}

/// Samples of the pixels of a tile.
#[derive(Clone, Copy, Debug)]
pub struct TileSamples {
    /// The tile's corner, in pixels.
    pub origin: [u32; 2],
    /// The tile's width and height, in pixels.
    pub size: [u32; 2],
    /// The first sample of each pixel and how many there are.
    pub samples: [u32; 2],
}

/// Results of a tile's paths as the engine renders it with an instruction set: pixels row by row, for each sample.
pub fn trace_tile(job: &Job, level: Level, tile: TileSamples) -> Vec<PathResult> {
    in_lanes(level, TraceTile { job, tile })
}

/// A call of [`trace_tile`].
struct TraceTile<'a> {
    job: &'a Job,
    tile: TileSamples,
}

impl InLanes for TraceTile<'_> {
    type Output = Vec<PathResult>;
    fn run<T: Single>(self) -> Self::Output {
        let TileSamples { origin, size, samples } = self.tile;
        let pixels = (size[0] * size[1]) as usize;
        let mut results_of = vec![PathResult::default(); pixels * samples[1] as usize];
        let tiles = Tiles::new(origin, size);
        let integrator = Integrator::<T>::new(self.job);
        let mut wave = Wave::new(PATHS, T::LANES, integrator.sequence());
        integrator.trace_tiles(&tiles, &mut wave, samples, |[first, count], results| {
            for sample in 0..count {
                let row = (first + sample - samples[0]) as usize * pixels;
                for block in tiles.blocks() {
                    let path = block.path([sample, count]);
                    for ([x, y], path) in block.places.iter().zip(path..) {
                        results_of[row + (y * size[0] + x) as usize] = results.get(path);
                    }
                }
            }
        });
        results_of
    }
}
