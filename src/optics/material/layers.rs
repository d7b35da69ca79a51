//! The shares of a material's layers for one view direction.

use super::{Material, Surface, by_index};
use crate::optics::albedo::{albedo_lookup, albedo_place, rough_albedo, rough_albedo_lookup};
use crate::optics::coat::{coat_probability, coat_share, coat_transmittance};
use crate::optics::curve::Curve;
use crate::optics::fresnel::{fresnel, fresnel_left};
use crate::optics::lobe::{Horizon, Lobe, LobeShape, refracts_at_facets};
use crate::optics::numeric::sampled_share;
use crate::optics::real::{Mask, Real};
use crate::optics::refraction::refracting_cosines;
use crate::optics::vector::Vec3;

/// The shares of the layers for one view direction.
#[derive(Clone, Copy, Debug)]
pub struct Layers<T> {
    /// Albedo of the Lambertian base after what the specular lobe took.
    pub base: Vec3<T>,
    /// What is refracted, on average over the lobe.
    pub transmission: Vec3<T>,
    /// Probability of sampling the specular lobe, where the coat is not sampled.
    pub specular_probability: T,
    /// Probability of sampling the refracting lobe, where the coat is not sampled.
    pub transmission_probability: T,
    /// Probability of sampling the coat.
    pub coat_probability: T,
    /// What the coat leaves of everything below it.
    pub below_coat: Vec3<T>,
}

impl<T: Real> Layers<T> {
    /// Probability of sampling the Lambertian base, where the coat is not sampled.
    #[inline(always)]
    pub fn base_probability(&self) -> T {
        T::one() - self.specular_probability - self.transmission_probability
    }
}

/// What the base is left with, and how often each layer is sampled: in proportion to the luminance it reflects or
/// transmits, the specular lobe as [`sampled_share`] says.
#[inline(always)]
pub fn material_layers<T: Real>(material: &Material<T>, tables: &[f32], surface: &Surface<T>) -> Layers<T> {
    let (zero, one) = (T::zero(), T::one());
    let coat = coat_share(material, tables, surface);
    let has_specular = material.has_specular();
    let has_more = material.has_base() | material.transmits();
    let alone = T::select(has_specular, one, zero);
    if !has_more.any() {
        return Layers {
            base: Vec3::zero(),
            transmission: Vec3::zero(),
            specular_probability: one,
            transmission_probability: zero,
            coat_probability: coat_probability(coat, alone),
            below_coat: coat_transmittance(material, surface, coat),
        };
    }
    let [mut taken, mut by_dielectric] = [Vec3::zero(); 2];
    if has_specular.any() {
        let albedos = specular_albedos(material, tables, surface);
        taken = Vec3::select(has_specular, albedos[0], taken);
        by_dielectric = Vec3::select(has_specular, albedos[1], by_dielectric);
    }
    // Under the metal's share there is nothing; the rest lies under the dielectric alone.
    let left = (Vec3::splat(one) - by_dielectric).at_least_zero() * (one - material.metalness);
    let left = Vec3::select(has_more, left, Vec3::zero());
    let base = material.base_color * left * (one - material.transmission_weight);
    let transmission = material.transmission_tint * left * material.transmission_weight;
    let (specular, below, through) = (taken.luminance(), base.luminance(), transmission.luminance());
    let rest = below + through;
    let tiny = T::from_f64(1e-9);
    let share = sampled_share(specular / (specular + rest).max(tiny));
    let share = T::select(zero.less(rest), share, one);
    // What is passed on is what was not reflected, no estimate.
    let share = T::select(passes_on(material), specular.min(one), share);
    let below = T::select(has_more, specular + rest, alone);
    Layers {
        base,
        transmission,
        specular_probability: share,
        transmission_probability: (one - share) * (through / rest.max(tiny)),
        coat_probability: coat_probability(coat, below),
        below_coat: coat_transmittance(material, surface, coat),
    }
}

