//! See docs/ARCHITECTURE.md.

#[path = "suite/geometry.rs"]
mod geometry;
#[path = "suite/gltf.rs"]
mod gltf;
#[path = "suite/gltf_builder.rs"]
mod gltf_builder;
#[path = "suite/gltf_damaged.rs"]
mod gltf_damaged;
#[path = "suite/support.rs"]
mod support;
