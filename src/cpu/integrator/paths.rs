//! The paths of a wave as structure of arrays: groups of lanes load and store whole vectors.
//!
//! [`PathStates`] holds what a path needs to continue. Its order changes from bounce to bounce, so that paths which are shaded
//! together are adjacent; a position in it is an *index*. [`PathOutput`] holds what a path accumulates, by its *id*: its
//! fixed number in the wave.

use super::*;
use super::{shadow_rays::ShadowRays, vectors::Vectors, vectors::gather};
use crate::{
    optics::random::{RandomState, path_state},
    optics::vector::Vec3,
    scene::Hit,
};
use std::mem::swap;

/// What paths need to continue, by index.
pub struct PathStates {
    pub ids: Vec<u16>,
    /// Keys of the random sequences, see [`RandomState`].
    pub keys: Vec<u32>,
    pub samples: Vec<u32>,
    /// Path throughput: weight of the light that arrives along the ray.
    pub throughput: Vectors,
    /// Unit directions of the rays.
    pub direction: Vectors,
    /// Density of the direction per steradian, for the MIS weight.
    pub lobe_density: Vec<f32>,
    /// True if light sampling could not have drawn the direction (a specular bounce or a camera ray).
    pub is_mirror: Vec<bool>,
    /// Bounces that were not specular; empty if nothing refracts.
    pub rough_bounces: Vec<u32>,
    pub hits: Vec<Hit>,
    /// Distances of the hits from the rays' origins. More than in `hits` if the ray passed transparent surfaces.
    pub distance: Vec<f32>,
    /// Slots of the media that the paths are in; empty if none absorbs.
    pub media: Vec<u32>,
}

impl PathStates {
    fn new(count: usize) -> Self {
        Self {
            ids: vec![0; count],
            keys: vec![0; count],
            samples: vec![0; count],
            throughput: Vectors::new(count),
            direction: Vectors::new(count),
            lobe_density: vec![0.0; count],
            is_mirror: vec![false; count],
            rough_bounces: Vec::new(),
            hits: vec![Hit::default(); count],
            distance: vec![0.0; count],
            media: Vec::new(),
        }
    }

    fn gather(&mut self, from: &Self, order: &[u16]) {
        gather(&mut self.ids, &from.ids, order);
        gather(&mut self.keys, &from.keys, order);
        gather(&mut self.samples, &from.samples, order);
        self.throughput.gather(&from.throughput, order);
        self.direction.gather(&from.direction, order);
        gather(&mut self.lobe_density, &from.lobe_density, order);
        gather(&mut self.is_mirror, &from.is_mirror, order);
        gather(&mut self.rough_bounces, &from.rough_bounces, order);
        gather(&mut self.hits, &from.hits, order);
        gather(&mut self.distance, &from.distance, order);
        gather(&mut self.media, &from.media, order);
    }
}

/// The paths of a wave.
pub struct Paths<R> {
    pub sequence: Sequence,
    pub state: PathStates,
    /// Target of [`Paths::reorder`], which then swaps it with `state`.
    scratch: PathStates,
    pub origin: Vectors,
    /// True if the ray is known to miss: no traversal needed.
    pub is_known_miss: Vec<bool>,
    /// True until the path ends.
    pub is_active: Vec<bool>,
    /// Environment map coordinates of escaped rays.
    pub environment_uv: [Vec<f32>; 2],
    /// Random numbers of light sampling, each in [0, 1).
    pub light_xi: Vectors,
    /// Rows of environment cells that `light_xi` selects.
    pub light_rows: Vec<u32>,
    /// Shadow rays, by index.
    pub shadow_rays: ShadowRays,
    /// The unoccluded shadow rays, compacted.
    pub unoccluded_rays: ShadowRays,
    /// Number of paths in the wave.
    pub count: usize,
    /// Pixel coordinates (x, y), by path id; `samples` are sample numbers.
    pub pixels: [Vec<u32>; 2],
    pub samples: Vec<u32>,
    /// Accumulated results, by path id.
    pub outputs: Vec<PathOutput<R>>,
    /// First-hit guides by path id; empty if no path records them.
    pub guides: Vec<GuideRecord>,
    /// Light of each group, those of a path in a row by its id; empty if they are not summed apart.
    pub light_groups: Vec<Vec3<f32>>,
    /// Shadow-catcher hits by path id; empty without a catcher.
    pub catcher_hits: Vec<CatcherHit>,
    /// Sum over paths of the throughput's luminance where the bounce limit ended them.
    pub cut: f64,
}

