//! What is edited and its files, a package of its own (`src/files/Cargo.toml`).
//!
//! The modules, in the order in which they may use each other: [`plot`], [`document`] ← [`compile`], [`matching`] ← [`store`].

#![deny(clippy::print_stdout, clippy::print_stderr)]

use glossmith_engine::{analysis, job, named, optics, panics, parallel, scene};
use glossmith_import as import;

pub mod plot;

pub mod document;

pub mod compile;

pub mod matching;

pub mod store;

/// What an error says.
pub fn in_words(error: impl std::fmt::Display) -> String {
    error.to_string()
}
