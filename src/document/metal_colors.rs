//! A metal by two colours, seen head-on and towards the edge, in place of a measured index of refraction.

use super::{MaterialSettings, material::Conductor};
use crate::{
    optics::fresnel::{Fresnel, fresnel_conductor, fresnel_schlick},
    optics::vector::Vec3,
    scene::texture::TextureTarget,
};

/// The cosine at which the edge's colour is exact, about 82°.
const EDGE: f64 = 1.0 / 7.0;

impl MaterialSettings {
    /// The same metal by its colours where it goes by η and k: what it reflects head-on becomes the colour, and what it
    /// reflects at 82° the edge tint.
    pub fn by_colors(&self) -> Self {
        let (f0, there) = (self.measured_reflectance(1.0), self.measured_reflectance(EDGE));
        let plain = fresnel_schlick(Vec3::from_f64(f0), EDGE).to_f64();
        let mut material = Self {
            fresnel: Fresnel::Schlick,
            metalness: 1.0,
            base_weight: 1.0,
            base_color: f0.map(|x| x as f32),
            edge_tint: [0, 1, 2].map(|i| (there[i] / plain[i]).clamp(0.0, 1.0) as f32),
            conductor: Conductor::Custom,
            ..self.clone()
        };
        // η and k had no texture.
        material.textures[TextureTarget::BaseColor] = false;
        material
    }

    /// What its η and k reflect at a cosine, linear RGB in [0, 1].
    pub(super) fn measured_reflectance(&self, cosine: f64) -> [f64; 3] {
        [0, 1, 2].map(|i| fresnel_conductor(cosine, f64::from(self.eta[i]), f64::from(self.k[i])))
    }

    /// A measured metal by its η and k.
    pub fn by_measured(&self, conductor: Conductor) -> Self {
        let mut material = Self {
            fresnel: Fresnel::Conductor,
            ..self.clone()
        };
        material.set_conductor(conductor);
        material
    }
}
