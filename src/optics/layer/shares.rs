//! Shares of a material's layers in light and samples, for one view direction.

use std::ops::{Index, IndexMut};

use super::{Layer, LayerAlbedo, LayerModel, LayerVisitor, each_layer, each_layer_upwards};
use crate::optics::material::{Material, Surface};
use crate::optics::real::{Mask, Real};
use crate::optics::vector::Vec3;

/// Share of one layer for a view direction.
#[derive(Clone, Copy, Debug)]
pub struct LayerShare<T> {
    /// Albedo under uniform light, relative to the light that the covers over it transmit.
    pub albedo: Vec3<T>,
    /// Transmittance of the covers over it, in and out.
    pub transmittance: Vec3<T>,
    /// The probability that no cover over it is sampled.
    pub reached: T,
    /// Sampling probability if no cover is sampled; on average, if a facet decides.
    pub probability: T,
}

/// Shares of the layers for a view direction, by [`Layer`].
#[derive(Clone, Copy, Debug)]
pub struct Layers<T>([LayerShare<T>; Layer::ALL.len()]);

impl<T> Index<Layer> for Layers<T> {
    type Output = LayerShare<T>;
    #[inline(always)]
    fn index(&self, layer: Layer) -> &LayerShare<T> {
        &self.0[layer as usize]
    }
}

impl<T> IndexMut<Layer> for Layers<T> {
    #[inline(always)]
    fn index_mut(&mut self, layer: Layer) -> &mut LayerShare<T> {
        &mut self.0[layer as usize]
    }
}

impl<T: Real> Layers<T> {
    /// The probability of sampling each layer, in their order.
    pub fn probabilities(&self) -> [T; Layer::ALL.len()] {
        self.0.map(|share| share.reached * share.probability)
    }
}

/// Computes the shares of all layers for a view.
pub fn material_layers<T: Real>(material: &Material<T>, tables: &[f32], surface: &Surface<T>) -> Layers<T> {
    T::out_of_line(
        #[inline(always)]
        || {
            let (white, one) = (Vec3::splat(T::one()), T::one());
            let nothing = LayerShare {
                albedo: Vec3::zero(),
                transmittance: white,
                reached: one,
                probability: T::zero(),
            };
            let mut albedos = Albedos {
                material,
                tables,
                surface,
                layers: Layers([nothing; Layer::ALL.len()]),
                transmittance: white,
                left: white,
            };
            each_layer(&mut albedos);
            let mut probabilities = Probabilities {
                material,
                layers: albedos.layers,
                below: T::zero(),
            };
            each_layer_upwards(&mut probabilities);
            let mut reached = Reached {
                layers: probabilities.layers,
                reached: one,
            };
            each_layer(&mut reached);
            reached.layers
        },
    )
}

/// The walk inwards that finds albedos.
struct Albedos<'a, T: Real> {
    material: &'a Material<T>,
    tables: &'a [f32],
    surface: &'a Surface<T>,
    layers: Layers<T>,
    /// Transmittance of the covers so far.
    transmittance: Vec3<T>,
    /// Light left by the other layers so far.
    left: Vec3<T>,
}

impl<T: Real> LayerVisitor<T> for Albedos<'_, T> {
    #[inline(always)]
    fn visit<L: LayerModel<T>>(&mut self) {
        let share = &mut self.layers[L::LAYER];
        share.transmittance = self.transmittance;
        let is_there = L::is_there(self.material, self.surface);
        if !is_there.any() {
            return;
        }
        let LayerAlbedo {
            reflected,
            transmittance,
        } = L::albedo(self.material, self.tables, self.surface, self.left);
        share.albedo = Vec3::select(is_there, reflected, Vec3::zero());
        let behind = if L::TRAITS.is_cover {
            &mut self.transmittance
        } else {
            &mut self.left
        };
        *behind = Vec3::select(is_there, *behind * transmittance, *behind);
    }
}

/// The walk outwards that finds how often each layer is sampled.
struct Probabilities<'a, T: Real> {
    material: &'a Material<T>,
    layers: Layers<T>,
    /// The luminance of the layers so far.
    below: T,
}

impl<T: Real> LayerVisitor<T> for Probabilities<'_, T> {
    #[inline(always)]
    fn visit<L: LayerModel<T>>(&mut self) {
        self.below = L::choose(self.material, &mut self.layers, self.below);
    }
}

/// The walk inwards that finds how often each layer is reached.
struct Reached<T> {
    layers: Layers<T>,
    reached: T,
}

impl<T: Real> LayerVisitor<T> for Reached<T> {
    #[inline(always)]
    fn visit<L: LayerModel<T>>(&mut self) {
        let share = &mut self.layers[L::LAYER];
        share.reached = self.reached;
        if L::TRAITS.is_cover {
            self.reached = self.reached * (T::one() - share.probability);
        }
    }
}
