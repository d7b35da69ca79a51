//! Density of the geometric lobe as a unit ball, in closed form (docs/MATHEMATICS.md, section 4).
//!
//! A direction ω from the surface point intersects the sphere of radius D around a + D κ n at the distances T ± √A W,
//! T = μ + κνD. With D = c + s cosh v and W = s sinh v (v is u shifted), the section's integral over u is
//!
//! p(ω) = 1/(4π√A) ∫ t² h(D) dv,   t = T + √A W,
//!
//! over the v with t ≥ 0 and D ≤ D's maximum.
//!
//! t² = (T² + A W²) + 2√A T W. The first part is a polynomial in D and integrates by the moments ∫ Dⁿ dv, which follow from
//! each other. In the second, W dv = dD. So a curve whose h is a polynomial or 1/D costs one logarithm at any roughness, and
//! a custom density costs the same per interval. Only the long tail needs quadrature.

use super::{
    curve::{CUSTOM_INTERVALS, Curve, Integral, curve_distance_max, curve_h},
    numeric::log1p,
    table::NODE_LENGTH,
};
use crate::optics::prelude::*;

/// Angle from the mirror direction, in radians, that f32 resolves: within it a density's peak is cut off.
pub const PEAK_RADIUS: f64 = 1e-7;
/// Lower bound of |a⊥|² for Lambertian lobes; its square is a normal f32.
pub const TINY: f64 = 1e-18;
/// Longest range of v to integrate for a Lambertian lobe, and its growth with μ: the integrand falls as e^(2v) towards its
/// lower end, and is flat otherwise.
pub const RANGE_MAX: [f64; 2] = [20.0, 1000.0];
/// Roughness up to which the shorter rule integrates a curve without a closed form (the long tail) to better than 1e-3.
pub const SHORT_RULE_ROUGHNESS: f64 = 0.5;
/// Range of v up to which a curve whose h vanishes at the silhouette is integrated by quadrature: the closed form is a
/// difference of much larger moments there.
pub const SHORT_RANGE: f64 = 0.5;

/// Positive nodes and weights of the 6-point Gauss–Legendre rule on [−1, 1].
pub const GAUSS_6: [[f64; 2]; 3] = [
    [0.2386191860831969, 0.46791393457269104],
    [0.6612093864662645, 0.36076157304813855],
    [0.932469514203152, 0.17132449237917025],
];
/// Positive nodes and weights of the 12-point Gauss–Legendre rule on [−1, 1].
pub const GAUSS_12: [[f64; 2]; 6] = [
    [0.1252334085114689, 0.2491470458134027],
    [0.3678314989981802, 0.2334925365383546],
    [0.5873179542866175, 0.20316742672306573],
    [0.7699026741943047, 0.16007832854334642],
    [0.9041172563704748, 0.10693932599531907],
    [0.9815606342467192, 0.04717533638651141],
];
/// Positive nodes and weights of the 20-point Gauss–Legendre rule on [−1, 1].
pub const GAUSS_20: [[f64; 2]; 10] = [
    [0.07652652113349734, 0.15275338713072628],
    [0.22778585114164507, 0.14917298647260424],
    [0.37370608871541955, 0.1420961093183824],
    [0.5108670019508271, 0.1316886384491769],
    [0.636053680726515, 0.1181945319615186],
    [0.7463319064601508, 0.1019301198172407],
    [0.8391169718222188, 0.08327674157670471],
    [0.912234428251326, 0.06267204833410879],
    [0.9639719272779138, 0.040601429800386446],
    [0.993128599185095, 0.017614007139150893],
];

/// The chord of a direction through the spheres.
#[derive(Clone, Copy, Debug)]
struct Chord<T> {
    centre: T,
    spread: T,
    /// s² − c² = |a⊥|²/A.
    product: T,
    /// c + s: the smallest sphere that ω touches.
    nearest: T,
    /// T² + A W² as coefficients of 1, D, D².
    even: [T; 3],
    /// 2√A T as coefficients of 1, D.
    odd: [T; 2],
    /// √A.
    a_root: T,
    /// D and W where the chord leaves the largest sphere.
    last: [T; 2],
    /// D and W where the chord starts: on the sphere through the surface point, or where it enters the largest one. W is
    /// negative if that point is beyond the chord's middle.
    first: [T; 2],
}

