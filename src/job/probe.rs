//! Single functions of the optics and the traversal asked about inputs of one's own, whichever engine answers: what hard
//! cases are made of. Questions are rows of words as `shaders/pass/probe.wgsl` reads them.

use bytemuck::{Pod, Zeroable};

use crate::optics::lobe::LobeShape;
use crate::optics::material::Material;
use crate::optics::vector::Vec3;
use crate::scene::Geometry;

/// What the questions refer to.
#[derive(Clone, Copy, Debug)]
pub struct ProbeScene<'a> {
    /// Custom curves and albedo tables.
    pub tables: &'a [f32],
    /// The materials that questions count.
    pub materials: &'a [Material<f32>],
    /// What rays meet, if anything.
    pub geometry: Option<&'a Geometry>,
}

/// Nothing but a table of one number.
impl Default for ProbeScene<'_> {
    fn default() -> Self {
        Self {
            tables: &[],
            materials: &[],
            geometry: None,
        }
    }
}

/// A lobe, seen from somewhere: what does it draw for these numbers, and what is its value in a direction?
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct LobeQuestion {
    /// The lobe as a number.
    pub lobe: u32,
    /// The curve as a number.
    pub curve: u32,
    /// The horizon policy as a number.
    pub horizon: u32,
    /// Where the custom curve's table begins.
    pub table: u32,
    /// Roughness in [0, 1].
    pub roughness: f32,
    /// Stretch in [−1, 1].
    pub anisotropy: f32,
    /// 0 where the lobe reflects, else the relative index of refraction.
    pub eta: f32,
    /// Unit shading normal.
    pub shading: Vec3<f32>,
    /// Unit geometric normal.
    pub normal: Vec3<f32>,
    /// Towards the viewer.
    pub wo: Vec3<f32>,
    /// The numbers to draw with, in [0, 1).
    pub xi: [f32; 3],
    /// Towards the light.
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

/// What a lobe answers.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct LobeAnswer {
    /// The direction drawn.
    pub wi: Vec3<f32>,
    /// Its weight.
    pub weight: f32,
    /// (Evaluate, density) of the direction drawn.
    pub drawn: [f32; 2],
    /// (Evaluate, density) of the direction asked about.
    pub given: [f32; 2],
}

/// Fresnel's equations.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct FresnelQuestion {
    /// 0: a dielectric. 1: a conductor.
    pub model: u32,
    /// On the incident side, in [0, 1].
    pub cosine: f32,
    /// Index of refraction behind the boundary over that before it, or its real part.
    pub eta: f32,
    /// Its imaginary part.
    pub k: f32,
}

/// A pair of random numbers.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct RandomQuestion {
    /// Pixel.
    pub pixel: [u32; 2],
    /// Seed of the render.
    pub seed: u32,
    /// Index of the sample.
    pub sample: u32,
    /// The sequence as a number.
    pub sequence: u32,
    /// Which pair.
    pub dimension: u32,
}

/// A material seen from somewhere and lit from somewhere.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct MaterialQuestion {
    /// Which of [`ProbeScene::materials`].
    pub material: u32,
    /// 1 where the viewer is within the solid.
    pub is_inside: u32,
    /// Unit shading normal.
    pub shading: Vec3<f32>,
    /// Unit geometric normal.
    pub normal: Vec3<f32>,
    /// Towards the viewer.
    pub wo: Vec3<f32>,
    /// Towards the light.
    pub wi: Vec3<f32>,
    /// Density with which the light was drawn.
    pub light_density: f32,
}

/// A ray in the geometry's units.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct RayQuestion {
    /// Where it starts.
    pub origin: [f32; 3],
    /// Where it goes; any length but 0.
    pub direction: [f32; 3],
    /// How far, in lengths of the direction.
    pub t_max: f32,
}

/// The answer of a ray that meets nothing.
pub const NO_HIT: u32 = u32::MAX;

/// What a ray meets first.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct RayAnswer {
    /// Which triangle, or [`NO_HIT`].
    pub triangle: u32,
    /// Distance in lengths of the direction.
    pub t: f32,
}
