//! The layers of a material behind one interface, and their registry.
//!
//! A layer's file states when the layer is present, its lobe, its albedo (the share of uniform light that it reflects or
//! transmits), its transmittance, its sampling probability, and its colour in a direction ([`LayerModel`]). Everything else
//! is one walk over the list, from the outermost layer inwards: the layers' shares of a view ([`material_layers`]),
//! reflected light ([`material_evaluate`]), sampled directions ([`material_sample`]).
//!
//! Covers lie over all layers after them and are sampled by their albedo. The layers below share the light that the covers
//! transmit: the specular lobe reflects some, the base and the refracting lobe share the rest.
//!
//! To add a layer: one Rust file with its [`LayerModel`], one WGSL file of the same name, one line in the registry below
//! and its cases in `shaders/optics/layer/registry.wgsl`.

/// A block of code for each layer `L`, from the outermost inwards, or outwards.
macro_rules! each_layer {
    ($walk:block) => {
        each_layer!(Fuzz Coat Specular Base Transmission: $walk)
    };
    (outwards, $walk:block) => {
        each_layer!(Transmission Base Specular Coat Fuzz: $walk)
    };
    ($($layer:ident)*: $walk:block) => {
        $(
            #[allow(unused, reason = "not every walk asks for each")]
            {
                use super::$layer as L;
                const LAYER: Layer = Layer::$layer;
                const IS_COVER: bool = <L as LayerModel<f32>>::IS_COVER;
                $walk
            }
        )*
    };
}

pub mod base;
pub mod coat;
mod density;
mod evaluate;
mod facet;
pub mod fuzz;
mod sample;
mod seen;
mod shares;
pub mod specular;
pub mod transmission;

use base::Base;
use coat::{Coat, absorbs_over, coat_tint};
pub use density::material_density;
pub use evaluate::{layer_evaluate, material_evaluate, material_is_mirror};
pub use facet::{decides_by_facet, passes_on};
use fuzz::Fuzz;
pub use sample::{MaterialNumbers, MaterialSample, material_sample};
pub use seen::{material_albedo, material_normal};
pub use shares::{LayerShare, Layers, material_layers};
use specular::Specular;
use transmission::Transmission;

use super::{
    frame::Frame,
    lobe::{LobeSample, LobeShape},
    material::{Material, Surface},
    numeric::sampled_share,
};
use crate::named::named;
use crate::optics::prelude::*;

// The effect of the same name has the code in the kernels that call for it.
named! {
    /// A layer of a material, in the order in which light from outside arrives.
    Layer {
        Fuzz, "fuzz", "fuzz", "A layer of small fibres over everything else: velvet, dust.";
        Coat, "coat", "coat", "A clear dielectric coat over everything else.";
        Specular, "specular", "specular lobe", "The lobe that reflects the Fresnel share.";
        Base, "base", "base", "The Lambertian base below the specular lobe.";
        Transmission, "transmission", "transmission", "The lobe that refracts light into the solid.";
    }
}

/// A layer's lobe and its frame.
#[derive(Clone, Copy, Debug)]
pub struct LayerLobe<'a, T> {
    pub shape: LobeShape<'a, T>,
    /// The shading frame, on the side of the viewer.
    pub frame: Frame<T>,
}

/// A layer's behaviour under uniform light, seen from one direction.
#[derive(Clone, Copy, Debug)]
pub struct LayerAlbedo<T> {
    /// Albedo: share reflected or transmitted to the viewer, in [0, 1].
    pub reflected: Vec3<T>,
    /// Transmittance to the layers after it, in [0, 1].
    pub transmittance: Vec3<T>,
}

/// A layer in one direction towards the light.
#[derive(Clone, Copy, Debug)]
pub struct LayerToward<T> {
    /// Factor of its lobe.
    pub color: Vec3<T>,
    /// Sampling probability of the layer by this direction, if no cover over it is sampled.
    pub probability: T,
}

/// A layer. The defaults serve covers.
pub trait LayerModel<T: Real> {
    /// Its entry in the registry.
    const LAYER: Layer;
    /// True if it covers all layers after it; the others share the light that covers transmit.
    const IS_COVER: bool = false;

    /// Lanes where this side of the surface has the layer.
    fn is_there(material: &Material<T>, surface: &Surface<T>) -> T::Mask;

    /// The layer's lobe. `tables` holds all materials' tables.
    fn lobe<'a>(material: &Material<T>, tables: &'a [f32], surface: &Surface<T>) -> LayerLobe<'a, T>;

    /// Albedo and transmittance of the layer. `left`: the light that the layers before it leave, but for the covers.
    fn albedo(material: &Material<T>, tables: &[f32], surface: &Surface<T>, left: Vec3<T>) -> LayerAlbedo<T>;

    /// The layer in a direction of its lobe.
    fn toward(
        material: &Material<T>,
        layers: &Layers<T>,
        surface: &Surface<T>,
        shape: &LobeShape<'_, T>,
        wi: Vec3<T>,
    ) -> LayerToward<T>;

    inlined! {
        /// The luminance of the layer with everything after it, which is `below`; sets how often the layer is sampled.
        fn choose(_: &Material<T>, layers: &mut Layers<T>, below: T) -> T {
            let share = &mut layers[Self::LAYER];
            let reflected = share.albedo.max_component();
            if !reflected.above_zero().any() {
                return below;
            }
            let rest = (T::ONE - reflected) * below;
            share.probability = cover_probability(reflected, rest);
            reflected + rest
        }

        /// Sampling probability of the layer if none before it is sampled.
        fn chance(layers: &Layers<T>) -> T {
            layers[Self::LAYER].probability
        }

        /// The albedo that leads a denoiser.
        fn seen_albedo(_: &Material<T>, _: &Surface<T>, share: &LayerShare<T>) -> Vec3<T> {
            share.albedo
        }

        /// Modifies a direction that the layer's lobe sampled with the numbers `xi`.
        fn refined_sample(_: &Material<T>, _: &Surface<T>, _xi: [T; 3], drawn: LobeSample<T>) -> LobeSample<T> {
            drawn
        }

        /// Modifies the lobe's (evaluate, density).
        fn refined(_: &Material<T>, _: &Surface<T>, _wi: Vec3<T>, evaluated: [T; 2]) -> [T; 2] {
            evaluated
        }

        /// Lanes where a direction is sampled first, and its Fresnel factor decides whether the layer is.
        fn decides_by_facet(_: &Material<T>) -> T::Mask {
            T::Mask::splat(false)
        }

        /// Sets the sampling probabilities of the layer and those after it from a direction sampled first, with its weight and
        /// probability. Returns the lanes in which the later layers sample with numbers of their own.
        fn pass_on(_: &Material<T>, _: &mut Layers<T>, _weight: T, _probability: T) -> T::Mask {
            T::Mask::splat(false)
        }
    }
}

/// Sampling probability of a cover that reflects `reflected`, if the layers below would reflect `rest`, as in
/// [`sampled_share`]; 1 without layers below.
#[inline(always)]
fn cover_probability<T: Real>(reflected: T, rest: T) -> T {
    let (zero, one) = (T::ZERO, T::ONE);
    let probability = sampled_share(reflected / (reflected + rest).max(T::from_f64(1e-9)));
    let probability = T::select(rest.above_zero(), probability, one);
    T::select(reflected.above_zero(), probability, zero)
}
