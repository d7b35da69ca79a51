//! The shares of a material's layers for one view direction.

use super::{Material, Surface, by_index};
use crate::optics::albedo::{albedo_lookup, albedo_place, rough_albedo, rough_albedo_lookup};
use crate::optics::coat::{coat_probability, coat_share, coat_transmittance};
use crate::optics::fresnel::{fresnel, fresnel_left, half_vector_cosine};
use crate::optics::lobe::{Facets, Lobe, LobeShape, refracts_at_facets};
use crate::optics::numeric::sampled_share;
use crate::optics::real::{Mask, Real};
use crate::optics::refraction::{refracted_square, refracting_cosines};
use crate::optics::vector::Vec3;

/// The shares of the layers for one view direction.
#[derive(Clone, Copy, Debug)]
pub struct Layers<T> {
    /// Albedo of the Lambertian base after what the specular lobe took.
    pub base: Vec3<T>,
    /// What is refracted, on average over the lobe.
    pub transmission: Vec3<T>,
    /// Probability of sampling the specular lobe, where the coat is not sampled; on average, where the facet decides.
    pub specular_probability: T,
    /// Probability of sampling the refracting lobe, where the coat is not sampled; on average, where the facet decides.
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
/// is only the specular lobe below the coat, its Fresnel term at the view's angle.
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
    let coat = Vec3::splat(coat_share(material, tables, surface));
    coat + layers.below_coat * (specular + layers.base + layers.transmission)
}

/// The shading normal that leads a denoiser: the coat's and that of what lies below, by how often each is sampled.
#[inline(always)]
pub fn material_normal<T: Real>(material: &Material<T>, tables: &[f32], surface: &Surface<T>) -> Vec3<T> {
    let below = surface.frame.normal;
    if !material.has_coat(surface).any() {
        return below;
    }
    let layers = material_layers(material, tables, surface);
    below.mix(surface.coat_normal, layers.coat_probability)
}

/// True where a mirrored direction is drawn first and what it does not reflect is passed on: then all weights are 1
/// however often light is reflected inside. It takes a lobe whose own weights are 1.
#[inline(always)]
pub fn passes_on<T: Real>(material: &Material<T>) -> T::Mask {
    material.transmits() & T::Mask::splat(by_index(Lobe::ALL, material.lobe).traits().weighs_one)
}

/// True where one facet is drawn, and its Fresnel factor decides whether it mirrors or refracts: where the lobe is made of
/// facets that are as rough seen either way. So no sample's weight depends on how the factor changes over the facets, which
/// near the critical angle it does from almost none to all (Walter et al. 2007, section 5.3).
#[inline(always)]
pub(super) fn shares_facets<T: Real>(material: &Material<T>) -> T::Mask {
    let has_facets = by_index(Lobe::ALL, material.lobe).facets() != Facets::None;
    material.transmits() & T::Mask::splat(has_facets) & !material.transmission_roughness.differs(material.roughness)
}

/// True where the Fresnel factor of a direction that was drawn decides which layer it is of ([`passes_on`],
/// [`shares_facets`]): elsewhere the layer is chosen first.
#[inline(always)]
pub fn decides_by_facet<T: Real>(material: &Material<T>) -> T::Mask {
    passes_on(material) | shares_facets(material)
}

/// The probability of sampling the specular lobe, where the coat is not sampled, for a direction that it mirrors to with
/// this Fresnel factor.
#[inline(always)]
pub(super) fn specular_probability<T: Real>(
    material: &Material<T>,
    layers: &Layers<T>,
    surface: &Surface<T>,
    wi: Vec3<T>,
    color: Vec3<T>,
) -> T {
    let reflected = color.luminance();
    let mut probability = T::select(passes_on(material), reflected, layers.specular_probability);
    let is_shared = shares_facets(material);
    if is_shared.any() {
        let ior = material.ior_ahead(surface.is_inside);
        let cosine = half_vector_cosine(surface.wo, wi);
        let square = refracted_square(cosine, ior);
        let left = left_by_facet(material, surface, [cosine, square.safe_sqrt() / ior]);
        // What is reflected totally is not refracted, whatever the model of the Fresnel factor says.
        let refracted = T::select(T::zero().less(square), left.luminance(), T::zero());
        let of_facets = T::one() - layers.base_probability();
        let share = mirrored_share(reflected, refracted);
        probability = T::select(is_shared, of_facets * share, probability);
    }
    probability
}

/// How often a facet mirrors, by the luminances of what it mirrors and what it refracts, as [`sampled_share`] says.
#[inline(always)]
fn mirrored_share<T: Real>(reflected: T, refracted: T) -> T {
    sampled_share(reflected / (reflected + refracted).max(T::from_f64(1e-20)))
}

/// What is refracted into a direction, and the probability of sampling the refracting lobe for it, where the coat is not
/// sampled.
#[derive(Clone, Copy, Debug)]
pub(super) struct Transmission<T> {
    pub color: Vec3<T>,
    pub probability: T,
}

/// What is refracted into a direction: of lobes made of facets what the facet does not reflect, of others what the
/// specular lobe leaves over on average.
#[inline(always)]
pub(super) fn transmission<T: Real>(
    material: &Material<T>,
    layers: &Layers<T>,
    shape: &LobeShape<'_, T>,
    surface: &Surface<T>,
    wi: Vec3<T>,
) -> Transmission<T> {
    let mut through = Transmission {
        color: layers.transmission,
        probability: layers.transmission_probability,
    };
    if !refracts_at_facets(shape) {
        return through;
    }
    let cosines = refracting_cosines(surface.wo, wi, shape.eta);
    through.color = left_by_facet(material, surface, cosines);
    let is_shared = shares_facets(material);
    if is_shared.any() {
        let reflected = fresnel(&material.fresnel_terms(surface.is_inside), cosines[0]).luminance();
        let refracted = through.color.luminance();
        let of_facets = T::one() - layers.base_probability();
        let share = T::one() - mirrored_share(reflected, refracted);
        through.probability = T::select(is_shared, of_facets * share, through.probability);
    }
    through
}

/// What a facet refracts of the light, by the cosines between its normal and the view and the refracted direction.
#[inline(always)]
fn left_by_facet<T: Real>(material: &Material<T>, surface: &Surface<T>, [cosine, behind]: [T; 2]) -> Vec3<T> {
    let left = fresnel_left(&material.fresnel_terms(surface.is_inside), cosine, behind);
    material.transmission_tint * left * (material.transmission_weight * (T::one() - material.metalness))
}
