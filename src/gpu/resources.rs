//! What a job becomes on the GPU.

use std::sync::Arc;

use super::device::{GpuDevice, GpuError};
use super::layout::{self, Globals, PixelColors, PixelStatistics, Tile};
use crate::job::Job;
use crate::job::effect::EffectId;
use crate::job::features::GuideSums;
use crate::scene::Geometry;
use crate::scene::environment::Environment;

/// Most tiles of a dispatch: a workgroup each, of which WebGPU lets 65 535 stand in a row.
pub const DISPATCH_TILES: usize = 65_535;

/// Buffers and textures of a job; what a new job shares with the old one is kept.
#[derive(Debug)]
pub struct Resources {
    job: Arc<Job>,
    /// Nodes, triangles, vertices, slots.
    geometry: [wgpu::Buffer; 4],
    materials: wgpu::Buffer,
    tables: wgpu::Buffer,
    environment_map: wgpu::TextureView,
    environment_cells: wgpu::Buffer,
    light_cells: wgpu::Buffer,
    /// Records, words.
    textures: [wgpu::Buffer; 2],
    /// Sums of colours, of statistics and of what is seen first, since the last flush.
    pub sums: [wgpu::Buffer; 3],
    /// What a dispatch renders: [`Tile`] by tile.
    pub tiles: wgpu::Buffer,
    pub bind_group: wgpu::BindGroup,
}

impl Resources {
    /// Uploads a job, sharing with `old` what has not changed. The sums may be the old ones as they stand.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`], [`GpuError::Unfit`] and [`GpuError::Refused`] where the adapter can't hold a part of it; what
    /// `old` holds is as it was.
    pub fn new(
        gpu: &GpuDevice,
        bindings: &wgpu::BindGroupLayout,
        job: Arc<Job>,
        old: Option<&Self>,
    ) -> Result<Self, GpuError> {
        gpu.checked(|_| Self::made(gpu, bindings, job, old))
            .map_err(GpuError::Refused)?
    }

