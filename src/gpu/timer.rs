//! Timing of passes by the GPU's own clock, if it has one.

use super::device::{GpuDevice, GpuError};

/// Two timestamps, before and after a pass.
#[derive(Debug)]
pub struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    staging: wgpu::Buffer,
    ns_per_tick: f64,
}

/// Bytes of two timestamps.
const SIZE: u64 = 16;

impl Timer {
    /// A timer; `None` if the adapter has no timestamps.
    pub fn new(gpu: &GpuDevice) -> Option<Self> {
        let has_timestamps = gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        let buffer = |usage| gpu.buffer("timestamps", SIZE, usage);
        has_timestamps.then(|| Self {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("timestamps"),
                ty: wgpu::QueryType::Timestamp,
                count: 2,
            }),
            resolved: buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC),
            staging: buffer(wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ),
            ns_per_tick: f64::from(gpu.queue.get_timestamp_period()),
        })
    }

    /// Timestamp writes for the pass to measure.
    pub fn writes(&self) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        }
    }

    /// Copies the timestamps, after the pass and before the submission.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..2, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.staging, 0, SIZE);
    }

    /// Asks for the timestamps after the submission, so that waiting for the pass brings them, too.
    pub fn request(&self) {
        self.staging.map_async(wgpu::MapMode::Read, .., |_| {});
    }

    /// The pass's seconds, after the wait that followed [`Timer::request`].
    pub fn seconds(&self) -> Result<f64, GpuError> {
        let ticks: [u64; 2] = {
            let view = self
                .staging
                .get_mapped_range(..)
                .map_err(|error| GpuError::Refused(error.to_string()))?;
            bytemuck::pod_read_unaligned(&view)
        };
        self.staging.unmap();
        Ok(ticks[1].saturating_sub(ticks[0]) as f64 * self.ns_per_tick * 1e-9)
    }
}
