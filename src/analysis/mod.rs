//! Numbers about pictures and samples.

pub mod film;
pub mod plot;
pub mod scatter;
