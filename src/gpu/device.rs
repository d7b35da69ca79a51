//! An open GPU device: its memory and its errors.

use std::{
    ops::Range,
    sync::{
        Arc, Mutex,
        atomic::{AtomicU8, AtomicU64, Ordering::Relaxed},
    },
};

use pollster::block_on;

use super::traversal::Traversal;
use crate::panics::lock;

/// Errors of a GPU.
#[derive(Clone, Debug, thiserror::Error)]
pub enum GpuError {
    /// No adapter of the requested kind.
    #[error(
        "no {0}Vulkan adapter was found. Install a driver (on Debian and Ubuntu: apt install mesa-vulkan-drivers), or \
         render on the CPU with --engine cpu"
    )]
    NoAdapter(&'static str),
    /// The adapter can't run the path tracer.
    #[error("the adapter {adapter} can't run the renderer: {reason}. Render on the CPU with --engine cpu")]
    Unfit { adapter: String, reason: String },
    /// A resource exceeds the adapter's limit.
    #[error("{0} at once. Choose something smaller, or render on the CPU with --engine cpu")]
    TooLarge(String),
    /// A command that the device refused; the device remains usable.
    #[error("the GPU refused a command: {0}. Choose something smaller, or render on the CPU with --engine cpu")]
    Refused(String),
    /// The device stopped working.
    #[error("the GPU stopped working: {0}. Start again, or render on the CPU with --engine cpu")]
    Lost(String),
    /// A shader did not compile: a mistake of ours.
    #[error("a shader does not compile on this adapter: {0}. Please report it; --engine cpu works meanwhile")]
    Shader(String),
}

impl GpuError {
    /// True if the device is lost; after any other error it remains usable.
    pub fn is_lost(&self) -> bool {
        matches!(self, Self::Lost(_))
    }
}

/// An open device.
#[derive(Clone, Debug)]
pub struct GpuDevice {
    pub device: wgpu::Device,
    /// Command queue of the device.
    pub queue: wgpu::Queue,
    /// Name, driver, kind.
    pub info: wgpu::AdapterInfo,
    /// Traversal of its kernels, if the scene permits.
    pub traversal: Traversal,
    failures: Arc<Mutex<Failures>>,
    /// Largest size of a buffer in bytes, if below the adapter's limit.
    buffer_limit: Arc<AtomicU64>,
    /// The [`Moment`] at which a test loses the device; 0 for none.
    losing_moment: Arc<AtomicU8>,
}

/// Moment at which a test loses the device; real ones are lost at any time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Moment {
    /// While a kernel is compiled.
    Compiling = 1,
    /// While a job is uploaded.
    Uploading,
    /// While a dispatch is waited for.
    Rendering,
    /// While sums are read back.
    Reading,
}

/// Errors that the device reported asynchronously.
#[derive(Debug, Default)]
struct Failures {
    /// Why it stopped working.
    lost: Option<String>,
    /// The first error since the last report.
    refused: Option<String>,
}

