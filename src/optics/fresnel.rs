//! The Fresnel factor: which share of the light is reflected at the half vector of view and sampled direction.

pub use super::fresnel_terms::{Fresnel, FresnelTerms, edge_darkening, edge_shape, fresnel_metal, fresnel_schlick};
use super::refraction::refracted_square;
use super::thin_film::{film_change_of_dielectric, film_change_of_metal, film_on_conductor, film_passed};
use crate::optics::prelude::*;

inlined! {
    /// The share reflected, linear RGB in [0, 1]; `cosine` between the half vector and either direction, in [0, 1].
    pub fn fresnel<T: Real>(terms: &FresnelTerms<T>, cosine: T) -> Vec3<T> {
        match terms.model {
            Fresnel::None => terms.tint * terms.weight,
            Fresnel::Schlick | Fresnel::Dielectric => {
                let [dielectric, metal] = fresnel_parts(terms, cosine);
                dielectric.mix(metal, terms.metalness)
            }
            Fresnel::Conductor => {
                let cosine = terms.cosine_in_coat(cosine);
                let mut channels = vec3(
                    fresnel_conductor(cosine, terms.eta.x, terms.k.x),
                    fresnel_conductor(cosine, terms.eta.y, terms.k.y),
                    fresnel_conductor(cosine, terms.eta.z, terms.k.z),
                );
                if terms.has_film {
                    channels = film_on_conductor(terms, cosine, channels);
                }
                channels * terms.tint * terms.weight
            }
        }
    }

    /// The shares that the dielectric and the metal of a surface reflect, by Schlick's model or the exact equations.
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

    /// Each channel brought into [0, 1].
    fn in_unit<T: Real>(share: Vec3<T>) -> Vec3<T> {
        share.map(#[inline(always)] |x| x.clamp(T::ZERO, T::ONE))
    }

    /// Cosine at the half vector of two unit directions: half the length of their sum. √(½ + ½ wo·wi) would lose precision for
    /// nearly opposite directions, where the Fresnel factor is steepest.
    pub fn half_vector_cosine<T: Real>(wo: Vec3<T>, wi: Vec3<T>) -> T {
        (T::HALF * (wo + wi).length()).min(T::ONE)
    }

    /// Reflectance at normal incidence of a dielectric.
    pub fn fresnel_f0<T: Real>(ior: T) -> T {
        let ratio = (ior - T::ONE) / (ior + T::ONE);
        ratio * ratio
    }
}

/// Index of refraction of a dielectric that reflects `weight` times as much at normal incidence, and all at grazing angles.
pub fn weighted_ior(ior: f64, weight: f64) -> f64 {
    let root = (fresnel_f0(ior) * weight).clamp(0.0, 0.99).sqrt();
    (1.0 + root) / (1.0 - root)
}

inlined! {
    /// Fresnel's equations for unpolarised light at a boundary of two dielectrics. `cosine` in [0, 1] on the incident side,
    /// `ior` = index behind the boundary over index before it; 1 under total internal reflection.
    pub fn fresnel_dielectric<T: Real>(cosine: T, ior: T) -> T {
        let c = cosine.clamp(T::ZERO, T::ONE);
        // ior² cos²θt, not negative unless the reflection is total.
        let square = refracted_square(c, ior);
        let g = square.safe_sqrt();
        let perpendicular = (c - g) / (c + g).max(T::from_f64(1e-12));
        let parallel = (ior * ior * c - g) / (ior * ior * c + g).max(T::from_f64(1e-12));
        let half = T::HALF;
        let value = half * (perpendicular * perpendicular + parallel * parallel);
        T::select(square.below_zero(), T::ONE, value)
    }

    /// Fresnel's equations for unpolarised light on a conductor with complex index `eta` + i `k` against vacuum.
    /// Source: Lagarde, "Memo on Fresnel equations" (2013).
    pub fn fresnel_conductor<T: Real>(cosine: T, eta: T, k: T) -> T {
        let c = cosine.clamp(T::ZERO, T::ONE);
        let cos2 = c * c;
        let sin2 = (T::ONE - c) * (T::ONE + c);
        // (a + ib)² = t0 + iu, written without cancellation, at grazing for η near 1 and head-on for η near 0. Its magnitude
        // without squares, which would overflow.
        let half = T::HALF;
        let real = T::select(cos2.less(half), refracted_square(c, eta), eta * eta - sin2);
        let t0 = real - k * k;
        let u = T::TWO * eta * k;
        let largest = t0.abs().max(u).max(T::from_f64(1e-30));
        let (x, y) = (t0 / largest, u / largest);
        let a2_plus_b2 = largest * (x * x + y * y).sqrt();
        let leg = (T::HALF * (a2_plus_b2 + t0.abs())).sqrt();
        let a = T::select(t0.below_zero(), T::HALF * u / leg.max(T::from_f64(1e-30)), leg);
        let t1 = a2_plus_b2 + cos2;
        let t2 = T::TWO * a * c;
        // Avoids 0/0: no wave behind the surface, or normal incidence, where both polarisations are alike.
        let tiny = T::from_f64(1e-37);
        let perpendicular = (t1 - t2) / (t1 + t2).max(tiny);
        let t3 = cos2 * a2_plus_b2 + sin2 * sin2;
        let t4 = t2 * sin2;
        let sum = t3 + t4;
        let ratio = T::select(sum.less(tiny), T::ONE, (t3 - t4) / sum.max(tiny));
        let parallel = perpendicular * ratio;
        (half * (perpendicular + parallel)).clamp(T::ZERO, T::ONE)
    }
}

inlined! {
    /// Transmittance of a facet, linear RGB in [0, 1]: 1 − [`fresnel`] without metal, which refracts nothing, and without tint,
    /// which is the reflection's alone (OpenPBR 1.1, "Dielectric base"). Written to keep precision if nearly everything is
    /// reflected. `cosine` is between the facet's normal and the view, `behind` between it and the refracted direction, both
    /// in [0, 1].
    pub fn fresnel_left<T: Real>(terms: &FresnelTerms<T>, cosine: T, behind: T) -> Vec3<T> {
        let mut left = Vec3::splat(fresnel_transmitted(cosine, behind, terms.ior));
        if terms.has_film {
            left += film_passed(terms, cosine, Some(terms.ior * behind));
        }
        (Vec3::splat(T::ONE - terms.weight) + left * terms.weight).at_least_zero()
    }

    /// The share that a boundary of two dielectrics lets through, by the cosines on both sides; `ior` as in
    /// [`fresnel_dielectric`]. The refracted cosine is given and not computed from the other: at the critical angle that would
    /// lose half of its digits.
    pub fn fresnel_transmitted<T: Real>(cosine: T, behind: T, ior: T) -> T {
        T::HALF * (passed(cosine, ior * behind) + passed(ior * cosine, behind))
    }

    /// 1 − ((a − b)/(a + b))².
    fn passed<T: Real>(a: T, b: T) -> T {
        let sum = (a + b).max(T::from_f64(1e-12));
        T::from_f64(4.0) * (a / sum) * (b / sum)
    }
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
