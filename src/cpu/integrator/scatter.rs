//! How paths go on from a surface.

use super::group::Group;
use super::paths::Paths;
use super::{Arrival, BELOW_DIMENSION, BOUNCE_DIMENSIONS, FIRST_DIMENSION, Integrator, ROULETTE_START};
use crate::cpu::recorder::{End, Event, LayerChance, Purpose, Recorder, single};
use crate::job::Strategy;
use crate::optics::layer::{
    Layer, Layers, MaterialNumbers, MaterialSample, decides_by_facet, material_sample, passes_on,
};
use crate::optics::material::Material;
use crate::optics::real::{Mask, Real};
use crate::optics::vector::Vec3;
use crate::scene::surface::SurfacePoint;

impl<T: Real> Integrator<'_, T> {
    /// Gives paths the rays on which they go on, or ends them.
    #[inline(always)]
    pub(super) fn scatter<R: Recorder>(
        &self,
        point: &SurfacePoint<T>,
        material: &Material<T>,
        layers: &Layers<T>,
        arrival: &Arrival<T>,
        paths: &mut Paths<T::Scalar, R>,
    ) {
        let group = arrival.group;
        let numbers = material_numbers(material, arrival, paths);
        let wants_density = self.samples_light() && self.settings.strategy == Strategy::Mis;
        let mut drawn = material_sample(material, self.tables, &point.surface, layers, numbers, wants_density);
        let mut leaves = self.meets_nothing(point, drawn.wi);
        if !paths.looks.is_empty() {
            let mirrors = drawn.is_mirror.to_bits();
            arrival.members.for_each(&mut paths.looks, arrival.on, |look, lane| {
                look.goes_on &= mirrors >> lane & 1 == 1;
            });
        }
        if arrival.is_caught_mirrored {
            // All of it goes on, also what the facets would keep, and none of what it meets is left to light sampling.
            leaves = leaves | !T::zero().less(drawn.throughput.max_component());
            drawn.throughput = Vec3::splat(T::one());
            drawn.is_mirror = T::Mask::splat(true);
        }
        let mut throughput = arrival.throughput * drawn.throughput;
        record_scattered(layers, arrival, &drawn, throughput, paths);
        let goes_on = survive(arrival, &mut throughput, self.settings.roulette_floor, paths);
        self.count_rough(arrival, &drawn, paths);
        let origin = point.ray_origin(drawn.wi, material.transmits());
        self.enter(point, material, drawn.wi, arrival, paths);
        let on = arrival.on;
        group.set_truth(&mut paths.goes_on, on, goes_on);
        group.set_vector(&mut paths.state.throughput, on, throughput);
        group.set_vector(&mut paths.origin, on, origin);
        group.set_vector(&mut paths.state.direction, on, drawn.wi);
        group.set_number(&mut paths.state.lobe_density, on, drawn.density);
        group.set_truth(&mut paths.state.is_mirror, on, drawn.is_mirror);
        group.set_truth(&mut paths.leaves, on, leaves);
    }

    /// Counts bounces that are not a mirror's or clear glass's.
    #[inline(always)]
    fn count_rough<R: Recorder>(
        &self,
        arrival: &Arrival<T>,
        drawn: &MaterialSample<T>,
        paths: &mut Paths<T::Scalar, R>,
    ) {
        if self.settings.roulette_floor < 1.0 {
            let counts = arrival.group.each(&paths.state.rough_bounces);
            let rough = (arrival.on & !drawn.is_mirror).to_bits();
            let counts = T::each(
                #[inline(always)]
                |lane| counts.as_ref()[lane] + (rough >> lane & 1),
            );
            arrival.group.set_each(&mut paths.state.rough_bounces, &counts);
        }
    }
}

#[inline(always)]
fn record_scattered<T: Real, R: Recorder>(
    layers: &Layers<T>,
    arrival: &Arrival<T>,
    drawn: &MaterialSample<T>,
    throughput: Vec3<T>,
    paths: &mut Paths<T::Scalar, R>,
) {
    if !R::KEEPS {
        return;
    }
    let probability = |lane| {
        move |(layer, probability): (&Layer, T)| LayerChance {
            layer: *layer,
            probability: single(probability.lane(lane)),
        }
    };
    let probabilities = layers.probabilities();
    arrival
        .members
        .record(&mut paths.found, arrival.on, |lane| Event::Scattered {
            layer: drawn.layer,
            probabilities: Layer::ALL.iter().zip(probabilities).map(probability(lane)).collect(),
            direction: drawn.wi.to_each().as_ref()[lane].to_f32(),
            factor: drawn.throughput.to_each().as_ref()[lane].to_f32(),
            density: single(drawn.density.lane(lane)),
            is_mirror: drawn.is_mirror.to_bits() >> lane & 1 == 1,
            throughput: throughput.to_each().as_ref()[lane].to_f32(),
        });
}