impl GpuDevice {
    /// Wraps an opened device.
    pub fn new((device, queue): (wgpu::Device, wgpu::Queue), info: wgpu::AdapterInfo, traversal: Traversal) -> Self {
        let failures = Arc::<Mutex<Failures>>::default();
        let of_commands = failures.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            log::error!("GPU: {error}");
            lock(&of_commands).refused.get_or_insert(error.to_string());
        }));
        let of_device = failures.clone();
        device.set_device_lost_callback(move |reason, message| {
            // Every device is destroyed in the end.
            if reason != wgpu::DeviceLostReason::Destroyed {
                log::error!("GPU: {message}");
            }
            lock(&of_device).lost.get_or_insert(message);
        });
        Self {
            device,
            queue,
            info,
            traversal,
            failures,
            buffer_limit: Arc::new(AtomicU64::new(u64::MAX)),
            losing_moment: Arc::default(),
        }
    }

    /// Refuses buffers above a size in bytes, as a smaller adapter does. For tests.
    pub fn limit_buffers(&self, bytes: u64) {
        self.buffer_limit.store(bytes, Relaxed);
    }

    /// Loses the device at a later moment, as a driver's reset does. For tests.
    pub fn lose_when(&self, moment: Moment) {
        self.losing_moment.store(moment as u8, Relaxed);
    }

    /// Notes that a moment has come.
    pub fn reach(&self, moment: Moment) {
        if self.losing_moment.load(Relaxed) == moment as u8 {
            self.device.destroy();
        }
    }

    /// True for a software adapter, which runs on the CPU.
    pub fn is_software(&self) -> bool {
        is_software(&self.info)
    }

    /// Driver with its version.
    pub fn driver(&self) -> String {
        driver(&self.info)
    }

    /// The result of `make`, or [`GpuError::Lost`], or the device's objection as a `refusal`.
    pub fn checked<T>(
        &self,
        refusal: impl FnOnce(String) -> GpuError,
        make: impl FnOnce(&wgpu::Device) -> T,
    ) -> Result<T, GpuError> {
        use wgpu::ErrorFilter::{Internal, OutOfMemory, Validation};
        let scopes = [Internal, OutOfMemory, Validation].map(|filter| self.device.push_error_scope(filter));
        let made = make(&self.device);
        // The last one is closed first.
        let said: Vec<_> = scopes
            .into_iter()
            .rev()
            .filter_map(|scope| block_on(scope.pop()))
            .collect();
        let Some(error) = said.first() else { return Ok(made) };
        // A lost device refuses everything; waiting returns the reason.
        match self.wait() {
            Err(lost) if lost.is_lost() => Err(lost),
            _ => Err(refusal(error.to_string())),
        }
    }

    /// Waits until all submitted work is done.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`] from the device's loss on; [`GpuError::Refused`] once for a refused command since the last call.
    pub fn wait(&self) -> Result<(), GpuError> {
        let polled = self.device.poll(wgpu::PollType::wait_indefinitely());
        let mut failures = lock(&self.failures);
        let refused = failures.refused.take();
        match (&failures.lost, polled, refused) {
            (Some(message), ..) => Err(GpuError::Lost(message.clone())),
            (None, Err(error), _) => Err(GpuError::Lost(error.to_string())),
            (None, Ok(_), Some(message)) => Err(GpuError::Refused(message)),
            (None, Ok(_), None) => Ok(()),
        }
    }

    /// Bytes that a storage buffer may have.
    pub fn binding_bytes(&self) -> u64 {
        let limits = self.device.limits();
        limits
            .max_storage_buffer_binding_size
            .min(limits.max_buffer_size)
            .min(self.buffer_limit.load(Relaxed))
    }

    /// A storage buffer of zeros.
    pub fn empty_storage(&self, what: &'static str, size: u64) -> Result<wgpu::Buffer, GpuError> {
        self.storage(what, size, wgpu::BufferUsages::empty())
    }

    /// The same with another usage.
    pub fn storage(
        &self,
        what: &'static str,
        size: u64,
        other_usage: wgpu::BufferUsages,
    ) -> Result<wgpu::Buffer, GpuError> {
        let allowed = self.binding_bytes();
        if size > allowed {
            let (needed_mib, allowed_mib) = (size >> 20, allowed >> 20);
            let takes = format!("the adapter {} takes {allowed_mib} MiB", self.info.name);
            return Err(GpuError::TooLarge(format!(
                "{what} takes {needed_mib} MiB, and {takes}"
            )));
        }
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        // Bindings must not be empty.
        Ok(self.buffer(what, size.max(64), usage | other_usage))
    }

    pub fn buffer(&self, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage,
            mapped_at_creation: false,
        })
    }

    /// A texture to be read by shaders, of this width, height and number of layers.
    pub fn texture(&self, label: &str, size: [u32; 3], format: wgpu::TextureFormat) -> wgpu::Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: extent(size),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        })
    }

    /// Writes a rectangle of a texture's layer, from column, row and layer `place` on.
    pub fn write_texture(&self, texture: &wgpu::Texture, [x, y, z]: [u32; 3], [width, height]: [u32; 2], bytes: &[u8]) {
        let place = wgpu::TexelCopyTextureInfo {
            origin: wgpu::Origin3d { x, y, z },
            ..texture.as_image_copy()
        };
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some((bytes.len() / height as usize) as u32),
            rows_per_image: None,
        };
        self.queue
            .write_texture(place, bytes, layout, extent([width, height, 1]));
    }

    /// A buffer of uniforms.
    pub fn uniforms<U: bytemuck::Pod>(&self, uniforms: &U) -> wgpu::Buffer {
        self.filled("uniforms", wgpu::BufferUsages::UNIFORM, bytemuck::bytes_of(uniforms))
    }

    /// A buffer of exactly these bytes. Unlike wgpu's own helper, it does not panic on a lost device.
    pub fn filled(&self, label: &str, usage: wgpu::BufferUsages, bytes: &[u8]) -> wgpu::Buffer {
        let buffer = self.buffer(label, bytes.len() as u64, usage | wgpu::BufferUsages::COPY_DST);
        self.queue.write_buffer(&buffer, 0, bytes);
        buffer
    }

    /// The same for a range of the values.
    pub fn read<A: bytemuck::Pod>(&self, buffer: &wgpu::Buffer, part: Range<usize>) -> Result<Vec<A>, GpuError> {
        let [first, size] = [part.start, part.len()].map(|count| (count * size_of::<A>()) as u64);
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        let staging = self.buffer("read back", size, usage);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(buffer, first, &staging, 0, size);
        self.queue.submit([encoder.finish()]);
        self.reach(Moment::Reading);
        // The outcome shows in get_mapped_range below.
        staging.map_async(wgpu::MapMode::Read, .., |_| {});
        self.wait()?;
        let view = staging
            .get_mapped_range(..)
            .map_err(|error| GpuError::Refused(error.to_string()))?;
        Ok(bytemuck::pod_collect_to_vec(&view))
    }
}

fn extent([width, height, depth_or_array_layers]: [u32; 3]) -> wgpu::Extent3d {
    wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers,
    }
}

/// Whether an adapter is software, which runs on the CPU.
pub fn is_software(info: &wgpu::AdapterInfo) -> bool {
    info.device_type == wgpu::DeviceType::Cpu
}

/// A driver with its version.
pub fn driver(info: &wgpu::AdapterInfo) -> String {
    format!("{} {}", info.driver, info.driver_info).trim().to_owned()
}
