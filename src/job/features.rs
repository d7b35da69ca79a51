//! What the camera sees first at each pixel: albedo, normal, depth. For compositing and denoising.

/// Means over some samples of each pixel; row by row from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Features {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// The share of the light that the surface reflects or lets through, linear Rec. 709, premultiplied by the share of
    /// the pixel that is covered: 0 where nothing is met.
    pub albedo: Vec<[f32; 3]>,
    /// Shading normal in the world, towards the viewer; shorter than 1 where normals differ or the pixel is not covered.
    pub normal: Vec<[f32; 3]>,
    /// Distance from the camera along its axis, in the model's units, over the covered part of the pixel; infinite where
    /// nothing is met.
    pub depth: Vec<f32>,
}

/// The sums over the samples of a pixel, as both engines make them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FeatureSums {
    /// Sum of the albedos, then the number of samples that met something.
    pub albedo_hits: [f32; 4],
    /// Sum of the normals, then of the depths in the geometry's units.
    pub normal_depth: [f32; 4],
}

impl Features {
    /// The means of sums over `samples` a pixel; `world_units_per_unit` is the geometry's.
    pub fn from_sums([width, height]: [u32; 2], sums: &[FeatureSums], samples: u32, world_units_per_unit: f64) -> Self {
        let per_sample = 1.0 / samples.max(1) as f32;
        let mean = |[x, y, z, _]: [f32; 4]| [x, y, z].map(|sum| sum * per_sample);
        let depth = |sums: &FeatureSums| match sums.albedo_hits[3] {
            hits if hits > 0.0 => (f64::from(sums.normal_depth[3] / hits) * world_units_per_unit) as f32,
            _ => f32::INFINITY,
        };
        Self {
            width,
            height,
            albedo: sums.iter().map(|sums| mean(sums.albedo_hits)).collect(),
            normal: sums.iter().map(|sums| mean(sums.normal_depth)).collect(),
            depth: sums.iter().map(depth).collect(),
        }
    }
}
