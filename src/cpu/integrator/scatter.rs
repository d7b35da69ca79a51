//! Scattering at a path vertex: BSDF sampling and Russian roulette.

use super::*;
use crate::cpu::recorder::{LayerChance, Purpose};
use crate::optics::layer::{Layer, MaterialNumbers, MaterialSample, decides_by_facet, material_sample, passes_on};

impl<T: Single> Integrator<'_, T> {
    /// Samples the next direction of each path, or ends it.
    #[inline(always)]
    pub fn scatter<R: Recorder>(
        &self,
        point: &SurfacePoint<T>,
        material: &Material<T>,
        layers: &Layers<T>,
        vertex: &PathVertex<T>,
        paths: &mut Paths<R>,
    ) {
        let group = vertex.group;
        let numbers = material_numbers(material, vertex, paths);
        let needs_density = self.samples_light() && self.settings.strategy == Strategy::Mis;
        let mut sampled = material_sample(material, self.tables, &point.surface, layers, numbers, needs_density);
        let mut known_miss = self.is_known_miss(point, sampled.wi);
        if !paths.guides.is_empty() {
            let mirrors = sampled.is_mirror.to_bits();
            vertex
                .members
                .for_each(&mut paths.guides, vertex.active, |record, lane| {
                    record.is_active &= mirrors >> lane & 1 == 1;
                });
        }
        if vertex.is_catcher_mirror {
            // The mirrored ray keeps its full weight, also the light that facets would block. Its light must not compete
            // with light sampling, which the catcher does not do.
            known_miss = known_miss | !sampled.throughput.max_component().above_zero();
            sampled.throughput = Vec3::ONE;
            sampled.is_mirror = T::Mask::splat(true);
        }
        let mut throughput = vertex.throughput * sampled.throughput;
        record_scattered(layers, vertex, &sampled, throughput, paths);
        let is_active = russian_roulette(vertex, &mut throughput, self.settings.roulette_floor, paths);
        self.count_rough(vertex, &sampled, paths);
        let origin = point.ray_origin(sampled.wi, material.transmits());
        self.update_media(point, material, sampled.wi, vertex, paths);
        let active = vertex.active;
        group.set_flags(&mut paths.is_active, active, is_active);
        group.set_vector(&mut paths.state.throughput, active, throughput);
        group.set_vector(&mut paths.origin, active, origin);
        group.set_vector(&mut paths.state.direction, active, sampled.wi);
        group.set_number(&mut paths.state.lobe_density, active, sampled.density);
        group.set_flags(&mut paths.state.is_mirror, active, sampled.is_mirror);
        group.set_flags(&mut paths.is_known_miss, active, known_miss);
    }

    /// Counts non-specular bounces.
    #[inline(always)]
    fn count_rough<R: Recorder>(&self, vertex: &PathVertex<T>, sampled: &MaterialSample<T>, paths: &mut Paths<R>) {
        if self.settings.roulette_floor < 1.0 {
            let counts = vertex.group.each(&paths.state.rough_bounces);
            let rough = (vertex.active & !sampled.is_mirror).to_bits();
            let counts = T::each(|lane| counts[lane] + (rough >> lane & 1));
            vertex.group.set_each(&mut paths.state.rough_bounces, &counts);
        }
    }
}

#[inline(always)]
fn record_scattered<T: Single, R: Recorder>(
    layers: &Layers<T>,
    vertex: &PathVertex<T>,
    sampled: &MaterialSample<T>,
    throughput: Vec3<T>,
    paths: &mut Paths<R>,
) {
    if !R::KEEPS {
        return;
    }
    let probability = |lane| {
        move |(layer, probability): (&Layer, T)| LayerChance {
            layer: *layer,
            probability: probability.lane(lane),
        }
    };
    let probabilities = layers.probabilities();
    vertex
        .members
        .record(&mut paths.outputs, vertex.active, |lane| Event::Scattered {
            layer: sampled.layer,
            probabilities: Layer::ALL.iter().zip(probabilities).map(probability(lane)).collect(),
            direction: sampled.wi.lane(lane).to_f32(),
            factor: sampled.throughput.lane(lane).to_f32(),
            density: sampled.density.lane(lane),
            is_mirror: sampled.is_mirror.to_bits() >> lane & 1 == 1,
            throughput: throughput.lane(lane).to_f32(),
        });
}

/// Random numbers of material sampling.
#[inline(always)]
fn material_numbers<T: Single, R: Recorder>(
    material: &Material<T>,
    vertex: &PathVertex<T>,
    paths: &mut Paths<R>,
) -> MaterialNumbers<T> {
    let PathVertex { group, bounce, .. } = *vertex;
    let dimension = FIRST_DIMENSION + bounce * BOUNCE_DIMENSIONS;
    // Other materials reuse the direction's number to choose the layer.
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

/// Paths that survive Russian roulette; their throughput is divided by the survival probability.
#[inline(always)]
fn russian_roulette<T: Single, R: Recorder>(
    vertex: &PathVertex<T>,
    throughput: &mut Vec3<T>,
    floor: f64,
    paths: &mut Paths<R>,
) -> T::Mask {
    let PathVertex {
        group,
        members,
        bounce,
        active,
        ..
    } = *vertex;
    let strength = throughput.max_component();
    // Ends NaN paths, too.
    let is_left = strength.above_zero();
    members.record(&mut paths.outputs, active & !is_left, |_| Event::Ended {
        why: End::Absorbed,
    });
    if bounce < ROULETTE_START {
        return is_left;
    }
    let mut limit = T::ONE;
    if floor < 1.0 {
        let counts = group.each(&paths.state.rough_bounces);
        limit = T::from_lanes(|lane| {
            let is_early = counts[lane] < ROULETTE_START;
            (if is_early { floor } else { 1.0 }) as f32
        });
    }
    let plays = active & is_left & strength.less(limit);
    if !plays.any() {
        return is_left;
    }
    let survival = strength / limit;
    let dimension = FIRST_DIMENSION + bounce * BOUNCE_DIMENSIONS + 3;
    let [_, number] = group.pairs(paths, dimension, [Purpose::Unused, Purpose::Roulette]);
    members.record(&mut paths.outputs, plays, |lane| Event::Roulette {
        survival: survival.lane(lane),
        number: number.lane(lane),
    });
    let is_out = plays & !number.less(survival);
    members.record(&mut paths.outputs, is_out, |_| Event::Ended { why: End::Roulette });
    let raised = *throughput / survival;
    *throughput = Vec3::select(plays, raised, *throughput);
    is_left & !is_out
}

impl<T: Single> PathVertex<T> {
    /// The path vertices of a group after `bounce` bounces.
    #[inline(always)]
    pub fn new<R: Recorder>(group: Group<T>, bounce: u32, paths: &Paths<R>) -> Self {
        let state = &paths.state;
        Self {
            group,
            members: group.members(&state.ids),
            bounce,
            active: group.mask(),
            throughput: group.vector(&state.throughput),
            direction: group.vector(&state.direction),
            lobe_density: group.number(&state.lobe_density),
            is_mirror: group.flags(&state.is_mirror),
            distance: group.number(&state.distance),
            is_catcher_mirror: false,
        }
    }
}
