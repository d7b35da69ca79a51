//! Proof by numbers: quadrature, χ² tests of samples against densities, histograms, and errors of images.
//!
//! Everything here is f64 and takes plain directions and slices, so that samples of either engine can be tested.

pub mod chi_square;
pub mod error;
pub mod histogram;
pub mod quadrature;
