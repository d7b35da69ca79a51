//! Numerical analysis: quadrature, χ² tests of samples against densities, histograms, errors of images, and estimates from
//! films and samples.
//!
//! The tests are f64 and take plain directions and slices, so that samples of either engine can be tested.

pub mod adaptive;
pub mod chi_square;
pub mod denoised;
pub mod difference;
pub mod error;
pub mod fit;
mod gamma;
pub mod halves;
pub mod histogram;
pub mod noise;
pub mod quadrature;
pub mod sphere_grid;
