//! Renders jobs on the GPU in slices that fit a budget.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::compute;
use super::device::{GpuDevice, GpuError};
use super::layout::{PixelColors, PixelStatistics, Tile};
use super::pipeline::Pipelines;
use super::resources::{DISPATCH_TILES, Resources};
use super::timer::Timer;
use crate::job::Job;
use crate::job::features::GuideSums;
use crate::job::film::{Film, HalfSums, luminance};
use crate::job::plan::Specialisation;
use crate::job::tiles::{Schedule, SliceLimits, Work};

/// Longest dispatch: other users of the adapter, the window among them, wait for its end.
const SLICE: Duration = Duration::from_millis(30);
/// Samples a pixel that the GPU's f32 sums take before the host adds them to its f64 film.
const FLUSH_SAMPLES: u32 = 1024;
/// Pixels that the host reads at once: what it needs for that is bounded.
const READ_PIXELS: usize = 1 << 19;

/// Renders on a GPU.
#[derive(Debug)]
pub struct GpuEngine {
    gpu: GpuDevice,
    pipelines: Pipelines,
    resources: Option<Resources>,
    film: Film,
    schedule: Schedule,
    /// Most samples of a pixel in the GPU's sums.
    unflushed: u32,
    /// Whether there is anything in them.
    is_flushed: bool,
    /// Pixel samples a second, to cut work to a budget; 0 before the first slice.
    samples_per_second: f64,
    timer: Option<Timer>,
    /// Groups that tiles are interleaved in: one for each thread of software Vulkan, which takes a run of workgroups and would
    /// else render cheap background while another renders the model. 1 on a GPU, whose units take one workgroup at a time.
    groups: usize,
    /// What the dispatches of the job took by the timer.
    gpu_seconds: f64,
}

impl GpuEngine {
    /// An engine on an open device.
    ///
    /// # Errors
    /// [`GpuError::Shader`] where the driver refuses the path tracer.
    pub fn new(gpu: GpuDevice) -> Result<Self, GpuError> {
        let pipelines = Pipelines::new(&gpu)?;
        Ok(Self {
            timer: Timer::new(&gpu),
            groups: if gpu.is_software() {
                std::thread::available_parallelism().map_or(1, usize::from)
            } else {
                1
            },
            gpu,
            pipelines,
            resources: None,
            film: Film::default(),
            schedule: Schedule::default(),
            unflushed: 0,
            is_flushed: true,
            samples_per_second: 0.0,
            gpu_seconds: 0.0,
        })
    }

    /// The device.
    pub fn device(&self) -> &GpuDevice {
        &self.gpu
    }

    /// Begins a job. After an error the old one goes on.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`], [`GpuError::Unfit`] and [`GpuError::Refused`] where the adapter can't hold a part of it.
    pub fn submit(&mut self, job: Arc<Job>) -> Result<(), GpuError> {
        let [width, height] = job.settings.image_size;
        let first_sample = job.settings.first_sample;
        let old = self.resources.as_ref();
        let resources = Resources::new(&self.gpu, &self.pipelines.bindings, job.clone(), old)?;
        if old.is_some_and(|old| old.job().plan.specialisation() != job.plan.specialisation()) {
            self.samples_per_second = 0.0;
        }
        resources.clear_sums(&self.gpu);
        self.resources = Some(resources);
        // The old film goes first: two would take twice the memory.
        self.film = Film::default();
        self.film = Film::of(&job);
        self.schedule = Schedule::starting_at(width, height, first_sample);
        (self.unflushed, self.is_flushed, self.gpu_seconds) = (0, true, 0.0);
        Ok(())
    }

    /// Whether the kernel is ready that is made for this.
    pub fn has_kernel(&self, specialisation: &Specialisation) -> bool {
        self.pipelines.has(specialisation)
    }

