//! The session over an engine, which the window, the command line and the tests use.
//!
//! `submit` a document, `step` with a time budget until `progress` is done, read `film` or `image`.

mod assets;
pub mod background;
mod calibration;
pub mod check;
mod choice;
mod chosen;
mod compile;
mod convergence;
pub mod denoise;
pub mod display;
mod engine;
pub mod environment_thumbnails;
mod error;
pub mod evaluate;
pub mod explain;
pub mod hard;
mod lens;
pub mod looks;
pub mod memory;
pub mod output;
mod picture_cache;
pub mod precision;
pub mod priority;
pub mod probe;
mod progress;
pub mod queue;
pub mod quiet;
mod ray_queries;
pub mod samples;
pub mod seen_map;
mod session;
pub mod shown;
mod step_denoiser;
pub mod study;
pub mod sums;
pub mod thumbnails;
pub mod to_end;
pub mod turntable;
pub mod worker;
mod workshop;

pub use assets::{Assets, Reloaded};
pub use choice::Sampler;
pub use convergence::Measurement;
pub use engine::{EngineChoice, EngineInfo, EngineKind, Precision};
pub use error::SessionError;
pub use output::Layers;
pub use progress::{Progress, StopReason};
pub use ray_queries::RayQueries;
pub use session::Session;
pub use step_denoiser::StepDenoiser;
