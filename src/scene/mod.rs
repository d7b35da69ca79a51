//! What is rendered: meshes and where they come from, the hierarchy that rays find them by, the light around them.

mod alias;
mod bvh;
pub mod camera;
mod convex;
pub mod environment;
pub mod facing;
mod geometry;
mod gltf;
mod intersect;
pub mod light;
pub mod mesh;
mod model;
pub mod shapes;
pub mod surface;
pub mod teapot;
pub mod texture;
mod traverse;

pub use geometry::{Geometry, Vertex};
pub use intersect::{Hit, RayFrame, intersect_triangle, triangle_normal};
pub use model::{AlphaMode, Filter, Model, ModelError, ModelSource, Slot, Texture, TextureRef, Wrap, load};