    /// Compiles the kernel of a job's plan: some drivers do that at the first dispatch, so one is made that renders
    /// nothing. Takes seconds.
    ///
    /// # Errors
    /// [`GpuError::Shader`] where the driver refuses the kernel; [`GpuError::TooLarge`].
    pub fn prepare(&mut self, job: Arc<Job>) -> Result<(), GpuError> {
        self.submit(job)?;
        self.dispatch(&[Tile::default()])
    }

    /// Lets scene and film go and keeps the kernels.
    pub fn rest(&mut self) {
        (self.resources, self.film, self.schedule) = (None, Film::default(), Schedule::default());
    }

    /// Goes on with what another engine rendered of the same job.
    pub fn take_over(&mut self, film: Film, schedule: Schedule) {
        (self.film, self.schedule) = (film, schedule);
    }

    /// Renders for about `budget`, at most up to `samples` a pixel.
    ///
    /// # Errors
    /// If the device fails.
    pub fn step(&mut self, budget: Duration, samples: u32) -> Result<(), GpuError> {
        let goals = vec![samples; self.schedule.grid().tiles()];
        self.step_towards(budget, &goals)
    }

    /// The same up to a number of samples a pixel for each tile.
    ///
    /// # Errors
    /// If the device fails.
    pub fn step_towards(&mut self, budget: Duration, goals: &[u32]) -> Result<(), GpuError> {
        self.schedule.aim(goals);
        let start = Instant::now();
        while self.resources.is_some() {
            let left = budget.saturating_sub(start.elapsed());
            let affordable = self.samples_per_second * left.min(SLICE).as_secs_f64();
            let limits = SliceLimits {
                pass_samples_max: FLUSH_SAMPLES - self.unflushed,
                // At least a row's: fewer leave a GPU idle.
                tiles: [self.schedule.grid().columns(), DISPATCH_TILES],
            };
            let works = self.schedule.slice(affordable, limits);
            if works.is_empty() {
                break;
            }
            self.render(&works)?;
            if start.elapsed() >= budget {
                break;
            }
        }
        Ok(())
    }

    /// Renders a slice in one dispatch.
    fn render(&mut self, works: &[Work]) -> Result<(), GpuError> {
        let grid = self.schedule.grid();
        let tile = |work: &Work| Tile {
            origin: grid.origin(work.tile),
            first_sample: work.first_sample,
            sample_count: work.count,
        };
        let tiles: Vec<Tile> = interleaved(works, self.groups).map(tile).collect();
        let begun = Instant::now();
        self.dispatch(&tiles)?;
        let seconds = begun.elapsed().as_secs_f64().max(1e-6);
        self.samples_per_second = grid.pixel_samples(works) as f64 / seconds;
        if self.schedule.finish(works) {
            self.unflushed += self.schedule.pass_samples();
            if self.unflushed >= FLUSH_SAMPLES {
                self.flush()?;
            }
        }
        Ok(())
    }

    /// Renders tiles and waits for them.
    fn dispatch(&mut self, tiles: &[Tile]) -> Result<(), GpuError> {
        let Some(resources) = &self.resources else {
            return Ok(());
        };
        let pipeline = self.pipelines.get(&self.gpu, &resources.job().plan)?;
        self.is_flushed = false;
        dispatch(&self.gpu, resources, pipeline, tiles, self.timer.as_ref())?;
        if let Some(timer) = &self.timer {
            self.gpu_seconds += timer.seconds()?;
        }
        Ok(())
    }

    /// Adds the GPU's sums to the film and sets them to zero.
    fn flush(&mut self) -> Result<(), GpuError> {
        let Some(resources) = self.resources.as_ref().filter(|_| !self.is_flushed) else {
            return Ok(());
        };
        let pixels = self.film.pixel_count();
        for first in (0..pixels).step_by(READ_PIXELS) {
            let part = first..(first + READ_PIXELS).min(pixels);
            let colors: Vec<PixelColors> = self.gpu.read_part(&resources.sums[0], part.clone())?;
            let statistics: Vec<PixelStatistics> = self.gpu.read_part(&resources.sums[1], part.clone())?;
            for (pixel, (colors, statistics)) in part.clone().zip(colors.iter().zip(&statistics)) {
                take_over(&mut self.film, pixel, colors, statistics);
            }
            if self.film.extras().guides {
                let guides: Vec<GuideSums> = self.gpu.read_part(&resources.sums[2], part.clone())?;
                for (sums, seen) in self.film.guides[part].iter_mut().zip(&guides) {
                    sums.add(seen);
                }
            }
        }
        resources.clear_sums(&self.gpu);
        (self.unflushed, self.is_flushed) = (0, true);
        Ok(())
    }

