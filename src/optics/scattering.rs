//! Multiple scattering between facets: single scattering loses the light that meets a second facet. A factor of the view
//! gives it back, so that no new direction is needed. Source: Turquin, "Practical multiple scattering compensation for
//! microfacet models" (2019).
//!
//! A metal's lobe is multiplied by 1 + F₀ (1 − E)/E, E being the energy that the lobe keeps with F = 1: a white metal
//! reflects all light. At a clear interface reflection and refraction are divided by the energy that both keep together.
//! The base below a dielectric takes what its lobe loses, so that needs no factor.

use rayon::prelude::*;

use super::albedo::{
    ALBEDO_LENGTH, ALBEDO_NODES, ROUGH_ALBEDO_LENGTH, ROUGHNESS_NODES, albedo_lookup, rough_albedo_lookup,
};
use super::frame::frame_from_normal;
use super::fresnel::{
    Fresnel, FresnelTerms, fresnel, fresnel_dielectric, fresnel_parts, fresnel_transmitted, half_vector_cosine,
};
use super::lobe::{LobeShape, lobe_sample};
use super::material::{COMPENSATES, Material, Surface};
use super::random::even_point;
use super::real::{Mask, Real};
use super::refraction::{refracted_square, refracting_cosines};
use super::thin_film::film_passed;
use super::vector::{Vec3, vec3};

/// Factor that keeps a clear interface's light, linear RGB: one over the energy of reflection and refraction together. A
/// film shares the light otherwise in each channel.
#[inline(always)]
pub fn interface_gain<T: Real>(material: &Material<T>, surface: &Surface<T>, shape: &LobeShape<'_, T>) -> Vec3<T> {
    if !material.has_flag(COMPENSATES) {
        return Vec3::splat(T::one());
    }
    let is_within = surface.is_within(material);
    let gain = |channel: usize| {
        let [_, outside, inside] = kept_energies(material, surface, shape, channel);
        T::one() / T::select(is_within, inside, outside)
    };
    let first = gain(0);
    if material.has_film == 0 || !material.transmits().any() {
        return Vec3::splat(first);
    }
    vec3(first, gain(1), gain(2))
}

/// The share that the specular lobe reflects at a half vector, linear RGB, with what its facets scatter more than once;
/// `once` is its Fresnel factor.
#[inline(always)]
pub fn scattered_again<T: Real>(
    material: &Material<T>,
    surface: &Surface<T>,
    shape: &LobeShape<'_, T>,
    terms: &FresnelTerms<T>,
    cosine: T,
    once: Vec3<T>,
) -> Vec3<T> {
    if !material.has_flag(COMPENSATES) {
        return once;
    }
    T::out_of_line(
        #[inline(always)]
        || compensated(material, surface, shape, terms, cosine),
    )
}

/// [`scattered_again`] of a lobe that is compensated.
#[inline(always)]
fn compensated<T: Real>(
    material: &Material<T>,
    surface: &Surface<T>,
    shape: &LobeShape<'_, T>,
    terms: &FresnelTerms<T>,
    cosine: T,
) -> Vec3<T> {
    let (white, one) = (Vec3::splat(T::one()), T::one());
    let [kept, ..] = kept_energies(material, surface, shape, 0);
    let again = (one - kept) / kept;
    if matches!(terms.model, Fresnel::None | Fresnel::Conductor) {
        let head_on = fresnel(terms, one);
        return fresnel(terms, cosine) * (white + head_on * (again * terms.metalness));
    }
    let [dielectric, metal] = fresnel_parts(terms, cosine);
    let mut head_on = terms.metal_f0 * terms.metal_tint;
    if terms.has_film {
        head_on = fresnel_parts(terms, one)[1];
    }
    let metal = metal * (white + head_on * again);
    // The refracting share of a dielectric is clear; the rest lies over a base.
    let share = T::select(material.transmits(), material.transmission_weight, T::zero());
    let gain = white + (interface_gain(material, surface, shape) - white) * share;
    (dielectric * gain).mix(metal, terms.metalness)
}

/// Energies that single scattering keeps for a view, by a channel's table: of a white metal, and of a clear interface from
/// outside and within.
#[inline(always)]
fn kept_energies<T: Real>(
    material: &Material<T>,
    surface: &Surface<T>,
    shape: &LobeShape<'_, T>,
    channel: usize,
) -> [T; 3] {
    let place = surface.frame.normal.dot(surface.wo).safe_sqrt();
    if material.has_rough_tables == 1 {
        let table = (channel * ROUGH_ALBEDO_LENGTH) as u32;
        let [metal, outside, inside, _] = rough_albedo_lookup(shape.table, table, place, material.roughness);
        return [metal, outside, inside];
    }
    let kept = albedo_lookup(shape.table, (channel * ALBEDO_LENGTH) as u32, place);
    [kept.x, kept.y, kept.z]
}

