//! Directions drawn from a material.

use super::base::{base_evaluate, base_sample};
use super::layers::{decides_by_facet, passes_on, shares_facets, specular_probability, transmission};
use super::{Layers, Material, Surface, material_layers};
use crate::optics::coat::coat_sample;
use crate::optics::fresnel::{fresnel, half_vector_cosine};
use crate::optics::lobe::{LobeSample, LobeShape, is_mirror, lobe_evaluate, lobe_sample};
use crate::optics::real::{Mask, Real};
use crate::optics::vector::Vec3;
use crate::optics::warp::split;

/// A layer of a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Layer {
    /// The coat.
    Coat,
    /// The specular lobe.
    Specular,
    /// The Lambertian base.
    Base,
    /// The refracting lobe.
    Refraction,
}

/// A direction drawn from a material.
#[derive(Clone, Copy, Debug)]
pub struct MaterialSample<T: Real> {
    /// Towards the light.
    pub wi: Vec3<T>,
    /// What the path's throughput is multiplied by; 0 where the sample was absorbed.
    pub throughput: Vec3<T>,
    /// Density of the lobe that was chosen times the probability of choosing it, per steradian; 0 where that lobe is
    /// weighed as a mirror (or the strategy asks for no density).
    pub density: T,
    /// True where the lobe is weighed as a mirror: light sampling has no share in this direction.
    pub is_mirror: T::Mask,
    /// The layer that was chosen, in some lane: for accounts of paths, nothing is computed from it.
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
            layer: Layer::Specular,
        }
    }

    /// `other` in its place where the mask holds.
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

/// The numbers that a sample of a material takes, each in [0, 1).
#[derive(Clone, Copy, Debug)]
pub struct MaterialNumbers<T> {
    /// Draw the direction. The first one also chooses the layer, and is stretched again ([`split`]), but where a facet's
    /// Fresnel factor decides.
    pub lobe: [T; 3],
    /// Chooses the layer where the Fresnel factor of the direction decides ([`decides_by_facet`]).
    pub facet: T,
    /// Draws the direction where the specular lobe passed it on to what is below.
    pub below: [T; 3],
}

/// Draws a direction: from the specular lobe, the base or the refracting lobe. `wants_density` is false where no other
/// strategy competes: then the geometric lobe never computes its density.
pub fn material_sample<T: Real>(
    material: &Material<T>,
    tables: &[f32],
    surface: &Surface<T>,
    numbers: MaterialNumbers<T>,
    wants_density: bool,
) -> MaterialSample<T> {
    T::out_of_line(
        #[inline(always)]
        || {
            let drawing = Drawing {
                material,
                layers: material_layers(material, tables, surface),
                surface,
                wants_density,
            };
            drawing.sample(tables, numbers)
        },
    )
}

/// What directions are drawn from.
struct Drawing<'a, T: Real> {
    material: &'a Material<T>,
    layers: Layers<T>,
    surface: &'a Surface<T>,
    wants_density: bool,
}

