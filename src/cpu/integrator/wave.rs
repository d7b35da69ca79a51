//! Some samples of every pixel of a tile, the paths going on together: rays that go the same way are traced in packets, paths
//! that met the same material are shaded side by side in lanes.
//!
//! Lanes hold what each path would have by itself, and rays in packets meet what they would meet alone, to the last bit. So it
//! does not matter which paths go on together, and no picture depends on how the work is shared out.

use std::ops::Range;

use super::group::{Group, Groups};
use super::paths::Paths;
use super::{Arrival, Integrator, PathResult};
use crate::cpu::recorder::Unrecorded;
use crate::instructions;
use crate::job::tiles::TILE_SIDE;
use crate::optics::random::Sequence;
use crate::optics::real::{Mask, Real, Scalar};
use crate::optics::vector::Vec3;
use crate::scene::{Hit, PACKET, Packet, WAYS, ray_way};

/// Pixels of a tile at most.
const PIXELS: usize = (TILE_SIDE * TILE_SIDE) as usize;
/// Samples of each pixel that go on together.
pub const WAVE_SAMPLES: u32 = 4;
/// Paths that go on together at most.
const PATHS: usize = PIXELS * WAVE_SAMPLES as usize;
/// Pixels near each other whose samples lie side by side: 2 × 2, of which those of a wave make a packet.
pub(super) const NEAR: usize = 4;
/// Fewer rays than this are traced one by one.
const RAYS_MIN: usize = 4;

/// A tile of a picture.
pub struct Tile {
    pub(super) origin: [u32; 2],
    size: [u32; 2],
    /// Its pixels, those near each other one after the other.
    pub(super) places: Vec<[u32; 2]>,
}

/// Where the paths of a tile are followed, for one tile after the other.
pub struct Wave<T: Real> {
    paths: Paths<T::Scalar, Unrecorded>,
    /// The places of those on their way.
    under_way: Vec<u16>,
    /// Those whose rays met a surface, each with its slot.
    met: Vec<(u32, u16)>,
    /// Those whose rays met nothing.
    left: Vec<u16>,
    /// The order in which all are shaded: those by their slots, then those whose rays met nothing.
    order: Vec<u16>,
    /// What the camera rays of all of them met.
    hits: Vec<Option<Hit>>,
    /// The ways of rays to lights.
    ways: Ways,
    /// The places of paths whose light arrives.
    lit: Vec<u16>,
    /// What they found, if they have all met nothing.
    seen: Vec<PathResult<T::Scalar>>,
}

impl<T: Real> Wave<T> {
    /// Room for any tile's, whose numbers are drawn from this sequence.
    pub fn new(sequence: Sequence) -> Self {
        Self {
            paths: Paths::new(PATHS, T::LANES, sequence),
            under_way: Vec::with_capacity(PATHS),
            met: Vec::with_capacity(PATHS),
            left: Vec::with_capacity(PATHS),
            order: Vec::with_capacity(PATHS),
            hits: Vec::with_capacity(PATHS),
            ways: Ways::default(),
            lit: Vec::with_capacity(PATHS),
            seen: Vec::with_capacity(PATHS),
        }
    }

    /// The places of those whose rays met a surface, shaded first.
    fn met(&self) -> Range<usize> {
        0..self.met.len()
    }

    /// The places of those whose rays met nothing.
    fn left(&self) -> Range<usize> {
        self.met.len()..self.order.len()
    }
}

