//! Evaluation of a material for a sampled light direction.

use super::*;
use crate::optics::lobe::{is_mirror, lobe_evaluate};

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
    out_of_line!(T, {
        let [mut covers, mut below] = [Vec3::ZERO; 2];
        each_layer!({
            let is_there = L::is_there(material, surface);
            if is_there.any() {
                let lobe = L::lobe(material, tables, surface);
                let gives = is_there & !is_mirror(&lobe.shape);
                if gives.any() {
                    let toward = L::toward(material, layers, surface, &lobe.shape, wi);
                    let [value, density] = lobe_of::<T, L>(material, surface, &lobe, wi);
                    let share = &layers[LAYER];
                    let competing = competing * share.reached * toward.probability * density;
                    let weight = light_density / (light_density + competing);
                    let mut color = toward.color * share.transmittance;
                    if absorbs_over(material, LAYER) {
                        color = color * coat_tint(material, layers, surface, wi);
                    }
                    let part = color * (value * weight);
                    let sum = if IS_COVER { &mut covers } else { &mut below };
                    *sum += part.masked(gives);
                }
            }
        });
        below + covers
    })
}

/// (evaluate, density) of a layer's lobe, for itself.
#[inline(always)]
pub fn lobe_of<T: Real, L: LayerModel<T>>(
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
    let [value, density] = lobe_of::<T, L>(material, surface, &lobe, wi);
    mapped!([value, density], |x| T::select(is_mirror, T::ZERO, x))
}

/// Lanes where every sampled direction of a material counts as a mirror's, seen from outside.
pub fn material_is_mirror<T: Real>(material: &Material<T>) -> T::Mask {
    let surface = Surface::upwards(vec3(T::ZERO, T::ZERO, T::ONE));
    let mut are_all = T::Mask::splat(true);
    each_layer!({
        let lobe = L::lobe(material, &[], &surface);
        let is_there = L::is_there(material, &surface);
        are_all = are_all & (!is_there | is_mirror(&lobe.shape));
    });
    are_all
}
