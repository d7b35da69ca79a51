//! What Glossmith computes, a package of its own (`src/engine/Cargo.toml`), so that its kernels are compiled in one piece,
//! and not again when anything else changes.
//!
//! The modules, in the order in which they may use each other: [`optics`] ← [`scene`] ← [`job`] ← [`analysis`], [`cpu`].

pub mod named;
pub mod panics;
pub mod parallel;

pub mod instructions;

pub mod optics;
pub mod scene;

pub mod job;

pub mod cpu;

pub mod analysis;