impl<T: Real> Chord<T> {
    /// The chord of one lane.
    #[inline(always)]
    fn lane(&self, lane: usize) -> Chord<T::Scalar> {
        Chord {
            centre: self.centre.lane(lane),
            spread: self.spread.lane(lane),
            product: self.product.lane(lane),
            nearest: self.nearest.lane(lane),
            even: [
                self.even[0].lane(lane),
                self.even[1].lane(lane),
                self.even[2].lane(lane),
            ],
            odd: [self.odd[0].lane(lane), self.odd[1].lane(lane)],
            a_root: self.a_root.lane(lane),
            last: [self.last[0].lane(lane), self.last[1].lane(lane)],
            first: [self.first[0].lane(lane), self.first[1].lane(lane)],
        }
    }
}

/// The density per steradian for roughness `kappa`: `mirror`, `light` and `normal` unit vectors of the unit ball's frame,
/// a = (1 − κ) `stretch` × `mirror`. `table` holds the custom curve and is not read for the others.
pub fn chord_density<T: Real>(
    curve: Curve,
    table: &[f32],
    kappa: T,
    stretch: T,
    normal: Vec3<T>,
    mirror: Vec3<T>,
    light: Vec3<T>,
) -> T {
    vectorized!(T, {
        let reach = curve_distance_max(curve, table);
        let chord = chord_through(reach, kappa, stretch, normal, mirror, light);
        // No intersection, or none ahead: without the test, the latter would be the rounding error of two ends that
        // cancel.
        let is_hit = chord.nearest.less(chord.last[0]) & (-chord.last[1]).less(chord.first[1]);
        if !is_hit.any() {
            return T::ZERO;
        }
        let integral = chord_integral(curve, table, kappa, &chord);
        let value = T::from_f64(0.25 * std::f64::consts::FRAC_1_PI) * integral / chord.a_root;
        value.max(T::ZERO).masked(is_hit)
    })
}

