//! Integrals over the sphere: Gauss–Legendre rules and an adaptive rule in polar coordinates.
//!
//! Polar coordinates around a lobe's peak tame it: the factor sin θ of the solid angle cancels a 1/distance peak.

use std::f64::consts::{PI, TAU};
use std::sync::LazyLock;

use crate::optics::{
    frame::{Frame, local_from_world, world_from_local},
    vector::Vec3,
    vector::vec3,
};

/// Maximum depth of patch subdivision.
const DEPTH_MAX: u32 = 9;
/// Halvings before agreement is believed.
const DEPTH_MIN: u32 = 1;
/// Nodes and weights of the adaptive rule along each coordinate: Gauss's of four, exact to the seventh degree.
static PATCH_NODES: LazyLock<Vec<[f64; 2]>> = LazyLock::new(|| gauss_legendre(4));

/// Nodes and weights of the Gauss–Legendre rule with `order` nodes on [−1, 1], ascending. Exact for polynomials up to
/// degree 2 `order` − 1. The nodes are found by Newton's method from Tricomi's estimate.
pub fn gauss_legendre(order: usize) -> Vec<[f64; 2]> {
    let n = order as f64;
    let mut rule = vec![[0.0; 2]; order];
    for (i, node) in rule.iter_mut().enumerate() {
        let mut x = -((i as f64 + 0.75) / (n + 0.5) * PI).cos();
        let mut slope = 1.0;
        for _ in 0..8 {
            let (mut previous, mut value) = (0.0, 1.0);
            for degree in 0..order {
                let j = degree as f64;
                (previous, value) = (value, ((2.0 * j + 1.0) * x * value - j * previous) / (j + 1.0));
            }
            slope = n * (x * value - previous) / (x * x - 1.0);
            x -= value / slope;
        }
        *node = [x, 2.0 / ((1.0 - x * x) * slope * slope)];
    }
    rule
}

/// ∫ f(x) dx over [`low`, `high`] by a rule of [`gauss_legendre`].
pub fn integrate(rule: &[[f64; 2]], low: f64, high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (half, middle) = (0.5 * (high - low), 0.5 * (high + low));
    rule.iter()
        .map(|[x, weight]| weight * f(middle + half * x))
        .sum::<f64>()
        * half
}

/// ∫ f(ω) dω over the directions with n·ω > 0, n = +z: `order` nodes in the cosine, twice as many equal steps in azimuth.
/// Meant for functions without narrow peaks; see [`SphereFunction`] for those.
pub fn integrate_hemisphere(order: usize, f: impl Fn(Vec3<f64>) -> f64) -> f64 {
    let steps = 2 * order;
    integrate(&gauss_legendre(order), 0.0, 1.0, |cosine| {
        let sine = (1.0 - cosine * cosine).sqrt();
        (0..steps)
            .map(|i| {
                let phi_rad = TAU * (i as f64 + 0.5) / steps as f64;
                f(vec3(sine * phi_rad.cos(), sine * phi_rad.sin(), cosine))
            })
            .sum::<f64>()
            * (TAU / steps as f64)
    })
}

/// A patch of the sphere in polar coordinates, radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Angle to the axis, from and to, in [0, π].
    pub polar_rad: [f64; 2],
    /// Azimuth, from and to, in [−π, π].
    pub azimuth_rad: [f64; 2],
}

/// A function on the sphere, with its known properties.
pub struct SphereFunction<'a, F> {
    /// The polar coordinates: their axis is the normal of this frame, which should lie on the function's peak.
    pub frame: Frame<f64>,
    /// Normals of the planes through the origin across which the function may jump (the horizon).
    pub cuts: &'a [Vec3<f64>],
    /// The function, of a unit direction.
    pub f: F,
}

impl<F: Fn(Vec3<f64>) -> f64> SphereFunction<'_, F> {
    /// ∫ f dω over a patch, to an error of about `relative` of itself or `absolute`, whichever is larger.
    pub fn integrate(&self, patch: Patch, relative: f64, absolute: f64) -> f64 {
        let whole = self.estimate(patch);
        self.refine(patch, whole, relative, absolute, 0)
    }

    fn refine(&self, patch: Patch, whole: f64, relative: f64, absolute: f64, depth: u32) -> f64 {
        let quarters = patch.quarters();
        let estimates = quarters.map(|quarter| self.estimate(quarter));
        let sum: f64 = estimates.iter().sum();
        // Agreement by chance, of a rule that misses an edge twice, is rare but happens among thousands of cells.
        let agrees = depth >= DEPTH_MIN && (sum - whole).abs() <= absolute.max(relative * sum.abs());
        if agrees || depth == DEPTH_MAX {
            return sum;
        }
        let mut refined = 0.0;
        for (quarter, estimate) in quarters.into_iter().zip(estimates) {
            // Half, not a quarter, of the tolerance: the errors of the quarters seldom add up.
            let absolute = 0.5 * absolute.max(relative * sum.abs());
            refined += self.refine(quarter, estimate, relative, absolute, depth + 1);
        }
        refined
    }

    /// One product rule; along the azimuth it is split where the function jumps.
    fn estimate(&self, patch: Patch) -> f64 {
        integrate(&PATCH_NODES, patch.polar_rad[0], patch.polar_rad[1], |polar| {
            let (sine, cosine) = polar.sin_cos();
            let on_circle = |azimuth: f64| {
                let local = vec3(sine * azimuth.cos(), sine * azimuth.sin(), cosine);
                (self.f)(world_from_local(&self.frame, local))
            };
            let mut breaks = vec![patch.azimuth_rad[0], patch.azimuth_rad[1]];
            for cut in self.cuts {
                let jumps = jump_azimuths(local_from_world(&self.frame, *cut), sine, cosine);
                let inside = |a: &f64| patch.azimuth_rad[0] < *a && *a < patch.azimuth_rad[1];
                breaks.extend(jumps.into_iter().flatten().filter(inside));
            }
            breaks.sort_by(f64::total_cmp);
            let parts = breaks.windows(2);
            sine * parts
                .map(|part| integrate(&PATCH_NODES, part[0], part[1], on_circle))
                .sum::<f64>()
        })
    }
}

impl Patch {
    fn quarters(self) -> [Patch; 4] {
        let halves = |[low, high]: [f64; 2]| [[low, 0.5 * (low + high)], [0.5 * (low + high), high]];
        let (polar, azimuth) = (halves(self.polar_rad), halves(self.azimuth_rad));
        let patch = |i: usize, j: usize| Patch {
            polar_rad: polar[i],
            azimuth_rad: azimuth[j],
        };
        [patch(0, 0), patch(0, 1), patch(1, 0), patch(1, 1)]
    }
}

/// The azimuths at which the circle of a polar angle crosses the plane with normal `cut` (local).
fn jump_azimuths(cut: Vec3<f64>, sine: f64, cosine: f64) -> [Option<f64>; 2] {
    let across = cut.x.hypot(cut.y) * sine;
    let ratio = -cut.z * cosine / across;
    // Also where the ratio is 0/0.
    if ratio.is_nan() || ratio.abs() >= 1.0 {
        return [None, None];
    }
    let (middle, half) = (cut.y.atan2(cut.x), ratio.acos());
    let wrapped = |azimuth: f64| azimuth - TAU * (azimuth / TAU).round();
    [Some(wrapped(middle - half)), Some(wrapped(middle + half))]
}
