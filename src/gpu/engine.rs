//! Renders jobs on the GPU in slices that fit a budget.

use std::{ops::Range, sync::Arc, time::Duration, time::Instant};

use super::{
    budget::{Budget, DISPATCH, DISPATCH_SOFTWARE},
    compute,
    compute::PATH_TRACE,
    device::{GpuDevice, GpuError},
    kernel_cache::KernelCache,
    layout::{PixelColors, PixelStatistics, Tile},
    pipeline::ScenePass,
    resources::Resources,
    scene_group::SceneForm,
    sums::{self, Band, DISPATCH_TILES},
    timer::Timer,
};
use crate::{
    job::{
        Job,
        film::{Film, HalfSums, LightSums, luminance},
        guides::GuideSums,
        plan::Specialisation,
        tiles::{Order, Schedule, SliceLimits, Work},
    },
    parallel,
};

/// Samples per pixel that the GPU's f32 sums take before the host adds them to its f64 film.
pub const FLUSH_SAMPLES: u32 = 1024;
/// Pixels per read by the host, to bound its memory.
const READ_PIXELS: usize = 1 << 19;

/// The path tracer, with a pipeline for the constants of each plan and the storage of each scene.
pub type PathTracer = ScenePass<(Specialisation, SceneForm)>;

/// Renders on a GPU.
#[derive(Debug)]
pub struct GpuEngine {
    gpu: GpuDevice,
    pass: PathTracer,
    resources: Option<Resources>,
    film: Film,
    schedule: Schedule,
    /// Per-tile samples already merged into `film`; the rest is still in the GPU's sums. `None` while a merge is pending.
    in_film: Option<Schedule>,
    /// Most samples of a pixel in the GPU's sums.
    unflushed: u32,
    /// Whether there is anything in them.
    is_flushed: bool,
    /// Size of the next dispatch.
    budget: Budget,
    timer: Option<Timer>,
    /// Time of the job's dispatches by the GPU's timer, in seconds.
    gpu_seconds: f64,
}

impl GpuEngine {
    /// An engine on an open device.
    pub fn new(gpu: GpuDevice) -> Result<Self, GpuError> {
        let mut pass = PathTracer::new(PATH_TRACE, sums::layout(&gpu), KernelCache::open(&gpu));
        pass.link(&gpu, gpu.traversal)?;
        let longest = if gpu.is_software() { DISPATCH_SOFTWARE } else { DISPATCH };
        Ok(Self {
            timer: Timer::new(&gpu),
            gpu,
            pass,
            resources: None,
            film: Film::default(),
            schedule: Schedule::default(),
            in_film: None,
            unflushed: 0,
            is_flushed: true,
            budget: Budget::new(longest),
            gpu_seconds: 0.0,
        })
    }

    /// The device that renders.
    pub fn device(&self) -> &GpuDevice {
        &self.gpu
    }

    /// Begins a job. After an error the old job continues.
    pub fn submit(&mut self, job: Arc<Job>) -> Result<(), GpuError> {
        let [width, height] = job.settings.image_size;
        let first_sample = job.settings.first_sample;
        let old = self.resources.as_ref();
        self.pass
            .link(&self.gpu, SceneForm::of(&self.gpu, &job).geometry.traversal())?;
        let resources = Resources::new(&self.gpu, &self.pass, job.clone(), old)?;
        self.budget = match old {
            Some(old) if old.job.plan.specialisation() == job.plan.specialisation() => self.budget.of_another_scene(),
            _ => self.budget.of_another_kernel(),
        };
        resources.sums.clear(&self.gpu);
        self.resources = Some(resources);
        // The old film goes first: two would take twice the memory.
        self.film = Film::default();
        self.film = Film::of(&job);
        self.schedule = Schedule::new(width, height, first_sample);
        self.in_film = Some(self.schedule.clone());
        (self.unflushed, self.is_flushed, self.gpu_seconds) = (0, true, 0.0);
        Ok(())
    }

    /// Whether the kernel is ready that a job needs.
    pub fn has_kernel(&self, job: &Job) -> bool {
        self.pass
            .has(&(job.plan.specialisation(), SceneForm::of(&self.gpu, job)))
    }

