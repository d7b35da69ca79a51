//! What is kept in files: projects, presets and the user's folder of them, images with a document inside, copies of
//! unsaved documents, pinned states; materials in other programs' formats; examples to begin with;
//! folders that are watched; tables of colours.

mod error;
pub mod examples;
pub mod exchange;
pub mod file;
pub mod file_kind;
pub mod library;
pub mod lut;
#[cfg_attr(not(feature = "video"), path = "mp4_not_built.rs")]
mod mp4;
pub mod opened;
mod own;
pub mod picture;
pub mod preset;
pub mod project;
pub mod recovery;
pub mod replace;
pub mod shelf;
pub mod snapshots;
pub mod video;

pub use error::FileError;
pub use file::Loaded;
pub use preset::{PRESETS, load_material, material_by_name, save_material};
pub use project::{load_document, save_document};
