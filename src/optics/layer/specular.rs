//! The specular lobe: it reflects the Fresnel share; base and transmission share the rest.

use super::facet::{left_by_facet, mirrored_share, shares_facets};
use super::transmission::transmission_estimate;
use super::*;
use crate::optics::{
    albedo::{
        ROUGH_ALBEDO_LENGTH, albedo_lookup, albedo_place, rough_albedo, rough_albedo_lookup, rough_albedo_number,
        table_row,
    },
    fresnel::{Fresnel, fresnel, fresnel_f0, half_vector_cosine},
    refraction::refracted_square,
    scattering::scattered_again,
};

/// The specular lobe.
#[derive(Debug)]
pub struct Specular;

impl<T: Real> LayerModel<T> for Specular {
    const LAYER: Layer = Layer::Specular;

    inlined! {
        fn is_there(material: &Material<T>, _: &Surface<T>) -> T::Mask {
            material.has_specular()
        }

        fn lobe<'a>(material: &Material<T>, tables: &'a [f32], surface: &Surface<T>) -> LayerLobe<'a, T> {
            LayerLobe {
                shape: material.shape(tables),
                frame: surface.frame,
            }
        }

        /// No look-up without layers below.
        fn albedo(material: &Material<T>, tables: &[f32], surface: &Surface<T>, _: Vec3<T>) -> LayerAlbedo<T> {
            let white = Vec3::ONE;
            let [mut taken, mut by_dielectric] = [Vec3::ZERO; 2];
            if has_more(material).any() {
                [taken, by_dielectric] = specular_albedos(material, tables, surface);
            }
            LayerAlbedo {
                reflected: taken,
                // A metal has no layer below; the rest lies below the dielectric alone.
                transmittance: (white - by_dielectric).at_least_zero(),
            }
        }

        fn toward(
            material: &Material<T>,
            layers: &Layers<T>,
            surface: &Surface<T>,
            shape: &LobeShape<'_, T>,
            wi: Vec3<T>,
        ) -> LayerToward<T> {
            let terms = material.fresnel_terms(surface.is_inside);
            let cosine = half_vector_cosine(surface.wo, wi);
            let color = fresnel(&terms, cosine);
            LayerToward {
                color: scattered_again(material, surface, shape, &terms, cosine, color),
                probability: specular_probability(material, layers, surface, wi, color),
            }
        }

        /// Distributes all samples below the covers: in proportion to reflected and transmitted luminance, the specular lobe as
        /// in [`sampled_share`].
        fn choose(material: &Material<T>, layers: &mut Layers<T>, below: T) -> T {
            let (zero, one) = (T::ZERO, T::ONE);
            let specular = layers[Layer::Specular].albedo.luminance();
            let through = transmission_estimate(material, layers);
            let share = sampled_share(specular / (specular + below).max(T::from_f64(1e-9)));
            let share = T::select(below.above_zero(), share, one);
            // The part passed on is exactly the part not reflected, no estimate.
            let share = T::select(passes_on(material), specular.min(one), share);
            let through = (one - share) * (through / below.max(T::from_f64(1e-9)));
            layers[Layer::Specular].probability = share;
            layers[Layer::Transmission].probability = through;
            layers[Layer::Base].probability = one - share - through;
            let alone = T::select(material.has_specular(), one, zero);
            T::select(has_more(material), specular + below, alone)
        }

        /// Without layers below: the Fresnel term at the view's angle.
        fn seen_albedo(material: &Material<T>, surface: &Surface<T>, share: &LayerShare<T>) -> Vec3<T> {
            let cosine = surface.view_cosine();
            let alone = fresnel(&material.fresnel_terms(surface.is_inside), cosine);
            let seen = Vec3::select(has_more(material), share.albedo, alone);
            seen.masked(material.has_specular())
        }

        fn decides_by_facet(material: &Material<T>) -> T::Mask {
            decides_by_facet(material)
        }

        fn pass_on(material: &Material<T>, layers: &mut Layers<T>, weight: T, probability: T) -> T::Mask {
            let is_passed_on = passes_on(material);
            let of_facets = T::ONE - layers[Layer::Base].probability;
            let through = &mut layers[Layer::Transmission].probability;
            *through = T::select(shares_facets(material), of_facets - probability, *through);
            let is_lost = is_passed_on & !weight.above_zero();
            layers[Layer::Specular].probability = T::select(is_lost, T::ZERO, probability);
            is_passed_on
        }
    }
}

