//! Numbers about pictures and samples.

pub mod film;
pub mod fit;
pub mod lobe_model;
pub mod lobe_view;
pub mod plot;
pub mod scatter;
pub mod sphere_grid;
