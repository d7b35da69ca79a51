//! Models: sources, and the loaded mesh with material slots and texture maps.

use std::{fmt, ops::Range, path::PathBuf};

use serde::{Deserialize, Serialize};

use super::{
    mesh::{Mesh, MeshInstance},
    path_text::path_of_text,
    report::ImportReport,
    shapes,
    stage::{ModelCamera, ModelLight},
    still_life, teapot,
    texture::{WRAP_CLAMP, WRAP_MIRRORED, WRAP_REPEAT},
};
use crate::{named::with_defaults, optics::target::TextureTarget};

/// Source of a model. On the command line and in files it is `teapot`, `sphere`, `plane`, `shaderball` or a path; a file of
/// such a name is written with its folder (`./teapot`).
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(from = "String", into = "String")]
pub enum ModelSource {
    /// The Utah teapot, about 40 000 triangles.
    #[default]
    Teapot,
    /// The unit sphere around the origin.
    Sphere,
    /// The square [−1, 1]² in the plane y = 0, facing up.
    Plane,
    /// A ball with an inset band that shows its core, on a stand.
    Shaderball,
    /// A teapot, a bowl, a ball and a bead, each in a slot of its own.
    StillLife,
    /// A file of one of the formats that are read, or a folder with such files.
    File(PathBuf),
}

const BUILT_IN: [(&str, ModelSource); 5] = [
    ("teapot", ModelSource::Teapot),
    ("sphere", ModelSource::Sphere),
    ("plane", ModelSource::Plane),
    ("shaderball", ModelSource::Shaderball),
    ("still-life", ModelSource::StillLife),
];

impl From<&str> for ModelSource {
    fn from(text: &str) -> Self {
        let built_in = BUILT_IN.into_iter().find(|(name, _)| *name == text);
        built_in.map_or_else(|| Self::File(path_of_text(text)), |(_, source)| source)
    }
}

impl From<String> for ModelSource {
    fn from(text: String) -> Self {
        Self::from(text.as_str())
    }
}

impl fmt::Display for ModelSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) if BUILT_IN.iter().any(|(name, _)| path.as_os_str() == *name) => {
                write!(f, "./{}", path.display())
            }
            Self::File(path) => write!(f, "{}", path.display()),
            _ => f.write_str(
                BUILT_IN
                    .iter()
                    .find(|(_, source)| source == self)
                    .map_or("", |(name, _)| name),
            ),
        }
    }
}

impl From<ModelSource> for String {
    fn from(source: ModelSource) -> Self {
        source.to_string()
    }
}

/// A mesh with the materials that its file gives it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// The built-in name, or the file's name without folder and extension.
    pub name: String,
    /// The triangles of all nodes together, without the repeated meshes.
    pub mesh: Mesh,
    /// Meshes with many instances, each in a space of its own and with slots as in `mesh`.
    pub repeated: Vec<Mesh>,
    /// Instances of `repeated`.
    pub instances: Vec<MeshInstance>,
    /// The material slots that `mesh.slots` counts.
    pub slots: Vec<Slot>,
    /// Texture maps of the slots.
    pub textures: Vec<Texture>,
    /// The objects that its triangles belong to, in the triangles' order.
    pub objects: Vec<ModelObject>,
    pub report: ImportReport,
    /// The middle of its bounding box; 0 for built-in models, whose file has no lights or cameras.
    pub center: [f64; 3],
    /// Distance from there to the farthest vertex.
    pub radius: f64,
    /// The cameras of the scene.
    pub cameras: Vec<ModelCamera>,
    /// The lights of the scene.
    pub lights: Vec<ModelLight>,
    /// Names of the variants of its materials (KHR_materials_variants).
    pub variants: Vec<String>,
    /// Names of the scenes in the file.
    pub scenes: Vec<String>,
    /// Length of the first animation in seconds; 0 without one.
    pub duration_s: f32,
    /// Files that were read, and missing ones that it names.
    pub files: Vec<PathBuf>,
}

/// A part of a model that has a name: a node of a glTF file, an object or group of an OBJ file, else the whole.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ModelObject {
    /// Name in the file.
    pub name: String,
    /// Triangle range in the mesh.
    pub triangles: Range<usize>,
}

impl Model {
    /// The built-in model of a source; `None` for a file.
    pub fn built_in(source: &ModelSource) -> Option<Self> {
        let (mesh, slots): (Mesh, &[&str]) = match source {
            ModelSource::Teapot => (teapot::mesh(teapot::DEFAULT_SEGMENTS), &["teapot"]),
            ModelSource::Sphere => (shapes::sphere(192, 96), &["sphere"]),
            ModelSource::Plane => (shapes::plane(), &["plane"]),
            ModelSource::Shaderball => (shapes::shaderball(), &["body", "stand"]),
            ModelSource::StillLife => (still_life::mesh(), &still_life::PARTS),
            ModelSource::File(_) => return None,
        };
        let mut model = Self {
            name: source.to_string(),
            mesh,
            slots: slots.iter().map(|name| Slot::neutral(name)).collect(),
            ..Self::default()
        };
        if *source == ModelSource::StillLife {
            // Each part is an object, beside its slot.
            let parts = still_life::PARTS.iter().zip(still_life::triangles(&model.mesh));
            model.objects = parts
                .map(|(name, triangles)| ModelObject {
                    name: (*name).to_owned(),
                    triangles,
                })
                .collect();
        }
        model.name_its_whole();
        Some(model)
    }

