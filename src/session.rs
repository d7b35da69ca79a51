//! How images come about and what is found out with them, a package of its own (`src/session/Cargo.toml`).
//!
//! The modules, in the order in which they may use each other: [`render`] ← [`study`].

#![deny(clippy::print_stdout, clippy::print_stderr)]

use glossmith_engine::{analysis, cpu, job, named, optics, panics, parallel, scene};
use glossmith_files::{compile, document, in_words, matching, plot, store};
use glossmith_gpu as gpu;
use glossmith_import as import;

pub mod render;

pub mod study;
