//! Sums of what a pixel's first samples saw first: guides of the denoiser, and layers of a picture.

/// Samples of a pixel that tell what is seen first: the mean over more would hardly change. Even, as both halves of the
/// samples tell as much.
pub const GUIDE_SAMPLES: u32 = 32;

/// Sums over a pixel's first samples of what they saw first, as both engines make them: of the even ones or the odd ones,
/// so that what leads a half's denoising is independent of the other half. Albedo and normal are those of the first
/// surface that is not a mirror or clear glass; the depth is that of the first surface of all.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct GuideSums {
    /// Sum of the albedos, each times what mirrors and glass before it leave of the light.
    pub albedo: [f32; 3],
    /// How many samples met something.
    pub hits: f32,
    /// Sum of the shading normals in the world.
    pub normal: [f32; 3],
    /// Sum of the depths, in the geometry's units.
    pub depth: f32,
}

impl GuideSums {
    /// Adds what a sample saw, or other sums.
    pub fn add(&mut self, seen: &GuideSums) {
        for i in 0..3 {
            self.albedo[i] += seen.albedo[i];
            self.normal[i] += seen.normal[i];
        }
        self.hits += seen.hits;
        self.depth += seen.depth;
    }

    /// Mean albedo and normal over as many samples.
    pub fn means(&self, samples: f64) -> [[f32; 3]; 2] {
        let per_sample = 1.0 / samples.max(1.0) as f32;
        [self.albedo, self.normal].map(|sum| sum.map(|x| x * per_sample))
    }
}
