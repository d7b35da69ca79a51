//! The scene: models and their sources, hierarchies, lights, environments and textures.

mod alias;
mod basis;
mod budget;
pub mod camera;
pub mod catcher;
mod coarse;
mod convex;
pub mod endings;
pub mod environment;
pub mod facing;
mod file_parameter;
mod files;
mod float_tiff;
mod geometry;
mod gltf;
mod gpu_picture;
pub mod ground;
mod hierarchy;
mod import;
mod intersect;
pub mod inversion;
pub mod light;
mod loading;
pub mod medium;
mod memory;
pub mod mesh;
mod model;
mod obj;
mod part;
pub mod picture;
mod ply;
pub mod report;
pub mod resource;
mod rle_bmp;
pub mod shapes;
mod stage;
mod still_life;
mod stl;
pub mod surface;
mod tangents;
pub mod teapot;
pub mod texture;

pub use budget::{Budget, LIMIT_VARIABLE, OverBudget};
pub use file_parameter::{FileParameter, Goes};
pub use geometry::{Geometry, NO_OBJECT};
pub use gltf::{GLTF_PARAMETERS, Widths, gltf_from_widths, kept_keys, widths_from_gltf};
pub use hierarchy::{Compressed, OCTANTS, PACKET, Packet, ray_octant};
pub use import::{holds_model, is_model};
pub use intersect::{Hit, RayFrame, intersect_triangle, triangle_normal};
pub use loading::{Cancelled, Loading};
pub use model::{
    AlphaMode, Filter, Model, ModelError, ModelObject, ModelOptions, ModelSource, Slot, Texture, TextureRef, Wrap,
    load, load_watched, load_with,
};
pub use obj::MTL_PARAMETERS;
pub use part::{Part, Vertex};
pub use report::{Entry, Fate, ImportReport};
pub use stage::{LIGHTS_MAX, LightKind, ModelCamera, ModelLens, ModelLight};