impl<T: Real> Drawing<'_, T> {
    /// See [`material_sample`].
    #[inline(always)]
    fn sample(&self, tables: &[f32], numbers: MaterialNumbers<T>) -> MaterialSample<T> {
        let Self {
            material,
            layers,
            surface,
            ..
        } = self;
        let (base, mut through) = (layers.base_probability(), layers.transmission_probability);
        let mut xi = numbers.lobe;
        let mut sample = MaterialSample::nothing();
        let mut left = T::Mask::splat(true);
        let has_coat = material.has_coat(surface);
        if has_coat.any() {
            let (takes, stretched) = split(xi[0], layers.coat_probability);
            let takes = has_coat & takes;
            xi[0] = T::select(has_coat, stretched, xi[0]);
            if takes.any() {
                sample = coat_sample(material, surface, xi, layers.coat_probability, self.wants_density);
                left = !takes;
            }
        }
        if !left.any() {
            return sample;
        }
        let (is_passed_on, is_shared) = (passes_on(material), shares_facets(material));
        let is_by_facet = decides_by_facet(material);
        let choice = T::select(is_by_facet, numbers.facet, xi[0]);
        let mut specular = layers.specular_probability;
        let (mut takes, mut rest) = split(choice, specular);
        xi[0] = T::select(is_by_facet, xi[0], rest);
        if (left & (is_by_facet | takes)).any() {
            let shape = material.shape(tables);
            let drawn = self.draw(&shape, xi);
            let terms = material.fresnel_terms(surface.is_inside);
            let color = fresnel(&terms, half_vector_cosine(surface.wo, drawn.wi));
            specular = specular_probability(material, layers, surface, drawn.wi, color);
            through = T::select(is_shared, T::one() - base - specular, through);
            if is_passed_on.any() {
                let is_lost = is_passed_on & !T::zero().less(drawn.weight);
                specular = T::select(is_lost, T::zero(), specular);
                for (number, below) in xi.iter_mut().zip(numbers.below) {
                    *number = T::select(is_passed_on, below, *number);
                }
            }
            if is_by_facet.any() {
                (takes, rest) = split(choice, specular);
            }
            takes = left & takes;
            if takes.any() {
                let finished = self.finish(Layer::Specular, &shape, drawn, color, [specular; 2]);
                sample = sample.replaced(takes, finished);
                left = left & !takes;
            }
        }
        if !left.any() {
            return sample;
        }
        let (is_base, stretched) = split(rest, base / (base + through).max(T::from_f64(1e-20)));
        xi[0] = T::select(is_by_facet, xi[0], stretched);
        let takes_base = is_base | !T::zero().less(through);
        if (left & takes_base).any() {
            let drawn = base_sample(material, surface, xi);
            let finished = self.finished(
                Layer::Base,
                drawn,
                #[inline(always)]
                || base_evaluate(material, surface, drawn.wi)[1],
                layers.base,
                [base; 2],
            );
            sample = sample.replaced(left & takes_base, finished);
            left = left & !takes_base;
        }
        if left.any() {
            let shape = material.transmission_shape(tables, surface.is_inside);
            let drawn = self.draw(&shape, xi);
            let there = transmission(material, layers, &shape, surface, drawn.wi);
            let probabilities = [through, there.probability];
            let finished = self.finish(Layer::Refraction, &shape, drawn, there.color, probabilities);
            sample = sample.replaced(left, finished);
        }
        sample
    }

    #[inline(always)]
    fn draw(&self, shape: &LobeShape<'_, T>, xi: [T; 3]) -> LobeSample<T> {
        let surface = self.surface;
        lobe_sample(shape, &surface.frame, surface.normal, surface.wo, xi)
    }

    /// What a direction drawn from a lobe below the coat makes of a path, see [`Drawing::finished`].
    #[inline(always)]
    fn finish(
        &self,
        layer: Layer,
        shape: &LobeShape<'_, T>,
        drawn: LobeSample<T>,
        color: Vec3<T>,
        probabilities: [T; 2],
    ) -> MaterialSample<T> {
        let (surface, is_mirror) = (self.surface, is_mirror(shape));
        let finished = self.finished(
            layer,
            drawn,
            #[inline(always)]
            || {
                if is_mirror.all() {
                    return T::zero();
                }
                let [_, density] = lobe_evaluate(shape, &surface.frame, surface.normal, surface.wo, drawn.wi);
                T::select(is_mirror, T::zero(), density)
            },
            color,
            probabilities,
        );
        MaterialSample { is_mirror, ..finished }
    }

    /// The same from a density, no mirror's. The probabilities are that with which the layer was chosen, and the one that
    /// the direction tells: they differ where the horizon policy has turned the direction.
    #[inline(always)]
    fn finished(
        &self,
        layer: Layer,
        drawn: LobeSample<T>,
        density: impl Fn() -> T,
        color: Vec3<T>,
        [chosen, told]: [T; 2],
    ) -> MaterialSample<T> {
        let layers = &self.layers;
        let below = T::one() - layers.coat_probability;
        let density = if self.wants_density {
            below * told * density()
        } else {
            T::zero()
        };
        let scale = drawn.weight / (below * chosen).max(T::from_f64(1e-20));
        MaterialSample {
            wi: drawn.wi,
            throughput: color * layers.below_coat * scale,
            density,
            is_mirror: T::Mask::splat(false),
            layer,
        }
    }
}
