//! The density with which a material draws a direction.

use super::evaluate::lobe_of;
use super::*;
use crate::optics::lobe::is_mirror;

/// Density of [`material_sample`](super::material_sample) in a direction, per steradian: the sum over all layers but
/// mirrors, whose directions have none.
pub fn material_density<T: Real>(
    material: &Material<T>,
    tables: &[f32],
    surface: &Surface<T>,
    layers: &Layers<T>,
    wi: Vec3<T>,
) -> T {
    let mut sum = T::ZERO;
    each_layer!({
        let lobe = L::lobe(material, tables, surface);
        let gives = L::is_there(material, surface) & !is_mirror(&lobe.shape);
        if gives.any() {
            let toward = L::toward(material, layers, surface, &lobe.shape, wi);
            let [_, density] = lobe_of::<T, L>(material, surface, &lobe, wi);
            let density = layers[LAYER].reached * toward.probability * density;
            sum += density.masked(gives);
        }
    });
    sum
}