impl<T: Real> Integrator<'_, T> {
    /// What samples of each pixel of a tile find, from sample `first` on: `tell` hears of each sample, in their order, with the
    /// number of its pixel in the tile.
    pub fn trace_tile(
        &self,
        tile: &Tile,
        wave: &mut Wave<T>,
        [first, count]: [u32; 2],
        mut tell: impl FnMut(usize, u32, &PathResult<T::Scalar>),
    ) {
        for from in (first..first + count).step_by(WAVE_SAMPLES as usize) {
            let samples = [from, WAVE_SAMPLES.min(first + count - from)];
            let is_background = self.trace_wave(tile, samples, wave);
            for sample in 0..samples[1] {
                for (index, [x, y]) in tile.places.iter().enumerate() {
                    let path = tile.path(index, [sample, samples[1]]);
                    let pixel = (y * tile.size[0] + x) as usize;
                    if is_background {
                        tell(pixel, from + sample, &wave.seen[path]);
                    } else {
                        tell(pixel, from + sample, &self.result(&wave.paths.found[path]));
                    }
                }
            }
        }
    }

    /// Follows the paths of some samples to their end; true where none of them met anything, and `seen` tells what is there.
    fn trace_wave(&self, tile: &Tile, samples: [u32; 2], wave: &mut Wave<T>) -> bool {
        self.add_paths(tile, samples, &mut wave.paths);
        if !self.has_holes {
            self.trace_camera_rays(&wave.paths, &mut wave.hits);
            if self.has_plain_background() && wave.hits.iter().all(Option::is_none) {
                self.see_background(&wave.paths, &mut wave.seen);
                return true;
            }
        }
        wave.paths.start(std::iter::repeat(Unrecorded), self.guide_samples);
        wave.under_way.clear();
        wave.under_way.extend(0..wave.paths.count() as u16);
        for bounce in 0.. {
            self.trace(bounce, wave);
            self.shade(bounce, wave);
            self.look_for_lights(wave);
            self.light(bounce, wave);
            let Wave {
                under_way,
                paths,
                order,
                ..
            } = wave;
            under_way.clear();
            under_way.extend((0..order.len() as u16).filter(|&place| paths.goes_on[usize::from(place)]));
            if under_way.is_empty() {
                break;
            }
        }
        false
    }

    /// Traces the rays of all paths under way, has the processor fetch what shading will look up, and puts those side by side
    /// that met the same material.
    fn trace(&self, bounce: u32, wave: &mut Wave<T>) {
        let Wave {
            paths,
            under_way,
            met,
            left,
            order,
            hits,
            ..
        } = wave;
        met.clear();
        left.clear();
        // What camera rays meet is known where no surface has holes.
        let is_known = bounce == 0 && !self.has_holes;
        for &member in &*under_way {
            let place = usize::from(member);
            let is_stopped = if is_known {
                paths.note(place, hits[place])
            } else {
                self.stop(bounce, place, paths)
            };
            if is_stopped {
                let triangle = paths.state.hits[place].triangle;
                self.geometry.fetch(triangle);
                met.push((self.geometry.slot(triangle as usize), member));
            } else {
                left.push(member);
            }
        }
        met.sort_unstable();
        order.clear();
        order.extend(met.iter().map(|(_, member)| *member).chain(left.iter().copied()));
        paths.arrange(order);
    }

    /// What all paths find where they are, and where they go on.
    fn shade(&self, bounce: u32, wave: &mut Wave<T>) {
        let (met, left) = (wave.met(), wave.left());
        let paths = &mut wave.paths;
        paths.lights.is_aimed[met.clone()].fill(false);
        let draws = self.samples_light() && bounce < self.settings.bounces;
        T::vectorize(
            #[inline(always)]
            || {
                for group in Groups::new(left.clone()) {
                    self.locate_left(&group, bounce, paths);
                }
                if draws {
                    for group in Groups::new(met.clone()) {
                        self.light_numbers(&group, bounce, paths);
                    }
                }
                for group in Groups::<T>::new(left.clone()) {
                    let place = [group.number(&paths.place[0]), group.number(&paths.place[1])];
                    self.leave(&Arrival::new(group, bounce, paths), place, paths);
                }
                if draws && self.samples_environment {
                    for group in Groups::new(met.clone()) {
                        self.fetch_lights(&group, paths);
                    }
                }
            },
        );
        let mut first = 0;
        for same in wave.met.chunk_by(|(a, _), (b, _)| a == b) {
            let places = first..first + same.len();
            first = places.end;
            self.bounce_together(same[0].0, places, bounce, paths);
        }
    }

    /// What paths do at surfaces of one slot, but for the light that arrives from elsewhere.
    fn bounce_together(&self, slot: u32, places: Range<usize>, bounce: u32, paths: &mut Paths<T::Scalar, Unrecorded>) {
        T::vectorize(
            #[inline(always)]
            || {
                for group in Groups::new(places.clone()) {
                    self.bounce_group(slot, group, bounce, paths);
                }
            },
        );
    }

    #[inline(always)]
    fn bounce_group(&self, slot: u32, group: Group<T>, bounce: u32, paths: &mut Paths<T::Scalar, Unrecorded>) {
        let mut arrival = Arrival::new(group, bounce, paths);
        let point = self.surfaces(&arrival, slot, paths);
        let passed = self.pass_catcher(&point, &mut arrival, paths);
        let is_passed = arrival.on & !passed.is_there;
        if is_passed.any() {
            let ray = Arrival {
                on: is_passed,
                ..arrival
            };
            self.leave(&ray, self.left_places(ray.direction, ray.bounce), paths);
        }
        let ways = [
            (passed.is_there & !passed.is_mirrored, false),
            (passed.is_there & passed.is_mirrored, true),
        ];
        for (on, is_caught_mirrored) in ways {
            if !on.any() {
                continue;
            }
            let mut arrival = Arrival {
                on,
                is_caught_mirrored,
                ..arrival
            };
            let material = &*self.material(&point, &arrival);
            if self.meet(&point, material, &mut arrival, paths) {
                if self.samples_light() && !is_caught_mirrored {
                    self.aim(&point, material, &arrival, paths);
                }
                self.scatter(&point, material, &arrival, paths);
            }
        }
    }

    /// Finds which of the lights that paths are aimed at are visible.
    fn look_for_lights(&self, wave: &mut Wave<T>) {
        let met = wave.met();
        let Wave { paths, ways, .. } = wave;
        ways.clear();
        for place in met {
            if !paths.lights.is_aimed[place] {
                continue;
            }
            let rays = &mut paths.found[usize::from(paths.state.ids[place])].rays;
            if self.has_holes {
                paths.lights.visible[place] = self.visible(&paths.lights.get(place), rays);
            } else if !paths.lights.meets_nothing[place] {
                *rays += 1;
                ways.add(ray_way(paths.lights.direction.get(place).to_f32()), place);
            }
        }
        for way in 0..WAYS {
            for group in ways.of(way).chunks(PACKET) {
                self.look_together(group, paths);
            }
        }
    }

    /// The same of paths whose rays go the same way.
    fn look_together(&self, places: &[u16], paths: &mut Paths<T::Scalar, Unrecorded>) {
        let lights = &mut paths.lights;
        let ray = |place: usize| {
            let distance = lights.distance[place].to_f64() as f32;
            (
                lights.origin.get(place).to_f32(),
                lights.direction.get(place).to_f32(),
                distance,
            )
        };
        let rays = places.iter().map(|&place| ray(usize::from(place)));
        let mut is_hidden = [false; PACKET];
        if places.len() < RAYS_MIN {
            for (is_hidden, (origin, direction, distance)) in is_hidden.iter_mut().zip(rays) {
                *is_hidden = self.geometry.occluded(origin, direction, distance);
            }
        } else {
            let mut packet = Packet::default();
            for (lane, (origin, direction, distance)) in rays.enumerate() {
                packet.set(lane, origin, direction, distance);
            }
            packet.fill(places.len());
            is_hidden = self.geometry.occluded_packet(instructions::level(), &packet);
        }
        for (&place, is_hidden) in places.iter().zip(is_hidden) {
            if is_hidden {
                lights.visible[usize::from(place)] = T::Scalar::zero();
            }
        }
    }

    /// Adds the light that arrives.
    fn light(&self, bounce: u32, wave: &mut Wave<T>) {
        let met = wave.met();
        let Wave { paths, lit, .. } = wave;
        let lights = &paths.lights;
        let is_lit = |place: &u16| {
            let place = usize::from(*place);
            lights.is_aimed[place] && lights.visible[place] > T::Scalar::zero()
        };
        lit.clear();
        lit.extend((0..met.len() as u16).filter(is_lit));
        paths.take_arriving(lit);
        T::vectorize(
            #[inline(always)]
            || {
                for group in Groups::new(0..lit.len()) {
                    self.locate_lights(&group, paths);
                }
                for group in Groups::new(0..lit.len()) {
                    self.arrive(&group, bounce, Vec3::zero(), paths);
                }
            },
        );
    }
}