impl<R: Recorder> Paths<R> {
    /// Compacts the unoccluded shadow rays, in the given order, see [`ShadowRays::gather_unoccluded`].
    pub fn gather_unoccluded(&mut self, order: &[u16], samples_emitters: bool) {
        let (rays, ids) = (&self.shadow_rays, &self.state.ids);
        self.unoccluded_rays
            .gather_unoccluded(rays, ids, order, samples_emitters);
    }

    /// Fields for `count` paths that are processed in groups of `lanes`.
    pub fn new(count: usize, lanes: usize, sequence: Sequence) -> Self {
        // The last group loads past the last path.
        let count = count + lanes;
        Self {
            sequence,
            state: PathStates::new(count),
            scratch: PathStates::new(count),
            origin: Vectors::new(count),
            is_known_miss: vec![false; count],
            is_active: vec![false; count],
            environment_uv: [vec![0.0; count], vec![0.0; count]],
            light_xi: Vectors::new(count),
            light_rows: vec![0; count],
            shadow_rays: ShadowRays::new(count),
            unoccluded_rays: ShadowRays::new(count),
            count: 0,
            pixels: [vec![0; count], vec![0; count]],
            samples: vec![0; count],
            outputs: Vec::with_capacity(count),
            guides: Vec::new(),
            light_groups: Vec::new(),
            catcher_hits: Vec::new(),
            cut: 0.0,
        }
    }

    pub fn clear(&mut self) {
        self.count = 0;
        self.outputs.clear();
        self.guides.clear();
        self.light_groups.clear();
        self.catcher_hits.clear();
        self.cut = 0.0;
    }

    /// Adds one sample of each pixel, offset by `corner`. [`Paths::set_counters`] and [`Integrator::start`] complete the new
    /// paths.
    pub fn add(&mut self, corner: [u32; 2], pixels: &[[u32; 2]], sample: u32) {
        let added = self.count..self.count + pixels.len();
        self.count = added.end;
        let [columns, rows] = &mut self.pixels;
        let places = columns[added.clone()].iter_mut().zip(&mut rows[added.clone()]);
        for ((column, row), [x, y]) in places.zip(pixels) {
            (*column, *row) = (corner[0] + x, corner[1] + y);
        }
        self.samples[added].fill(sample);
    }

    /// Initialises the random states. Written so that compilers vectorise it.
    #[inline(always)]
    pub fn set_counters(&mut self, seed: u32) {
        let state = &mut self.state;
        let counters = state.keys.iter_mut().zip(&mut state.samples).zip(&mut state.ids);
        let pixels = self.pixels[0].iter().zip(&self.pixels[1]);
        let all = pixels.zip(&self.samples).zip(0..).take(self.count);
        for (((key, index), id), (((&x, &y), &sample), number)) in counters.zip(all) {
            let state = path_state(x, y, seed, sample, self.sequence);
            (*key, *index, *id) = (state.key, state.sample, number);
        }
    }

    /// Makes empty results for the added paths.
    pub fn add_outputs(&mut self) {
        self.outputs.resize_with(self.count, || PathOutput {
            radiance: Vec3::ZERO,
            clamped: 0.0,
            alpha: 1.0,
            rays: 0,
            recorder: R::default(),
        });
    }

