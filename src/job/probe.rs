//! Single functions of the optics and the traversal on given inputs, on either engine, for tests of hard cases. Inputs are
//! rows of words as `shaders/pass/probe.wgsl` reads them.

use bytemuck::{Pod, Zeroable};

use crate::optics::lobe::LobeShape;
use crate::optics::material::Material;
use crate::optics::vector::Vec3;
use crate::scene::Geometry;

/// Scene data that the inputs refer to.
#[derive(Clone, Copy, Debug)]
pub struct ProbeScene<'a> {
    /// Custom curves and albedo tables.
    pub tables: &'a [f32],
    /// The materials that questions count.
    pub materials: &'a [Material<f32>],
    /// The geometry, if any.
    pub geometry: Option<&'a Geometry>,
}

/// Only a table of one number.
impl Default for ProbeScene<'_> {
    fn default() -> Self {
        Self {
            tables: &[],
            materials: &[],
            geometry: None,
        }
    }
}

/// Input of a lobe: random numbers to sample with, and a direction to evaluate, for a view.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct LobeQuestion {
    /// The lobe as a number.
    pub lobe: u32,
    /// The curve as a number.
    pub curve: u32,
    /// The horizon policy as a number.
    pub horizon: u32,
    /// Start of the custom curve's table.
    pub table: u32,
    /// Roughness in [0, 1].
    pub roughness: f32,
    /// Stretch in [−1, 1].
    pub anisotropy: f32,
    /// Relative index of refraction; 0 for reflection.
    pub eta: f32,
    /// Unit shading normal.
    pub shading: Vec3<f32>,
    /// Unit geometric normal.
    pub normal: Vec3<f32>,
    /// Unit direction to the viewer.
    pub wo: Vec3<f32>,
    /// The numbers to draw with, in [0, 1).
    pub xi: [f32; 3],
    /// Unit direction to the light.
    pub wi: Vec3<f32>,
}

impl LobeQuestion {
    /// Asks about a shape whose table, if it has one, begins at `table`.
    pub fn about(shape: &LobeShape<'_, f32>, table: u32) -> Self {
        Self {
            lobe: shape.lobe as u32,
            curve: shape.curve as u32,
            horizon: shape.horizon as u32,
            table,
            roughness: shape.roughness,
            anisotropy: shape.anisotropy,
            eta: shape.eta,
            ..Self::zeroed()
        }
    }
}

/// Output of a lobe.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct LobeAnswer {
    /// Sampled direction.
    pub wi: Vec3<f32>,
    /// Weight of the sample.
    pub weight: f32,
    /// (Evaluate, density) of the direction drawn.
    pub drawn: [f32; 2],
    /// (Evaluate, density) of the direction asked about.
    pub given: [f32; 2],
}

/// Input of the Fresnel equations.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct FresnelQuestion {
    /// 0: a dielectric. 1: a conductor. 2 and 3: the same under a thin film.
    pub model: u32,
    /// On the incident side, in [0, 1].
    pub cosine: f32,
    /// Index of refraction behind the boundary over that before it, or its real part.
    pub eta: f32,
    /// Imaginary part of the index of refraction.
    pub k: f32,
    /// Weight of the thin film, its index of refraction, and the phase of a crossing at normal incidence over that.
    pub film: [f32; 3],
}

/// A pair of random numbers.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct RandomQuestion {
    /// Pixel coordinates (x, y).
    pub pixel: [u32; 2],
    /// Seed of the render.
    pub seed: u32,
    /// Index of the sample.
    pub sample: u32,
    /// The sequence as a number.
    pub sequence: u32,
    /// Dimension: index of the pair.
    pub dimension: u32,
}

/// A material seen from somewhere.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct MaterialView {
    /// Index into [`ProbeScene::materials`].
    pub material: u32,
    /// 1 if the viewer is inside the solid.
    pub is_inside: u32,
    /// Unit shading normal, on the side of the viewer.
    pub shading: Vec3<f32>,
    /// Unit tangent of the shading frame, rotation applied; perpendicular to `shading`.
    pub tangent: Vec3<f32>,
    /// Unit geometric normal, on the side of the viewer.
    pub normal: Vec3<f32>,
    /// Unit direction to the viewer.
    pub wo: Vec3<f32>,
}

/// A material lit from somewhere.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct MaterialQuestion {
    /// The material and the viewer.
    pub view: MaterialView,
    /// Unit direction to the light.
    pub wi: Vec3<f32>,
    /// Density with which the light was drawn.
    pub light_density: f32,
    /// 1 if the material's own density enters the MIS weight, or 0.
    pub competing: f32,
}

/// The random numbers that draw a direction from a material.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct DrawQuestion {
    /// The material and the viewer.
    pub view: MaterialView,
    /// See [`MaterialNumbers::lobe`](crate::optics::layer::MaterialNumbers::lobe).
    pub lobe: [f32; 3],
    /// See [`MaterialNumbers::facet`](crate::optics::layer::MaterialNumbers::facet).
    pub facet: f32,
    /// See [`MaterialNumbers::below`](crate::optics::layer::MaterialNumbers::below).
    pub below: [f32; 3],
}

/// A direction drawn from a material.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct DrawAnswer {
    /// Unit direction to the light.
    pub wi: Vec3<f32>,
    /// Value over density, linear RGB; 0 if absorbed.
    pub throughput: Vec3<f32>,
}

/// A ray in the geometry's units.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct RayQuestion {
    pub origin: [f32; 3],
    /// Ray direction, of any length but 0.
    pub direction: [f32; 3],
    /// Ray length, in lengths of the direction.
    pub t_max: f32,
}

/// Triangle index of a miss.
pub const NO_HIT: u32 = u32::MAX;

/// Closest hit of a ray.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct RayAnswer {
    /// Triangle index, or [`NO_HIT`].
    pub triangle: u32,
    /// Distance in lengths of the direction.
    pub t: f32,
}
