//! What drawing directions costs: what is asked for, whichever engine draws them.

use crate::optics::curve::Curve;
use crate::optics::lobe::Lobe;

/// How much of the work is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum SamplingStage {
    /// Random numbers alone.
    Numbers = 0,
    /// Directions, too.
    Directions = 1,
    /// And a triangle that they may meet.
    Rays = 2,
}

impl SamplingStage {
    /// All of them, each with all that the ones before it do.
    pub const ALL: [Self; 3] = [Self::Numbers, Self::Directions, Self::Rays];
}

/// Directions to draw over a picture of a quad that is seen from above its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SamplingRequest {
    /// The lobe.
    pub lobe: Lobe,
    /// The geometric lobe's curve.
    pub curve: Curve,
    /// Roughness in (0, 1].
    pub roughness: f32,
    /// How much of the work is done.
    pub stage: SamplingStage,
    /// Columns of pixels.
    pub width: u32,
    /// Rows of pixels that are drawn.
    pub rows: u32,
    /// Rows of the whole picture.
    pub height: u32,
    /// Directions a pixel.
    pub samples: u32,
    /// Changes all random numbers.
    pub seed: u32,
}

/// What came of it.
#[derive(Clone, Debug, PartialEq)]
pub struct SamplingRun {
    /// By the clock of the engine that drew.
    pub seconds: f64,
    /// The sum of all coordinates drawn: the same on every engine, but for rounding.
    pub sum: f64,
}

/// The quad's normal: not an axis, so that nothing is simpler than for any other.
pub const QUAD_NORMAL: [f64; 3] = [0.05, -0.03, 0.998_299_55];