    /// Reorders the state: index i becomes the path of index `order[i]`. Drops all others.
    pub fn reorder(&mut self, order: &[u16]) {
        if !order.iter().copied().eq(0..order.len() as u16) {
            self.scratch.gather(&self.state, order);
            swap(&mut self.state, &mut self.scratch);
        }
    }

    /// Random state of a path, by index.
    pub fn random_state(&self, index: usize) -> RandomState {
        RandomState {
            key: self.state.keys[index],
            sample: self.state.samples[index],
            sequence: self.sequence,
        }
    }

    /// Takes the light of the groups from paths whose light has become alpha, see [`CatcherHit::result`].
    pub fn finish_groups(&mut self) {
        let groups = self.light_groups.len() / self.count.max(1);
        for (id, hit) in self.catcher_hits.iter().enumerate() {
            if hit.is_alpha() {
                self.light_groups[id * groups..(id + 1) * groups].fill(Vec3::ZERO);
            }
        }
    }

    /// Accumulated result of the path at an index.
    pub fn output_at(&mut self, index: usize) -> &mut PathOutput<R> {
        &mut self.outputs[usize::from(self.state.ids[index])]
    }

    /// Stores a ray's hit and counts the ray. Returns false for a miss.
    pub fn record_hit(&mut self, index: usize, hit: Option<Hit>) -> bool {
        self.output_at(index).rays += 1;
        if let Some(hit) = hit {
            self.state.hits[index] = hit;
            self.state.distance[index] = hit.t;
        }
        hit.is_some()
    }
}

impl<T: Single> Integrator<'_, T> {
    /// Initialises the added paths for their camera rays.
    pub fn start<R: Recorder>(&self, paths: &mut Paths<R>) {
        let is_guided = |sample: &u32| *sample < self.guide_samples;
        paths.state.throughput.fill(1.0);
        paths.state.lobe_density.fill(0.0);
        paths.state.is_mirror.fill(true);
        paths.is_known_miss.fill(false);
        paths.is_active.fill(true);
        paths.add_outputs();
        let samples = &paths.samples[..paths.count];
        if samples.iter().any(is_guided) {
            paths.guides.extend(samples.iter().map(|sample| GuideRecord {
                is_active: is_guided(sample),
                guides: GuideSums::default(),
            }));
        }
        paths.light_groups.resize(paths.count * self.light_groups, Vec3::ZERO);
        if self.settings.catcher.is_some() {
            paths.catcher_hits.resize(paths.count, CatcherHit::Miss);
        }
        for state in [&mut paths.state, &mut paths.scratch] {
            if self.settings.roulette_floor < 1.0 {
                state.rough_bounces.clear();
                state.rough_bounces.resize(state.ids.len(), 0);
            }
            if self.has_absorption {
                let medium = self.settings.camera_medium.unwrap_or(NO_MEDIUM);
                state.media.clear();
                state.media.resize(state.ids.len(), medium);
            }
        }
    }

    /// Result of a path by its id; the path has ended.
    pub fn result<R: Recorder>(&self, paths: &Paths<R>, number: usize) -> PathResult {
        let output = &paths.outputs[number];
        let result = PathResult {
            radiance: output.radiance,
            alpha: output.alpha,
            rays: output.rays,
            clamped: output.clamped,
            guides: paths
                .guides
                .get(number)
                .map_or_else(GuideSums::default, |record| record.guides),
        };
        let catcher_hit = paths.catcher_hits.get(number).copied().unwrap_or_default();
        catcher_hit.result(result, self.settings.least_reflections == 0)
    }
}

/// Accumulated result of a path.
pub struct PathOutput<R> {
    pub radiance: Vec3<f32>,
    /// Luminance that the firefly clamp removed.
    pub clamped: f32,
    /// Coverage in [0, 1].
    pub alpha: f32,
    /// Rays traced, shadow rays included.
    pub rays: u32,
    pub recorder: R,
}

/// First-hit guides of a path.
pub struct GuideRecord {
    /// True while the path still records: it has met only mirrors and clear glass.
    pub is_active: bool,
    pub guides: GuideSums,
}