    /// Compiles the kernel of a job's plan, with an empty dispatch, because some drivers compile at the first one. Takes
    /// seconds.
    pub fn prepare(&mut self, job: Arc<Job>) -> Result<(), GpuError> {
        self.submit(job)?;
        self.dispatch(&[Tile::default()])
    }

    /// Lets scene and film go and keeps the kernels.
    pub fn rest(&mut self) {
        (self.resources, self.film, self.schedule) = (None, Film::default(), Schedule::default());
        self.in_film = None;
    }

    /// Continues from another engine's film of the same job.
    pub fn take_over(&mut self, film: Film, schedule: Schedule) {
        self.in_film = Some(schedule.clone());
        (self.film, self.schedule) = (film, schedule);
    }

    /// The film and schedule on the host, for another engine to continue. Samples still on the GPU are lost. `None` if a
    /// merge failed.
    pub fn hand_over(self) -> Option<(Film, Schedule)> {
        Some((self.film, self.in_film?))
    }

    /// Renders for about `budget`, at most up to `samples` a pixel.
    pub fn step(&mut self, budget: Duration, samples: u32) -> Result<(), GpuError> {
        let goals = vec![samples; self.schedule.grid().tiles()];
        self.step_towards(budget, &goals)
    }

    /// The same up to a number of samples per pixel of each tile.
    pub fn step_towards(&mut self, budget: Duration, goals: &[u32]) -> Result<(), GpuError> {
        self.schedule.set_goals(goals);
        let start = Instant::now();
        while self.resources.is_some() {
            let left = budget.saturating_sub(start.elapsed());
            let affordable = self.budget.affordable(left);
            let most = self.most_pass_samples();
            let least = Budget::least_pass_samples(affordable, self.schedule.samples_per_pixel());
            let limits = SliceLimits {
                pass_samples: [least.min(most), most],
                tiles: [1, DISPATCH_TILES],
                // Spread, so that of software Vulkan's threads, which take a run of workgroups each, none gets only
                // background.
                order: Order::Spread,
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

    /// Most samples per pixel of the next pass.
    fn most_pass_samples(&self) -> u32 {
        let until_flush = FLUSH_SAMPLES - self.unflushed;
        match &self.resources {
            Some(resources) if self.gpu.is_software() => {
                until_flush.min(Budget::most_pass_samples(resources.job.settings.bounces))
            }
            _ => until_flush,
        }
    }

    /// Renders a slice in one dispatch.
    fn render(&mut self, works: &[Work]) -> Result<(), GpuError> {
        let grid = self.schedule.grid();
        let tiles: Vec<Tile> = works
            .iter()
            .map(|work| Tile {
                origin: grid.origin(work.tile),
                first_sample: work.first_sample,
                sample_count: work.count,
            })
            .collect();
        let begun = Instant::now();
        self.dispatch(&tiles)?;
        self.budget.note(grid.pixel_samples(works), begun.elapsed());
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
        let (plan, form) = (&resources.job.plan, resources.form);
        let kernel = (plan.specialisation(), form);
        let pipeline = self.pass.get(&self.gpu, kernel, PATH_TRACE, form, plan.constants())?;
        self.is_flushed = false;
        for (number, band) in (0..).zip(resources.sums.bands()) {
            let mut of_band = tiles.to_vec();
            of_band.retain(|tile| resources.sums.band_of(tile) == number);
            if of_band.is_empty() {
                continue;
            }
            resources.sums.list(&self.gpu, &of_band);
            let groups = [&resources.scene_group, &band.group];
            compute::dispatch(&self.gpu, &pipeline, groups, of_band.len() as u32, self.timer.as_ref());
            self.gpu.wait()?;
            if let Some(timer) = &self.timer {
                self.gpu_seconds += timer.seconds()?;
            }
        }
        Ok(())
    }

    /// Adds the GPU's sums to the film and sets them to zero.
    fn flush(&mut self) -> Result<(), GpuError> {
        let Some(resources) = self.resources.as_ref().filter(|_| !self.is_flushed) else {
            return Ok(());
        };
        self.in_film = None;
        for band in resources.sums.bands() {
            for first in (0..band.pixels).step_by(READ_PIXELS) {
                merge_band(
                    &self.gpu,
                    &mut self.film,
                    band,
                    first..(first + READ_PIXELS).min(band.pixels),
                )?;
            }
        }
        resources.sums.clear(&self.gpu);
        (self.unflushed, self.is_flushed) = (0, true);
        self.in_film = Some(self.schedule.clone());
        Ok(())
    }

    /// The accumulated film.
    pub fn film(&mut self) -> Result<&Film, GpuError> {
        self.flush()?;
        Ok(&self.film)
    }

    /// The film of an engine that ends.
    pub fn into_film(mut self) -> Result<Film, GpuError> {
        self.flush()?;
        Ok(self.film)
    }

    /// The samples rendered per tile.
    pub fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    /// GPU time of the job by its own clock, in seconds; `None` without one.
    pub fn gpu_seconds(&self) -> Option<f64> {
        self.timer.as_ref().map(|_| self.gpu_seconds)
    }
}

/// Merges the GPU's sums of some pixels of a band into the film.
fn merge_band(gpu: &GpuDevice, film: &mut Film, band: &Band, part: Range<usize>) -> Result<(), GpuError> {
    let [all_colors, statistics, guides] = &band.buffers;
    let colors: Vec<PixelColors> = gpu.read(all_colors, part.clone())?;
    let statistics: Vec<PixelStatistics> = gpu.read(statistics, part.clone())?;
    let first = band.first_row as usize * film.width as usize + part.start;
    merge_sums(film, first, &colors, &statistics);
    for group in 0..film.light_groups() {
        let before = (1 + group) * band.pixels;
        let lights: Vec<PixelColors> = gpu.read(all_colors, before + part.start..before + part.end)?;
        for (pixel, light) in (first..).zip(&lights) {
            film.add_light(pixel, group, light_sums(light));
        }
    }
    if film.extras().guides > 0 {
        let guides: Vec<[GuideSums; 2]> = gpu.read(guides, part)?;
        for (pixel, halves) in (first..).zip(&guides) {
            (0..)
                .zip(halves)
                .for_each(|(half, seen)| film.add_guides(pixel, half, seen));
        }
    }
    Ok(())
}

/// A group's light in the even and the odd samples of a pixel.
fn light_sums(colors: &PixelColors) -> LightSums {
    let odd = std::array::from_fn(|channel| f64::from(colors.odd[channel]));
    [
        std::array::from_fn(|channel| f64::from(colors.all[channel]) - odd[channel]),
        odd,
    ]
}

/// Merges the GPU's sums of consecutive pixels into the film, from pixel `first` on.
pub fn merge_sums(film: &mut Film, first: usize, colors: &[PixelColors], statistics: &[PixelStatistics]) {
    parallel::for_rows(&mut film.pixels[first..][..colors.len()], 1, |place, kept| {
        let [even, odd] = halves(&colors[place], &statistics[place]);
        kept[0] = [kept[0][0].with(&even), kept[0][1].with(&odd)];
    });
    let grid = film.grid();
    for (pixel, (colors, statistics)) in (first..).zip(colors.iter().zip(statistics)) {
        film.add_coverage(pixel, f64::from(colors.all[3]));
        let [rays, clamped] = statistics.rays_clamped;
        let costs = &mut film.costs[grid.of_pixel(pixel)];
        costs.rays += f64::from(rays);
        costs.dropped += statistics.kept_dropped[1] as u64;
        costs.clamped += f64::from(clamped);
        costs.cut += f64::from(statistics.cut);
    }
}

/// The halves of a pixel's samples, from the GPU's sums over all and over the odd ones.
fn halves(colors: &PixelColors, statistics: &PixelStatistics) -> [HalfSums; 2] {
    let [even, odd] = light_sums(colors);
    let [squared, odd_squared] = statistics.luminance_squared.map(f64::from);
    let [kept, odd_kept] = [statistics.kept_dropped[0], colors.odd[3]].map(f64::from);
    [
        half(even, squared - odd_squared, kept - odd_kept),
        half(odd, odd_squared, odd_kept),
    ]
}

/// Converts a half's raw moments to central ones. Rounding may make the deviations negative; that cancels in the mean.
fn half(color: [f64; 3], luminance_squared: f64, samples: f64) -> HalfSums {
    let y = luminance(color);
    HalfSums {
        color,
        squared_deviations: luminance_squared - y * y / samples.max(1.0),
        samples,
    }
}
