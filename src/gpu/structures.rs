//! The adapter's acceleration structures, for ray queries.

use super::device::GpuDevice;
use super::layout::Triangle;
use crate::scene::{Geometry, Part};

/// The bottom-level structures of the model and its surroundings, and the top-level structure over both. Instance 0 is the
/// model, 1 its surroundings (`shaders/scene/ray_query.wgsl`).
#[derive(Clone, Debug)]
pub struct Structures {
    /// `None` without a model.
    model: Option<wgpu::Blas>,
    whole: wgpu::Tlas,
}

/// A hierarchy to be built over a part, whose triangles begin at a place.
struct Plan<'a> {
    blas: wgpu::Blas,
    size: wgpu::BlasTriangleGeometrySizeDescriptor,
    first: usize,
    triangles: &'a wgpu::Buffer,
}

impl Structures {
    /// Hierarchies over the triangles of a geometry, which lie in a buffer part by part.
    pub fn new(gpu: &GpuDevice, geometry: &Geometry, triangles: &wgpu::Buffer) -> Self {
        let model = Plan::new(gpu, geometry.whole_model(), 0, triangles);
        let blas = model.as_ref().map(|plan| plan.blas.clone());
        Self::build(gpu, (blas, model), geometry, triangles)
    }

    /// The same model with other surroundings; the model's structure is kept.
    pub fn with_around(&self, gpu: &GpuDevice, geometry: &Geometry, triangles: &wgpu::Buffer) -> Self {
        Self::build(gpu, (self.model.clone(), None), geometry, triangles)
    }

    /// Builds over a model that is there or planned.
    fn build(
        gpu: &GpuDevice,
        (model, planned): (Option<wgpu::Blas>, Option<Plan<'_>>),
        geometry: &Geometry,
        triangles: &wgpu::Buffer,
    ) -> Self {
        let [_, (around, first)] = geometry.whole_parts();
        let around = Plan::new(gpu, around, first, triangles);
        let mut whole = gpu.device.create_tlas(&wgpu::CreateTlasDescriptor {
            label: Some("model and surroundings"),
            max_instances: 2,
            flags: wgpu::AccelerationStructureFlags::PREFER_FAST_TRACE,
            update_mode: wgpu::AccelerationStructureUpdateMode::Build,
        });
        whole[0] = model.as_ref().map(|blas| instance(blas, 0));
        whole[1] = around.as_ref().map(|plan| instance(&plan.blas, 1));
        let plans = planned.iter().chain(&around);
        let entries: Vec<_> = plans.map(Plan::entry).collect();
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.build_acceleration_structures(&entries, [&whole]);
        gpu.queue.submit([encoder.finish()]);
        Self { model, whole }
    }

    /// The top-level structure, which shaders read.
    pub fn whole(&self) -> &wgpu::Tlas {
        &self.whole
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

impl<'a> Plan<'a> {
    /// `None` without triangles.
    fn new(gpu: &GpuDevice, part: &Part, first: usize, triangles: &'a wgpu::Buffer) -> Option<Self> {
        let size = wgpu::BlasTriangleGeometrySizeDescriptor {
            vertex_format: wgpu::VertexFormat::Float32x3,
            vertex_count: 3 * part.triangles.len() as u32,
            index_format: None,
            index_count: None,
            // The integrator looks after holes.
            flags: wgpu::AccelerationStructureGeometryFlags::OPAQUE,
        };
        let descriptor = wgpu::CreateBlasDescriptor {
            label: Some("triangles"),
            flags: wgpu::AccelerationStructureFlags::PREFER_FAST_TRACE,
            update_mode: wgpu::AccelerationStructureUpdateMode::Build,
        };
        let sizes = wgpu::BlasGeometrySizeDescriptors::Triangles {
            descriptors: vec![size.clone()],
        };
        (!part.is_empty()).then(|| Self {
            blas: gpu.device.create_blas(&descriptor, sizes),
            size,
            first,
            triangles,
        })
    }

    /// The order to build it. A triangle is three corners of four words each, of which the first three are its place.
    fn entry(&self) -> wgpu::BlasBuildEntry<'_> {
        wgpu::BlasBuildEntry {
            blas: &self.blas,
            geometry: wgpu::BlasGeometries::TriangleGeometries(vec![wgpu::BlasTriangleGeometry {
                size: &self.size,
                vertex_buffer: self.triangles,
                first_vertex: 3 * self.first as u32,
                vertex_stride: (size_of::<Triangle>() / 3) as u64,
                index_buffer: None,
                first_index: None,
                transform_buffer: None,
                transform_buffer_offset: None,
            }]),
        }
    }
}

/// An instance of a part by its instance number.
fn instance(blas: &wgpu::Blas, number: u32) -> wgpu::TlasInstance {
    let in_place = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    wgpu::TlasInstance::new(blas, in_place, number, 0xff)
}
