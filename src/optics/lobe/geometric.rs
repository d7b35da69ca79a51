//! The geometric lobe: the mirror direction plus a random vector (paper, eqs. 8 to 10), and its density, which the
//! paper calls unavailable (docs/MATHEMATICS.md, section 4).
//!
//! In the frame where the lobe is a unit ball (widths M divided out) a sample is a + D (V + κ n). The density is an
//! integral over the distance t along ω, smooth in u with t = B/A + √(Δ/A) sinh u. Here it is written with the part of
//! `a` that is perpendicular to ω, so that nothing cancels where the lobe is narrow (R → 0) or Lambertian (R → 1).

use super::{LobeShape, stretch_from_anisotropy};
use crate::optics::curve::{Curve, curve_distance, curve_distance_max, curve_h};
use crate::optics::frame::{Frame, local_from_world, world_from_local};
use crate::optics::numeric::{arsinh, normalize_or};
use crate::optics::real::Real;
use crate::optics::vector::{Vec3, vec3};
use crate::optics::warp::uniform_sphere;

/// The horizon policy decides about samples below the surface.
pub const HEMISPHERICAL: bool = false;
/// Widths along tangent and bitangent.
pub const ANISOTROPIC: bool = true;

/// Roughness up to which eight nodes integrate the density to better than 1e-3 at 99.9 % of the sampled directions.
pub const FEW_NODES_ROUGHNESS: f64 = 0.6;
/// Longest range of u worth integrating: the integrand falls as e^(2u) towards its lower end.
pub const RANGE_MAX: f64 = 14.0;

/// Positive nodes and weights of the 8-point Gauss–Legendre rule on [−1, 1].
const GAUSS_8: [[f64; 2]; 4] = [
    [0.18343464249564978, 0.362683783378362],
    [0.525532409916329, 0.3137066458778874],
    [0.7966664774136268, 0.22238103445337445],
    [0.9602898564975363, 0.10122853629037679],
];
/// Positive nodes and weights of the 16-point Gauss–Legendre rule on [−1, 1].
const GAUSS_16: [[f64; 2]; 8] = [
    [0.09501250983763744, 0.18945061045506847],
    [0.2816035507792589, 0.1826034150449236],
    [0.45801677765722737, 0.16915651939500256],
    [0.6178762444026438, 0.14959598881657682],
    [0.755404408355003, 0.12462897125553395],
    [0.8656312023878318, 0.0951585116824929],
    [0.9445750230732326, 0.062253523938647776],
    [0.9894009349916499, 0.027152459411754058],
];

/// Widths of the lobe along the frame's axes: R itself three times, or stretched with the product of the first two kept.
#[inline(always)]
fn widths<T: Real>(shape: &LobeShape<'_, T>) -> Vec3<T> {
    let stretch = stretch_from_anisotropy(shape.anisotropy);
    vec3(shape.roughness * stretch, shape.roughness / stretch, shape.roughness)
}

/// The mirror direction plus a random vector: w = (1 − R) r + R (V + R n) D(ξ), normalised (paper, eqs. 8 to 10). The
/// anisotropic lobe scales V + R n along the frame's axes.
#[inline(always)]
pub fn sample<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, xi: [T; 3]) -> Vec3<T> {
    let roughness = shape.roughness;
    let mirror = wo.mirrored_about(frame.normal);
    let ball = uniform_sphere([xi[0], xi[1]]) + frame.normal * roughness;
    let distance = curve_distance(shape.curve, shape.table, xi[2]);
    let spread = if is_stretched(shape) {
        let local = local_from_world(frame, ball);
        let width = widths(shape);
        world_from_local(frame, local * width)
    } else {
        ball * roughness
    };
    // R = 1 with D = 0 or V = −n leaves nothing to normalise: any direction is right for a set of measure zero.
    normalize_or(mirror * (T::one() - roughness) + spread * distance, frame.normal)
}

/// The density of [`sample`] over the whole sphere, per steradian (mathematics, section 4).
#[inline(always)]
pub fn density<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, wi: Vec3<T>) -> T {
    let mirror = wo.mirrored_about(frame.normal);
    if !is_stretched(shape) {
        let scale = (T::one() - shape.roughness) / shape.roughness;
        return unit_ball_density(shape, frame.normal, mirror, scale, wi);
    }
    let width = widths(shape);
    let unstretched = |v: Vec3<T>| {
        let local = local_from_world(frame, v);
        vec3(local.x / width.x, local.y / width.y, local.z / width.z)
    };
    let (mirror, light) = (unstretched(mirror), unstretched(wi));
    let (mirror_length, light_length) = (mirror.length(), light.length());
    let up = vec3(T::zero(), T::zero(), T::one());
    let scale = (T::one() - shape.roughness) * mirror_length;
    let value = unit_ball_density(shape, up, mirror / mirror_length, scale, light / light_length);
    value / (width.x * width.y * width.z * light_length * light_length * light_length)
}

/// Always 1: the lobe is its density.
#[inline(always)]
pub fn weight<T: Real>(_shape: &LobeShape<'_, T>, _frame: &Frame<T>, _wo: Vec3<T>, _wi: Vec3<T>) -> T {
    T::one()
}

/// True where the widths differ.
#[inline(always)]
fn is_stretched<T: Real>(shape: &LobeShape<'_, T>) -> bool {
    shape.anisotropy.to_f64() != 0.0
}

