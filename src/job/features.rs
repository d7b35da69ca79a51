//! What the camera sees first at each pixel: albedo, normal, depth. For compositing and denoising.

use super::film::Film;

/// Means over some samples of each pixel; row by row from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Features {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// The share of the light that the surface reflects or lets through, linear Rec. 709, premultiplied by the share of
    /// the pixel that is covered: 0 where nothing is met. In a mirror, and behind clear glass, that of what is seen there.
    pub albedo: Vec<[f32; 3]>,
    /// Shading normal in the world, towards the viewer; shorter than 1 where normals differ or the pixel is not covered.
    pub normal: Vec<[f32; 3]>,
    /// Distance from the camera along its axis, in the model's units, over the covered part of the pixel; infinite where
    /// nothing is met.
    pub depth: Vec<f32>,
}

impl Features {
    /// The means of a film's sums; `world_units_per_unit` is the geometry's. Nothing is seen where the film keeps none.
    pub fn of(film: &Film, world_units_per_unit: f64) -> Self {
        Self::of_samples(film, |pixel| film.guide_samples(pixel), world_units_per_unit)
    }

    /// The same where it is said how many samples of a pixel are in the sums of each half.
    pub fn of_samples(film: &Film, samples: impl Fn(usize) -> [f64; 2], world_units_per_unit: f64) -> Self {
        let mut features = Self {
            width: film.width,
            height: film.height,
            ..Self::default()
        };
        for pixel in 0..film.pixel_count() {
            let [mut sums, odd] = film.guides.get(pixel).copied().unwrap_or_default();
            sums.add(&odd);
            let [albedo, normal] = sums.means(samples(pixel).iter().sum());
            features.albedo.push(albedo);
            features.normal.push(normal);
            features.depth.push(match sums.hits {
                hits if hits > 0.0 => (f64::from(sums.depth / hits) * world_units_per_unit) as f32,
                _ => f32::INFINITY,
            });
        }
        features
    }
}
