//! Directions drawn from a material.

use super::coat::{absorbs_over, coat_tint};
use super::evaluate::lobe_of;
use super::{Layer, LayerLobe, LayerModel, LayerToward, LayerVisitor, Layers, each_layer};
use crate::optics::lobe::{LobeSample, is_mirror, lobe_sample};
use crate::optics::material::{Material, Surface};
use crate::optics::real::{Mask, Real};
use crate::optics::vector::Vec3;
use crate::optics::warp::split;

/// A direction drawn from a material.
#[derive(Clone, Copy, Debug)]
pub struct MaterialSample<T: Real> {
    /// Unit direction to the light.
    pub wi: Vec3<T>,
    /// Factor of the path's throughput; 0 if absorbed.
    pub throughput: Vec3<T>,
    /// Density of the chosen lobe times its probability, per steradian; 0 for a mirror, or if the strategy needs no density.
    pub density: T,
    /// True for a mirror: light sampling cannot have drawn this direction.
    pub is_mirror: T::Mask,
    /// The chosen layer of some lane: for records of paths only.
    pub layer: Layer,
}

impl<T: Real> MaterialSample<T> {
    /// No direction.
    #[inline(always)]
    fn nothing() -> Self {
        Self {
            wi: Vec3::zero(),
            throughput: Vec3::zero(),
            density: T::zero(),
            is_mirror: T::Mask::splat(false),
            layer: Layer::ALL[0],
        }
    }

    /// `other` in the masked lanes, else `self`.
    #[inline(always)]
    fn replaced(self, mask: T::Mask, other: Self) -> Self {
        Self {
            wi: Vec3::select(mask, other.wi, self.wi),
            throughput: Vec3::select(mask, other.throughput, self.throughput),
            density: T::select(mask, other.density, self.density),
            is_mirror: (mask & other.is_mirror) | (!mask & self.is_mirror),
            layer: other.layer,
        }
    }
}

/// Random numbers of a material sample, each in [0, 1).
#[derive(Clone, Copy, Debug)]
pub struct MaterialNumbers<T> {
    /// For the direction. The first one also chooses the layer and is remapped ([`split`]), unless a facet's Fresnel factor
    /// decides.
    pub lobe: [T; 3],
    /// For the choice of the layer, if the direction's Fresnel factor decides
    /// ([`decides_by_facet`](super::decides_by_facet)).
    pub facet: T,
    /// For the direction below the specular lobe, if that passed it on.
    pub below: [T; 3],
}

/// Samples a direction from one of the layers. `needs_density` is false if no other strategy competes: then the geometric
/// lobe never computes its density.
pub fn material_sample<T: Real>(
    material: &Material<T>,
    tables: &[f32],
    surface: &Surface<T>,
    layers: &Layers<T>,
    numbers: MaterialNumbers<T>,
    needs_density: bool,
) -> MaterialSample<T> {
    T::out_of_line(
        #[inline(always)]
        || {
            let mut drawing = Drawing {
                material,
                tables,
                surface,
                layers: *layers,
                numbers,
                needs_density,
                xi: numbers.lobe,
                choice: numbers.lobe[0],
                is_apart: T::Mask::splat(false),
                left: T::Mask::splat(true),
                sample: MaterialSample::nothing(),
            };
            each_layer(&mut drawing);
            drawing.sample
        },
    )
}

/// The walk that draws from the first layer that is chosen.
struct Drawing<'a, T: Real> {
    material: &'a Material<T>,
    tables: &'a [f32],
    surface: &'a Surface<T>,
    /// Shares, updated by directions that were sampled first.
    layers: Layers<T>,
    numbers: MaterialNumbers<T>,
    needs_density: bool,
    /// The numbers that draw a direction.
    xi: [T; 3],
    /// The number that chooses a layer.
    choice: T,
    /// Lanes in which the current layer samples no direction.
    is_apart: T::Mask,
    /// Lanes without a chosen layer.
    left: T::Mask,
    sample: MaterialSample<T>,
}

impl<T: Real> LayerVisitor<T> for Drawing<'_, T> {
    #[inline(always)]
    fn visit<L: LayerModel<T>>(&mut self) {
        let (material, surface) = (self.material, self.surface);
        let (chance, is_by_facet) = (L::chance(&self.layers), L::decides_by_facet(material));
        if !(self.left & (is_by_facet | T::zero().less(chance))).any() {
            return;
        }
        self.choice = T::select(is_by_facet, self.numbers.facet, self.choice);
        self.is_apart = self.is_apart | is_by_facet;
        let (mut takes, mut rest) = split(self.choice, chance);
        self.xi[0] = T::select(self.is_apart, self.xi[0], rest);
        if (self.left & (is_by_facet | takes)).any() {
            let lobe = L::lobe(material, self.tables, surface);
            let drawn = lobe_sample(&lobe.shape, &lobe.frame, surface.normal, surface.wo, self.xi);
            let drawn = L::refined_sample(material, surface, self.xi, drawn);
            let toward = L::toward(material, &self.layers, surface, &lobe.shape, drawn.wi);
            if is_by_facet.any() {
                let is_passed_on = L::pass_on(material, &mut self.layers, drawn.weight, toward.probability);
                for (number, below) in self.xi.iter_mut().zip(self.numbers.below) {
                    *number = T::select(is_passed_on, below, *number);
                }
                (takes, rest) = split(self.choice, L::chance(&self.layers));
            }
            takes = self.left & takes;
            if takes.any() {
                self.sample = self.sample.replaced(takes, self.finished::<L>(&lobe, drawn, toward));
                self.left = self.left & !takes;
            }
        }
        self.choice = rest;
    }
}

impl<T: Real> Drawing<'_, T> {
    /// Effect on the path of a direction sampled from a layer. If the horizon policy has turned the direction, its own
    /// selection probability differs from the one used to sample: keep the latter.
    #[inline(always)]
    fn finished<L: LayerModel<T>>(
        &self,
        lobe: &LayerLobe<'_, T>,
        drawn: LobeSample<T>,
        toward: LayerToward<T>,
    ) -> MaterialSample<T> {
        let share = &self.layers[L::LAYER];
        let is_mirror = is_mirror(&lobe.shape);
        let mut density = T::zero();
        if self.needs_density && !is_mirror.all() {
            let [_, of_lobe] = lobe_of::<T, L>(self.material, self.surface, lobe, drawn.wi);
            let density_there = share.reached * toward.probability * of_lobe;
            density = T::select(is_mirror, T::zero(), density_there);
        }
        let scale = drawn.weight / (share.reached * share.probability).max(T::from_f64(1e-20));
        let mut color = toward.color * share.transmittance;
        if absorbs_over::<T, L>(self.material) {
            color = color * coat_tint(self.material, &self.layers, self.surface, drawn.wi);
        }
        MaterialSample {
            wi: drawn.wi,
            throughput: color * scale,
            density,
            is_mirror,
            layer: L::LAYER,
        }
    }
}
