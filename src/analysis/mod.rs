//! Numbers about pictures and samples.

pub mod film;