/// Table of the energies that a material's lobe keeps, over the root of the view's cosine, and over the roughness if its
/// albedo tables are: of a white metal, of a clear interface from outside and from within, 0. One for each channel follows
/// the other where a film shares the light of an interface. `samples` per node.
pub fn scattering_table(material: &Material<f64>, samples: u32) -> Vec<f32> {
    let is_rough = material.has_rough_tables == 1;
    let steps = if is_rough { ROUGHNESS_NODES } else { 1 };
    let offset = material.transmission_roughness - material.roughness;
    let energies = |index: usize| {
        let (step, node) = (index / ALBEDO_NODES, index % ALBEDO_NODES);
        let roughness = match is_rough {
            true => step as f64 / (ROUGHNESS_NODES - 1) as f64,
            false => material.roughness,
        };
        let material = Material {
            roughness,
            transmission_roughness: (roughness + offset).clamp(0.0, 1.0),
            ..*material
        };
        let place = node as f64 / (ALBEDO_NODES - 1) as f64;
        // At exactly grazing the microfacet lobes are 0/0.
        energies_at(&material, (place * place).max(1e-4), samples)
    };
    let energies: Vec<_> = (0..steps * ALBEDO_NODES).into_par_iter().map(energies).collect();
    let channels = if material.has_film == 1 && material.transmits() {
        3
    } else {
        1
    };
    let table = |channel: usize| {
        let of_node = move |[metal, outside, inside]: &[Vec3<f64>; 3]| {
            let numbers = [metal, outside, inside].map(|energy| energy.to_f64()[channel] as f32);
            [numbers[0], numbers[1], numbers[2], 0.0]
        };
        energies.iter().flat_map(of_node)
    };
    (0..channels).flat_map(table).collect()
}

/// Energies that single scattering keeps, linear RGB: of a white metal, of a clear interface from outside and from within.
fn energies_at(material: &Material<f64>, cosine: f64, samples: u32) -> [Vec3<f64>; 3] {
    let white = Vec3::splat(1.0);
    let reflecting = material.shape(&[]);
    if !material.transmits() {
        return [white * kept_energy(&reflecting, cosine, samples), white, white];
    }
    let sides = [false, true].map(|is_inside| Side::of(material, is_inside));
    // The same facets reflect all of it.
    let [metal, outside, inside] = mean_weights(&reflecting, cosine, samples, |wo, wi| {
        let facet = half_vector_cosine(wo, wi);
        [white, sides[0].reflected(facet), sides[1].reflected(facet)]
    });
    let [outside, inside] =
        [(outside, &sides[0], false), (inside, &sides[1], true)].map(|(reflected, side, is_inside)| {
            let shape = material.transmission_shape(&[], is_inside);
            let [refracted] = mean_weights(&shape, cosine, samples, |wo, wi| [side.refracted(wo, wi)]);
            reflected + refracted
        });
    [metal, outside, inside]
}

/// A clear interface, seen from one side.
struct Side {
    terms: FresnelTerms<f64>,
    eta: f64,
}

impl Side {
    fn of(material: &Material<f64>, is_inside: bool) -> Self {
        Self {
            // Under a coat the reflection has another index than the refraction.
            terms: FresnelTerms {
                tint: Vec3::splat(1.0),
                ..material.fresnel_terms(is_inside)
            },
            eta: material.ior_ahead(is_inside),
        }
    }

    /// What a film lets through more, by channel.
    fn film(&self, cosine: f64) -> Vec3<f64> {
        if !self.terms.has_film {
            return Vec3::zero();
        }
        let height = refracted_square(cosine, self.terms.ior).safe_sqrt();
        film_passed(&self.terms, cosine, height)
    }

    /// The share that a facet reflects.
    fn reflected(&self, cosine: f64) -> Vec3<f64> {
        Vec3::splat(fresnel_dielectric(cosine, self.terms.ior)) - self.film(cosine)
    }

    /// The share that a facet refracts.
    fn refracted(&self, wo: Vec3<f64>, wi: Vec3<f64>) -> Vec3<f64> {
        let [before, behind] = refracting_cosines(wo, wi, self.eta);
        if self.terms.ior == self.eta {
            return Vec3::splat(fresnel_transmitted(before, behind, self.eta)) + self.film(before);
        }
        Vec3::splat(1.0) - self.reflected(before)
    }
}

/// The energy that single scattering of a reflecting lobe keeps with F = 1, for a view of this cosine to the normal.
pub fn kept_energy(shape: &LobeShape<'_, f64>, cosine: f64, samples: u32) -> f64 {
    let [kept] = mean_weights(shape, cosine, samples, |_, _| [Vec3::splat(1.0)]);
    kept.x
}

/// Samples of a stretched lobe for each of another's: its mean is over all azimuths of the view, too.
const STRETCHED_SAMPLES: u32 = 4;

/// Means of a lobe's weights times factors of both directions; of a stretched one over all azimuths of the view.
fn mean_weights<const N: usize>(
    shape: &LobeShape<'_, f64>,
    cosine: f64,
    samples: u32,
    factors: impl Fn(Vec3<f64>, Vec3<f64>) -> [Vec3<f64>; N],
) -> [Vec3<f64>; N] {
    let normal = vec3(0.0, 0.0, 1.0);
    let frame = frame_from_normal(normal);
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    let is_stretched = shape.anisotropy != 0.0;
    let samples = if is_stretched {
        STRETCHED_SAMPLES * samples
    } else {
        samples
    };
    let mut sums = [Vec3::zero(); N];
    for sample in 0..samples {
        let [a, b, c, turn] = even_point(sample);
        let azimuth = if is_stretched {
            std::f64::consts::TAU * turn
        } else {
            0.0
        };
        let (across, along) = azimuth.sin_cos();
        let wo = vec3(sine * along, sine * across, cosine);
        let drawn = lobe_sample(shape, &frame, normal, wo, [a, b, c]);
        if drawn.weight > 0.0 {
            for (sum, factor) in sums.iter_mut().zip(factors(wo, drawn.wi)) {
                *sum = *sum + factor * drawn.weight;
            }
        }
    }
    sums.map(|sum| sum * (1.0 / f64::from(samples)))
}
