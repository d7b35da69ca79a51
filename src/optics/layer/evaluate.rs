//! Evaluation of a material for a sampled light direction.

use super::coat::{absorbs_over, coat_tint};
use super::{LayerLobe, LayerModel, LayerVisitor, Layers, each_layer};
use crate::optics::lobe::{is_mirror, lobe_evaluate};
use crate::optics::material::{Material, Surface};
use crate::optics::real::{Mask, Real};
use crate::optics::vector::{Vec3, vec3};

/// Value of a material (cosine included) for light from `wi`, which was sampled with density `light_density`. Each layer is
/// multiplied by its MIS weight (Veach 1997, balance heuristic): light_density / (light_density + `competing` × density of
/// that layer). `competing` is 1, or 0 if light sampling is the only strategy. Mirror layers give 0: only BSDF sampling
/// finds their light.
pub fn material_evaluate<T: Real>(
    material: &Material<T>,
    tables: &[f32],
    surface: &Surface<T>,
    layers: &Layers<T>,
    wi: Vec3<T>,
    light_density: T,
    competing: T,
) -> Vec3<T> {
    T::out_of_line(
        #[inline(always)]
        || {
            let mut evaluation = Evaluation {
                material,
                tables,
                surface,
                layers,
                wi,
                light_density,
                competing,
                covers: Vec3::zero(),
                below: Vec3::zero(),
            };
            each_layer(&mut evaluation);
            evaluation.below + evaluation.covers
        },
    )
}

/// Visitor that sums the layers' values.
struct Evaluation<'a, T: Real> {
    material: &'a Material<T>,
    tables: &'a [f32],
    surface: &'a Surface<T>,
    layers: &'a Layers<T>,
    wi: Vec3<T>,
    light_density: T,
    competing: T,
    covers: Vec3<T>,
    below: Vec3<T>,
}

impl<T: Real> LayerVisitor<T> for Evaluation<'_, T> {
    #[inline(always)]
    fn visit<L: LayerModel<T>>(&mut self) {
        let Self {
            material,
            surface,
            layers,
            wi,
            ..
        } = *self;
        let is_there = L::is_there(material, surface);
        if !is_there.any() {
            return;
        }
        let lobe = L::lobe(material, self.tables, surface);
        let gives = is_there & !is_mirror(&lobe.shape);
        if !gives.any() {
            return;
        }
        let toward = L::toward(material, layers, surface, &lobe.shape, wi);
        let [value, density] = lobe_of::<T, L>(material, surface, &lobe, wi);
        let share = &layers[L::LAYER];
        let competing = self.competing * share.reached * toward.probability * density;
        let weight = self.light_density / (self.light_density + competing);
        let mut color = toward.color * share.transmittance;
        if absorbs_over::<T, L>(material) {
            color = color * coat_tint(material, layers, surface, wi);
        }
        let part = color * (value * weight);
        let sum = if L::TRAITS.is_cover {
            &mut self.covers
        } else {
            &mut self.below
        };
        *sum += Vec3::select(gives, part, Vec3::zero());
    }
}

/// (evaluate, density) of a layer's lobe, for itself.
#[inline(always)]
pub(super) fn lobe_of<T: Real, L: LayerModel<T>>(
    material: &Material<T>,
    surface: &Surface<T>,
    lobe: &LayerLobe<'_, T>,
    wi: Vec3<T>,
) -> [T; 2] {
    let evaluated = lobe_evaluate(&lobe.shape, &lobe.frame, surface.normal, surface.wo, wi);
    L::refined(material, surface, wi, evaluated)
}

/// (evaluate, density) of a layer's own lobe for a direction; both 0 for a mirror.
pub fn layer_evaluate<T: Real, L: LayerModel<T>>(
    material: &Material<T>,
    tables: &[f32],
    surface: &Surface<T>,
    wi: Vec3<T>,
) -> [T; 2] {
    let lobe = L::lobe(material, tables, surface);
    let is_mirror = is_mirror(&lobe.shape);
    lobe_of::<T, L>(material, surface, &lobe, wi).map(|x| T::select(is_mirror, T::zero(), x))
}

/// Lanes where every sampled direction of a material counts as a mirror's, seen from outside.
pub fn material_is_mirror<T: Real>(material: &Material<T>) -> T::Mask {
    let mut mirrors = Mirrors {
        material,
        surface: Surface::upwards(vec3(T::zero(), T::zero(), T::one())),
        are_all: T::Mask::splat(true),
    };
    each_layer(&mut mirrors);
    mirrors.are_all
}

/// The walk that asks whether layers are mirrors.
struct Mirrors<'a, T: Real> {
    material: &'a Material<T>,
    surface: Surface<T>,
    are_all: T::Mask,
}

impl<T: Real> LayerVisitor<T> for Mirrors<'_, T> {
    #[inline(always)]
    fn visit<L: LayerModel<T>>(&mut self) {
        let lobe = L::lobe(self.material, &[], &self.surface);
        let is_there = L::is_there(self.material, &self.surface);
        self.are_all = self.are_all & (!is_there | is_mirror(&lobe.shape));
    }
}
