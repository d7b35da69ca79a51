//! Shadow rays of the paths of a wave.

use super::vectors::{Vectors, gather};
use crate::cpu::recorder::{Event, Source};
use crate::optics::vector::Vec3;

/// Shadow rays as structure of arrays, by path index.
pub struct ShadowRays {
    /// Path ids; only of unoccluded rays.
    pub ids: Vec<u16>,
    /// Environment map coordinates; only of unoccluded rays.
    pub environment_uv: [Vec<f32>; 2],
    /// True if the ray is to be traced; the other fields are arbitrary otherwise.
    pub is_pending: Vec<bool>,
    /// See [`LightSample`](crate::scene::light::LightSample).
    pub direction: Vectors,
    pub density: Vec<f32>,
    pub distance: Vec<f32>,
    /// Of the emitter; unused for the environment.
    pub radiance: Vectors,
    /// Numbers of the emitters' light groups; only where these are summed apart.
    pub groups: Vec<f32>,
    /// True for a sample of the environment, whose radiance is looked up later. Always true if no emitters are sampled. Set
    /// together with the random numbers, for all hits.
    pub is_environment: Vec<bool>,
    /// The material's value (cosine included) times the MIS weight of light sampling.
    pub value: Vectors,
    /// Path throughput before the surface.
    pub throughput: Vectors,
    pub origin: Vectors,
    /// True if the ray is known to be unoccluded: no traversal needed.
    pub is_known_miss: Vec<bool>,
    /// Share of the light in [0, 1] that passes.
    pub visibility: Vec<f32>,
}

impl ShadowRays {
    /// Fields for `count` paths.
    pub fn new(count: usize) -> Self {
        let numbers = || vec![0.0; count];
        Self {
            ids: vec![0; count],
            environment_uv: [numbers(), numbers()],
            is_pending: vec![false; count],
            direction: Vectors::new(count),
            density: numbers(),
            distance: numbers(),
            radiance: Vectors::new(count),
            groups: numbers(),
            is_environment: vec![true; count],
            value: Vectors::new(count),
            throughput: Vectors::new(count),
            origin: Vectors::new(count),
            is_known_miss: vec![false; count],
            visibility: numbers(),
        }
    }

    /// The shadow ray of one path.
    pub fn get(&self, index: usize) -> ShadowRay {
        ShadowRay {
            origin: self.origin.get(index),
            direction: self.direction.get(index),
            distance: self.distance[index],
            density: self.density[index],
            value: self.value.get(index),
            is_environment: self.is_environment[index],
            is_known_miss: self.is_known_miss[index],
            visibility: self.visibility[index],
        }
    }

    /// Compacts the fields of unoccluded rays that adding their light needs, in the given order. Emitters' fields are copied
    /// only if they are sampled. `ids` are the paths' by index.
    pub fn gather_unoccluded(&mut self, from: &Self, ids: &[u16], order: &[u16], samples_emitters: bool) {
        gather(&mut self.ids, ids, order);
        self.direction.gather(&from.direction, order);
        gather(&mut self.density, &from.density, order);
        if samples_emitters {
            self.radiance.gather(&from.radiance, order);
            gather(&mut self.groups, &from.groups, order);
            gather(&mut self.is_environment, &from.is_environment, order);
        }
        self.value.gather(&from.value, order);
        self.throughput.gather(&from.throughput, order);
        gather(&mut self.visibility, &from.visibility, order);
    }
}

/// The shadow ray of one path; see [`ShadowRays`] for the fields.
#[derive(Clone, Copy, Debug)]
pub struct ShadowRay {
    pub origin: Vec3<f32>,
    pub direction: Vec3<f32>,
    pub distance: f32,
    pub density: f32,
    pub value: Vec3<f32>,
    pub is_environment: bool,
    pub is_known_miss: bool,
    pub visibility: f32,
}

impl ShadowRay {
    /// Where its light comes from.
    pub fn source(&self) -> Source {
        if self.is_environment {
            Source::Environment
        } else {
            Source::Surface
        }
    }

    /// The recorded event of this ray; `unweighted` is its value without the MIS weight.
    pub fn event(&self, unweighted: Vec3<f32>, visibility: f32, radiance: Vec3<f32>) -> Event {
        let (unweighted, kept) = (unweighted.to_f32(), self.value.to_f32());
        Event::Light {
            source: self.source(),
            direction: self.direction.to_f32(),
            density: self.density,
            value: unweighted,
            weight: [0, 1, 2].map(|i| if kept[i] > 0.0 { kept[i] / unweighted[i] } else { 0.0 }),
            visible: visibility,
            radiance: radiance.to_f32(),
        }
    }
}
