//! Tests that compute with the engine's generic functions, in f64 or in lanes, and so compile them again.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod coat;
mod density;
mod elementary;
mod facets;
mod lanes;
mod layouts;
mod lobe_cases;
mod material_samples;
mod shaders;
mod statistics;
#[allow(dead_code, reason = "most of it is for the other tests")]
#[path = "../suite/support.rs"]
mod support;
mod twins;
mod walk;