    /// Makes the whole mesh one object if the file names none.
    pub fn name_its_whole(&mut self) {
        if self.objects.is_empty() {
            self.objects = vec![ModelObject {
                name: self.name.clone(),
                triangles: 0..self.mesh.triangles.len(),
            }];
        }
    }

    /// Appends another model, in its own file's space.
    pub fn join(&mut self, mut other: Self) {
        let (slots, textures) = (self.slots.len() as u32, self.textures.len());
        let meshes = other.repeated.iter_mut().chain([&mut other.mesh]);
        meshes.flat_map(|mesh| &mut mesh.slots).for_each(|slot| *slot += slots);
        let (repeated, objects) = (self.repeated.len(), self.objects.len());
        self.instances.extend(other.instances.drain(..).map(|one| MeshInstance {
            mesh: one.mesh + repeated,
            object: one.object + objects,
            ..one
        }));
        self.repeated.append(&mut other.repeated);
        for slot in &mut other.slots {
            slot.textures
                .iter_mut()
                .flatten()
                .for_each(|reference| reference.texture += textures);
        }
        let first = self.mesh.triangles.len();
        other.name_its_whole();
        self.objects.extend(other.objects.into_iter().map(|object| ModelObject {
            triangles: first + object.triangles.start..first + object.triangles.end,
            ..object
        }));
        self.mesh.append(other.mesh);
        self.slots.extend(other.slots);
        self.textures.extend(other.textures);
        self.report.append(other.report);
        self.cameras.extend(other.cameras);
        self.lights.extend(other.lights);
        self.duration_s = self.duration_s.max(other.duration_s);
    }

    /// Bytes in memory, near enough.
    pub fn bytes(&self) -> usize {
        let pictures: usize = self.textures.iter().map(Texture::bytes).sum();
        let repeated: usize = self.repeated.iter().map(Mesh::bytes).sum();
        self.mesh.bytes() + repeated + pictures
    }
}

with_defaults! {
    /// Options for files with more than one scene, variant or pose.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(default)]
    pub struct ModelOptions {
        /// Scene index; `None` is the file's default.
        pub scene: Option<usize>,
        /// Material variant (KHR_materials_variants); `None` is the file's own materials.
        pub variant: Option<String>,
        /// Time in the first animation, in seconds; `None` is the rest pose.
        pub time_s: Option<f32>,
        /// The longest side of a texture; larger ones are halved until they fit.
        pub texture_side_max: u32 = 8192,
        /// Other files given with it. Models are joined with it; files that it names and that are missing beside it are searched
        /// among the others.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        pub beside: Vec<PathBuf>,
    }
}

with_defaults! {
    /// One material as the file gives it: its numbers by the keys of a material's parameters, with GGX's roughness.
    #[derive(Clone, Debug, PartialEq)]
    pub struct Slot {
        pub name: String = "default".to_owned(),
        /// The number of the material in a glTF file.
        pub file_material: Option<usize>,
        /// What the file says, each key once; a number stands three times. Colours are linear, lengths inside are in bounding radii.
        pub values: Vec<(&'static str, [f32; 3])> = vec![
                    ("base.color", [1.0; 3]),
                    ("base.metalness", [1.0; 3]),
                    ("specular.weight", [1.0; 3]),
                    ("specular.roughness", [1.0; 3]),
                    ("specular.ior", [1.5; 3]),
                    ("emission.color", [0.0; 3]),
                    ("emission.strength", [1.0; 3]),
                ],
        pub alpha_mode: AlphaMode = AlphaMode::Opaque,
        /// Opacity cutoff of [`AlphaMode::Mask`].
        pub alpha_cutoff: f32 = 0.5,
        /// Whether the back of a triangle is seen.
        pub double_sided: bool,
        /// Textures by target, colours in sRGB, normals with green upwards; [`Slot::texture`] knows those that share one.
        pub textures: [Option<TextureRef>; TextureTarget::ALL.len()],
        /// Largest roughness in the texture, in [0, 1]; 1 without one.
        pub roughest_texel: f32 = 1.0,
        /// The thin film's thickness where its texture is 0, over that where it is 1.
        pub thinnest: f32,
        /// Whether vertex colours multiply the base colour, or the emission if unlit.
        pub has_vertex_colors: bool,
        /// Some of these colours have an alpha below 1.
        pub has_vertex_alpha: bool,
        /// Whether it ignores light (KHR_materials_unlit).
        pub is_unlit: bool,
        /// Unsupported parameters, under the keys of a material file.
        pub kept: serde_json::Map<String, serde_json::Value>,
    }
}

impl Slot {
    /// The neutral grey plastic of the built-in models and the ground.
    pub fn neutral(name: &str) -> Self {
        let mut slot = Self {
            name: name.to_owned(),
            ..Self::default()
        };
        slot.set_color("base.color", [0.6; 3]);
        slot.with(&[("base.metalness", 0.0), ("specular.roughness", 0.5)])
    }

