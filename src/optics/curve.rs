//! D(ξ): how far from the mirror direction the geometric lobe's samples lie (paper, section 4.6 and eq. 13).
//!
//! A curve is the quantile function of the distance D. The lobe's density needs h(D) = f_D(D)/D, f_D being the density
//! of D (docs/MATHEMATICS.md, section 1).

use super::numeric::log1p;
use super::real::Real;
use crate::named::named;

named! {
    /// The curve D(ξ).
    Curve {
        Linear = 0, "linear", "Linear", "Crowded around the mirror direction.";
        Sqrt = 1, "sqrt", "Square root", "The simplest: an even disc with a sharp edge.";
        Cbrt = 2, "cbrt", "Cube root", "Pushed outwards, with a sharp edge.";
        Smooth = 3, "smooth", "Smooth", "A soft edge, closest to Phong.";
        LongTail = 4, "long-tail", "Long tail", "A wide glow like GGX; crosses the surface at any roughness.";
        Custom = 5, "custom", "Custom", "A monotone curve of your own.";
    }
}

impl Curve {
    /// True where D(ξ) is at most 1 whatever ξ.
    pub fn is_within_unit(self) -> bool {
        match self {
            Self::Linear | Self::Sqrt | Self::Cbrt | Self::Smooth => true,
            Self::LongTail | Self::Custom => false,
        }
    }

    /// D(ξ) written out.
    pub fn formula(self) -> &'static str {
        match self {
            Self::Linear => "ξ",
            Self::Sqrt => "√ξ",
            Self::Cbrt => "∛ξ",
            Self::Smooth => "1 − √(1 − √ξ)",
            Self::LongTail => "−ln(1 − √ξ)",
            Self::Custom => "drawn",
        }
    }
}

/// Intervals of a custom curve's table, equal in D.
pub const CUSTOM_INTERVALS: usize = 64;
/// Numbers of a custom curve's table: D's maximum, then at each node the cumulative distribution, then the density.
pub const CUSTOM_LENGTH: usize = 1 + 2 * (CUSTOM_INTERVALS + 1);
/// Largest distance of the long tail, reached at the largest 24-bit number below 1: 25 ln 2.
pub const LONG_TAIL_MAX: f64 = 17.328_679_513_998_632;

/// D(ξ) for ξ in [0, 1]. `table` holds the custom curve and is not read for the others.
#[inline(always)]
pub fn curve_distance<T: Real>(curve: Curve, table: &[f32], xi: T) -> T {
    let one = T::one();
    match curve {
        Curve::Linear => xi,
        Curve::Sqrt => xi.sqrt(),
        Curve::Cbrt => xi.powf(T::from_f64(1.0 / 3.0)),
        Curve::Smooth => {
            // 1 − √(1 − √ξ) without the cancellation near ξ = 0.
            let root = xi.sqrt();
            root / (one + (one - root).safe_sqrt())
        }
        Curve::LongTail => {
            // 1 − √ξ = (1 − ξ)/(1 + √ξ): stays above zero for the largest number below 1.
            let root = xi.sqrt();
            let complement = ((one - xi) / (one + root)).max(T::from_f64(0.5 / 16_777_216.0));
            T::select(root.less(T::from_f64(0.5)), -log1p(-root), -complement.ln())
        }
        Curve::Custom => custom_distance(table, xi),
    }
}

/// D's maximum.
#[inline(always)]
pub fn curve_distance_max<T: Real>(curve: Curve, table: &[f32]) -> T {
    match curve {
        Curve::LongTail => T::from_f64(LONG_TAIL_MAX),
        Curve::Custom => T::from_f64(f64::from(table[0])),
        _ => T::one(),
    }
}

