//! The geometry on the GPU: hierarchy, triangles and vertices of the model, followed by those of its surroundings; for ray
//! queries, the adapter's acceleration structures, too.

use super::{
    array,
    array::Values,
    device::{GpuDevice, GpuError},
    layout,
    layout::Triangle,
    structures::Structures,
    traversal::Traversal,
};
use crate::scene::{Geometry, Part, Vertex};

/// Triangles around a model for which there is always room, so that lights move and come without the model being brought to
/// the GPU again.
const ROOM: usize = 1024;

/// Storage of a geometry; kernels are specialised for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Form {
    /// Nodes and triangles in buffers.
    Buffers,
    /// In textures, too, which may exceed a buffer binding. Not for ray queries, which build over a buffer.
    Textures,
    /// In buffers, with the adapter's acceleration structures.
    Structures,
}

impl Form {
    /// The form of a geometry on a device. Nodes, which may not be built yet, take less than the triangles.
    pub fn of(gpu: &GpuDevice, geometry: &Geometry) -> Self {
        let counts = Counts::with_room(0, geometry.whole_model(), room(&geometry.around));
        if counts
            .buffer_bytes()
            .into_iter()
            .any(|bytes| bytes > gpu.binding_bytes())
        {
            return Self::Textures;
        }
        let is_empty = geometry.whole_parts().iter().all(|(part, _)| part.is_empty());
        let has_structures =
            gpu.traversal == Traversal::RayQueries && !is_empty && Structures::have_room_for(gpu, geometry);
        if has_structures {
            Self::Structures
        } else {
            Self::Buffers
        }
    }

    /// Traversal of this storage.
    pub fn traversal(self) -> Traversal {
        match self {
            Self::Buffers | Self::Textures => Traversal::Own,
            Self::Structures => Traversal::RayQueries,
        }
    }

    /// Override constant of a pipeline for this storage.
    pub fn constant(self) -> (&'static str, f64) {
        ("GEOMETRY_IN_TEXTURES", f64::from(u8::from(self == Self::Textures)))
    }
}

/// Hierarchy and triangles in buffers, or in textures if one exceeds a buffer binding. Vertices and material slots, read
/// once per bounce, are always in textures.
#[derive(Clone, Debug)]
pub struct GeometryArrays {
    /// Nodes and triangles.
    pub buffers: [wgpu::Buffer; 2],
    /// The same.
    pub textures: [wgpu::TextureView; 2],
    pub vertices: wgpu::TextureView,
    pub slots: wgpu::TextureView,
    pub form: Form,
    /// The adapter's, if used.
    pub structures: Option<Structures>,
    /// Triangles around the model that there is room for.
    room: usize,
}

impl GeometryArrays {
    /// An empty geometry.
    pub fn empty(gpu: &GpuDevice) -> Result<Self, GpuError> {
        let buffer = || gpu.empty_storage("nothing", 0);
        let texture = || array::empty_texture::<u32>(gpu, "nothing", 0);
        Ok(Self {
            buffers: [buffer()?, buffer()?],
            textures: [texture(), texture()],
            vertices: texture(),
            slots: texture(),
            form: Form::Buffers,
            structures: None,
            room: 0,
        })
    }

    /// Brings a geometry to the GPU.
    pub fn new(gpu: &GpuDevice, geometry: &Geometry) -> Result<Self, GpuError> {
        let room = room(&geometry.around);
        let model = geometry.whole_model();
        let counts = Counts::with_room(model.compressed().nodes.len(), model, room);
        let mut arrays = Self {
            vertices: array::empty_texture::<Vertex>(gpu, "the model's vertices", counts.vertices),
            slots: array::empty_texture::<u32>(gpu, "the model's material slots", counts.triangles),
            form: Form::of(gpu, geometry),
            room,
            ..Self::empty(gpu)?
        };
        let names = ["the BVH", "the model's triangles"];
        if arrays.form == Form::Textures {
            arrays.textures = [
                array::empty_texture::<NodeWords>(gpu, names[0], counts.nodes),
                array::empty_texture::<Triangle>(gpu, names[1], counts.triangles),
            ];
        } else {
            let bytes = counts.buffer_bytes();
            let built_over = match arrays.form {
                Form::Structures => wgpu::BufferUsages::BLAS_INPUT,
                _ => wgpu::BufferUsages::empty(),
            };
            arrays.buffers = [
                gpu.empty_storage(names[0], bytes[0])?,
                gpu.storage(names[1], bytes[1], built_over)?,
            ];
        }
        arrays.write(gpu, model, Counts::default())?;
        arrays.write_around(gpu, geometry)?;
        if arrays.form == Form::Structures {
            arrays.structures = Some(Structures::new(gpu, geometry, &arrays.buffers[1], None));
        }
        Ok(arrays)
    }

