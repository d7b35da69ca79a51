//! See docs/ARCHITECTURE.md.

pub mod environment;
