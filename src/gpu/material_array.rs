//! A scene's materials on the GPU: in a uniform buffer, which drivers read without bounds checks per lane and word; or in a
//! storage buffer if there are too many.

use bytemuck::Zeroable;

use super::array::{self, Values};
use super::device::{GpuDevice, GpuError};
use crate::optics::material::Material;

/// Materials that lie among the uniforms at most: WebGPU grants every adapter 64 KiB of them.
pub const FEW_MATERIALS: usize = (64 << 10) / size_of::<Material<f32>>();

/// The materials of a scene, in one of two buffers.
#[derive(Clone, Debug)]
pub struct MaterialArray {
    /// The uniform buffer, always of full size.
    few: wgpu::Buffer,
    many: wgpu::Buffer,
    are_many: bool,
}

impl MaterialArray {
    /// Brings materials to the GPU.
    pub fn new(gpu: &GpuDevice, materials: &[Material<f32>]) -> Result<Self, GpuError> {
        let are_many = Self::are_many(materials);
        // Each buffer has at least the size that the shader declares, whether it is read or not.
        let filler = [Material::zeroed()];
        let mut few = vec![filler[0]; FEW_MATERIALS];
        let many = if are_many {
            materials
        } else {
            few[..materials.len()].copy_from_slice(materials);
            &filler
        };
        Ok(Self {
            few: gpu.filled("materials", wgpu::BufferUsages::UNIFORM, bytemuck::cast_slice(&few)),
            many: array::buffer(gpu, "the materials", &Values::of(many))?,
            are_many,
        })
    }

    /// Whether there are too many for the uniforms.
    pub fn are_many(materials: &[Material<f32>]) -> bool {
        materials.len() > FEW_MATERIALS
    }

    /// Whether the materials are in the storage buffer.
    pub(super) fn has_many(&self) -> bool {
        self.are_many
    }

    /// The buffer among the uniforms, and the other.
    pub(super) fn buffers(&self) -> [&wgpu::Buffer; 2] {
        [&self.few, &self.many]
    }
}