inlined! {
    /// Lanes with layers below the specular lobe.
    fn has_more<T: Real>(material: &Material<T>) -> T::Mask {
        material.has_base() | material.transmits()
    }

    /// Albedo of the specular lobe for a view, and that of its dielectric alone.
    fn specular_albedos<T: Real>(material: &Material<T>, tables: &[f32], surface: &Surface<T>) -> [Vec3<T>; 2] {
        let cosine = surface.view_cosine();
        let is_within = surface.is_within(material);
        let mut albedos = [Vec3::ZERO; 2];
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

    /// The same from a table at a position.
    fn albedos_in<T: Real>(
        material: &Material<T>,
        tables: &[f32],
        surface: &Surface<T>,
        table: u32,
        place: T,
    ) -> [Vec3<T>; 2] {
        let terms = material.fresnel_terms(surface.is_inside);
        let untinted = terms.untinted();
        if material.holds_integrals() {
            let row = table_row(material, surface);
            let mut integrals = rough_albedo_lookup(tables, table, place, row);
            if table == material.albedo_table && material.has_coated_table() {
                integrals[0] = dielectric_under_coat(material, tables, [place, row], integrals[0]);
            }
            let film = material.has_film_table().then(|| {
                let table = table + ROUGH_ALBEDO_LENGTH as u32;
                let [r, g, b, _] = rough_albedo_lookup(tables, table, place, row);
                vec3(r, g, b)
            });
            return [
                rough_albedo(&terms, integrals, film),
                rough_albedo(&untinted.of_dielectric(), integrals, film),
            ];
        }
        // A partly metallic material has the other table. This one is untinted where the tint is a factor.
        let [r, g, b, _] = match material.is_over_azimuth() {
            true => rough_albedo_lookup(tables, table, place, table_row(material, surface)),
            false => albedo_lookup(tables, table, place),
        };
        let mean = vec3(r, g, b);
        let tint = if terms.model == Fresnel::Dielectric { terms.tint } else { Vec3::ONE };
        [mean * tint, mean]
    }

    /// The dielectric's integral where a texture varies the cover over it: between those without and under all of it, as the
    /// reflectances head-on are.
    fn dielectric_under_coat<T: Real>(material: &Material<T>, tables: &[f32], [place, row]: [T; 2], bare: T) -> T {
        let table = material.albedo_table + ROUGH_ALBEDO_LENGTH as u32;
        let coated = rough_albedo_number(tables, table, 0, [place, row]);
        let [zero, one] = mapped!([T::ZERO, T::ONE], |weight| fresnel_f0(material.ior_under_coat(weight)));
        let there = fresnel_f0(material.reflecting_ior);
        let share = (there - zero) / T::select(one.differs(zero), one - zero, T::ONE);
        bare + (coated - bare) * share
    }

    /// Sampling probability of the specular lobe, if no cover is sampled, for a direction that it mirrors to with this Fresnel
    /// factor.
    fn specular_probability<T: Real>(
        material: &Material<T>,
        layers: &Layers<T>,
        surface: &Surface<T>,
        wi: Vec3<T>,
        color: Vec3<T>,
    ) -> T {
        let reflected = color.luminance();
        let mut probability = T::select(passes_on(material), reflected, layers[Layer::Specular].probability);
        let is_shared = shares_facets(material);
        if is_shared.any() {
            let ior = material.ior_ahead(surface.is_inside);
            let cosine = half_vector_cosine(surface.wo, wi);
            let square = refracted_square(cosine, ior);
            let left = left_by_facet(material, surface, [cosine, square.safe_sqrt() / ior]);
            // Total reflection leaves nothing to refract, whichever Fresnel model is used.
            let refracted = left.luminance().masked(square.above_zero());
            let of_facets = T::ONE - layers[Layer::Base].probability;
            let share = mirrored_share(reflected, refracted);
            probability = T::select(is_shared, of_facets * share, probability);
        }
        probability
    }
}
