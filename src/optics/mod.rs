//! The mathematics of reflection: no GPU, no window, no files.
//!
//! Every function here that the renderer runs on the GPU has a WGSL twin with the same name at the same relative path
//! below `shaders/`. Conventions: directions are unit vectors pointing away from the surface; `wo` is towards the
//! viewer, `wi` towards the light; evaluating a lobe includes the cosine; a density is per steradian.

pub mod real;
pub mod vector;