/// The numbers with which a material's directions are drawn.
#[inline(always)]
fn material_numbers<T: Real, R: Recorder>(
    material: &Material<T>,
    arrival: &Arrival<T>,
    paths: &mut Paths<T::Scalar, R>,
) -> MaterialNumbers<T> {
    let Arrival { group, bounce, .. } = *arrival;
    let dimension = FIRST_DIMENSION + bounce * BOUNCE_DIMENSIONS;
    // Elsewhere the number that draws the direction chooses the layer.
    let facet = if decides_by_facet(material).any() {
        Purpose::Layer
    } else {
        Purpose::Unused
    };
    let [a, b] = group.pairs(paths, dimension, [Purpose::Lobe; 2]);
    let [c, facet] = group.pairs(paths, dimension + 1, [Purpose::Lobe, facet]);
    let lobe = [a, b, c];
    let mut below = lobe;
    if passes_on(material).any() {
        let dimension = BELOW_DIMENSION + 2 * bounce;
        let [a, b] = group.pairs(paths, dimension, [Purpose::Below; 2]);
        let [c, _] = group.pairs(paths, dimension + 1, [Purpose::Below, Purpose::Unused]);
        below = [a, b, c];
    }
    MaterialNumbers { lobe, facet, below }
}

/// Where paths go on: Russian roulette, its survivors made up for by their throughput.
#[inline(always)]
fn survive<T: Real, R: Recorder>(
    arrival: &Arrival<T>,
    throughput: &mut Vec3<T>,
    floor: f64,
    paths: &mut Paths<T::Scalar, R>,
) -> T::Mask {
    let Arrival {
        group,
        members,
        bounce,
        on,
        ..
    } = *arrival;
    let strength = throughput.max_component();
    // Also ends paths that are NaN.
    let is_left = T::zero().less(strength);
    members.record(&mut paths.found, on & !is_left, |_| Event::Ended { why: End::Absorbed });
    if bounce < ROULETTE_START {
        return is_left;
    }
    let mut limit = T::one();
    if floor < 1.0 {
        let counts = group.each(&paths.state.rough_bounces);
        limit = T::from_lanes(
            #[inline(always)]
            |lane| {
                let is_early = counts.as_ref()[lane] < ROULETTE_START;
                T::Scalar::from_f64(if is_early { floor } else { 1.0 })
            },
        );
    }
    let plays = on & is_left & strength.less(limit);
    if !plays.any() {
        return is_left;
    }
    let survival = strength / limit;
    let dimension = FIRST_DIMENSION + bounce * BOUNCE_DIMENSIONS + 3;
    let [_, number] = group.pairs(paths, dimension, [Purpose::Unused, Purpose::Roulette]);
    members.record(&mut paths.found, plays, |lane| Event::Roulette {
        survival: single(survival.lane(lane)),
        number: single(number.lane(lane)),
    });
    let is_out = plays & !number.less(survival);
    members.record(&mut paths.found, is_out, |_| Event::Ended { why: End::Roulette });
    let raised = *throughput / survival;
    *throughput = Vec3::select(plays, raised, *throughput);
    is_left & !is_out
}

impl<T: Real> Arrival<T> {
    /// Paths of a group whose rays came to an end after so many bounces.
    #[inline(always)]
    pub(super) fn new<R: Recorder>(group: Group<T>, bounce: u32, paths: &Paths<T::Scalar, R>) -> Self {
        let state = &paths.state;
        Self {
            group,
            members: group.members(&state.ids),
            bounce,
            on: group.mask(),
            throughput: group.vector(&state.throughput),
            direction: group.vector(&state.direction),
            lobe_density: group.number(&state.lobe_density),
            is_mirror: group.truth(&state.is_mirror),
            distance: group.number(&state.distance),
            is_caught_mirrored: false,
        }
    }
}
