//! Names on the command line.

/// The choice of this name; the parser of every option that takes one of a closed list.
pub use crate::named::{names, parse as choice};
