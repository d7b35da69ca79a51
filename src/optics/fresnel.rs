//! The Fresnel factor: which share of the light is reflected at the half vector of view and sampled direction.

use super::real::{Mask, Real};
use super::refraction::refracted_square;
use super::thin_film::{FilmTerms, LEAST_FILM_COSINE, film_on_conductor, film_on_metal, film_passed};
use super::vector::{Vec3, vec3};
use crate::named::named;

named! {
    /// The Fresnel model.
    Fresnel {
        None = 0, "none", "None", "Every sample counts fully: F = 1 at any angle, tinted by the specular colour.";
        Schlick = 1, "schlick", "Schlick", "Schlick's approximation from the reflectance at normal incidence.";
        Dielectric = 2, "dielectric", "Dielectric", "The exact equations for glass, water, plastic, lacquer, from the index of refraction.";
        Conductor = 3, "conductor", "Conductor", "The exact equations for metals, from η and k of each colour channel.";
    }
}

/// Parameters of the Fresnel factor, besides the angle.
#[derive(Clone, Copy, Debug)]
pub struct FresnelTerms<T> {
    /// Equation of the Fresnel factor.
    pub model: Fresnel,
    /// Reflectance at normal incidence of the metal, linear RGB.
    pub metal_f0: Vec3<T>,
    /// 0 for a dielectric, 1 for a metal.
    pub metalness: T,
    /// Tint, linear RGB: of the reflectance at normal incidence in Schlick's model for a dielectric, else of the whole
    /// factor.
    pub tint: Vec3<T>,
    /// Factor of a metal's reflection: tint times weight, or 1 if those spare metals.
    pub metal_tint: Vec3<T>,
    /// Factor of a metal's reflection near 82 degrees; 1 for none.
    pub edge_tint: Vec3<T>,
    /// Share of the reflection that is kept at any angle, in [0, 1]; a metal's is in `metal_tint`.
    pub weight: T,
    /// Relative index of refraction of the dielectric.
    pub ior: T,
    /// Conductor: real part of the index of refraction a channel.
    pub eta: Vec3<T>,
    /// Conductor: imaginary part a channel, not negative.
    pub k: Vec3<T>,
    /// True where the surface has a thin film.
    pub has_film: bool,
    /// The thin film.
    pub film: FilmTerms<T>,
}

impl<T: Real> FresnelTerms<T> {
    /// The same without metal.
    #[inline(always)]
    pub fn of_dielectric(&self) -> Self {
        let metalness = T::zero();
        Self { metalness, ..*self }
    }
}

/// The share reflected, linear RGB in [0, 1]; `cosine` between the half vector and either direction, in [0, 1].
#[inline(always)]
pub fn fresnel<T: Real>(terms: &FresnelTerms<T>, cosine: T) -> Vec3<T> {
    match terms.model {
        Fresnel::None => terms.tint * terms.weight,
        Fresnel::Schlick | Fresnel::Dielectric => {
            let [dielectric, metal] = fresnel_parts(terms, cosine);
            dielectric.mix(metal, terms.metalness)
        }
        Fresnel::Conductor => {
            let mut channels = vec3(
                fresnel_conductor(cosine, terms.eta.x, terms.k.x),
                fresnel_conductor(cosine, terms.eta.y, terms.k.y),
                fresnel_conductor(cosine, terms.eta.z, terms.k.z),
            );
            if terms.has_film {
                channels = film_on_conductor(&terms.film, cosine, [terms.eta, terms.k], channels);
            }
            channels * terms.tint * terms.weight
        }
    }
}

