//! Glossmith: a material editor around the geometric lobe.
//!
//! The modules, in the order in which they may use each other:
//! [`optics`] ← [`scene`] ← [`job`] ← [`cpu`], [`gpu`] ← [`render`] ← [`cli`], [`app`] ← `main`, and between [`job`] and
//! [`render`] also [`analysis`] ← [`plot`] ← [`document`] ← [`store`].

pub mod named;
pub mod panics;

pub mod instructions;

pub mod optics;
pub mod scene;

pub mod job;

pub mod cpu;
pub mod gpu;

pub mod analysis;
pub mod plot;

pub mod document;
pub mod store;

pub mod render;

#[cfg(feature = "window")]
pub mod app;
pub mod cli;
