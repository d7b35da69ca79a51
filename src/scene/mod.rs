//! The scene: what is traced and looked up. Models, hierarchies, lights, environments and textures; files are read elsewhere.

mod alias;
mod area_shape;
pub mod camera;
pub mod catcher;
mod coarse;
mod convex;
pub mod environment;
pub mod facing;
mod geometry;
pub mod ground;
mod hierarchy;
mod intersect;
pub mod inversion;
pub mod light;
mod loading;
pub mod medium;
mod memory;
pub mod mesh;
mod model;
mod part;
pub mod report;
pub mod shapes;
mod stage;
pub mod surface;
mod tangents;
pub mod teapot;
pub mod texture;

pub use area_shape::{AreaFrame, AreaShape, Outline};
pub use geometry::{Framing, Geometry, NO_OBJECT};
pub use hierarchy::{Compressed, OCTANTS, PACKET, Packet, ray_octant};
pub use intersect::{Hit, RayFrame, intersect_triangle, triangle_normal};
pub use loading::{Cancelled, Loading, USUAL};
pub use model::{AlphaMode, Filter, Model, ModelObject, ModelOptions, ModelSource, Slot, Texture, TextureRef, Wrap};
pub use part::{Part, Vertex};
pub use report::{Entry, Fate, ImportReport};
pub use stage::{LIGHTS_MAX, LightKind, ModelCamera, ModelLens, ModelLight};
