//! What Glossmith computes, a package of its own (`src/engine/Cargo.toml`), so that it is compiled at full optimisation and
//! the rest is not, and that a change of the window does not compile it again.
//!
//! The modules, in the order in which they may use each other:
//! [`optics`] ← [`scene`] ← [`job`] ← [`cpu`], [`gpu`], [`analysis`].

pub mod named;
pub mod panics;
pub mod parallel;

pub mod instructions;

pub mod optics;
pub mod scene;

pub mod job;

pub mod cpu;
pub mod gpu;

pub mod analysis;