/// The shares that the dielectric and the metal of a surface reflect, by Schlick's model or the exact equations.
#[inline(always)]
pub fn fresnel_parts<T: Real>(terms: &FresnelTerms<T>, cosine: T) -> [Vec3<T>; 2] {
    let dielectric = if terms.model == Fresnel::Schlick {
        fresnel_schlick(terms.tint * fresnel_f0(terms.ior), cosine)
    } else {
        terms.tint * fresnel_dielectric(cosine, terms.ior)
    };
    let metal = fresnel_metal(terms.metal_f0, terms.edge_tint, cosine) * terms.metal_tint;
    let parts = [dielectric * terms.weight, metal];
    if !terms.has_film {
        return parts;
    }
    [
        in_unit(parts[0] + film_change_of_dielectric(terms, cosine)),
        in_unit(parts[1] + film_change_of_metal(terms, cosine)),
    ]
}

/// The change by a thin film of what the dielectric of a surface reflects, tint included.
#[inline(always)]
pub fn film_change_of_dielectric<T: Real>(terms: &FresnelTerms<T>, cosine: T) -> Vec3<T> {
    if !terms.metalness.less(T::one()).any() {
        return Vec3::zero();
    }
    let height = refracted_square(cosine.max(T::from_f64(LEAST_FILM_COSINE)), terms.ior).safe_sqrt();
    let passed = T::out_of_line(
        #[inline(always)]
        || film_passed(&terms.film, terms.ior, cosine, height),
    );
    -(terms.tint.map(|x| x.min(T::one())) * passed) * terms.weight
}

/// The change by a thin film of what the metal of a surface reflects, tint included.
#[inline(always)]
pub fn film_change_of_metal<T: Real>(terms: &FresnelTerms<T>, cosine: T) -> Vec3<T> {
    if !T::zero().less(terms.metalness).any() {
        return Vec3::zero();
    }
    let colors = [terms.metal_f0, terms.edge_tint];
    let bare = fresnel_metal(terms.metal_f0, terms.edge_tint, cosine);
    let changed = T::out_of_line(
        #[inline(always)]
        || film_on_metal(&terms.film, cosine, colors, bare),
    );
    changed * terms.metal_tint
}

/// Each channel brought into [0, 1].
#[inline(always)]
fn in_unit<T: Real>(share: Vec3<T>) -> Vec3<T> {
    share.map(|x| x.clamp(T::zero(), T::one()))
}

/// Cosine at the half vector of two unit directions: half the length of their sum. √(½ + ½ wo·wi) would lose precision for
/// nearly opposite directions, where the Fresnel factor is steepest.
#[inline(always)]
pub fn half_vector_cosine<T: Real>(wo: Vec3<T>, wi: Vec3<T>) -> T {
    (T::from_f64(0.5) * (wo + wi).length()).min(T::one())
}

/// Reflectance at normal incidence of a dielectric.
#[inline(always)]
pub fn fresnel_f0<T: Real>(ior: T) -> T {
    let ratio = (ior - T::one()) / (ior + T::one());
    ratio * ratio
}

/// Index of refraction of a dielectric that reflects `weight` times as much at normal incidence, and all at grazing angles.
pub fn weighted_ior(ior: f64, weight: f64) -> f64 {
    let root = (fresnel_f0(ior) * weight).clamp(0.0, 0.99).sqrt();
    (1.0 + root) / (1.0 - root)
}

/// Schlick's approximation (1994).
#[inline(always)]
pub fn fresnel_schlick<T: Real>(f0: Vec3<T>, cosine: T) -> Vec3<T> {
    let x = (T::one() - cosine).clamp(T::zero(), T::one());
    let x2 = x * x;
    let grazing = x2 * x2 * x;
    f0 + (Vec3::splat(T::one()) - f0) * grazing
}

/// The reflectance of a metal that is `f0` at normal incidence: Schlick's, darkened near 82 degrees by `edge_tint` (the
/// F82-tint model: Kutz, Hasan and Edmondson, "Novel aspects of the Adobe Standard Material", 2021; OpenPBR 1.1).
#[inline(always)]
pub fn fresnel_metal<T: Real>(f0: Vec3<T>, edge_tint: Vec3<T>, cosine: T) -> Vec3<T> {
    let plain = fresnel_schlick(f0, cosine);
    let is_tinted = (edge_tint.x + edge_tint.y + edge_tint.z).less(T::from_f64(3.0));
    if !is_tinted.any() {
        return plain;
    }
    let darkening = edge_darkening(f0, edge_tint) * edge_shape(cosine);
    Vec3::select(is_tinted, (plain - darkening).at_least_zero(), plain)
}

