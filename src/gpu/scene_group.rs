//! Group 0 of the passes: all that shaders read of a scene (`shaders/scene/layout.wgsl`).

use bytemuck::Zeroable as _;

use super::{
    array,
    array::Values,
    compute::{self, READ, UNIFORMS, texture},
    device::{GpuDevice, GpuError},
    geometry_arrays::{Form, GeometryArrays},
    traversal::Traversal,
};
use crate::{
    job::Job,
    optics::{material::Material, table::NODE_LENGTH},
    scene::{
        Geometry,
        environment::{Distribution, Environment},
        inversion::Share,
        light::Lights,
        texture::Textures,
    },
};

/// The binding of the materials' tables.
pub const TABLES_BINDING: u32 = 5;

/// The binding of the materials among the uniforms.
const FEW_MATERIALS_BINDING: u32 = 14;
/// Binding of the adapter's acceleration structure, the last of the group, if used.
const STRUCTURES_BINDING: u32 = 15;

/// Materials that lie among the uniforms at most: WebGPU grants every adapter 64 KiB of them.
pub const FEW_MATERIALS: usize = (64 << 10) / size_of::<Material<f32>>();

const MAP: wgpu::BindingType = texture(
    wgpu::TextureSampleType::Float { filterable: false },
    wgpu::TextureViewDimension::D2,
);
pub const TEXELS: wgpu::BindingType = texture(wgpu::TextureSampleType::Uint, wgpu::TextureViewDimension::D2Array);

/// The layout of the group, for rays that go this way.
pub fn layout(gpu: &GpuDevice, traversal: Traversal) -> wgpu::BindGroupLayout {
    let kind = |binding: u32| match binding {
        0 | FEW_MATERIALS_BINDING => UNIFORMS,
        1..=3 => READ,
        4 => MAP,
        STRUCTURES_BINDING => wgpu::BindingType::AccelerationStructure { vertex_return: false },
        _ => TEXELS,
    };
    let count = STRUCTURES_BINDING + u32::from(traversal == Traversal::RayQueries);
    compute::layout(gpu, "scene", (0..count).map(|binding| (binding, kind(binding))))
}

/// Storage of a scene; kernels are specialised for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SceneForm {
    /// Storage of the geometry.
    pub geometry: Form,
    /// Whether the materials are too many for the uniforms.
    pub has_many_materials: bool,
}

impl SceneForm {
    /// The form of a job's scene on a device.
    pub fn of(gpu: &GpuDevice, job: &Job) -> Self {
        Self {
            geometry: Form::of(gpu, &job.geometry),
            has_many_materials: are_many(&job.materials),
        }
    }

    /// Override constants of a pipeline for this storage.
    pub fn constants(self) -> [(&'static str, f64); 2] {
        [
            self.geometry.constant(),
            ("HAS_MANY_MATERIALS", f64::from(u8::from(self.has_many_materials))),
        ]
    }
}

/// A scene on the GPU. Its parts are shared: a new scene may reuse some of an old one's.
#[derive(Clone, Debug)]
pub struct SceneGroup {
    /// Arrays of the geometry.
    pub geometry: GeometryArrays,
    /// See [`materials`].
    pub materials: [wgpu::Buffer; 2],
    /// See [`tables`].
    pub tables: wgpu::TextureView,
    /// See [`environment`].
    pub environment: [wgpu::TextureView; 2],
    /// See [`light_cells`].
    pub light_cells: wgpu::TextureView,
    /// See [`textures`].
    pub textures: [wgpu::TextureView; 2],
}

impl SceneGroup {
    /// An empty scene.
    pub fn empty(gpu: &GpuDevice) -> Result<Self, GpuError> {
        let nothing = || array::texture(gpu, "nothing", &Values::<u32>::of(&[]));
        Ok(Self {
            geometry: GeometryArrays::empty(gpu)?,
            materials: materials(gpu, &[])?,
            tables: tables(gpu, &[])?,
            environment: [environment_map(gpu, [1, 1], &[[0.0; 4]]), nothing()?],
            light_cells: nothing()?,
            textures: [nothing()?, nothing()?],
        })
    }