    /// What has been accumulated.
    ///
    /// # Errors
    /// If the device fails.
    pub fn film(&mut self) -> Result<&Film, GpuError> {
        self.flush()?;
        Ok(&self.film)
    }

    /// What has been rendered of each tile.
    pub fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    /// Completed samples a pixel.
    pub fn samples_per_pixel(&self) -> u32 {
        self.schedule.samples_per_pixel()
    }

    /// How long the GPU rendered the job by its own clock; `None` where it has none.
    pub fn gpu_seconds(&self) -> Option<f64> {
        self.timer.as_ref().map(|_| self.gpu_seconds)
    }
}

/// Adds what the GPU summed of a pixel to the film.
fn take_over(film: &mut Film, pixel: usize, colors: &PixelColors, statistics: &PixelStatistics) {
    let [red, green, blue, coverage] = colors.all.map(f64::from);
    let odd = half(
        colors.odd.map(f64::from),
        statistics.odd_luminance_squared.into(),
        colors.odd_kept.into(),
    );
    let even = half(
        [red - odd.color[0], green - odd.color[1], blue - odd.color[2]],
        f64::from(statistics.luminance_squared) - f64::from(statistics.odd_luminance_squared),
        f64::from(statistics.kept) - odd.samples,
    );
    let [kept_even, kept_odd] = film.halves(pixel);
    film.set_halves(pixel, &[kept_even.with(&even), kept_odd.with(&odd)]);
    film.add_coverage(pixel, coverage);
    let tile = film.grid().of_pixel(pixel);
    let costs = &mut film.costs[tile];
    costs.rays += f64::from(statistics.rays);
    costs.dropped += statistics.dropped as u64;
    costs.clamped += f64::from(statistics.clamped);
}

/// A half's sums from those of its squares. Rounding may take the deviations below 0; further on it averages out.
fn half(color: [f64; 3], luminance_squared: f64, samples: f64) -> HalfSums {
    let y = luminance(color);
    HalfSums {
        color,
        squared_deviations: luminance_squared - y * y / samples.max(1.0),
        samples,
    }
}

/// The items of `groups` interleaved groups, one group after the other: 0, n, 2n, …, then 1, n + 1, …
fn interleaved<T>(items: &[T], groups: usize) -> impl Iterator<Item = &T> {
    (0..groups).flat_map(move |group| items.iter().skip(group).step_by(groups))
}

/// Runs a pass over tiles, and waits for its end.
fn dispatch(
    gpu: &GpuDevice,
    resources: &Resources,
    pipeline: &wgpu::ComputePipeline,
    tiles: &[Tile],
    timer: Option<&Timer>,
) -> Result<(), GpuError> {
    gpu.queue.write_buffer(&resources.tiles, 0, bytemuck::cast_slice(tiles));
    let workgroups = [tiles.len() as u32, 1];
    compute::dispatch(gpu, pipeline, &[&resources.bind_group], workgroups, timer);
    gpu.wait()
}

#[cfg(test)]
mod tests {
    use super::interleaved;

    #[test]
    fn every_tile_is_in_a_group_and_neighbours_are_in_different_ones() {
        let of = |groups| interleaved(&[0, 1, 2, 3, 4, 5, 6], groups).copied().collect::<Vec<_>>();
        assert_eq!(of(1), [0, 1, 2, 3, 4, 5, 6]);
        assert_eq!(of(2), [0, 2, 4, 6, 1, 3, 5]);
        assert_eq!(of(9), [0, 1, 2, 3, 4, 5, 6]);
    }
}
