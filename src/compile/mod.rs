//! What a document compiles to: the materials as the integrators read them, and the job, of assets that are loaded once.

mod assets;
mod error;
mod job;
mod materials;

pub use assets::{Assets, Reloaded};
pub use error::AssetError;
pub use job::{Compiler, slot_materials, user_texture_files};
pub use materials::{compile, compile_textured};
