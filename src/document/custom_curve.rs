//! A curve D(ξ) drawn by points: monotone cubic between them, compiled to the table that the lobe samples.

use serde::{Deserialize, Serialize};

/// Most points of a curve.
pub const POINTS_MAX: usize = 64;
/// Least distance that a curve may end at.
pub const DISTANCE_MIN: f32 = 0.01;
/// Largest distance that a curve may end at.
pub const DISTANCE_MAX: f32 = 20.0;

/// The points (ξ, D) of a custom curve: ξ strictly increasing from 0 to 1, D not decreasing and not negative.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<[f32; 2]>", into = "Vec<[f32; 2]>")]
pub struct CustomCurve(Vec<[f32; 2]>);

/// Close to the smooth curve.
impl Default for CustomCurve {
    fn default() -> Self {
        Self(vec![[0.0, 0.0], [0.25, 0.29], [0.5, 0.46], [0.75, 0.63], [1.0, 1.0]])
    }
}

/// What is wrong with a curve's points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CustomCurveError {
    /// Fewer than two, or too many.
    #[error("a curve has 2 to {POINTS_MAX} points")]
    Count,
    /// ξ does not run from 0 to 1.
    #[error("ξ must increase from 0 at the first point to 1 at the last, by at least 0.001 from point to point")]
    Xi,
    /// D decreases or is negative.
    #[error("D must not be negative and must not decrease from point to point")]
    Distance,
    /// D ends too low or too high.
    #[error("D must end between {DISTANCE_MIN} and {DISTANCE_MAX}")]
    End,
}

impl TryFrom<Vec<[f32; 2]>> for CustomCurve {
    type Error = CustomCurveError;
    fn try_from(points: Vec<[f32; 2]>) -> Result<Self, CustomCurveError> {
        if !(2..=POINTS_MAX).contains(&points.len()) {
            return Err(CustomCurveError::Count);
        }
        let (first, last) = (points[0], points[points.len() - 1]);
        let increases = points.windows(2).all(|pair| pair[1][0] - pair[0][0] >= 0.000_999);
        if first[0] != 0.0 || last[0] != 1.0 || !increases {
            return Err(CustomCurveError::Xi);
        }
        // Written so that NaN fails.
        let rises = first[1] >= 0.0 && points.windows(2).all(|pair| pair[1][1] >= pair[0][1]);
        if !rises {
            return Err(CustomCurveError::Distance);
        }
        if !(DISTANCE_MIN..=DISTANCE_MAX).contains(&last[1]) {
            return Err(CustomCurveError::End);
        }
        Ok(Self(points))
    }
}

impl From<CustomCurve> for Vec<[f32; 2]> {
    fn from(curve: CustomCurve) -> Self {
        curve.0
    }
}

impl CustomCurve {
    /// The points (ξ, D).
    pub fn points(&self) -> &[[f32; 2]] {
        &self.0
    }
}
