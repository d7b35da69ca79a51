//! Group 1 of the path tracer: its tiles, and the image's sums, in bands of rows if they exceed a buffer binding.

use super::{
    compute::{self, UNIFORMS, WRITE},
    device::{GpuDevice, GpuError},
    layout::{PixelColors, PixelStatistics, TILE_COLUMNS, Tile},
};
use crate::job::{Job, film::Extras, guides::GuideSums, tiles::TILE_SIDE};

/// Tiles per dispatch at most: one workgroup each, of which WebGPU allows 65 535 per dimension.
pub const DISPATCH_TILES: usize = 65_535;

/// The layout of the group.
pub fn layout(gpu: &GpuDevice) -> wgpu::BindGroupLayout {
    let list = compute::texture(wgpu::TextureSampleType::Uint, wgpu::TextureViewDimension::D2);
    compute::layout(gpu, "sums", (0..).zip([UNIFORMS, list, WRITE, WRITE, WRITE]))
}

/// The sums over samples that the host has not read yet, and the list of tiles to render.
#[derive(Clone, Debug)]
pub struct Sums {
    size: [u32; 2],
    extras: Extras,
    band_rows: u32,
    bands: Vec<Band>,
    tiles: wgpu::Texture,
}

/// Sums of some rows of pixels.
#[derive(Clone, Debug)]
pub struct Band {
    /// First pixel row.
    pub first_row: u32,
    /// Number of pixels.
    pub pixels: usize,
    /// Sums of colours (of all light, then of each light group), statistics and guides.
    pub buffers: [wgpu::Buffer; 3],
    /// The group to bind.
    pub group: wgpu::BindGroup,
}

impl Sums {
    /// Whether these fit a job.
    pub fn fit(&self, job: &Job) -> bool {
        self.size == job.settings.image_size && self.extras == Extras::of(job)
    }

    /// Sums for a job's image; not cleared, if the driver does not clear memory.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] if not even a row of tiles fits a binding.
    pub fn new(gpu: &GpuDevice, layout: &wgpu::BindGroupLayout, job: &Job) -> Result<Self, GpuError> {
        let [width, height] = job.settings.image_size;
        let extras = Extras::of(job);
        let widest = pixel_bytes(extras).into_iter().max().unwrap_or(1);
        let tile_row_bytes = u64::from(TILE_SIDE * width) * widest as u64;
        let tile_rows = (gpu.binding_bytes() / tile_row_bytes).clamp(1, u64::from(height.div_ceil(TILE_SIDE)));
        let band_rows = tile_rows as u32 * TILE_SIDE;
        let list_size = [TILE_COLUMNS, (DISPATCH_TILES as u32).div_ceil(TILE_COLUMNS), 1];
        let tiles = gpu.texture("the list of tiles", list_size, wgpu::TextureFormat::Rgba32Uint);
        let list = tiles.create_view(&Default::default());
        let bands = (0..height).step_by(band_rows as usize).map(|first_row| {
            let rows = band_rows.min(height - first_row);
            Band::new(
                gpu,
                layout,
                &list,
                first_row,
                u64::from(rows) * u64::from(width),
                extras,
            )
        });
        Ok(Self {
            size: [width, height],
            extras,
            band_rows,
            bands: bands.collect::<Result<_, _>>()?,
            tiles,
        })
    }

    /// The bands, from the top.
    pub fn bands(&self) -> &[Band] {
        &self.bands
    }

    /// The band that a tile is in, by its number.
    pub fn band_of(&self, tile: &Tile) -> usize {
        (tile.origin[1] / self.band_rows) as usize
    }

    /// Sets the tiles of the next dispatch, at most [`DISPATCH_TILES`].
    pub fn list(&self, gpu: &GpuDevice, tiles: &[Tile]) {
        let rows = tiles.len().div_ceil(TILE_COLUMNS as usize);
        let mut whole = tiles.to_vec();
        whole.resize(rows * TILE_COLUMNS as usize, Tile::default());
        gpu.write_texture(
            &self.tiles,
            [0; 3],
            [TILE_COLUMNS, rows as u32],
            bytemuck::cast_slice(&whole),
        );
    }

    /// Sets the sums to zero.
    pub fn clear(&self, gpu: &GpuDevice) {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        for buffer in self.bands.iter().flat_map(|band| &band.buffers) {
            encoder.clear_buffer(buffer, 0, None);
        }
        gpu.queue.submit([encoder.finish()]);
    }
}

/// Bytes per pixel of the three buffers of a band.
fn pixel_bytes(extras: Extras) -> [usize; 3] {
    let guides = if extras.guides > 0 {
        size_of::<[GuideSums; 2]>()
    } else {
        0
    };
    [
        (1 + extras.light_groups as usize) * size_of::<PixelColors>(),
        size_of::<PixelStatistics>(),
        guides,
    ]
}

impl Band {
    fn new(
        gpu: &GpuDevice,
        layout: &wgpu::BindGroupLayout,
        tiles: &wgpu::TextureView,
        first_row: u32,
        pixels: u64,
        extras: Extras,
    ) -> Result<Self, GpuError> {
        let [colors, statistics, guides] =
            pixel_bytes(extras).map(|bytes| gpu.empty_storage("the image", pixels * bytes as u64));
        let buffers = [colors?, statistics?, guides?];
        let uniforms = gpu.uniforms(&[first_row, pixels as u32, 0, 0]);
        let list = wgpu::BindingResource::TextureView(tiles);
        let buffer_bindings = buffers.each_ref().map(wgpu::Buffer::as_entire_binding);
        let bound = [uniforms.as_entire_binding(), list].into_iter().chain(buffer_bindings);
        let group = compute::bind(gpu, layout, (0..).zip(bound));
        Ok(Self {
            first_row,
            pixels: pixels as usize,
            buffers,
            group,
        })
    }
}