    /// The clay of surfaces to which a file gives no material.
    pub fn clay() -> Self {
        Self::neutral("Clay")
    }

    /// Has the surface coloured by its vertices. Clay has no other colour then.
    pub fn color_by_vertices(&mut self) {
        if *self == Self::clay() {
            self.set("base.color", 1.0);
        }
        self.has_vertex_colors = true;
    }

    /// A colour of the file; black where it says none.
    pub fn color(&self, key: &str) -> [f32; 3] {
        self.values
            .iter()
            .find(|(known, _)| *known == key)
            .map_or([0.0; 3], |(_, value)| *value)
    }

    /// A number of the file; 0 where it says none.
    pub fn number(&self, key: &str) -> f32 {
        self.color(key)[0]
    }

    pub fn set_color(&mut self, key: &'static str, value: [f32; 3]) {
        match self.values.iter_mut().find(|(known, _)| *known == key) {
            Some((_, known)) => *known = value,
            None => self.values.push((key, value)),
        }
    }

    pub fn set(&mut self, key: &'static str, value: f32) {
        self.set_color(key, [value; 3]);
    }

    /// The same with these numbers.
    #[must_use]
    pub fn with(mut self, numbers: &[(&'static str, f32)]) -> Self {
        numbers.iter().for_each(|(key, value)| self.set(key, *value));
        self
    }

    /// Multiplies what the file says of a parameter.
    pub fn multiply(&mut self, key: &str, by: [f32; 3]) {
        if let Some((_, value)) = self.values.iter_mut().find(|(known, _)| *known == key) {
            *value = [0, 1, 2].map(|i| value[i] * by[i]);
        }
    }

    /// The texture that a target looks up.
    pub fn texture(&self, target: TextureTarget) -> Option<TextureRef> {
        let is_looked_up = target != TextureTarget::Opacity || self.alpha_mode != AlphaMode::Opaque;
        self.textures[target.home() as usize].filter(|_| is_looked_up)
    }

    /// The texture of a target, and of those that share it, to be changed.
    pub fn texture_mut(&mut self, target: TextureTarget) -> &mut Option<TextureRef> {
        &mut self.textures[target.home() as usize]
    }
}

/// Meaning of a slot's opacity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AlphaMode {
    /// Ignored: the surface is opaque.
    #[default]
    Opaque,
    /// Cut-out: opaque where the opacity reaches the cutoff.
    Mask,
    /// The fraction of light that the surface stops.
    Blend,
}

/// A texture and how the mesh's texture coordinates look into it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// Index into [`Model::textures`].
    pub texture: usize,
    /// Set of texture coordinates: 0 or 1.
    pub uv_set: usize,
    /// Affine map from the mesh's coordinates to the texture's: (m[0]·u + m[1]·v + m[2], m[3]·u + m[4]·v + m[5])
    /// (KHR_texture_transform).
    pub texture_from_mesh_uv: [f32; 6],
    /// Wrap modes in u and v.
    pub wrap: [Wrap; 2],
    pub filter: Filter,
}

/// Filtering between texel centres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// The four around the place, weighed by their nearness.
    #[default]
    Linear,
    /// The texel in which the place is.
    Nearest,
}

/// Wrap mode beyond a texture's edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    #[default]
    Repeat = WRAP_REPEAT as isize,
    MirroredRepeat = WRAP_MIRRORED as isize,
    /// Clamp to the texel at the edge.
    ClampToEdge = WRAP_CLAMP as isize,
}

/// A texture map, encoded as in the file: whether the values are sRGB or linear depends on its use.
#[derive(Clone, Default, PartialEq)]
pub struct Texture {
    /// The image's name, its file or its number.
    pub name: String,
    pub width: u32,
    pub height: u32,
    /// Red, green, blue, opacity of each texel, row by row from the top.
    pub rgba8: Vec<u8>,
    /// The same with 16 bits per channel, for files with more than 8 bits that hold no colours; else empty.
    pub rgba16: Vec<u16>,
}

impl Texture {
    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.rgba8[..]) + size_of_val(&self.rgba16[..])
    }

    /// Largest value of a channel, in [0, 1]; 0 without texels.
    pub fn brightest(&self, channel: usize) -> f32 {
        fn largest<N: Copy + Ord + Into<f32>>(numbers: &[N], channel: usize) -> f32 {
            numbers
                .iter()
                .skip(channel)
                .step_by(4)
                .max()
                .map_or(0.0, |largest| (*largest).into())
        }
        if self.rgba16.is_empty() {
            largest(&self.rgba8, channel) / 255.0
        } else {
            largest(&self.rgba16, channel) / 65535.0
        }
    }

    /// Whether a texel is not opaque.
    pub fn is_translucent(&self) -> bool {
        self.rgba8.iter().skip(3).step_by(4).any(|alpha| *alpha < 255)
    }
}

impl fmt::Debug for Texture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Texture({:?}, {} × {})", self.name, self.width, self.height)
    }
}
