//! Group 0 of the passes: all that shaders read of a scene (`shaders/scene/layout.wgsl`).

use super::array::{self, Values};
use super::compute::{self, READ, UNIFORMS, buffer_entry, texture_entry};
use super::device::{GpuDevice, GpuError};
use super::geometry_arrays::{Form, GeometryArrays};
use super::material_array::MaterialArray;
use super::traversal::Traversal;
use crate::job::Job;
use crate::optics::table::NODE_LENGTH;
use crate::scene::Geometry;
use crate::scene::environment::{Distribution, Environment};
use crate::scene::inversion::Share;
use crate::scene::light::Lights;
use crate::scene::texture::Textures;

/// The binding of the materials' tables.
const TABLES_BINDING: u32 = 5;

/// The binding of the materials among the uniforms.
const FEW_MATERIALS_BINDING: u32 = 14;
/// Binding of the adapter's acceleration structure, the last of the group, if used.
const STRUCTURES_BINDING: u32 = 15;

const MAP: wgpu::TextureSampleType = wgpu::TextureSampleType::Float { filterable: false };

/// The layout of the group, for rays that go this way.
pub fn layout(gpu: &GpuDevice, traversal: Traversal) -> wgpu::BindGroupLayout {
    use wgpu::TextureViewDimension::{D2, D2Array};
    let entry = |binding: u32| match binding {
        0 | FEW_MATERIALS_BINDING => buffer_entry(binding, UNIFORMS),
        1..=3 => buffer_entry(binding, READ),
        4 => texture_entry(binding, MAP, D2),
        _ => texture_entry(binding, wgpu::TextureSampleType::Uint, D2Array),
    };
    let structures = wgpu::BindGroupLayoutEntry {
        ty: wgpu::BindingType::AccelerationStructure { vertex_return: false },
        ..buffer_entry(STRUCTURES_BINDING, READ)
    };
    let structures = (traversal == Traversal::RayQueries).then_some(structures);
    let entries: Vec<_> = (0..STRUCTURES_BINDING).map(entry).chain(structures).collect();
    compute::layout(gpu, "scene", &entries)
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
            has_many_materials: MaterialArray::are_many(&job.materials),
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
    /// Array of the materials, by slot.
    pub materials: MaterialArray,
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
            materials: MaterialArray::new(gpu, &[])?,
            tables: tables(gpu, &[])?,
            environment: [environment_map(gpu, [1, 1], &[[0.0; 4]]), nothing()?],
            light_cells: nothing()?,
            textures: [nothing()?, nothing()?],
        })
    }

    /// The group with its uniforms, a [`layout::Globals`]; the layout is that for the geometry's form.
    pub fn bind(&self, gpu: &GpuDevice, layout: &wgpu::BindGroupLayout, globals: &wgpu::Buffer) -> wgpu::BindGroup {
        let [nodes, triangles] = self.geometry.buffers();
        let [few_materials, many_materials] = self.materials.buffers();
        let buffers = [globals, nodes, triangles, many_materials];
        let [map, cells] = &self.environment;
        let [records, words] = &self.textures;
        let [node_texels, triangle_texels, vertex_texels, slots] = self.geometry.textures();
        let textures = [
            map,
            &self.tables,
            cells,
            &self.light_cells,
            slots,
            records,
            words,
            node_texels,
            triangle_texels,
            vertex_texels,
        ];
        let buffers = buffers.map(wgpu::Buffer::as_entire_binding).into_iter();
        let textures = textures.map(wgpu::BindingResource::TextureView).into_iter();
        let structures = self.geometry.structure().map(wgpu::Tlas::as_binding);
        let last = [few_materials.as_entire_binding()].into_iter().chain(structures);
        compute::bind(gpu, layout, (0..).zip(buffers.chain(textures).chain(last)))
    }

    /// Storage of the scene.
    pub fn form(&self) -> SceneForm {
        SceneForm {
            geometry: self.geometry.form(),
            has_many_materials: self.materials.has_many(),
        }
    }
}

/// The materials' custom curves and albedo tables.
pub fn tables(gpu: &GpuDevice, tables: &[f32]) -> Result<wgpu::TextureView, GpuError> {
    let (nodes, rest) = tables.as_chunks::<NODE_LENGTH>();
    assert!(rest.is_empty(), "tables are made of whole nodes");
    array::texture(gpu, "the materials' tables", &Values::of(nodes))
}

/// Layout of a group with the tables alone, for passes that read nothing else of a scene.
pub fn tables_layout(gpu: &GpuDevice) -> wgpu::BindGroupLayout {
    let entry = texture_entry(
        TABLES_BINDING,
        wgpu::TextureSampleType::Uint,
        wgpu::TextureViewDimension::D2Array,
    );
    compute::layout(gpu, "tables", &[entry])
}

/// The group for [`Self::tables_layout`].
pub fn bind_tables(gpu: &GpuDevice, layout: &wgpu::BindGroupLayout, tables: &wgpu::TextureView) -> wgpu::BindGroup {
    compute::bind_group(gpu, layout, &[], &[(TABLES_BINDING, tables)])
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
    let guides = share(index).guide | next_guide << 16;
    [lower, share(index).upper, guides, density.to_bits()]
}

fn environment_map(gpu: &GpuDevice, [width, height]: [u32; 2], texels: &[[f32; 4]]) -> wgpu::TextureView {
    let size = wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    };
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
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(16 * width),
        rows_per_image: None,
    };
    gpu.queue
        .write_texture(texture.as_image_copy(), bytemuck::cast_slice(texels), layout, size);
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
