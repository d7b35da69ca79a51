//! The engine on the GPU: the only code that talks to wgpu's compute.

use glossmith_engine::{job, named, optics, panics, parallel, scene};

mod adapter;
mod array;
pub mod budget;
mod compute;
pub mod device;
mod engine;
mod generated_shader;
pub mod geometry_arrays;
mod kernel_cache;
pub mod layout;
mod pipeline;
pub mod probe;
mod resources;
pub mod scene_group;
pub mod shader;
mod structures;
mod sums;
mod timer;
mod traversal;

pub use adapter::{AdapterKind, GpuAdapter};
pub use device::{GpuDevice, GpuError, Moment};
pub use engine::{FLUSH_SAMPLES, GpuEngine, merge_sums};
pub use traversal::Traversal;
