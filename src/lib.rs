//! Glossmith: a material editor around the geometric lobe.
//!
//! The modules, in the order in which they may use each other:
//! [`optics`] ← [`scene`] ← [`job`] ← [`cpu`], [`gpu`] ← [`render`] ← [`study`] ← [`cli`], [`app`] ← `main`, and between
//! [`job`] and [`render`] also [`analysis`] ← [`plot`] ← [`document`] ← [`matching`], [`compile`] ← [`store`]; [`import`], after [`scene`],
//! reads files.

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub use glossmith_engine::{analysis, cpu, gpu, instructions, job, named, optics, panics, parallel, scene};
pub use glossmith_import as import;

pub mod console;

pub mod plot;

pub mod compile;
pub mod document;
pub mod matching;
pub mod store;

pub mod render;
pub mod study;

#[cfg(feature = "window")]
pub mod app;
pub mod cli;

/// What an error says.
pub(crate) fn in_words(error: impl std::fmt::Display) -> String {
    error.to_string()
}
