//! The integration tests, in one binary.

#[path = "suite/environment.rs"]
mod environment;
#[path = "suite/environment_files.rs"]
mod environment_files;
#[path = "suite/environment_twin.rs"]
mod environment_twin;
