//! The session over an engine, which the window, the command line and the tests use.
//!
//! `submit` a document, `step` with a time budget until `progress` is done, read `film` or `image`.

pub mod background;
mod convergence;
pub mod denoise;
pub mod display;
mod engine;
mod error;
pub mod frame;
mod lens;
pub mod light_layers;
pub mod looks;
pub mod memory;
pub mod output;
pub mod precision_maps;
pub mod priority;
mod progress;
pub mod queue;
pub mod samples;
pub mod seen_map;
mod session;
pub mod shown;
mod step_denoiser;
pub mod sums;
pub mod thumbnails;
pub mod to_end;
pub mod turntable;
pub mod worker;
mod workshop;

pub use crate::compile::{Assets, Reloaded};
pub use convergence::Measurement;
pub use engine::{EngineChoice, EngineInfo, EngineKind, MachineOptions, Precision, Prober, RayQueries, cpu_name};
pub use error::SessionError;
pub use output::Layers;
pub use progress::{Progress, StopReason, beyond_bounces};
pub use session::Session;
pub use step_denoiser::StepDenoiser;
