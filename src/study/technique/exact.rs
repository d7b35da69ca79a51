//! Fresnel's equations and Schlick's approximation for the same material: equal along the normal.

use crate::{
    document::{Conductor, MaterialSettings},
    optics::fresnel::{Fresnel, fresnel_conductor},
    scene::texture::TextureTarget,
};

/// Largest reflectance along the normal of a metal: at 1 its index would be infinite.
const F0_MAX: f64 = 0.999;

/// Gives a material the exact equations. A metal keeps its colour along the normal and its η as far as they go
/// together; k follows. One whose colour or metalness comes from a texture stays as it is, as η and k do not.
pub fn with_exact_fresnel(material: &mut MaterialSettings) {
    match material.fresnel {
        Fresnel::Dielectric | Fresnel::Conductor => {}
        Fresnel::None | Fresnel::Schlick if material.metalness < 1.0 => material.fresnel = Fresnel::Dielectric,
        Fresnel::None | Fresnel::Schlick => {
            let textures = material.textures;
            if textures[TextureTarget::BaseColor] || textures[TextureTarget::Roughness] {
                return;
            }
            let of_channel = |channel: usize| {
                let f0 = f64::from(material.base_color[channel] * material.base_weight).clamp(0.0, F0_MAX);
                conductor_of(f0, f64::from(material.eta[channel])).map(|x| x as f32)
            };
            let [red, green, blue] = [0, 1, 2].map(of_channel);
            material.set_eta_and_k([red[0], green[0], blue[0]], [red[1], green[1], blue[1]]);
            material.fresnel = Fresnel::Conductor;
        }
    }
}

/// Gives a material Schlick's approximation; what the exact equations reflect along the normal becomes its colour.
pub fn with_schlick(material: &mut MaterialSettings) {
    if material.fresnel == Fresnel::Conductor {
        let f0 = |channel: usize| {
            fresnel_conductor(1.0, f64::from(material.eta[channel]), f64::from(material.k[channel])) as f32
        };
        material.base_color = [0, 1, 2].map(f0);
        material.base_weight = 1.0;
        material.metalness = 1.0;
        material.textures[TextureTarget::BaseColor] = false;
        material.textures[TextureTarget::Roughness] = false;
        material.conductor = Conductor::Custom;
    }
    material.fresnel = Fresnel::Schlick;
}

/// η and k of a conductor that reflects `f0` in [0, 1) along the normal: (η − 1)² + k² = f0 ((η + 1)² + k²). η is
/// `eta` where there is a k for it, else the nearest that has one.
fn conductor_of(f0: f64, eta: f64) -> [f64; 2] {
    let root = f0.sqrt();
    // Between these k is real; it is 0 at either end.
    let (low, high) = ((1.0 - root) / (1.0 + root), (1.0 + root) / (1.0 - root));
    let eta = eta.clamp(low, high);
    let square = (f0 * (eta + 1.0).powi(2) - (eta - 1.0).powi(2)) / (1.0 - f0);
    [eta, square.max(0.0).sqrt()]
}
