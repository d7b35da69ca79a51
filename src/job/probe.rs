//! Single functions of the optics and the traversal on given inputs, on either engine, for tests of hard cases. Inputs are
//! rows of words as `shaders/pass/probe.wgsl` reads them.

use bytemuck::Zeroable as _;

use crate::{
    optics::{lobe::LobeShape, material::Material, vector::Vec3},
    scene::Geometry,
};

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

plain! {
    /// Input of a lobe: random numbers to sample with, and a direction to evaluate, for a view.
    struct LobeQuestion {
        /// The lobe as a number.
        lobe: u32,
        /// The curve as a number.
        curve: u32,
        /// The horizon policy as a number.
        horizon: u32,
        /// Start of the custom curve's table.
        table: u32,
        /// Roughness in [0, 1].
        roughness: f32,
        /// Stretch in [−1, 1].
        anisotropy: f32,
        /// Relative index of refraction; 0 for reflection.
        eta: f32,
        /// Unit shading normal.
        shading: Vec3<f32>,
        /// Unit geometric normal.
        normal: Vec3<f32>,
        /// Unit direction to the viewer.
        wo: Vec3<f32>,
        /// The numbers to draw with, in [0, 1).
        xi: [f32; 3],
        /// Unit direction to the light.
        wi: Vec3<f32>,
    }
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

plain! {
    /// Output of a lobe.
    struct LobeAnswer {
        /// Sampled direction.
        wi: Vec3<f32>,
        /// Weight of the sample.
        weight: f32,
        /// (Evaluate, density) of the direction drawn.
        drawn: [f32; 2],
        /// (Evaluate, density) of the direction asked about.
        given: [f32; 2],
    }

    /// Input of the Fresnel equations.
    struct FresnelQuestion {
        /// 0: a dielectric. 1: a conductor. 2 and 3: the same under a thin film.
        model: u32,
        /// On the incident side, in [0, 1].
        cosine: f32,
        /// Index of refraction behind the boundary over that before it, or its real part.
        eta: f32,
        /// Imaginary part of the index of refraction.
        k: f32,
        /// Weight of the thin film, its index of refraction, and the phase of a crossing at normal incidence over that.
        film: [f32; 3],
    }

    /// A pair of random numbers.
    struct RandomQuestion {
        /// Pixel coordinates (x, y).
        pixel: [u32; 2],
        /// Seed of the render.
        seed: u32,
        /// Index of the sample.
        sample: u32,
        /// The sequence as a number.
        sequence: u32,
        /// Dimension: index of the pair.
        dimension: u32,
    }

    /// A material seen from somewhere.
    struct MaterialView {
        /// Index into [`ProbeScene::materials`].
        material: u32,
        /// 1 if the viewer is inside the solid.
        is_inside: u32,
        /// Unit shading normal, on the side of the viewer.
        shading: Vec3<f32>,
        /// Unit tangent of the shading frame, rotation applied; perpendicular to `shading`.
        tangent: Vec3<f32>,
        /// Unit geometric normal, on the side of the viewer.
        normal: Vec3<f32>,
        /// Unit direction to the viewer.
        wo: Vec3<f32>,
    }

    /// A material lit from somewhere.
    struct MaterialQuestion {
        /// The material and the viewer.
        view: MaterialView,
        /// Unit direction to the light.
        wi: Vec3<f32>,
        /// Density with which the light was drawn.
        light_density: f32,
        /// 1 if the material's own density enters the MIS weight, or 0.
        competing: f32,
    }

    /// The random numbers that draw a direction from a material.
    struct DrawQuestion {
        /// The material and the viewer.
        view: MaterialView,
        /// See [`MaterialNumbers::lobe`](crate::optics::layer::MaterialNumbers::lobe).
        lobe: [f32; 3],
        /// See [`MaterialNumbers::facet`](crate::optics::layer::MaterialNumbers::facet).
        facet: f32,
        /// See [`MaterialNumbers::below`](crate::optics::layer::MaterialNumbers::below).
        below: [f32; 3],
    }

    /// A direction drawn from a material.
    struct DrawAnswer {
        /// Unit direction to the light.
        wi: Vec3<f32>,
        /// Value over density, linear RGB; 0 if absorbed.
        throughput: Vec3<f32>,
    }

    /// A ray in the geometry's units.
    struct RayQuestion {
        origin: [f32; 3],
        /// Ray direction, of any length but 0.
        direction: [f32; 3],
        /// Ray length, in lengths of the direction.
        t_max: f32,
    }
}

/// Triangle index of a miss.
pub const NO_HIT: u32 = u32::MAX;

plain! {
    /// Closest hit of a ray.
    struct RayAnswer {
        /// Triangle index, or [`NO_HIT`].
        triangle: u32,
        /// Distance in lengths of the direction.
        t: f32,
    }
}
