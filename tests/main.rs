//! All integration tests: one binary, so that they link once.

#[path = "suite/layouts.rs"]
mod layouts;
#[path = "suite/shaders.rs"]
mod shaders;
#[path = "suite/twins/mod.rs"]
mod twins;