    /// The group with its uniforms, a [`layout::Globals`]; the layout is that for the geometry's form.
    pub fn bind(&self, gpu: &GpuDevice, layout: &wgpu::BindGroupLayout, globals: &wgpu::Buffer) -> wgpu::BindGroup {
        let [nodes, triangles] = &self.geometry.buffers;
        let [few_materials, many_materials] = &self.materials;
        let buffers = [globals, nodes, triangles, many_materials];
        let [map, cells] = &self.environment;
        let [records, words] = &self.textures;
        let [node_texels, triangle_texels] = &self.geometry.textures;
        let textures = [
            map,
            &self.tables,
            cells,
            &self.light_cells,
            &self.geometry.slots,
            records,
            words,
            node_texels,
            triangle_texels,
            &self.geometry.vertices,
        ];
        let buffers = buffers.map(wgpu::Buffer::as_entire_binding).into_iter();
        let textures = textures.map(wgpu::BindingResource::TextureView).into_iter();
        let structures = self.geometry.structures.as_ref().map(|built| built.whole.as_binding());
        let last = [few_materials.as_entire_binding()].into_iter().chain(structures);
        compute::bind(gpu, layout, (0..).zip(buffers.chain(textures).chain(last)))
    }
}

/// The materials by slot: in a uniform buffer, which drivers read without bounds checks per lane and word; or in the storage
/// buffer if there are too many.
pub fn materials(gpu: &GpuDevice, materials: &[Material<f32>]) -> Result<[wgpu::Buffer; 2], GpuError> {
    // Each buffer has at least the size that the shader declares, whether it is read or not.
    let mut few = vec![Material::zeroed(); FEW_MATERIALS];
    let many = if are_many(materials) {
        materials
    } else {
        few[..materials.len()].copy_from_slice(materials);
        &[Material::zeroed()]
    };
    Ok([
        gpu.filled("materials", wgpu::BufferUsages::UNIFORM, bytemuck::cast_slice(&few)),
        array::buffer(gpu, "the materials", &Values::of(many))?,
    ])
}

/// Whether materials are too many for the uniforms.
pub fn are_many(materials: &[Material<f32>]) -> bool {
    materials.len() > FEW_MATERIALS
}

/// The materials' custom curves and albedo tables.
pub fn tables(gpu: &GpuDevice, tables: &[f32]) -> Result<wgpu::TextureView, GpuError> {
    let (nodes, rest) = tables.as_chunks::<NODE_LENGTH>();
    assert!(rest.is_empty(), "tables are made of whole nodes");
    array::texture(gpu, "the materials' tables", &Values::of(nodes))
}

/// The map of an environment and its sampling cells.
///
/// # Errors
///
/// [`GpuError::Unfit`] if the map is wider than the adapter's textures.
pub fn environment(
    gpu: &GpuDevice,
    environment: &Environment,
    distribution: &Distribution,
) -> Result<[wgpu::TextureView; 2], GpuError> {
    let size = [environment.width, environment.height];
    let limit = gpu.device.limits().max_texture_dimension_2d;
    if size[0].max(size[1]) > limit {
        return Err(GpuError::Unfit {
            adapter: gpu.info.name.clone(),
            reason: format!("the environment {} is wider than {limit} pixels", environment.name),
        });
    }
    let cells = environment_cells(distribution);
    Ok([
        environment_map(gpu, size, &environment.texels),
        array::texture(gpu, "the environment's cells", &cells)?,
    ])
}

/// An environment's sampling cells, row by row, followed by the rows. An entry has the first number that selects it, the
/// number after the last, the guides of its slot and the next (halves of a word), and the density.
fn environment_cells(distribution: &Distribution) -> Values<'_, [u32; 4]> {
    let (width, height) = (distribution.width as usize, distribution.height as usize);
    let cell = move |index: usize| {
        let (row, column) = (index / width, index % width);
        if row < height {
            let cells = &distribution.cells[row * width..][..width];
            entry(width, column, |column| cells[column].share, cells[column].density)
        } else {
            let row = index - width * height;
            entry(height, row, |row| distribution.rows[row], 0.0)
        }
    };
    Values::made(width * height + height, cell)
}

/// An entry of `count` that are drawn from.
fn entry(count: usize, index: usize, share: impl Fn(usize) -> Share, density: f32) -> [u32; 4] {
    let lower = index.checked_sub(1).map_or(0, |before| share(before).upper);
    let last = count as u32 - 1;
    let next = index + 1;
    let next_guide = if next < 1 << count.ilog2() {
        share(next).guide
    } else {
        last
    };
    [
        lower,
        share(index).upper,
        share(index).guide | next_guide << 16,
        density.to_bits(),
    ]
}

fn environment_map(gpu: &GpuDevice, [width, height]: [u32; 2], texels: &[[f32; 4]]) -> wgpu::TextureView {
    let texture = gpu.texture("environment", [width, height, 1], wgpu::TextureFormat::Rgba32Float);
    gpu.write_texture(&texture, [0; 3], [width, height], bytemuck::cast_slice(texels));
    texture.create_view(&Default::default())
}

/// The alias table of emitting triangles, which are given by their positions in the hierarchy's order.
pub fn light_cells(gpu: &GpuDevice, geometry: &Geometry, lights: &Lights) -> Result<wgpu::TextureView, GpuError> {
    let place = geometry.places();
    let cells =
        Values::of(&lights.cells).map(|cell| [cell.threshold.to_bits(), cell.alias_index, place(cell.triangle), 0]);
    array::texture(gpu, "the triangles that emit", &cells)
}

/// The records and texels of a model's texture maps; unchanged ones are kept.
pub fn textures(
    gpu: &GpuDevice,
    textures: &Textures,
    words: Option<wgpu::TextureView>,
) -> Result<[wgpu::TextureView; 2], GpuError> {
    let records = array::texture(gpu, "the model's textures", &Values::of(&textures.records))?;
    let words = match words {
        Some(words) => words,
        None => array::texture(gpu, "the model's textures", &Values::of(&textures.words))?,
    };
    Ok([records, words])
}
