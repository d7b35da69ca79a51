//! Directions drawn from a material.

use super::evaluate::lobe_of;
use super::*;
use crate::optics::{lobe::is_mirror, lobe::lobe_sample_density, warp::split};

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
            wi: Vec3::ZERO,
            throughput: Vec3::ZERO,
            density: T::ZERO,
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
    out_of_line!(T, {
        // Shares, updated by directions that were sampled first.
        let mut layers = *layers;
        // The numbers that draw a direction, and the one that chooses a layer.
        let (mut xi, mut choice) = (numbers.lobe, numbers.lobe[0]);
        // Lanes in which the current layer samples no direction, and lanes without a chosen layer.
        let (mut is_apart, mut left) = (T::Mask::splat(false), T::Mask::splat(true));
        let mut sample = MaterialSample::nothing();
        each_layer!({
            let (chance, is_by_facet) = (L::chance(&layers), L::decides_by_facet(material));
            if (left & (is_by_facet | chance.above_zero())).any() {
                choice = T::select(is_by_facet, numbers.facet, choice);
                is_apart = is_apart | is_by_facet;
                let (mut takes, mut rest) = split(choice, chance);
                xi[0] = T::select(is_apart, xi[0], rest);
                if (left & (is_by_facet | takes)).any() {
                    let lobe = L::lobe(material, tables, surface);
                    let is_mirror = is_mirror(&lobe.shape);
                    let needs_density = needs_density && !is_mirror.all();
                    // Where a facet decides, few lanes may take the direction: its density then waits for that.
                    let is_together = needs_density && !is_by_facet.any();
                    let (frame, normal, wo) = (&lobe.frame, surface.normal, surface.wo);
                    let (drawn, of_lobe) = lobe_sample_density(&lobe.shape, frame, normal, wo, xi, is_together);
                    let drawn = L::refined_sample(material, surface, xi, drawn);
                    let toward = L::toward(material, &layers, surface, &lobe.shape, drawn.wi);
                    if is_by_facet.any() {
                        let is_passed_on = L::pass_on(material, &mut layers, drawn.weight, toward.probability);
                        for (number, below) in xi.iter_mut().zip(numbers.below) {
                            *number = T::select(is_passed_on, below, *number);
                        }
                        (takes, rest) = split(choice, L::chance(&layers));
                    }
                    takes = left & takes;
                    if takes.any() {
                        let share = &layers[LAYER];
                        let mut density = T::ZERO;
                        if needs_density {
                            let [_, of_lobe] = match is_together {
                                true => L::refined(material, surface, drawn.wi, [T::ZERO, of_lobe]),
                                false => lobe_of::<T, L>(material, surface, &lobe, drawn.wi),
                            };
                            let density_there = share.reached * toward.probability * of_lobe;
                            density = T::select(is_mirror, T::ZERO, density_there);
                        }
                        // If the horizon policy has turned the direction, its own selection probability differs from
                        // the one used to sample: keep the latter.
                        let scale = drawn.weight / (share.reached * share.probability).max(T::from_f64(1e-20));
                        let mut color = toward.color * share.transmittance;
                        if absorbs_over(material, LAYER) {
                            color = color * coat_tint(material, &layers, surface, drawn.wi);
                        }
                        let of_layer = MaterialSample {
                            wi: drawn.wi,
                            throughput: color * scale,
                            density,
                            is_mirror,
                            layer: LAYER,
                        };
                        sample = sample.replaced(takes, of_layer);
                        left = left & !takes;
                    }
                }
                choice = rest;
            }
        });
        sample
    })
}
