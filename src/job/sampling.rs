//! Cost of sampling directions: request and result, for either engine.

use crate::optics::curve::Curve;
use crate::optics::lobe::Lobe;

/// Stage of the measured work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum SamplingStage {
    /// Random numbers alone.
    Numbers = 0,
    /// With directions.
    Directions = 1,
    /// With a test against a triangle.
    Rays = 2,
}

impl SamplingStage {
    /// All stages; each includes the ones before.
    pub const ALL: [Self; 3] = [Self::Numbers, Self::Directions, Self::Rays];
}

/// Directions to sample over an image of a quad, seen from above its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SamplingRequest {
    /// Lobe to sample.
    pub lobe: Lobe,
    /// The geometric lobe's curve.
    pub curve: Curve,
    /// Roughness in (0, 1].
    pub roughness: f32,
    /// Stage of the work.
    pub stage: SamplingStage,
    /// Width of the image in pixels.
    pub width: u32,
    /// Rows of pixels that are drawn.
    pub rows: u32,
    /// Height of the whole image in pixels.
    pub height: u32,
    /// Directions per pixel.
    pub samples: u32,
    /// Changes all random numbers.
    pub seed: u32,
}

/// Result of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct SamplingRun {
    /// Time in seconds, by the engine's clock.
    pub seconds: f64,
    /// The sum of all coordinates drawn: the same on every engine, but for rounding.
    pub sum: f64,
}

/// Normal of the quad: not an axis, so that no special case applies.
pub const QUAD_NORMAL: [f64; 3] = [0.05, -0.03, 0.998_299_55];
