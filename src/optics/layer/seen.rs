//! What guides a denoiser: albedo and normal of a material, over all its layers.

use super::*;

inlined! {
    /// Albedo of all layers, linear RGB in [0, 1]. If only the specular lobe is below the covers, its Fresnel term at the view's
    /// angle.
    pub fn material_albedo<T: Real>(material: &Material<T>, surface: &Surface<T>, layers: &Layers<T>) -> Vec3<T> {
        let [mut covers, mut below, mut transmittance] = [Vec3::ZERO; 3];
        each_layer!({
            let share = &layers[LAYER];
            let albedo = L::seen_albedo(material, surface, share);
            if IS_COVER {
                covers += share.transmittance * albedo;
            } else {
                below += albedo;
                transmittance = share.transmittance;
                if absorbs_over(material, LAYER) {
                    transmittance = transmittance * coat_tint(material, layers, surface, surface.wo);
                }
            }
        });
        covers + transmittance * below
    }

    /// The shading normal that guides a denoiser: the covers' and that of the layers below, weighted by sampling probability.
    pub fn material_normal<T: Real>(
        material: &Material<T>,
        tables: &[f32],
        surface: &Surface<T>,
        layers: &Layers<T>,
    ) -> Vec3<T> {
        let mut normal = surface.frame.normal;
        each_layer!(outwards, {
            if IS_COVER && L::is_there(material, surface).any() {
                let above = L::lobe(material, tables, surface).frame.normal;
                normal = normal.mix(above, layers[LAYER].probability);
            }
        });
        normal
    }
}
