//! What a material reflects or refracts of light from a direction that was drawn towards it.

use super::base::base_evaluate;
use super::layers::{specular_probability, transmission};
use super::{Layers, Material, Surface, material_layers};
use crate::optics::coat::coat_evaluate;
use crate::optics::fresnel::{fresnel, half_vector_cosine};
use crate::optics::lobe::{LobeShape, is_mirror, lobe_evaluate};
use crate::optics::real::{Mask, Real};
use crate::optics::vector::Vec3;

/// The material's evaluate (cosine included) for light from `wi` that was drawn with density `light_density`, each layer
/// multiplied by its share under multiple importance sampling (Veach 1997, balance heuristic): light_density/
/// (light_density + `competing` × density of that layer). `competing` is 1, or 0 where light sampling works alone.
/// Layers weighed as mirrors give nothing: only sampling the lobe finds what they reflect or refract.
pub fn material_evaluate<T: Real>(
    material: &Material<T>,
    tables: &[f32],
    surface: &Surface<T>,
    wi: Vec3<T>,
    light_density: T,
    competing: T,
) -> Vec3<T> {
    T::out_of_line(
        #[inline(always)]
        || {
            let evaluation = Evaluation {
                layers: material_layers(material, tables, surface),
                surface,
                wi,
                light_density,
                competing,
            };
            evaluation.sum(material, tables)
        },
    )
}

/// A direction of the light for which a material is evaluated.
struct Evaluation<'a, T: Real> {
    layers: Layers<T>,
    surface: &'a Surface<T>,
    wi: Vec3<T>,
    light_density: T,
    competing: T,
}

impl<T: Real> Evaluation<'_, T> {
    /// See [`material_evaluate`].
    #[inline(always)]
    fn sum(&self, material: &Material<T>, tables: &[f32]) -> Vec3<T> {
        let Self {
            layers, surface, wi, ..
        } = *self;
        let mut sum = Vec3::zero();
        let has_specular = material.has_specular();
        if has_specular.any() {
            let terms = material.fresnel_terms(surface.is_inside);
            let color = fresnel(&terms, half_vector_cosine(surface.wo, wi));
            let probability = specular_probability(material, &layers, surface, wi, color);
            let part = self.part(&material.shape(tables), probability, color);
            sum = Vec3::select(has_specular, part, sum);
        }
        let has_base = material.has_base();
        if has_base.any() {
            let evaluated = base_evaluate(material, surface, wi);
            let part = self.weighed(evaluated, layers.base_probability(), layers.base);
            sum = Vec3::select(has_base, sum + part, sum);
        }
        let transmits = material.transmits();
        if transmits.any() {
            let shape = material.transmission_shape(tables, surface.is_inside);
            let through = transmission(material, &layers, &shape, surface, wi);
            let part = self.part(&shape, through.probability, through.color);
            sum = Vec3::select(transmits, sum + part, sum);
        }
        let has_coat = material.has_coat(surface);
        if has_coat.any() {
            let [value, density] = coat_evaluate(material, surface, wi);
            let competing = self.competing * layers.coat_probability * density;
            let share = self.light_density / (self.light_density + competing);
            sum = Vec3::select(has_coat, sum + Vec3::splat(value * share), sum);
        }
        sum
    }

    /// What a lobe below the coat gives.
    #[inline(always)]
    fn part(&self, shape: &LobeShape<'_, T>, probability: T, color: Vec3<T>) -> Vec3<T> {
        let is_mirror = is_mirror(shape);
        if is_mirror.all() {
            return Vec3::zero();
        }
        let surface = self.surface;
        let evaluated = lobe_evaluate(shape, &surface.frame, surface.normal, surface.wo, self.wi);
        Vec3::select(is_mirror, Vec3::zero(), self.weighed(evaluated, probability, color))
    }

    /// The same of a lobe's (evaluate, density).
    #[inline(always)]
    fn weighed(&self, [value, density]: [T; 2], probability: T, color: Vec3<T>) -> Vec3<T> {
        let layers = &self.layers;
        let below = T::one() - layers.coat_probability;
        let share = self.light_density / (self.light_density + self.competing * below * probability * density);
        color * layers.below_coat * (value * share)
    }
}
