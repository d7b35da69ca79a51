//! The density with which a material draws a direction.

use super::evaluate::lobe_of;
use super::{Layer, LayerModel, Layers};
use crate::optics::lobe::is_mirror;
use crate::optics::material::{Material, Surface};
use crate::optics::real::{Mask, Real};
use crate::optics::vector::Vec3;

/// Density of [`material_sample`](super::material_sample) in a direction, per steradian: the sum over all layers but
/// mirrors, whose directions have none.
pub fn material_density<T: Real>(
    material: &Material<T>,
    tables: &[f32],
    surface: &Surface<T>,
    layers: &Layers<T>,
    wi: Vec3<T>,
) -> T {
    let mut sum = T::zero();
    each_layer!({
        let lobe = L::lobe(material, tables, surface);
        let gives = L::is_there(material, surface) & !is_mirror(&lobe.shape);
        if gives.any() {
            let toward = L::toward(material, layers, surface, &lobe.shape, wi);
            let [_, density] = lobe_of::<T, L>(material, surface, &lobe, wi);
            let density = layers[LAYER].reached * toward.probability * density;
            sum += T::select(gives, density, T::zero());
        }
    });
    sum
}
