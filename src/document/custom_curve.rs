//! A curve D(ξ) drawn by points: monotone cubic between them, compiled to the table that the lobe samples.

use crate::optics::curve::{CUSTOM_INTERVALS, custom_table};

/// Most points of a curve.
pub const POINTS_MAX: usize = 64;
/// Least ξ between two points.
pub const XI_STEP_MIN: f32 = 0.001;
/// Least distance that a curve may end at.
pub const DISTANCE_MIN: f32 = 0.01;
/// Largest distance that a curve may end at.
pub const DISTANCE_MAX: f32 = 20.0;

/// The points (ξ, D) of a custom curve: ξ increasing from 0 to 1, D not negative and not decreasing. Between them it is
/// the monotone cubic of Fritsch and Carlson (1980).
#[derive(Clone, Debug, PartialEq)]
pub struct CustomCurve(Vec<[f32; 2]>);

/// What is wrong with a curve's points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CustomCurveError {
    /// Fewer than two, or too many.
    #[error("give 2 to {POINTS_MAX} points")]
    Count,
    /// ξ does not run from 0 to 1.
    #[error("let ξ increase from 0 at the first point to 1 at the last, by at least {XI_STEP_MIN} from point to point")]
    Xi,
    /// D decreases or is negative.
    #[error("let D begin at 0 or above and never decrease from point to point")]
    Distance,
    /// D ends too low or too high.
    #[error("let D end between {DISTANCE_MIN} and {DISTANCE_MAX}")]
    End,
}

/// Close to the smooth curve.
impl Default for CustomCurve {
    fn default() -> Self {
        Self(vec![[0.0, 0.0], [0.25, 0.29], [0.5, 0.46], [0.75, 0.63], [1.0, 1.0]])
    }
}

impl TryFrom<Vec<[f32; 2]>> for CustomCurve {
    type Error = CustomCurveError;
    fn try_from(points: Vec<[f32; 2]>) -> Result<Self, CustomCurveError> {
        let ([first, .., last], 2..=POINTS_MAX) = (&points[..], points.len()) else {
            return Err(CustomCurveError::Count);
        };
        // Comparisons such that NaN fails; a little below the least step for what decimals round to.
        let step_min = 0.999 * XI_STEP_MIN;
        let increases = points.windows(2).all(|pair| pair[1][0] - pair[0][0] >= step_min);
        if !(first[0] == 0.0 && last[0] == 1.0 && increases) {
            return Err(CustomCurveError::Xi);
        }
        if !(first[1] >= 0.0 && points.windows(2).all(|pair| pair[1][1] >= pair[0][1])) {
            return Err(CustomCurveError::Distance);
        }
        if !(DISTANCE_MIN..=DISTANCE_MAX).contains(&last[1]) {
            return Err(CustomCurveError::End);
        }
        Ok(Self(points))
    }
}

impl CustomCurve {
    /// The points (ξ, D), at least two.
    pub fn points(&self) -> &[[f32; 2]] {
        &self.0
    }

    /// D(ξ), for ξ in [0, 1].
    pub fn distance(&self, xi: f64) -> f64 {
        let segments = self.segments();
        let index = segments.partition_point(|segment| segment.xi[1] < xi);
        segments[index.min(segments.len() - 1)].distance(xi)
    }

    /// The table of [`crate::optics::curve::custom_table`]: the density at each of its nodes is the share of the samples
    /// in the interval around it, so that flat parts of the curve, where the density is infinite, keep their weight.
    pub fn table(&self) -> Vec<f32> {
        let segments = self.segments();
        let distance_max = f64::from(self.0[self.0.len() - 1][1]);
        let width = distance_max / CUSTOM_INTERVALS as f64;
        // ξ at the lower edge of a node's interval.
        let edge = |node: usize| match node {
            0 => 0.0,
            _ if node > CUSTOM_INTERVALS => 1.0,
            _ => xi_at(&segments, (node as f64 - 0.5) * width),
        };
        let density = |node: usize| {
            let is_half = node == 0 || node == CUSTOM_INTERVALS;
            (edge(node + 1) - edge(node)).max(0.0) / (if is_half { 0.5 } else { 1.0 } * width)
        };
        let density: Vec<f64> = (0..=CUSTOM_INTERVALS).map(density).collect();
        custom_table(distance_max, &density).expect("the shares are not negative and add to 1")
    }

    /// The cubics between the points, with tangents that keep them monotone.
    fn segments(&self) -> Vec<Segment> {
        let point = |i: usize| self.0[i].map(f64::from);
        let slopes: Vec<f64> = (1..self.0.len())
            .map(|i| (point(i)[1] - point(i - 1)[1]) / (point(i)[0] - point(i - 1)[0]))
            .collect();
        let mut tangents = vec![slopes[0]];
        tangents.extend(slopes.windows(2).map(|pair| {
            let is_flat = pair[0] == 0.0 || pair[1] == 0.0;
            if is_flat { 0.0 } else { 0.5 * (pair[0] + pair[1]) }
        }));
        tangents.push(slopes[slopes.len() - 1]);
        for (i, slope) in slopes.iter().enumerate().filter(|(_, slope)| **slope > 0.0) {
            let excess = (tangents[i] / slope).hypot(tangents[i + 1] / slope);
            if excess > 3.0 {
                tangents[i] *= 3.0 / excess;
                tangents[i + 1] *= 3.0 / excess;
            }
        }
        let segment = |i: usize| Segment {
            xi: [point(i)[0], point(i + 1)[0]],
            distance: [point(i)[1], point(i + 1)[1]],
            tangent: [tangents[i], tangents[i + 1]],
        };
        (0..slopes.len()).map(segment).collect()
    }
}

/// A cubic between two points, in Hermite's form.
struct Segment {
    xi: [f64; 2],
    distance: [f64; 2],
    tangent: [f64; 2],
}

impl Segment {
    fn distance(&self, xi: f64) -> f64 {
        let width = self.xi[1] - self.xi[0];
        let t = ((xi - self.xi[0]) / width).clamp(0.0, 1.0);
        let s = 1.0 - t;
        let values = self.distance[0] * s * s * (1.0 + 2.0 * t) + self.distance[1] * t * t * (1.0 + 2.0 * s);
        values + width * t * s * (self.tangent[0] * s - self.tangent[1] * t)
    }
}

/// The largest ξ whose distance is not above `distance`: the cumulative distribution of D.
fn xi_at(segments: &[Segment], distance: f64) -> f64 {
    let index = segments.partition_point(|segment| segment.distance[1] <= distance);
    let Some(segment) = segments.get(index) else {
        return 1.0;
    };
    let [mut low, mut high] = segment.xi;
    // Each halving gains a bit of the interval.
    for _ in 0..52 {
        let middle = 0.5 * (low + high);
        if segment.distance(middle) <= distance {
            low = middle
        } else {
            high = middle
        }
    }
    low
}
