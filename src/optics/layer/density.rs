//! The density with which a material draws a direction.

use super::evaluate::lobe_of;
use super::{LayerModel, LayerVisitor, Layers, each_layer};
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
    let mut densities = Densities {
        material,
        tables,
        surface,
        layers,
        wi,
        sum: T::zero(),
    };
    each_layer(&mut densities);
    densities.sum
}

/// The walk that sums the layers' densities.
struct Densities<'a, T: Real> {
    material: &'a Material<T>,
    tables: &'a [f32],
    surface: &'a Surface<T>,
    layers: &'a Layers<T>,
    wi: Vec3<T>,
    sum: T,
}

impl<T: Real> LayerVisitor<T> for Densities<'_, T> {
    #[inline(always)]
    fn visit<L: LayerModel<T>>(&mut self) {
        let (material, surface) = (self.material, self.surface);
        let lobe = L::lobe(material, self.tables, surface);
        let gives = L::is_there(material, surface) & !is_mirror(&lobe.shape);
        if !gives.any() {
            return;
        }
        let toward = L::toward(material, self.layers, surface, &lobe.shape, self.wi);
        let [_, density] = lobe_of::<T, L>(material, surface, &lobe, self.wi);
        let density = self.layers[L::LAYER].reached * toward.probability * density;
        self.sum += T::select(gives, density, T::zero());
    }
}
