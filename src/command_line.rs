//! The command line, a package of its own (`src/cli/Cargo.toml`).

#![deny(clippy::print_stdout, clippy::print_stderr)]

use glossmith_engine::{analysis, instructions, job, named, optics, panics, scene};
use glossmith_files::{document, in_words, matching, plot, store};
use glossmith_import as import;
use glossmith_session::{render, study};

pub mod cli;
pub mod console;
