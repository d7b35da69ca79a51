//! Shadow rays of the paths of a wave.

use super::vectors::{Vectors, gather};

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
