//! What is edited and saved, and what it compiles to.

pub mod job;
pub mod plan;
