//! Environments that need no file.

mod sky;
mod studio;

use super::{Environment, EnvironmentError};

pub use sky::{SkyParams, sky, sun_direction, sun_irradiance};
pub use studio::studio;

/// Radiance 1 from everywhere, on a tiny map: what goes in must come out.
///
/// # Errors
/// None in practice; the signature is that of the other environments.
pub fn furnace() -> Result<Environment, EnvironmentError> {
    Environment::from_texels("furnace", 4, 2, vec![[1.0; 4]; 8])
}