/// The integrand's geometry for one direction ω: everything that does not depend on the node.
struct Chord<T> {
    /// κ = R.
    kappa: T,
    /// 1 − κ².
    k: T,
    /// n·ω.
    nu: T,
    /// n·a⊥, a⊥ the part of a perpendicular to ω.
    m: T,
    /// |a⊥|².
    e: T,
    /// Middle of t − ω·a.
    tau_middle: T,
    /// √(Δ/A) and √Δ.
    tau_scale: T,
    delta_root: T,
    /// ω·a.
    mu: T,
}

impl<T: Real> Chord<T> {
    /// t² h(D) at e^u.
    #[inline(always)]
    fn integrand(&self, shape: &LobeShape<'_, T>, exp_u: T) -> T {
        let inverse = T::one() / exp_u;
        let half = T::from_f64(0.5);
        let tau = self.tau_middle + self.tau_scale * half * (exp_u - inverse);
        let s = self.delta_root * half * (exp_u + inverse);
        // D is the positive root of k D² + 2κ(n·q) D − |q|² = 0 in the form that does not cancel.
        let lifted = self.kappa * (tau * self.nu - self.m);
        let distance = T::select(
            T::zero().less(lifted),
            (tau * tau + self.e) / (lifted + s),
            (s - lifted) / self.k.max(T::from_f64(1e-9)),
        );
        let t = (tau + self.mu).max(T::zero());
        t * t * curve_h(shape.curve, shape.table, distance)
    }
}

/// The density where the lobe is a unit ball: `mirror`, `light` and `normal` unit vectors of that frame, a = `scale` ×
/// `mirror`.
#[inline(always)]
fn unit_ball_density<T: Real>(
    shape: &LobeShape<'_, T>,
    normal: Vec3<T>,
    mirror: Vec3<T>,
    scale: T,
    light: Vec3<T>,
) -> T {
    let kappa = shape.roughness;
    let k = ((T::one() - kappa) * (T::one() + kappa)).max(T::zero());
    let apart = mirror - light;
    let versine = T::from_f64(0.5) * apart.dot(apart);
    // a⊥ from the difference of the two directions: exact where they are close.
    let perpendicular = (apart + light * versine) * scale;
    let mu = scale * (T::one() - versine);
    let (nu, m, e) = (normal.dot(light), normal.dot(perpendicular), perpendicular.dot(perpendicular));
    let kappa2 = kappa * kappa;
    let a = kappa2 * nu * nu + k;
    let a_root = a.max(T::from_f64(1e-30)).sqrt();
    // A Δ, clamped from below: at a⊥ = 0 the density has an integrable peak.
    let a_delta = (k * (kappa2 * (nu * nu * e + m * m) + k * e)).max(T::from_f64(1e-18));
    let tau_scale = a_delta.sqrt() / (a_root * a_root);
    let tau_middle = kappa2 * nu * m / (a_root * a_root);
    // The chord of the ball of D's maximum, and the part of it ahead of the surface point (t ≥ 0).
    let reach: T = curve_distance_max(shape.curve, shape.table);
    let discriminant = reach * reach * a - e - T::from_f64(2.0) * reach * kappa * m;
    let half_chord = discriminant.safe_sqrt();
    let tau_last = reach * kappa * nu + half_chord;
    let tau_first = (reach * kappa * nu - half_chord).max(-mu);
    let inside = T::zero().less(discriminant) & tau_first.less(tau_last);
    let u_last = arsinh((tau_last - tau_middle) / tau_scale);
    let u_first = arsinh((tau_first - tau_middle) / tau_scale).max(u_last - T::from_f64(RANGE_MAX));
    let chord = Chord { kappa, k, nu, m, e, tau_middle, tau_scale, delta_root: tau_scale * a_root, mu };
    let integral = integrate(shape, &chord, u_first, u_last);
    let value = T::from_f64(0.25 * std::f64::consts::FRAC_1_PI) * integral / a_root;
    T::select(inside, value.max(T::zero()), T::zero())
}

/// Gauss–Legendre over u in [`first`, `last`]; the nodes' exponentials come in pairs, e^(c + d) and e^(c − d).
#[inline(always)]
fn integrate<T: Real>(shape: &LobeShape<'_, T>, chord: &Chord<T>, first: T, last: T) -> T {
    let half = T::from_f64(0.5) * (last - first);
    let middle = (T::from_f64(0.5) * (last + first)).exp();
    let mut sum = T::zero();
    let mut add = |node: [f64; 2]| {
        let step = (half * T::from_f64(node[0])).exp();
        let pair = chord.integrand(shape, middle * step) + chord.integrand(shape, middle / step);
        sum += pair * T::from_f64(node[1]);
    };
    if has_few_nodes(shape) {
        GAUSS_8.into_iter().for_each(&mut add);
    } else {
        GAUSS_16.into_iter().for_each(&mut add);
    }
    sum * half
}

/// True where eight nodes are enough.
#[inline(always)]
fn has_few_nodes<T: Real>(shape: &LobeShape<'_, T>) -> bool {
    matches!(shape.curve, Curve::Sqrt | Curve::Cbrt | Curve::Smooth) && shape.roughness.to_f64() <= FEW_NODES_ROUGHNESS
}
