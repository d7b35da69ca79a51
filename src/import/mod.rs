//! Import of models, textures, environments and light profiles from files, a package of its own (`src/import/Cargo.toml`): its decoders are
//! compiled once, and not again when the engine's formulas or the window change.

use glossmith_engine::{optics, panics, parallel, scene};

mod assembly;
pub mod endings;
pub mod environment;
mod fbx;
mod file_parameter;
mod files;
mod gltf;
pub mod light_profile;
pub mod limits;
mod maps;
mod model;
mod model_error;
mod obj;
pub mod picture;
mod ply;
mod polygon;
mod preview_surface;
pub mod remembered;
mod shipped;
mod stl;
#[cfg(feature = "usd")]
pub mod usd;
pub mod xml;

pub use fbx::FBX_PARAMETERS;
pub use file_parameter::{FileParameter, Goes};
pub use gltf::{GLTF_PARAMETERS, Widths, gltf_from_widths, kept_keys, widths_from_gltf};
pub use limits::{Budget, OverBudget};
pub use model::{holds_model, is_model, load, load_watched, load_with};
pub use model_error::ModelError;
pub use obj::MTL_PARAMETERS;
pub use preview_surface::USD_PREVIEW_SURFACE;
