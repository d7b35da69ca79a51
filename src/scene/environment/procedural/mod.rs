//! Environments that need no file.

mod rooms;
mod sky;
mod soft_box;
mod studio;

use super::{Environment, MapError, environment_direction_from_angles};
use crate::{optics::vector::Vec3, optics::vector::vec3, parallel, scene::memory::room_in_large_pages};

pub use rooms::{overcast, portrait, product, rim, warehouse};
pub use sky::{SkyParams, sky, sun_direction, sun_irradiance};
pub use studio::studio;

/// The white furnace: radiance 1 from everywhere, on a tiny map.
pub fn furnace() -> Result<Environment, MapError> {
    Environment::from_texels("furnace", 4, 2, vec![[1.0; 4]; 8])
}

/// The texels of a map whose radiance is a function of the direction, taken at the texels' centres.
fn texels_of(width: u32, height: u32, radiance: impl Fn(Vec3<f64>) -> [f32; 3] + Sync) -> Vec<[f32; 4]> {
    let count = (width * height) as usize;
    let mut texels = room_in_large_pages(count);
    texels.resize(count, [0.0, 0.0, 0.0, 1.0]);
    let center = |place: u32, count: u32| (f64::from(place) + 0.5) / f64::from(count);
    let level = |column| environment_direction_from_angles(center(column, width), 0.0, 1.0);
    let around: Vec<Vec3<f64>> = (0..width).map(level).collect();
    parallel::for_rows(&mut texels, width as usize, |row, texels| {
        let (sine, cosine) = (std::f64::consts::PI * center(row as u32, height)).sin_cos();
        for (level, texel) in around.iter().zip(texels) {
            texel[..3].copy_from_slice(&radiance(vec3(level.x * sine, cosine, level.z * sine)));
        }
    });
    texels
}