    /// The same model with other surroundings, which overwrite the old ones. They must fit.
    pub fn with_around(&self, gpu: &GpuDevice, geometry: &Geometry) -> Result<Self, GpuError> {
        self.write_around(gpu, geometry)?;
        let structures = self.structures.as_ref();
        Ok(Self {
            structures: structures.map(|old| Structures::new(gpu, geometry, &self.buffers[1], Some(old))),
            ..self.clone()
        })
    }

    /// Whether other surroundings of the same model fit in place of the current ones.
    pub fn has_room_for(&self, gpu: &GpuDevice, geometry: &Geometry) -> bool {
        self.room == room(&geometry.around) && self.form == Form::of(gpu, geometry)
    }

    /// Uploads the surroundings over the current ones. They must fit.
    pub fn write_around(&self, gpu: &GpuDevice, geometry: &Geometry) -> Result<(), GpuError> {
        self.write(gpu, &geometry.around, Counts::of(geometry.whole_model()))
    }

    /// Brings a part to the GPU, after so much else.
    fn write(&self, gpu: &GpuDevice, part: &Part, before: Counts) -> Result<(), GpuError> {
        let compressed = part.compressed();
        let count = compressed.triangles.len();
        let nodes: &[NodeWords] = bytemuck::cast_slice(&compressed.nodes);
        let nodes = Values::made(nodes.len(), |place| before.node(nodes[place]));
        let triangles = Values::made(count, |place| before.triangle(layout::triangle(part, place)));
        let vertices = Values::of(&part.vertices);
        let slots = Values::made(count, |place| part.slots[compressed.triangles[place] as usize]);
        array::write_texture(gpu, &self.vertices, before.vertices, &vertices)?;
        array::write_texture(gpu, &self.slots, before.triangles, &slots)?;
        if self.form == Form::Textures {
            array::write_texture(gpu, &self.textures[0], before.nodes, &nodes)?;
            array::write_texture(gpu, &self.textures[1], before.triangles, &triangles)
        } else {
            array::write_buffer(gpu, &self.buffers[0], before.nodes, &nodes)?;
            array::write_buffer(gpu, &self.buffers[1], before.triangles, &triangles)
        }
    }
}

/// Triangles reserved for the surroundings.
fn room(around: &Part) -> usize {
    around.triangles.len().next_power_of_two().max(ROOM)
}

/// Elements of the arrays.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    nodes: usize,
    triangles: usize,
    vertices: usize,
}

impl Counts {
    /// Sizes of a part.
    fn of(part: &Part) -> Self {
        Self {
            nodes: part.compressed().nodes.len(),
            triangles: part.triangles.len(),
            vertices: part.vertices.len(),
        }
    }

    /// Sizes with `nodes` nodes and room for `room` triangles.
    fn with_room(nodes: usize, part: &Part, room: usize) -> Self {
        Self {
            nodes: nodes + room,
            triangles: part.triangles.len() + room,
            vertices: part.vertices.len() + 3 * room,
        }
    }

    /// Bytes of nodes and triangles in buffers.
    fn buffer_bytes(self) -> [u64; 2] {
        let bytes = [
            self.nodes * size_of::<NodeWords>(),
            self.triangles * size_of::<Triangle>(),
        ];
        bytes.map(|bytes| bytes as u64)
    }

    /// A node whose children and triangles come after so many others.
    fn node(self, mut node: NodeWords) -> NodeWords {
        node[1][0] += self.nodes as u32;
        node[1][1] += self.triangles as u32;
        node
    }

    /// A triangle whose vertices come after so many others.
    fn triangle(self, mut triangle: Triangle) -> Triangle {
        for corner in &mut triangle.corners {
            corner[3] += self.vertices as u32;
        }
        triangle
    }
}

/// A node of the hierarchy, whole texels of 16 bytes: the second begins with the first of its children and of its triangles.
type NodeWords = [[u32; 4]; 5];