/// The places of paths whose rays go each way, in their order.
struct Ways {
    places: [[u16; PATHS]; WAYS],
    counts: [u16; WAYS],
}

impl Default for Ways {
    fn default() -> Self {
        Self {
            places: [[0; PATHS]; WAYS],
            counts: [0; WAYS],
        }
    }
}

impl Ways {
    fn clear(&mut self) {
        self.counts = [0; WAYS];
    }

    #[inline(always)]
    fn add(&mut self, way: usize, place: usize) {
        let count = &mut self.counts[way];
        self.places[way][usize::from(*count)] = place as u16;
        *count += 1;
    }

    #[inline(always)]
    fn of(&self, way: usize) -> &[u16] {
        &self.places[way][..usize::from(self.counts[way])]
    }
}

impl Tile {
    /// The tile at a place of the picture, of a size in pixels.
    pub fn new(origin: [u32; 2], size: [u32; 2]) -> Self {
        // Along Morton's curve: squares of 2 × 2, of which four make a square again.
        let every_second = |bits: u32| (bits & 1) | (bits >> 1 & 2) | (bits >> 2 & 4);
        let places = (0..PIXELS as u32).map(|place| [every_second(place), every_second(place >> 1)]);
        let places = places.filter(|[x, y]| *x < size[0] && *y < size[1]).collect();
        Self { origin, size, places }
    }

    /// Which path of a wave is a sample, of so many, of the pixel of this index.
    fn path(&self, index: usize, [sample, count]: [u32; 2]) -> usize {
        let first = index - index % NEAR;
        let near = NEAR.min(self.places.len() - first);
        first * count as usize + sample as usize * near + index % NEAR
    }
}