inlined! {
    /// ∫ t² h dv over the chord.
    fn chord_integral<T: Real>(curve: Curve, table: &[f32], kappa: T, chord: &Chord<T>) -> T {
        match curve.traits().integral {
            Integral::Reciprocal => chord_reciprocal_integral(chord),
            Integral::Polynomial(h) => chord_polynomial_integral(chord, h),
            Integral::PolynomialToZero(h) => {
                let is_short = chord_range(chord).less(T::from_f64(SHORT_RANGE));
                let mut integral = T::ZERO;
                if is_short.any() {
                    integral = chord_quadrature(curve, &GAUSS_6, chord);
                }
                if is_short.all() {
                    return integral;
                }
                T::select(is_short, integral, chord_polynomial_integral(chord, h))
            }
            Integral::Quadrature => {
                let is_long = T::from_f64(SHORT_RULE_ROUGHNESS).less(kappa);
                let mut integral = T::ZERO;
                if is_long.any() {
                    integral = chord_quadrature(curve, &GAUSS_20, chord);
                }
                if is_long.all() {
                    return integral;
                }
                T::select(is_long, integral, chord_quadrature(curve, &GAUSS_12, chord))
            }
            Integral::Table => T::from_lanes(|lane| chord_table_integral(table, chord.lane(lane))),
        }
    }

    /// The chord's geometry, by the component of a perpendicular to ω, so that nothing cancels for narrow (κ → 0) or Lambertian
    /// (κ → 1) lobes.
    fn chord_through<T: Real>(
        reach: T,
        kappa: T,
        stretch: T,
        normal: Vec3<T>,
        mirror: Vec3<T>,
        light: Vec3<T>,
    ) -> Chord<T> {
        let c = T::from_f64;
        let scale = (T::ONE - kappa) * stretch;
        let k = (T::ONE - kappa) * (T::ONE + kappa);
        let apart = mirror - light;
        let perpendicular = (apart - light * light.dot(apart)) * scale;
        let mu = scale * (T::ONE - c(0.5) * apart.dot(apart));
        let m = kappa * normal.dot(perpendicular);
        let peak = scale * c(PEAK_RADIUS);
        let e = perpendicular.dot(perpendicular).max(peak * peak).max(c(TINY));
        let lift = kappa * normal.dot(light);
        let a = (lift * lift + k).max(c(TINY));
        let a_root = a.sqrt();
        let a_inverse = T::ONE / a;
        let (centre, product) = (m * a_inverse, e * a_inverse);
        let spread = (centre * centre + product).sqrt();
        let is_left = centre.below_zero();
        let larger = spread + centre.abs();
        let nearest = T::select(is_left, product / larger, larger);
        // The sphere through the surface point: k D² − 2κ (n·a) D − |a|² = 0, 1 − κ divided out.
        let tilt = kappa * normal.dot(mirror);
        let root = (tilt * tilt + k).safe_sqrt();
        let through = T::select(tilt.below_zero(), k / (root + tilt.abs()), root + tilt);
        let start = (stretch * through / (T::ONE + kappa)).max(nearest).min(reach);
        let beyond = reach - nearest;
        let last = (beyond * (beyond + c(2.0) * spread)).safe_sqrt();
        Chord {
            centre,
            spread,
            product,
            nearest,
            even: [mu * mu - e, c(2.0) * (mu * lift - m), lift * lift + a],
            odd: [c(2.0) * a_root * mu, c(2.0) * a_root * lift],
            a_root,
            last: [reach, last],
            first: [start, ((mu + lift * start) * (a_root * a_inverse)).clamp(-last, last)],
        }
    }

    /// e^v − 1 at an end.
    fn chord_growth<T: Real>(chord: &Chord<T>, end: [T; 2]) -> T {
        let grown = (end[0] - chord.nearest + end[1].abs()) / chord.spread;
        T::select(end[1].below_zero(), -grown / (T::ONE + grown), grown)
    }

    /// ∫ dv over the chord.
    fn chord_range<T: Real>(chord: &Chord<T>) -> T {
        let (last, first) = (chord_growth(chord, chord.last), chord_growth(chord, chord.first));
        log1p(last + first + last * first)
    }

    /// The integral of t² Dⁿ: `even` holds ∫ Dⁿ dv and the next two moments, `odd` ∫ Dⁿ dD and the next.
    fn chord_weighed<T: Real>(chord: &Chord<T>, even: [T; 3], odd: [T; 2]) -> T {
        let even = chord.even[0] * even[0] + chord.even[1] * even[1] + chord.even[2] * even[2];
        even + chord.odd[0] * odd[0] + chord.odd[1] * odd[1]
    }

    /// ∫ t² h dv for h = 1/D.
    fn chord_reciprocal_integral<T: Real>(chord: &Chord<T>) -> T {
        let ([last, w_last], [first, w_first]) = (chord.last, chord.first);
        let product_root = chord.product.sqrt();
        // ∫ dv/D is the angle with the tangent y/x, doubled, over √product; the angles of both ends added.
        let double = T::TWO * chord.spread;
        let (x1, y1) = (chord.nearest * (last - chord.nearest + double), product_root * w_last);
        let (x0, y0) = (chord.nearest * (first - chord.nearest + double), product_root * w_first);
        let angle = (y1 * x0 + y0 * x1).atan2(x1 * x0 - y1 * y0);
        let inverse = T::TWO * angle / product_root;
        let zeroth = chord_range(chord);
        let first_moment = w_last + w_first + chord.centre * zeroth;
        chord_weighed(
            chord,
            [inverse, zeroth, first_moment],
            [(last / first).ln(), last - first],
        )
    }

    /// ∫ t² h dv for h = h₀ + h₁ D + h₂ D².
    fn chord_polynomial_integral<T: Real>(chord: &Chord<T>, h: [f64; 3]) -> T {
        let c = T::from_f64;
        let ([last, w_last], [first, w_first]) = (chord.last, chord.first);
        let (centre, product) = (chord.centre, chord.product);
        // n ∫ Dⁿ dv = Dⁿ⁻¹ W + (2n − 1) c ∫ Dⁿ⁻¹ dv + (n − 1) (s² − c²) ∫ Dⁿ⁻² dv.
        let (last2, first2) = (last * last, first * first);
        let i0 = chord_range(chord);
        let i1 = w_last + w_first + centre * i0;
        let i2 = c(0.5) * (last * w_last + first * w_first + c(3.0) * centre * i1 + product * i0);
        let ends = last2 * w_last + first2 * w_first;
        let i3 = c(1.0 / 3.0) * (ends + c(5.0) * centre * i2 + c(2.0) * product * i1);
        let ends = last2 * last * w_last + first2 * first * w_first;
        let i4 = c(0.25) * (ends + c(7.0) * centre * i3 + c(3.0) * product * i2);
        // ∫ Dⁿ dD.
        let d1 = last - first;
        let d2 = c(0.5) * (last2 - first2);
        let d3 = c(1.0 / 3.0) * (last2 * last - first2 * first);
        let d4 = c(0.25) * (last2 * last2 - first2 * first2);
        c(h[0]) * chord_weighed(chord, [i0, i1, i2], [d1, d2])
            + c(h[1]) * chord_weighed(chord, [i1, i2, i3], [d2, d3])
            + c(h[2]) * chord_weighed(chord, [i2, i3, i4], [d3, d4])
    }

    /// ∫ t² h dv by Gauss–Legendre in v, for curves without a closed form, or if it cancels.
    fn chord_quadrature<T: Real>(curve: Curve, rule: &[[f64; 2]], chord: &Chord<T>) -> T {
        let half = T::HALF;
        let mu = half * chord.odd[0] / chord.a_root;
        let range_max = T::from_f64(RANGE_MAX[0]) + T::from_f64(RANGE_MAX[1]) * mu.max(T::ZERO);
        let half_range = half * chord_range(chord).min(range_max);
        let middle = (T::ONE + chord_growth(chord, chord.last)) * (-half_range).exp();
        let mut sum = T::ZERO;
        // The nodes' exponentials come in pairs, e^(m + d) and e^(m − d).
        for &node in rule {
            sum += chord_pair(curve, chord, mu, middle, half_range, node);
        }
        sum * half_range
    }

    /// The weighed values at the two nodes that lie as far to both sides of the middle: [place, weight].
    fn chord_pair<T: Real>(curve: Curve, chord: &Chord<T>, mu: T, middle: T, half_range: T, node: [f64; 2]) -> T {
        let factor = (half_range * T::from_f64(node[0])).exp();
        let (more, less) = (middle * factor, middle / factor);
        let values = chord_integrand(curve, chord, mu, more) + chord_integrand(curve, chord, mu, less);
        values * T::from_f64(node[1])
    }

    /// t² h at e^v.
    fn chord_integrand<T: Real>(curve: Curve, chord: &Chord<T>, mu: T, exp_v: T) -> T {
        let half = T::HALF;
        let inverse = T::ONE / exp_v;
        let distance = (chord.centre + chord.spread * half * (exp_v + inverse)).max(T::ZERO);
        let w = chord.spread * half * (exp_v - inverse);
        let t = mu + (half * chord.odd[1] * distance) / chord.a_root + chord.a_root * w;
        t * t * curve_h(curve, &[], distance)
    }
}