/// Factor of [`edge_shape`] that leaves exactly the tint at a cosine of 1/7.
#[inline(always)]
pub fn edge_darkening<T: Real>(f0: Vec3<T>, edge_tint: Vec3<T>) -> Vec3<T> {
    let seventh = T::from_f64(1.0 / 7.0);
    let white = Vec3::splat(T::one());
    fresnel_schlick(f0, seventh) * (white - edge_tint) * (T::one() / edge_shape(seventh))
}

/// Angular shape of the darkening towards the edge: cosθ (1 − cosθ)⁶, largest at a cosine of 1/7.
#[inline(always)]
pub fn edge_shape<T: Real>(cosine: T) -> T {
    let c = cosine.clamp(T::zero(), T::one());
    let x = T::one() - c;
    let x2 = x * x;
    c * x2 * x2 * x2
}

/// Fresnel's equations for unpolarised light at a boundary of two dielectrics. `cosine` in [0, 1] on the incident side,
/// `ior` = index behind the boundary over index before it; 1 under total internal reflection.
#[inline(always)]
pub fn fresnel_dielectric<T: Real>(cosine: T, ior: T) -> T {
    let c = cosine.clamp(T::zero(), T::one());
    // ior² cos²θt, not negative unless the reflection is total.
    let square = refracted_square(c, ior);
    let g = square.safe_sqrt();
    let perpendicular = (c - g) / (c + g).max(T::from_f64(1e-12));
    let parallel = (ior * ior * c - g) / (ior * ior * c + g).max(T::from_f64(1e-12));
    let half = T::from_f64(0.5);
    let value = half * (perpendicular * perpendicular + parallel * parallel);
    T::select(square.less(T::zero()), T::one(), value)
}

/// Fresnel's equations for unpolarised light on a conductor with complex index `eta` + i `k` against vacuum.
/// Source: Lagarde, "Memo on Fresnel equations" (2013).
#[inline(always)]
pub fn fresnel_conductor<T: Real>(cosine: T, eta: T, k: T) -> T {
    let c = cosine.clamp(T::zero(), T::one());
    let cos2 = c * c;
    let sin2 = (T::one() - c) * (T::one() + c);
    // (a + ib)² = t0 + iu, written without cancellation, at grazing for η near 1 and head-on for η near 0. Its magnitude
    // without squares, which would overflow.
    let half = T::from_f64(0.5);
    let real = T::select(cos2.less(half), refracted_square(c, eta), eta * eta - sin2);
    let t0 = real - k * k;
    let u = T::from_f64(2.0) * eta * k;
    let largest = t0.abs().max(u).max(T::from_f64(1e-30));
    let (x, y) = (t0 / largest, u / largest);
    let a2_plus_b2 = largest * (x * x + y * y).sqrt();
    let leg = (T::from_f64(0.5) * (a2_plus_b2 + t0.abs())).sqrt();
    let a = T::select(
        t0.less(T::zero()),
        T::from_f64(0.5) * u / leg.max(T::from_f64(1e-30)),
        leg,
    );
    let t1 = a2_plus_b2 + cos2;
    let t2 = T::from_f64(2.0) * a * c;
    // Avoids 0/0: no wave behind the surface, or normal incidence, where both polarisations are alike.
    let tiny = T::from_f64(1e-37);
    let perpendicular = (t1 - t2) / (t1 + t2).max(tiny);
    let t3 = cos2 * a2_plus_b2 + sin2 * sin2;
    let t4 = t2 * sin2;
    let sum = t3 + t4;
    let ratio = T::select(sum.less(tiny), T::one(), (t3 - t4) / sum.max(tiny));
    let parallel = perpendicular * ratio;
    (half * (perpendicular + parallel)).clamp(T::zero(), T::one())
}

