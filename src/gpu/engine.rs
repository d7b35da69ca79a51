//! Renders jobs on the GPU in slices that fit a budget.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::device::{GpuDevice, GpuError};
use super::layout::Globals;
use super::pipeline::Pipelines;
use super::resources::Resources;
use crate::analysis::film::Film;
use crate::document::job::Job;

/// Longest dispatch: other users of the adapter, the window among them, wait for its end.
const SLICE: Duration = Duration::from_millis(30);
/// Samples a pixel that the GPU's f32 sums take before the host adds them to its f64 film.
const FLUSH_SAMPLES: u32 = 1024;
/// Rows and columns of a workgroup.
const WORKGROUP: u32 = 8;

/// Renders on a GPU.
#[derive(Debug)]
pub struct GpuEngine {
    gpu: GpuDevice,
    pipelines: Pipelines,
    resources: Option<Resources>,
    film: Film,
    /// Completed samples a pixel, and the first row that has not had the samples of the pass in progress.
    samples: u32,
    next_row: u32,
    /// Samples of the pass in progress.
    pass_samples: u32,
    /// Samples in the GPU's sums.
    unflushed: u32,
    /// Pixel samples a second, to cut work to a budget; 0 before the first slice.
    samples_per_second: f64,
}

impl GpuEngine {
    /// An engine on an open device.
    ///
    /// # Errors
    /// [`GpuError::Shader`] where the driver refuses the path tracer.
    pub fn new(gpu: GpuDevice) -> Result<Self, GpuError> {
        let pipelines = Pipelines::new(&gpu)?;
        Ok(Self {
            gpu,
            pipelines,
            resources: None,
            film: Film::default(),
            samples: 0,
            next_row: 0,
            pass_samples: 0,
            unflushed: 0,
            samples_per_second: 0.0,
        })
    }

    /// The device.
    pub fn device(&self) -> &GpuDevice {
        &self.gpu
    }

    /// Starts a job over.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] where the adapter can't hold a part of it.
    pub fn submit(&mut self, job: Arc<Job>) -> Result<(), GpuError> {
        let [width, height] = job.settings.image_size;
        let old = self.resources.take();
        if old.as_ref().is_some_and(|old| old.job().plan != job.plan) {
            self.samples_per_second = 0.0;
        }
        self.resources = Some(Resources::new(&self.gpu, &self.pipelines.bindings, job, old)?);
        self.film = Film::new(width, height);
        (self.samples, self.next_row, self.pass_samples, self.unflushed) = (0, 0, 0, 0);
        Ok(())
    }

    /// Renders for about `budget`, at most up to `samples` a pixel.
    ///
    /// # Errors
    /// If the device fails.
    pub fn step(&mut self, budget: Duration, samples: u32) -> Result<(), GpuError> {
        let start = Instant::now();
        while self.resources.is_some() && self.samples < samples {
            let left = budget.saturating_sub(start.elapsed());
            self.slice(left.min(SLICE), samples)?;
            if start.elapsed() >= budget {
                break;
            }
        }
        Ok(())
    }

    /// One dispatch of about `duration`: some rows of a pass, or a pass of several samples where the GPU is fast.
    fn slice(&mut self, duration: Duration, samples: u32) -> Result<(), GpuError> {
        let Some(resources) = &self.resources else {
            return Ok(());
        };
        let job = resources.job();
        let [width, height] = job.settings.image_size;
        let affordable = self.samples_per_second * duration.as_secs_f64();
        if self.next_row == 0 {
            let picture = f64::from(width) * f64::from(height);
            let most = (samples - self.samples).min(FLUSH_SAMPLES - self.unflushed);
            self.pass_samples = ((affordable / picture) as u32).clamp(1, most);
        }
        let rows = (affordable / f64::from(width * self.pass_samples)) as u32;
        let rows = rows
            .next_multiple_of(WORKGROUP)
            .max(WORKGROUP)
            .min(height - self.next_row);
        let cells = [job.environment.cells_width, job.environment.cells_height];
        let globals = Globals {
            tile_origin: [0, self.next_row],
            tile_size: [width, rows],
            first_sample: self.samples,
            sample_count: self.pass_samples,
            ..Globals::new(&job.settings, job.geometry.bvh.nodes.len(), cells)
        };
        self.gpu
            .queue
            .write_buffer(&resources.globals, 0, bytemuck::bytes_of(&globals));
        let pipeline = self.pipelines.get(&self.gpu, job.plan)?;
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &resources.bind_group, &[]);
            pass.dispatch_workgroups(width.div_ceil(WORKGROUP), rows.div_ceil(WORKGROUP), 1);
        }
        let begun = Instant::now();
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.wait()?;
        let seconds = begun.elapsed().as_secs_f64().max(1e-6);
        self.samples_per_second = f64::from(width * rows * self.pass_samples) / seconds;
        self.next_row += rows;
        if self.next_row >= height {
            self.next_row = 0;
            self.samples += self.pass_samples;
            self.unflushed += self.pass_samples;
            if self.unflushed >= FLUSH_SAMPLES {
                self.flush()?;
            }
        }
        Ok(())
    }

    /// Adds the GPU's sums to the film and sets them to zero.
    fn flush(&mut self) -> Result<(), GpuError> {
        let Some(resources) = &self.resources else {
            return Ok(());
        };
        let pixels = self.film.color.len();
        let colors: Vec<[f32; 4]> = self.gpu.read(&resources.sums[0], pixels)?;
        let clamps = resources.job().plan.firefly_clamp;
        let count = if clamps { 2 * pixels } else { pixels };
        let statistics: Vec<[f32; 4]> = self.gpu.read(&resources.sums[1], count)?;
        let (statistics, taken) = statistics.split_at(pixels);
        for (sum, color) in self.film.color.iter_mut().zip(colors) {
            for (sum, x) in sum.iter_mut().zip(color) {
                *sum += f64::from(x);
            }
        }
        for (sum, [luminance_squared, kept, dropped, rays]) in self.film.statistics.iter_mut().zip(statistics) {
            sum[0] += f64::from(*luminance_squared);
            sum[1] += f64::from(*kept);
            self.film.dropped += *dropped as u64;
            self.film.rays += *rays as u64;
        }
        self.film.clamped += taken.iter().map(|[taken, ..]| f64::from(*taken)).sum::<f64>();
        resources.clear_sums(&self.gpu);
        self.unflushed = 0;
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

    /// Completed samples a pixel.
    pub fn samples_per_pixel(&self) -> u32 {
        self.samples
    }
}
