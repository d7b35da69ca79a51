//! The engine on the GPU: the only code that talks to wgpu's compute.

mod compute;
pub mod device;
mod engine;
mod generated_shader;
mod kernel_cache;
pub mod layout;
mod pipeline;
pub mod probe;
mod resources;
pub mod sampling;
pub mod scatter;
pub mod shader;
mod timer;

pub use device::{AdapterKind, GpuDevice, GpuError};
pub use engine::GpuEngine;
