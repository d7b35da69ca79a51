//! Shares of a material's layers in light and samples, for one view direction.

use super::*;
use std::ops::{Index, IndexMut};

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
    fn index(&self, layer: Layer) -> &LayerShare<T> {
        &self.0[layer as usize]
    }
}

impl<T> IndexMut<Layer> for Layers<T> {
    fn index_mut(&mut self, layer: Layer) -> &mut LayerShare<T> {
        &mut self.0[layer as usize]
    }
}

impl<T: Real> Layers<T> {
    /// The probability of sampling each layer, in their order.
    pub fn probabilities(&self) -> [T; Layer::ALL.len()] {
        mapped!([0, 1, 2, 3, 4], |layer| self.0[layer].reached
            * self.0[layer].probability)
    }
}

/// Computes the shares of all layers for a view.
pub fn material_layers<T: Real>(material: &Material<T>, tables: &[f32], surface: &Surface<T>) -> Layers<T> {
    out_of_line!(T, {
        let (white, one) = (Vec3::ONE, T::ONE);
        let nothing = LayerShare {
            albedo: Vec3::ZERO,
            transmittance: white,
            reached: one,
            probability: T::ZERO,
        };
        let mut layers = Layers([nothing; Layer::ALL.len()]);
        // Transmittance of the covers so far, and light left by the other layers.
        let [mut through, mut left] = [white; 2];
        each_layer!({
            let share = &mut layers[LAYER];
            share.transmittance = through;
            let is_there = L::is_there(material, surface);
            if is_there.any() {
                let LayerAlbedo {
                    reflected,
                    transmittance,
                } = L::albedo(material, tables, surface, left);
                share.albedo = reflected.masked(is_there);
                let behind = if IS_COVER { &mut through } else { &mut left };
                *behind = Vec3::select(is_there, *behind * transmittance, *behind);
            }
        });
        let mut below = T::ZERO;
        each_layer!(outwards, {
            below = L::choose(material, &mut layers, below);
        });
        let mut reached = one;
        each_layer!({
            let share = &mut layers[LAYER];
            share.reached = reached;
            if IS_COVER {
                reached = reached * (one - share.probability);
            }
        });
        layers
    })
}