/// Transmittance of a facet, linear RGB in [0, 1]: 1 − [`fresnel`] without metal, which refracts nothing. Written to keep
/// precision if nearly everything is reflected. `cosine` is between the facet's normal and the view, `behind` between it and
/// the refracted direction, both in [0, 1].
#[inline(always)]
pub fn fresnel_left<T: Real>(terms: &FresnelTerms<T>, cosine: T, behind: T) -> Vec3<T> {
    let white = Vec3::splat(T::one());
    let mut left = match terms.model {
        Fresnel::None | Fresnel::Conductor => {
            let weight = T::one();
            white - fresnel(&FresnelTerms { weight, ..*terms }, cosine)
        }
        Fresnel::Schlick => {
            let c = cosine.clamp(T::zero(), T::one());
            // 1 − (1 − c)⁵.
            let five = T::from_f64(5.0);
            let ten = T::from_f64(10.0);
            let beside_grazing = c * (five - c * (ten - c * (ten - c * (five - c))));
            (white - terms.tint * fresnel_f0(terms.ior)) * beside_grazing
        }
        Fresnel::Dielectric => {
            let through = fresnel_transmitted(cosine, behind, terms.ior);
            white - terms.tint + terms.tint * through
        }
    };
    if terms.has_film && matches!(terms.model, Fresnel::Schlick | Fresnel::Dielectric) {
        left += terms.tint.map(|x| x.min(T::one())) * film_passed(&terms.film, terms.ior, cosine, terms.ior * behind);
    }
    (white * (T::one() - terms.weight) + left * terms.weight).at_least_zero()
}

/// The share that a boundary of two dielectrics lets through, by the cosines on both sides; `ior` as in
/// [`fresnel_dielectric`]. The refracted cosine is given and not computed from the other: at the critical angle that would
/// lose half of its digits.
#[inline(always)]
pub fn fresnel_transmitted<T: Real>(cosine: T, behind: T, ior: T) -> T {
    T::from_f64(0.5) * (passed(cosine, ior * behind) + passed(ior * cosine, behind))
}

/// 1 − ((a − b)/(a + b))².
#[inline(always)]
fn passed<T: Real>(a: T, b: T) -> T {
    let sum = (a + b).max(T::from_f64(1e-12));
    T::from_f64(4.0) * (a / sum) * (b / sum)
}

/// A metal of the preset list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metal {
    /// Name in presets and on the command line.
    pub name: &'static str,
    /// η at about 650, 550 and 450 nm.
    pub eta: [f64; 3],
    /// k at the same wavelengths.
    pub k: [f64; 3],
}

const fn metal(name: &'static str, eta: [f64; 3], k: [f64; 3]) -> Metal {
    Metal { name, eta, k }
}

/// Measured metals, sampled at the primaries (refractiveindex.info: Johnson and Christy 1972 and 1974, Rakić 1998; brass: Querry
/// 1985; mercury: Inagaki 1981).
pub const METALS: &[Metal] = &[
    metal("gold", [0.143, 0.375, 1.442], [3.983, 2.386, 1.603]),
    metal("copper", [0.200, 0.924, 1.102], [3.912, 2.452, 2.142]),
    metal("silver", [0.155, 0.117, 0.138], [4.828, 3.122, 2.147]),
    metal("aluminium", [1.657, 0.880, 0.521], [9.224, 6.270, 4.837]),
    metal("iron", [2.911, 2.950, 2.585], [3.089, 2.932, 2.767]),
    metal("chromium", [3.108, 3.180, 2.230], [3.317, 3.330, 3.147]),
    metal("brass", [0.444, 0.527, 1.094], [3.695, 2.765, 1.829]),
    metal("platinum", [2.376, 2.085, 1.845], [4.266, 3.715, 3.137]),
    metal("titanium", [2.741, 2.542, 2.237], [3.814, 3.435, 3.024]),
    metal("mercury", [2.073, 1.552, 1.061], [5.338, 4.651, 3.863]),
];