/// ∫ t² h dv for a custom curve: D's density is linear in each interval of its table.
fn chord_table_integral<T: Scalar>(table: &[f32], chord: Chord<T>) -> T {
    let chord = &chord;
    let ([last, _], [first, w_first]) = (chord.last, chord.first);
    let mut sum = T::ZERO;
    // Spheres that are intersected twice ahead of the surface point: odd terms in W cancel.
    if w_first.above_zero().any() {
        sum += T::TWO * chord_table_section(table, chord, [chord.nearest, T::ZERO], first, T::ZERO);
    }
    // Spheres around the surface point are intersected once.
    if first.less(last).any() {
        sum += chord_table_section(table, chord, [first, w_first.abs()], last, T::ONE);
    }
    sum
}

/// [`chord_table_integral`] on one side of the chord's middle, from the end `from` (D and W) to the distance `to`; `odd`
/// scales the odd terms in W.
fn chord_table_section<T: Scalar>(table: &[f32], chord: &Chord<T>, from: [T; 2], to: T, odd: T) -> T {
    let c = T::from_f64;
    let width = chord.last[0] * c(1.0 / CUSTOM_INTERVALS as f64);
    let per_width = T::ONE / width;
    let begin = ((from[0] * per_width).to_f64() as usize).min(CUSTOM_INTERVALS - 1);
    let mut low = from;
    let mut sum = T::ZERO;
    for interval in begin..CUSTOM_INTERVALS {
        if !low[0].less(to).any() {
            break;
        }
        let end = (width * c(interval as f64 + 1.0)).min(to);
        let beyond = (end - chord.nearest).max(T::ZERO);
        let high = [end, (beyond * (beyond + c(2.0) * chord.spread)).sqrt()];
        // The density of D here: intercept + slope D.
        let numbers = &table[NODE_LENGTH * interval..];
        let [left, right] = [numbers[1], numbers[2]].map(|density| c(f64::from(density)));
        let slope = (right - left) * per_width;
        let intercept = left - slope * (width * c(interval as f64));
        let [inverse, i0] = chord_interval(chord, low, high, interval < begin + 2);
        let i1 = high[1] - low[1] + chord.centre * i0;
        let ends = high[0] * high[1] - low[0] * low[1];
        let i2 = c(0.5) * (ends + c(3.0) * chord.centre * i1 + chord.product * i0);
        let d0 = odd * (high[0] / low[0]).ln();
        let d1 = odd * (high[0] - low[0]);
        let d2 = c(0.5) * d1 * (high[0] + low[0]);
        sum += intercept * chord_weighed(chord, [inverse, i0, i1], [d0, d1])
            + slope * chord_weighed(chord, [i0, i1, i2], [d1, d2]);
        low = high;
    }
    sum
}

