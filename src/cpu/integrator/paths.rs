//! The paths of a wave, field by field: what is done with as many of them as there are lanes takes whole vectors out of
//! memory and puts whole vectors back.
//!
//! What a path needs to go on lies in [`State`], in an order that changes from bounce to bounce, so that paths which are
//! shaded together lie side by side. What it has found lies in [`Found`], by its number in the wave.

use std::mem::swap;

use super::PathResult;
use super::catcher::Caught;
use super::light::LightRays;
use crate::cpu::recorder::{Event, Recorder};
use crate::job::guides::GuideSums;
use crate::optics::random::{RandomState, Sequence, path_state};
use crate::optics::real::Scalar;
use crate::optics::vector::{Vec3, vec3};
use crate::scene::Hit;

/// Three numbers of each path.
pub(super) struct Vectors<S> {
    pub x: Vec<S>,
    pub y: Vec<S>,
    pub z: Vec<S>,
}

impl<S: Scalar> Vectors<S> {
    /// All zero.
    pub fn new(count: usize) -> Self {
        Self {
            x: vec![S::zero(); count],
            y: vec![S::zero(); count],
            z: vec![S::zero(); count],
        }
    }

    /// Those of one path.
    #[inline(always)]
    pub fn get(&self, place: usize) -> Vec3<S> {
        vec3(self.x[place], self.y[place], self.z[place])
    }

    /// Sets those of one path.
    #[inline(always)]
    pub fn set(&mut self, place: usize, value: Vec3<S>) {
        (self.x[place], self.y[place], self.z[place]) = (value.x, value.y, value.z);
    }

    pub fn fill(&mut self, value: S) {
        self.x.fill(value);
        self.y.fill(value);
        self.z.fill(value);
    }

    /// Takes those of other paths, in this order.
    #[inline(always)]
    pub fn take(&mut self, from: &Self, order: &[u16]) {
        take(&mut self.x, &from.x, order);
        take(&mut self.y, &from.y, order);
        take(&mut self.z, &from.z, order);
    }
}

/// Takes what other paths have of something, in this order.
#[inline(always)]
pub(super) fn take<E: Copy>(field: &mut [E], from: &[E], order: &[u16]) {
    for (to, &place) in field.iter_mut().zip(order) {
        *to = from[usize::from(place)];
    }
}

/// What paths need to go on.
pub(super) struct State<S> {
    /// Which paths of the wave they are.
    pub ids: Vec<u16>,
    /// The counters from which they draw their numbers, see [`RandomState`].
    pub keys: Vec<u32>,
    pub samples: Vec<u32>,
    /// What light from the rays' other ends is multiplied by.
    pub throughput: Vectors<S>,
    /// Of the rays: unit vectors.
    pub direction: Vectors<S>,
    /// The density of the direction, for what competes with light sampling.
    pub lobe_density: Vec<S>,
    /// True where light sampling could not have drawn the direction.
    pub is_mirror: Vec<bool>,
    /// Bounces that were not a mirror's or clear glass's; empty where nothing is refracted.
    pub rough_bounces: Vec<u32>,
    /// What the rays met.
    pub hits: Vec<Hit>,
    /// How far from the rays' origins: farther than in `hits` where they went through surfaces before.
    pub distance: Vec<S>,
    /// The slots of the solids that they are in; empty where none absorbs.
    pub media: Vec<u32>,
}

impl<S: Scalar> State<S> {
    fn new(count: usize) -> Self {
        Self {
            ids: vec![0; count],
            keys: vec![0; count],
            samples: vec![0; count],
            throughput: Vectors::new(count),
            direction: Vectors::new(count),
            lobe_density: vec![S::zero(); count],
            is_mirror: vec![false; count],
            rough_bounces: Vec::new(),
            hits: vec![Hit::default(); count],
            distance: vec![S::zero(); count],
            media: Vec::new(),
        }
    }

