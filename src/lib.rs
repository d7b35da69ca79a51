//! Glossmith: a material editor around the geometric lobe. Its packages, under one name: each sees only those before it.

pub use glossmith_cli::{cli, console};
pub use glossmith_engine::{analysis, cpu, instructions, job, named, optics, panics, parallel, scene};
pub use glossmith_files::{compile, document, matching, plot, store};
pub use glossmith_gpu as gpu;
pub use glossmith_import as import;
pub use glossmith_session::{render, study};
#[cfg(feature = "window")]
pub use glossmith_window as app;
