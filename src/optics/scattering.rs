//! Multiple scattering between facets: single scattering loses the light that meets a second facet. A factor of the view
//! gives it back, so that no new direction is needed. Source: Turquin, "Practical multiple scattering compensation for
//! microfacet models" (2019).
//!
//! A metal's lobe is multiplied by 1 + F₀ (1 − E)/E, E being the energy that the lobe keeps with F = 1: a white metal
//! reflects all light. At a clear interface reflection and refraction are divided by the energy that both keep together.
//! The base below a dielectric takes what its lobe loses, so that needs no factor.

use rayon::prelude::*;

use super::albedo::{ALBEDO_NODES, ROUGHNESS_NODES, albedo_lookup, rough_albedo_lookup};
use super::frame::frame_from_normal;
use super::fresnel::{
    Fresnel, FresnelTerms, fresnel, fresnel_dielectric, fresnel_parts, fresnel_transmitted, half_vector_cosine,
};
use super::lobe::{LobeShape, lobe_sample};
use super::material::{COMPENSATES, Material, Surface};
use super::random::even_point;
use super::real::Real;
use super::refraction::{refracted_square, refracting_cosines};
use super::thin_film::film_passed;
use super::vector::{Vec3, vec3};

/// Factor that keeps a clear interface's light: one over the energy of reflection and refraction together.
#[inline(always)]
pub fn interface_gain<T: Real>(material: &Material<T>, surface: &Surface<T>, shape: &LobeShape<'_, T>) -> T {
    if !material.has_flag(COMPENSATES) {
        return T::one();
    }
    let [_, outside, inside] = kept_energies(material, surface, shape);
    let is_within = surface.is_within(material);
    T::one() / T::select(is_within, inside, outside)
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
    let kept = kept_energies(material, surface, shape)[0];
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
    let gain = one + (interface_gain(material, surface, shape) - one) * share;
    (dielectric * gain).mix(metal, terms.metalness)
}

/// Energies that single scattering keeps for a view: of a white metal, and of a clear interface from outside and within.
#[inline(always)]
fn kept_energies<T: Real>(material: &Material<T>, surface: &Surface<T>, shape: &LobeShape<'_, T>) -> [T; 3] {
    let place = surface.frame.normal.dot(surface.wo).safe_sqrt();
    if material.has_rough_tables == 1 {
        let [metal, outside, inside, _] = rough_albedo_lookup(shape.table, 0, place, material.roughness);
        return [metal, outside, inside];
    }
    let kept = albedo_lookup(shape.table, 0, place);
    [kept.x, kept.y, kept.z]
}

/// Table of the energies that a material's lobe keeps, over the root of the view's cosine, and over the roughness if its
/// albedo tables are: of a white metal, of a clear interface from outside and from within, 0. `samples` per node.
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
        let cosine = (place * place).max(1e-4);
        let mut energies = [reflected_energy(&material, cosine, samples, |_| 1.0), 1.0, 1.0, 0.0];
        if material.transmits() {
            for (energy, is_inside) in energies[1..].iter_mut().zip([false, true]) {
                *energy = interface_energy(&material, is_inside, cosine, samples);
            }
        }
        energies.map(|energy| energy as f32)
    };
    (0..steps * ALBEDO_NODES)
        .into_par_iter()
        .flat_map_iter(energies)
        .collect()
}

/// Energy that reflection and refraction of a clear interface keep together.
fn interface_energy(material: &Material<f64>, is_inside: bool, cosine: f64, samples: u32) -> f64 {
    let eta = material.ior_ahead(is_inside);
    // Under a coat the reflection has another index than the refraction.
    let terms = FresnelTerms {
        tint: Vec3::splat(1.0),
        ..material.fresnel_terms(is_inside)
    };
    // A film shares the light otherwise, by its mean over the channels.
    let film = |cosine: f64| match terms.has_film {
        true => {
            film_passed(&terms, cosine, refracted_square(cosine, terms.ior).safe_sqrt()).dot(Vec3::splat(1.0 / 3.0))
        }
        false => 0.0,
    };
    let reflects = |cosine: f64| fresnel_dielectric(cosine, terms.ior) - film(cosine);
    let reflected = reflected_energy(material, cosine, samples, reflects);
    let shape = material.transmission_shape(&[], is_inside);
    let refracted = mean_weight(&shape, cosine, samples, |wo, wi| {
        let [before, behind] = refracting_cosines(wo, wi, eta);
        if terms.ior == eta {
            fresnel_transmitted(before, behind, eta) + film(before)
        } else {
            1.0 - reflects(before)
        }
    });
    reflected + refracted
}

/// Energy of the reflecting lobe under a Fresnel factor of the half vector's cosine.
fn reflected_energy(material: &Material<f64>, cosine: f64, samples: u32, factor: impl Fn(f64) -> f64) -> f64 {
    mean_weight(&material.shape(&[]), cosine, samples, |wo, wi| {
        factor(half_vector_cosine(wo, wi))
    })
}

/// The energy that single scattering of a reflecting lobe keeps with F = 1, for a view of this cosine to the normal.
pub fn kept_energy(shape: &LobeShape<'_, f64>, cosine: f64, samples: u32) -> f64 {
    mean_weight(shape, cosine, samples, |_, _| 1.0)
}

/// Samples of a stretched lobe for each of another's: its mean is over all azimuths of the view, too.
const STRETCHED_SAMPLES: u32 = 4;

/// Mean of a lobe's weights times a factor of both directions; of a stretched one over all azimuths of the view.
fn mean_weight(
    shape: &LobeShape<'_, f64>,
    cosine: f64,
    samples: u32,
    factor: impl Fn(Vec3<f64>, Vec3<f64>) -> f64,
) -> f64 {
    let normal = vec3(0.0, 0.0, 1.0);
    let frame = frame_from_normal(normal);
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    let is_stretched = shape.anisotropy != 0.0;
    let samples = if is_stretched {
        STRETCHED_SAMPLES * samples
    } else {
        samples
    };
    let mut sum = 0.0;
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
            sum += drawn.weight * factor(wo, drawn.wi);
        }
    }
    sum / f64::from(samples)
}