    fn take(&mut self, from: &Self, order: &[u16]) {
        take(&mut self.ids, &from.ids, order);
        take(&mut self.keys, &from.keys, order);
        take(&mut self.samples, &from.samples, order);
        self.throughput.take(&from.throughput, order);
        self.direction.take(&from.direction, order);
        take(&mut self.lobe_density, &from.lobe_density, order);
        take(&mut self.is_mirror, &from.is_mirror, order);
        take(&mut self.rough_bounces, &from.rough_bounces, order);
        take(&mut self.hits, &from.hits, order);
        take(&mut self.distance, &from.distance, order);
        take(&mut self.media, &from.media, order);
    }
}

/// What is noted of paths besides what they find.
pub(super) struct Beginning {
    /// How many samples of a pixel tell what they see.
    pub guide_samples: u32,
    pub has_catcher: bool,
    /// Whether bounces are counted that are not a mirror's.
    pub counts_rough: bool,
    /// The solid around the camera; `None` where no solid absorbs.
    pub medium: Option<u32>,
}

/// The paths of a wave.
pub(super) struct Paths<S, R> {
    pub sequence: Sequence,
    pub state: State<S>,
    /// Where `state` is put in another order.
    other: State<S>,
    /// Where rays start.
    pub origin: Vectors<S>,
    /// True where it is proven that nothing lies ahead.
    pub leaves: Vec<bool>,
    /// True until they have come to their end.
    pub goes_on: Vec<bool>,
    /// Where they look at the environment's map.
    pub place: [Vec<S>; 2],
    /// The numbers that draw their light.
    pub light_numbers: Vectors<S>,
    /// The rows of the environment's cells that those draw.
    pub light_rows: Vec<u32>,
    /// The rays to lights, of paths that are aimed at one.
    pub lights: LightRays<S>,
    /// Those that arrive, side by side.
    pub arriving: LightRays<S>,
    /// How many there are.
    count: usize,
    /// Pixels and numbers of the samples in them, by the paths' numbers in the wave.
    pub pixels: [Vec<u32>; 2],
    pub samples: Vec<u32>,
    /// What they have found, by their numbers in the wave.
    pub found: Vec<Found<S, R>>,
    /// What they see first, by their numbers in the wave; empty where none of them tells.
    pub looks: Vec<Look>,
    /// What a shadow catcher has made of them, by their numbers in the wave; empty where there is none.
    pub caught: Vec<Caught<S>>,
    /// Sum of the luminances of the throughputs of paths that ended at their last bounce.
    pub cut: f64,
}

impl<S: Scalar, R: Recorder> Paths<S, R> {
    /// Room for paths, of which as many go on side by side as there are lanes.
    pub fn new(count: usize, lanes: usize, sequence: Sequence) -> Self {
        // The last group may reach beyond them.
        let count = count + lanes;
        Self {
            sequence,
            state: State::new(count),
            other: State::new(count),
            origin: Vectors::new(count),
            leaves: vec![false; count],
            goes_on: vec![false; count],
            place: [vec![S::zero(); count], vec![S::zero(); count]],
            light_numbers: Vectors::new(count),
            light_rows: vec![0; count],
            lights: LightRays::new(count),
            arriving: LightRays::new(count),
            count: 0,
            pixels: [vec![0; count], vec![0; count]],
            samples: vec![0; count],
            found: Vec::with_capacity(count),
            looks: Vec::new(),
            caught: Vec::new(),
            cut: 0.0,
        }
    }

    /// Forgets all paths.
    pub fn clear(&mut self) {
        self.count = 0;
        self.found.clear();
        self.looks.clear();
        self.caught.clear();
        self.cut = 0.0;
    }

    /// How many paths the wave has.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Adds a sample of each of these pixels, from a corner on: paths before their first rays, of which
    /// [`Paths::set_counters`] and [`Paths::start`] make the rest.
    #[inline(always)]
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

    /// Sets the counters from which paths draw their numbers. Written so that compilers turn it into lanes.
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

