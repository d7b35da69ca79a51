//! What guides a denoiser: albedo and normal of a material, over all its layers.

use super::coat::{absorbs_over, coat_tint};
use super::{LayerModel, LayerVisitor, Layers, each_layer, each_layer_upwards};
use crate::optics::material::{Material, Surface};
use crate::optics::real::{Mask, Real};
use crate::optics::vector::Vec3;

/// Albedo of all layers, linear RGB in [0, 1]. If only the specular lobe is below the covers, its Fresnel term at the view's
/// angle.
#[inline(always)]
pub fn material_albedo<T: Real>(material: &Material<T>, surface: &Surface<T>, layers: &Layers<T>) -> Vec3<T> {
    let mut seen = SeenAlbedo {
        material,
        surface,
        layers,
        covers: Vec3::zero(),
        below: Vec3::zero(),
        transmittance: Vec3::zero(),
    };
    each_layer(&mut seen);
    seen.covers + seen.transmittance * seen.below
}

/// The walk that sums up albedos.
struct SeenAlbedo<'a, T: Real> {
    material: &'a Material<T>,
    surface: &'a Surface<T>,
    layers: &'a Layers<T>,
    covers: Vec3<T>,
    below: Vec3<T>,
    /// Transmittance of all covers.
    transmittance: Vec3<T>,
}

impl<T: Real> LayerVisitor<T> for SeenAlbedo<'_, T> {
    #[inline(always)]
    fn visit<L: LayerModel<T>>(&mut self) {
        let share = &self.layers[L::LAYER];
        let albedo = L::seen_albedo(self.material, self.surface, share);
        if L::TRAITS.is_cover {
            self.covers += share.transmittance * albedo;
        } else {
            self.below += albedo;
            self.transmittance = share.transmittance;
            if absorbs_over::<T, L>(self.material) {
                let tint = coat_tint(self.material, self.layers, self.surface, self.surface.wo);
                self.transmittance = self.transmittance * tint;
            }
        }
    }
}

/// The shading normal that guides a denoiser: the covers' and that of the layers below, weighted by sampling probability.
#[inline(always)]
pub fn material_normal<T: Real>(
    material: &Material<T>,
    tables: &[f32],
    surface: &Surface<T>,
    layers: &Layers<T>,
) -> Vec3<T> {
    let mut seen = SeenNormal {
        material,
        tables,
        surface,
        layers,
        normal: surface.frame.normal,
    };
    each_layer_upwards(&mut seen);
    seen.normal
}

/// The walk that mixes normals.
struct SeenNormal<'a, T: Real> {
    material: &'a Material<T>,
    tables: &'a [f32],
    surface: &'a Surface<T>,
    layers: &'a Layers<T>,
    normal: Vec3<T>,
}

impl<T: Real> LayerVisitor<T> for SeenNormal<'_, T> {
    #[inline(always)]
    fn visit<L: LayerModel<T>>(&mut self) {
        if L::TRAITS.is_cover && L::is_there(self.material, self.surface).any() {
            let above = L::lobe(self.material, self.tables, self.surface).frame.normal;
            self.normal = self.normal.mix(above, self.layers[L::LAYER].probability);
        }
    }
}