inlined! {
    /// ∫ dv/D and ∫ dv between two points (D and W) of one side of the chord: a difference of angles and one of logarithms.
    /// Unless `is_near` the chord's middle, both are so small that a rational function gives them to 1e-7.
    fn chord_interval<T: Real>(chord: &Chord<T>, low: [T; 2], high: [T; 2], is_near: bool) -> [T; 2] {
        let two = T::TWO;
        let gain = high[0] - low[0] + (high[1] - low[1]);
        let base = two * (low[0] - chord.nearest + chord.spread + low[1]);
        let (x_low, x_high) = (
            chord.centre * low[0] + chord.product,
            chord.centre * high[0] + chord.product,
        );
        let rise = x_low * high[1] - x_high * low[1];
        let run = x_low * x_high + chord.product * low[1] * high[1];
        if is_near {
            let root = chord.product.sqrt();
            [(root * rise).atan2(run) / root, log1p(two * gain / base)]
        } else {
            [
                chord_angle(rise / run, chord.product),
                chord_log_ratio(gain / (base + gain)),
            ]
        }
    }

    /// 2 artanh z = ln((1 + z)/(1 − z)) for |z| ≤ 1/3 (Padé).
    fn chord_log_ratio<T: Real>(z: T) -> T {
        let c = T::from_f64;
        let square = z * z;
        let above = c(945.0) - square * (c(735.0) - square * c(64.0));
        let below = c(945.0) - square * (c(1050.0) - square * c(225.0));
        c(2.0) * z * above / below
    }

    /// arctan(√`product` z)/√`product` for √`product` |z| ≤ 0.6 (Padé).
    fn chord_angle<T: Real>(z: T, product: T) -> T {
        let c = T::from_f64;
        let square = product * z * z;
        let above = c(945.0) + square * (c(735.0) + square * c(64.0));
        let below = c(945.0) + square * (c(1050.0) + square * c(225.0));
        z * above / below
    }
}