/// h(D) = f_D(D)/D, for D in [0, D's maximum]; clamped where it goes to infinity.
#[inline(always)]
pub fn curve_h<T: Real>(curve: Curve, table: &[f32], distance: T) -> T {
    let c = T::from_f64;
    match curve {
        Curve::Linear => T::one() / distance.max(c(1e-12)),
        Curve::Sqrt => c(2.0),
        Curve::Cbrt => c(3.0) * distance,
        Curve::Smooth => c(4.0) * (c(2.0) - distance) * (T::one() - distance).max(T::zero()),
        Curve::LongTail => {
            // 2 e^(−D) (1 − e^(−D))/D; the last factor goes to 1 at D = 0.
            let d = distance.max(c(1e-6));
            c(-2.0) * (-d).exp() * super::numeric::expm1(-d) / d
        }
        Curve::Custom => custom_density(table, distance) / distance.max(c(1e-6)),
    }
}

/// f_D(D), the density of the distance (paper, eq. 14).
pub fn curve_density<T: Real>(curve: Curve, table: &[f32], distance: T) -> T {
    curve_h(curve, table, distance) * distance
}

/// The distance at which the custom curve's cumulative distribution reaches ξ: the density is linear between the nodes,
/// so a quadratic equation in the interval that bisection finds.
#[inline(always)]
fn custom_distance<T: Real>(table: &[f32], xi: T) -> T {
    let c = T::from_f64;
    let number = |i: usize| c(f64::from(table[i]));
    // Six halvings of 64 intervals; `low` counts the nodes that lie below ξ.
    let mut low = T::zero();
    let mut step = CUSTOM_INTERVALS / 2;
    while step > 0 {
        let middle = low + c(step as f64);
        let node = number(1 + middle.to_f64() as usize);
        low = T::select(xi.less(node), low, middle);
        step /= 2;
    }
    let index = low.to_f64() as usize;
    let width = number(0) * c(1.0 / CUSTOM_INTERVALS as f64);
    let (left, right) = (
        number(CUSTOM_INTERVALS + 2 + index),
        number(CUSTOM_INTERVALS + 3 + index),
    );
    let missing = (xi - number(1 + index)).max(T::zero());
    let root = (left * left + c(2.0) * (right - left) / width * missing).safe_sqrt();
    let step = c(2.0) * missing / (left + root).max(c(1e-12));
    width * low + step.min(width)
}

/// The custom curve's density, linear between the nodes.
#[inline(always)]
fn custom_density<T: Real>(table: &[f32], distance: T) -> T {
    let c = T::from_f64;
    let number = |i: usize| c(f64::from(table[i]));
    let position = (distance / number(0) * c(CUSTOM_INTERVALS as f64)).clamp(T::zero(), c(CUSTOM_INTERVALS as f64));
    let low = position.floor().min(c(CUSTOM_INTERVALS as f64 - 1.0));
    let node = CUSTOM_INTERVALS + 2 + low.to_f64() as usize;
    let fraction = position - low;
    number(node) * (T::one() - fraction) + number(node + 1) * fraction
}

/// A custom curve's table from the density of D at equidistant nodes over [0, `distance_max`] (65 values, not negative,
/// any scale: normalised here). Returns `None` where the density is zero everywhere or not finite.
pub fn custom_table(distance_max: f64, density: &[f64]) -> Option<Vec<f32>> {
    let width = distance_max / CUSTOM_INTERVALS as f64;
    let mut cumulative = vec![0.0; CUSTOM_INTERVALS + 1];
    for i in 0..CUSTOM_INTERVALS {
        cumulative[i + 1] = cumulative[i] + 0.5 * width * (density[i] + density[i + 1]);
    }
    let total = cumulative[CUSTOM_INTERVALS];
    if !(total.is_finite() && total > 0.0 && distance_max.is_finite() && density.iter().all(|f| *f >= 0.0)) {
        return None;
    }
    let mut table = vec![distance_max as f32];
    table.extend(cumulative.iter().map(|c| (c / total) as f32));
    table.extend(density.iter().map(|f| (f / total) as f32));
    Some(table)
}