/// What the specular lobe reflects of this view, and what it would if nothing of it were metal.
#[inline(always)]
fn specular_albedos<T: Real>(material: &Material<T>, tables: &[f32], surface: &Surface<T>) -> [Vec3<T>; 2] {
    let cosine = surface.frame.normal.dot(surface.wo);
    let is_within = surface.is_inside & material.transmits();
    let mut albedos = [Vec3::zero(); 2];
    if is_within.any() {
        let place = albedo_place(cosine, material.ior_ahead(is_within));
        albedos = albedos_in(material, tables, surface, material.inner_albedo_table, place);
    }
    if is_within.all() {
        return albedos;
    }
    let outer = albedos_in(material, tables, surface, material.albedo_table, cosine);
    [
        Vec3::select(is_within, albedos[0], outer[0]),
        Vec3::select(is_within, albedos[1], outer[1]),
    ]
}

/// The same from a table, at a place in it.
#[inline(always)]
fn albedos_in<T: Real>(
    material: &Material<T>,
    tables: &[f32],
    surface: &Surface<T>,
    table: u32,
    place: T,
) -> [Vec3<T>; 2] {
    if material.has_rough_tables == 1 {
        let integrals = rough_albedo_lookup(tables, table, place, material.roughness);
        let terms = material.fresnel_terms(surface.is_inside);
        return [
            rough_albedo(&terms, integrals),
            rough_albedo(&terms.of_dielectric(), integrals),
        ];
    }
    // What is metal in part has the other table.
    [albedo_lookup(tables, table, place); 2]
}

/// The share of the light from everywhere that reaches the viewer by all layers, in [0, 1] for each colour: where there
/// is only the specular lobe, its Fresnel term at the view's angle.
#[inline(always)]
pub fn material_albedo<T: Real>(material: &Material<T>, tables: &[f32], surface: &Surface<T>) -> Vec3<T> {
    let has_more = material.has_specular() & (material.has_base() | material.transmits());
    let cosine = surface.frame.normal.dot(surface.wo);
    let mut specular = fresnel(&material.fresnel_terms(surface.is_inside), cosine);
    if has_more.any() {
        let [albedo, _] = specular_albedos(material, tables, surface);
        specular = Vec3::select(has_more, albedo, specular);
    }
    let specular = Vec3::select(material.has_specular(), specular, Vec3::zero());
    let layers = material_layers(material, tables, surface);
    specular + layers.base + layers.transmission
}

/// The base's lobe: Lambert's, its rare samples below the geometric surface mirrored.
#[inline(always)]
pub(super) fn base_shape<'a, T: Real>() -> LobeShape<'a, T> {
    LobeShape {
        lobe: Lobe::Lambert,
        curve: Curve::Sqrt,
        horizon: Horizon::Mirror,
        roughness: T::one(),
        anisotropy: T::zero(),
        eta: T::zero(),
        table: &[],
    }
}

/// True where a mirrored direction is drawn first and what it does not reflect is passed on: then all weights are 1
/// however often light is reflected inside. It takes a lobe whose own weights are 1.
#[inline(always)]
pub(super) fn passes_on<T: Real>(material: &Material<T>) -> T::Mask {
    material.transmits() & T::Mask::splat(by_index(Lobe::ALL, material.lobe).traits().weighs_one)
}

/// What is refracted into a direction: of lobes made of facets what the facet does not reflect, of others what the
/// specular lobe leaves over on average.
#[inline(always)]
pub(super) fn transmission_color<T: Real>(
    material: &Material<T>,
    layers: &Layers<T>,
    shape: &LobeShape<'_, T>,
    surface: &Surface<T>,
    wi: Vec3<T>,
) -> Vec3<T> {
    if !refracts_at_facets(shape) {
        return layers.transmission;
    }
    let [cosine, behind] = refracting_cosines(surface.wo, wi, shape.eta);
    let left = fresnel_left(&material.fresnel_terms(surface.is_inside), cosine, behind);
    material.transmission_tint * left * (material.transmission_weight * (T::one() - material.metalness))
}
