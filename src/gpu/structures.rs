//! The adapter's acceleration structures, for ray queries.

use super::{device::GpuDevice, layout::Triangle};
use crate::scene::Geometry;

/// The bottom-level structures of the model and its surroundings, and the top-level structure over both. Instance 0 is the
/// model, 1 its surroundings (`shaders/scene/ray_query.wgsl`).
#[derive(Clone, Debug)]
pub struct Structures {
    /// `None` without a model.
    model: Option<wgpu::Blas>,
    /// The top-level structure, which shaders read.
    pub whole: wgpu::Tlas,
}

impl Structures {
    /// Hierarchies over the triangles of a geometry, which lie in a buffer part by part. `old` are those of the same model
    /// with other surroundings: the model's is kept.
    pub fn new(gpu: &GpuDevice, geometry: &Geometry, triangles: &wgpu::Buffer, old: Option<&Self>) -> Self {
        let parts = geometry.whole_parts();
        let sizes = parts.map(|(part, _)| wgpu::BlasTriangleGeometrySizeDescriptor {
            vertex_format: wgpu::VertexFormat::Float32x3,
            vertex_count: 3 * part.triangles.len() as u32,
            index_format: None,
            index_count: None,
            // The integrator looks after holes.
            flags: wgpu::AccelerationStructureGeometryFlags::OPAQUE,
        });
        let build = |part: usize| {
            let descriptor = wgpu::CreateBlasDescriptor {
                label: Some("triangles"),
                flags: wgpu::AccelerationStructureFlags::PREFER_FAST_TRACE,
                update_mode: wgpu::AccelerationStructureUpdateMode::Build,
            };
            let descriptors = vec![sizes[part].clone()];
            let sizes = wgpu::BlasGeometrySizeDescriptors::Triangles { descriptors };
            (!parts[part].0.is_empty()).then(|| gpu.device.create_blas(&descriptor, sizes))
        };
        let model = old.map_or_else(|| build(0), |old| old.model.clone());
        let around = build(1);
        let mut whole = gpu.device.create_tlas(&wgpu::CreateTlasDescriptor {
            label: Some("model and surroundings"),
            max_instances: 2,
            flags: wgpu::AccelerationStructureFlags::PREFER_FAST_TRACE,
            update_mode: wgpu::AccelerationStructureUpdateMode::Build,
        });
        let mut entries = Vec::new();
        for (part, blas) in [&model, &around].into_iter().enumerate() {
            let Some(blas) = blas else { continue };
            let in_place = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
            whole[part] = Some(wgpu::TlasInstance::new(blas, in_place, part as u32, 0xff));
            if part == 0 && old.is_some() {
                continue;
            }
            // A triangle is three corners of four words each, of which the first three are its place.
            let geometry = wgpu::BlasTriangleGeometry {
                size: &sizes[part],
                vertex_buffer: triangles,
                first_vertex: 3 * parts[part].1 as u32,
                vertex_stride: (size_of::<Triangle>() / 3) as u64,
                index_buffer: None,
                first_index: None,
                transform_buffer: None,
                transform_buffer_offset: None,
            };
            let geometry = wgpu::BlasGeometries::TriangleGeometries(vec![geometry]);
            entries.push(wgpu::BlasBuildEntry { blas, geometry });
        }
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.build_acceleration_structures(&entries, [&whole]);
        gpu.queue.submit([encoder.finish()]);
        Self { model, whole }
    }

    /// Whether an adapter can build over parts that are so large.
    pub fn have_room_for(gpu: &GpuDevice, geometry: &Geometry) -> bool {
        let most = gpu.device.limits().max_blas_primitive_count as usize;
        geometry
            .whole_parts()
            .iter()
            .all(|(part, _)| 3 * part.triangles.len() <= most)
    }
}
