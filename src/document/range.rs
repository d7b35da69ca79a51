//! The ranges of the settings, both ends included.

use std::ops::RangeInclusive;

/// Factor on the environment's radiance.
pub const STRENGTH: RangeInclusive<f64> = 0.0..=1e6;
/// Turn of the environment, degrees.
pub const ROTATION_DEG: RangeInclusive<f64> = -3600.0..=3600.0;
/// Blur of the environment as a background, degrees.
pub const BACKGROUND_BLUR_DEG: RangeInclusive<f64> = 0.0..=90.0;
/// Sides of the rendered part, shares of the image.
pub const REGION: RangeInclusive<f64> = 0.0..=1.0;
/// Coordinates and distances of the camera, scene units.
pub const COORDINATE: RangeInclusive<f64> = -1e9..=1e9;
/// Distance of the camera from its target, scene units.
pub const DISTANCE: RangeInclusive<f64> = 1e-6..=1e9;
/// Azimuth of the camera, degrees.
pub const YAW_DEG: RangeInclusive<f64> = -3600.0..=3600.0;
/// Height of the camera, degrees.
pub const PITCH_DEG: RangeInclusive<f64> = -90.0..=90.0;
/// Vertical field of view, degrees.
pub const FOV_DEG: RangeInclusive<f64> = 0.1..=170.0;
/// Radius of the lens, bounding radii.
pub const APERTURE: RangeInclusive<f64> = 0.0..=10.0;
/// Exposure, stops.
pub const EXPOSURE_EV: RangeInclusive<f64> = -32.0..=32.0;
/// Factor of a light group.
pub const LIGHT_MIX: RangeInclusive<f64> = 0.0..=1000.0;
/// Width and height, pixels; the random numbers' counters have 16 bits for each.
pub const SIZE: RangeInclusive<f64> = 1.0..=65535.0;
/// Samples per pixel.
pub const SAMPLES: RangeInclusive<f64> = 1.0..=4_294_967_295.0;
/// Render time, seconds.
pub const TIME_S: RangeInclusive<f64> = 0.001..=1e9;
/// Relative error of the image at which rendering stops.
pub const NOISE: RangeInclusive<f64> = 1e-5..=1.0;
/// Samples per pixel before an estimate of the error is believed.
pub const MIN_SAMPLES: RangeInclusive<f64> = 2.0..=65536.0;
pub const BOUNCES: RangeInclusive<f64> = 1.0..=64.0;
/// The largest radiance that an indirect contribution keeps.
pub const FIREFLY_CLAMP: RangeInclusive<f64> = 1e-6..=1e9;
/// Distance and sides of an area light, bounding radii.
pub const AREA_LENGTH: RangeInclusive<f64> = 1e-3..=1e3;
/// Coordinates of what an area light looks at, bounding radii.
pub const LIGHT_TARGET: RangeInclusive<f64> = -1e3..=1e3;
/// The angle across a spot's cone, degrees.
pub const CONE_DEG: RangeInclusive<f64> = 1.0..=180.0;
/// The angle across a sun, degrees.
pub const SUN_ANGLE_DEG: RangeInclusive<f64> = 0.01..=90.0;
/// The longest side of a model's textures, texels.
pub const TEXTURE_SIDE: RangeInclusive<f64> = 16.0..=16384.0;
/// Time of a model's pose, seconds.
pub const POSE_TIME_S: RangeInclusive<f64> = 0.0..=1e6;
/// How many area lights there may be.
pub const AREA_LIGHTS: RangeInclusive<f64> = 0.0..=crate::scene::LIGHTS_MAX as f64;
pub const SHARE: RangeInclusive<f64> = 0.0..=1.0;
/// Linear colours of things that do not emit.
pub const COLOR: RangeInclusive<f64> = 0.0..=1.0;
