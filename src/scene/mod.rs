//! What is rendered: meshes and where they come from, the hierarchy that rays find them by, the light around them.

mod alias;
pub mod camera;
mod convex;
pub mod environment;
pub mod facing;
mod files;
mod geometry;
mod gltf;
mod hierarchy;
mod import;
mod intersect;
mod ktx2;
pub mod light;
pub mod mesh;
mod model;
mod obj;
mod picture;
mod ply;
pub mod report;
pub mod shapes;
mod stl;
pub mod surface;
mod tangents;
pub mod teapot;
pub mod texture;

pub use geometry::{Geometry, Vertex};
pub use gltf::{Widths, gltf_from_widths, kept_keys, widths_from_gltf};
pub use hierarchy::Compressed;
pub use import::{MODEL_ENDINGS, is_model};
pub use intersect::{Hit, RayFrame, intersect_triangle, triangle_normal};
pub use model::{
    AlphaMode, Filter, LightKind, Model, ModelCamera, ModelError, ModelLight, ModelOptions, ModelSource, Slot,
    SlotPicture, Texture, TextureRef, Wrap, load, load_with,
};
pub use report::{Entry, Fate, ImportReport};
