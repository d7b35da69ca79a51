//! See docs/ARCHITECTURE.md.

#[path = "suite/environment.rs"]
mod environment;
#[path = "suite/environment_files.rs"]
mod environment_files;
#[path = "suite/environment_sampling.rs"]
mod environment_sampling;
#[path = "suite/environment_twin.rs"]
mod environment_twin;
#[path = "suite/geometry.rs"]
mod geometry;
#[path = "suite/gltf.rs"]
mod gltf;
#[path = "suite/gltf_builder.rs"]
mod gltf_builder;
#[path = "suite/gltf_damaged.rs"]
mod gltf_damaged;
#[path = "suite/renders.rs"]
mod renders;
#[path = "suite/support.rs"]
mod support;
#[path = "suite/ui.rs"]
mod ui;
#[path = "suite/worker.rs"]
mod worker;
