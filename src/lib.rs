//! Glossmith: a material editor around the geometric lobe.
//!
//! The modules, in the order in which they may use each other:
//! [`optics`] ← [`scene`], [`analysis`] ← [`document`] ← [`cpu`], [`gpu`] ← [`render`] ← [`cli`], [`app`] ← `main`.

pub mod optics;

pub mod analysis;
pub mod scene;

pub mod document;

pub mod cpu;
pub mod gpu;

pub mod render;

pub mod app;
pub mod cli;
