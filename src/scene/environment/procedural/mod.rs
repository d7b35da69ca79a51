//! Environments that need no file.

mod rooms;
mod sky;
mod soft_box;
mod studio;

use super::{Environment, MapError, texel_direction};
use crate::{optics::vector::Vec3, parallel};

pub use rooms::{overcast, portrait, product, rim, warehouse};
pub use sky::{SkyParams, sky, sun_direction, sun_irradiance};
pub use studio::studio;

/// The white furnace: radiance 1 from everywhere, on a tiny map.
pub fn furnace() -> Result<Environment, MapError> {
    Environment::from_texels("furnace", 4, 2, vec![[1.0; 4]; 8])
}

/// The texels of a map whose radiance is a function of the direction, taken at the texels' centres.
fn texels_of(width: u32, height: u32, radiance: impl Fn(Vec3<f64>) -> [f32; 3] + Sync) -> Vec<[f32; 4]> {
    let mut texels = vec![[0.0, 0.0, 0.0, 1.0]; (width * height) as usize];
    parallel::for_rows(&mut texels, width as usize, |row, texels| {
        for (column, texel) in (0..).zip(texels) {
            texel[..3].copy_from_slice(&radiance(texel_direction([column, row as u32], [width, height])));
        }
    });
    texels
}
