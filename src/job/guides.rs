//! First-hit guides: sums over a pixel's first samples, for the denoiser and as layers.

/// Samples per pixel that record guides: the mean over more would hardly change. Even, so that both halves have the same
/// number.
pub const GUIDE_SAMPLES: u32 = 32;

/// Sums of first-hit guides over a pixel's first samples, as both engines compute them: of the even or the odd ones, so that
/// the guides of a half are independent of the other half. Albedo and normal are those of the first surface that is not a
/// mirror or clear glass; depth is the first surface's.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct GuideSums {
    /// Sum of the albedos, each times the throughput of the mirrors and glass before it.
    pub albedo: [f32; 3],
    /// Number of samples with a hit.
    pub hits: f32,
    /// Sum of the shading normals in the world.
    pub normal: [f32; 3],
    /// Sum of the depths, in the geometry's units.
    pub depth: f32,
}

impl GuideSums {
    /// Adds a sample's guides, or other sums.
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
