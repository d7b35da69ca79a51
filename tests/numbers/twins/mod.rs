//! The shaders' functions against their Rust twins, on the adapter and on the same random inputs.
//!
//! A function's twins agree where their results differ by at most 1e-4 of the larger one (or of the function's stated
//! scale, where results near 0 are rounding noise of larger terms). That is asked of every input at which the function
//! is well-conditioned: where moving all inputs by eight roundings moves the f64 twin by less than half of what is
//! allowed. There must be 10 000 such inputs for each function and each entry of its registry. At the other inputs (next
//! to a jump, at a lobe's edge, where a narrow lobe magnifies the rounding of a direction) the twins may differ by what
//! those roundings do on top.

mod bench;
mod curves;
mod elementary;
mod environment;
pub mod harness;
mod light;
mod lobes;
mod material;
mod refraction;
mod surface;
mod texture;
mod trace;