    /// Has the paths that were added start from the camera, having found nothing: one recorder for each.
    pub fn start(&mut self, recorders: impl IntoIterator<Item = R>, beginning: &Beginning) {
        let guide_samples = beginning.guide_samples;
        self.state.throughput.fill(S::one());
        self.state.lobe_density.fill(S::zero());
        self.state.is_mirror.fill(true);
        self.leaves.fill(false);
        self.goes_on.fill(true);
        self.found
            .extend(recorders.into_iter().take(self.count).map(Found::new));
        let samples = &self.samples[..self.count];
        if samples.iter().any(|sample| *sample < guide_samples) {
            self.looks
                .extend(samples.iter().map(|sample| Look::new(*sample < guide_samples)));
        }
        if beginning.has_catcher {
            self.caught.resize(self.count, Caught::Not);
        }
        if beginning.counts_rough {
            for state in [&mut self.state, &mut self.other] {
                state.rough_bounces.clear();
                state.rough_bounces.resize(state.ids.len(), 0);
            }
        }
        if let Some(medium) = beginning.medium {
            for state in [&mut self.state, &mut self.other] {
                state.media.clear();
                state.media.resize(state.ids.len(), medium);
            }
        }
    }

    /// Puts these paths first, in this order, and forgets the others.
    pub fn arrange(&mut self, order: &[u16]) {
        if !order.iter().copied().eq(0..order.len() as u16) {
            self.other.take(&self.state, order);
            swap(&mut self.state, &mut self.other);
        }
    }

    /// The counters of a path.
    #[inline(always)]
    pub fn random_state(&self, place: usize) -> RandomState {
        RandomState {
            key: self.state.keys[place],
            sample: self.state.samples[place],
            sequence: self.sequence,
        }
    }

    /// What a path found, by its number in the wave, of all light or of a part.
    pub fn result(&self, number: usize, is_all_light: bool) -> PathResult<S> {
        let found = &self.found[number];
        let result = PathResult {
            radiance: found.radiance,
            alpha: found.alpha,
            rays: found.rays,
            clamped: found.clamped,
            seen: self.looks.get(number).map_or_else(GuideSums::default, |look| look.seen),
        };
        let caught = self.caught.get(number).copied().unwrap_or_default();
        caught.result(result, is_all_light)
    }

    /// What the path at a place has found.
    #[inline(always)]
    pub fn found_at(&mut self, place: usize) -> &mut Found<S, R> {
        &mut self.found[usize::from(self.state.ids[place])]
    }

    /// Notes what a ray was found to meet; false where that is nothing.
    #[inline(always)]
    pub fn note(&mut self, place: usize, hit: Option<Hit>) -> bool {
        self.found_at(place).rays += 1;
        if let Some(hit) = hit {
            self.state.hits[place] = hit;
            self.state.distance[place] = S::from_f64(f64::from(hit.t));
        }
        hit.is_some()
    }
}

/// What a path has found.
pub(super) struct Found<S, R> {
    pub radiance: Vec3<S>,
    /// Luminance that limiting fireflies took.
    pub clamped: S,
    /// 1 where it met something that is not transparent background.
    pub alpha: S,
    /// Rays traced.
    pub rays: u32,
    recorder: R,
}

/// What a path sees first.
pub(super) struct Look {
    /// True while the path is one of those that tell, and has met nothing but mirrors and clear glass.
    pub goes_on: bool,
    pub seen: GuideSums,
}

impl Look {
    fn new(goes_on: bool) -> Self {
        Self {
            goes_on,
            seen: GuideSums::default(),
        }
    }
}

impl<S: Scalar, R: Recorder> Found<S, R> {
    /// Nothing.
    #[inline(always)]
    pub fn new(recorder: R) -> Self {
        Self {
            radiance: Vec3::zero(),
            clamped: S::zero(),
            alpha: S::one(),
            rays: 0,
            recorder,
        }
    }

    /// Tells of an event.
    #[inline(always)]
    pub fn record(&mut self, event: impl FnOnce() -> Event) {
        self.recorder.record(event);
    }
}