    fn made(
        gpu: &GpuDevice,
        bindings: &wgpu::BindGroupLayout,
        job: Arc<Job>,
        old: Option<&Self>,
    ) -> Result<Self, GpuError> {
        let geometry = match old.filter(|old| Arc::ptr_eq(&old.job.geometry, &job.geometry)) {
            Some(old) => old.geometry.clone(),
            None => upload_geometry(gpu, &job.geometry)?,
        };
        let materials = match old.filter(|old| Arc::ptr_eq(&old.job.materials, &job.materials)) {
            Some(old) => old.materials.clone(),
            None => gpu.storage("the materials", bytemuck::cast_slice(&job.materials))?,
        };
        let tables = match old.filter(|old| Arc::ptr_eq(&old.job.tables, &job.tables)) {
            Some(old) => old.tables.clone(),
            None => gpu.storage("the materials' tables", bytemuck::cast_slice(&job.tables))?,
        };
        let (environment_map, environment_cells) =
            match old.filter(|old| Arc::ptr_eq(&old.job.environment, &job.environment)) {
                Some(old) => (old.environment_map.clone(), old.environment_cells.clone()),
                None => upload_environment(gpu, &job.environment)?,
            };
        let light_cells = match old.filter(|old| Arc::ptr_eq(&old.job.lights, &job.lights)) {
            Some(old) => old.light_cells.clone(),
            None => {
                let cells = layout::light_cells(&job.geometry, &job.lights);
                gpu.storage("the triangles that emit", bytemuck::cast_slice(&cells))?
            }
        };
        let textures = match old.filter(|old| Arc::ptr_eq(&old.job.textures, &job.textures)) {
            Some(old) => old.textures.clone(),
            None => [
                gpu.storage("the model's textures", bytemuck::cast_slice(&job.textures.records))?,
                gpu.storage("the model's pictures", bytemuck::cast_slice(&job.textures.words))?,
            ],
        };
        let bytes_of = |size: usize| pixels(&job) * size as u64;
        let has_guides = |job: &Job| job.plan.has(EffectId::Guides);
        let layout = |job: &Job| (pixels(job), has_guides(job));
        let sums = match old.filter(|old| layout(&old.job) == layout(&job)) {
            Some(old) => old.sums.clone(),
            None => [
                gpu.empty_storage("the picture", bytes_of(size_of::<PixelColors>()))?,
                gpu.empty_storage("the picture", bytes_of(size_of::<PixelStatistics>()))?,
                gpu.empty_storage(
                    "the picture",
                    if has_guides(&job) {
                        bytes_of(size_of::<GuideSums>())
                    } else {
                        0
                    },
                )?,
            ],
        };
        let tiles = match old {
            Some(old) => old.tiles.clone(),
            None => gpu.empty_storage("the list of tiles", (DISPATCH_TILES * size_of::<Tile>()) as u64)?,
        };
        let globals = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("globals"),
            size: size_of::<Globals>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let cells = [job.environment.cells_width, job.environment.cells_height];
        let values = Globals::new(&job.settings, job.geometry.compressed().nodes.len(), cells);
        gpu.queue.write_buffer(&globals, 0, bytemuck::bytes_of(&values));
        let [nodes, triangles, vertices, slots] = &geometry;
        let resources = [
            globals.as_entire_binding(),
            nodes.as_entire_binding(),
            triangles.as_entire_binding(),
            vertices.as_entire_binding(),
            slots.as_entire_binding(),
            materials.as_entire_binding(),
            tables.as_entire_binding(),
            wgpu::BindingResource::TextureView(&environment_map),
            environment_cells.as_entire_binding(),
            sums[0].as_entire_binding(),
            sums[1].as_entire_binding(),
            light_cells.as_entire_binding(),
            tiles.as_entire_binding(),
            textures[0].as_entire_binding(),
            textures[1].as_entire_binding(),
            sums[2].as_entire_binding(),
        ];
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        let bind_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("job"),
            layout: bindings,
            entries: &entries,
        });
        Ok(Self {
            job,
            geometry,
            materials,
            tables,
            environment_map,
            environment_cells,
            light_cells,
            textures,
            sums,
            tiles,
            bind_group,
        })
    }

    /// The job that these are of.
    pub fn job(&self) -> &Job {
        &self.job
    }

    /// Sets the sums to zero.
    pub fn clear_sums(&self, gpu: &GpuDevice) {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        for buffer in &self.sums {
            encoder.clear_buffer(buffer, 0, None);
        }
        gpu.queue.submit([encoder.finish()]);
    }
}

fn pixels(job: &Job) -> u64 {
    job.settings.image_size.iter().map(|&x| u64::from(x)).product()
}

fn upload_geometry(gpu: &GpuDevice, geometry: &Geometry) -> Result<[wgpu::Buffer; 4], GpuError> {
    Ok([
        gpu.storage(
            "the hierarchy of boxes",
            bytemuck::cast_slice(&geometry.compressed().nodes),
        )?,
        gpu.storage(
            "the model's triangles",
            bytemuck::cast_slice(&layout::triangles(geometry)),
        )?,
        gpu.storage("the model's vertices", bytemuck::cast_slice(&geometry.vertices))?,
        gpu.storage(
            "the model's material slots",
            bytemuck::cast_slice(&layout::slots(geometry)),
        )?,
    ])
}

fn upload_environment(
    gpu: &GpuDevice,
    environment: &Environment,
) -> Result<(wgpu::TextureView, wgpu::Buffer), GpuError> {
    let size = wgpu::Extent3d {
        width: environment.width,
        height: environment.height,
        depth_or_array_layers: 1,
    };
    let limit = gpu.device.limits().max_texture_dimension_2d;
    if size.width.max(size.height) > limit {
        return Err(GpuError::Unfit {
            adapter: gpu.info.name.clone(),
            reason: format!("the environment {} is wider than {limit} pixels", environment.name),
        });
    }
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("environment"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    gpu.queue.write_texture(
        texture.as_image_copy(),
        bytemuck::cast_slice(&environment.texels),
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(16 * size.width),
            rows_per_image: None,
        },
        size,
    );
    let cells = gpu.storage("the environment's cells", bytemuck::cast_slice(&environment.cells))?;
    Ok((texture.create_view(&Default::default()), cells))
}
