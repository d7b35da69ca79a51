//! The mathematics of reflection: no GPU, no window, no files.
//!
//! Every function here that the renderer runs on the GPU has a WGSL twin at the same relative path below `shaders/`;
//! `lobe::ggx::density` is `ggx_density` there, since WGSL has one namespace. Conventions: directions are unit vectors
//! pointing away from the surface; `wo` is towards the viewer, `wi` towards the light; evaluating a lobe includes the
//! cosine; a density is per steradian.

pub mod albedo;
pub mod blackbody;
pub mod chord;
pub mod coat_medium;
pub mod curve;
pub mod elementary;
pub mod frame;
pub mod fresnel;
mod fresnel_terms;
pub mod lanes;
pub mod layer;
pub mod lobe;
pub mod material;
pub mod microfacet;
pub mod numeric;
pub mod primaries;
pub mod random;
pub mod real;
pub mod refraction;
pub mod rough_diffuse;
mod scalar;
pub mod scattering;
pub mod table;
pub mod target;
pub mod thin_film;
pub mod tone;
pub mod vector;
pub mod warp;

/// What all code on numbers uses.
pub(crate) mod prelude {
    pub use super::elementary::Single;
    pub use super::real::{Mask, Real, Scalar};
    pub(crate) use super::real::{inlined, mapped, out_of_line, vectorized};
    pub use super::vector::{Vec3, vec3};
}
