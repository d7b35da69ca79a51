//! Some samples of every pixel of a tile, the paths going on together: rays that go the same way are traced in packets, paths
//! that met the same material are shaded side by side in lanes.
//!
//! Lanes hold what each path would have by itself, and rays in packets meet what they would meet alone, to the last bit. So it
//! does not matter which paths go on together, and no picture depends on how the work is shared out.

use std::ops::Range;

use super::group::{Group, Groups};
use super::paths::Paths;
use super::results::Results;
use super::{Arrival, Integrator};
use crate::cpu::recorder::Unrecorded;
use crate::instructions;
use crate::job::tiles::TILE_SIDE;
use crate::optics::layer::material_layers;
use crate::optics::random::Sequence;
use crate::optics::real::{Mask, Real, Scalar};
use crate::optics::vector::Vec3;
use crate::scene::{Hit, PACKET, Packet, WAYS, ray_way};

/// Pixels of a tile at most.
const PIXELS: usize = (TILE_SIDE * TILE_SIDE) as usize;
/// Samples of each pixel that go on together.
pub const WAVE_SAMPLES: u32 = 8;
/// Paths that go on together at most.
const PATHS: usize = PIXELS * WAVE_SAMPLES as usize;
/// Pixels near each other whose samples lie side by side: 2 × 2, of which four samples make a packet.
pub const NEAR: usize = 4;
/// Fewer rays to lights than this are traced one by one.
const LIGHT_RAYS_MIN: usize = 4;
/// Fewer of the rays with which paths go on: a packet of them takes more of the hierarchy, as each has to find the nearest
/// triangle.
const RAYS_MIN: usize = 8;

/// A tile of a picture.
pub struct Tile {
    pub(super) origin: [u32; 2],
    /// Its pixels from its corner on, those near each other one after the other.
    places: Vec<[u32; 2]>,
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
    /// The camera rays of all of them.
    packets: Vec<Packet>,
    /// What the rays of all of them met, where no surface has holes.
    hits: Vec<Option<Hit>>,
    /// The ways of rays.
    ways: Ways,
    /// The places of paths whose light arrives.
    lit: Vec<u16>,
    /// What they found.
    results: Results<T::Scalar>,
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
            packets: Vec::with_capacity(PATHS / PACKET),
            hits: Vec::with_capacity(PATHS),
            ways: Ways::default(),
            lit: Vec::with_capacity(PATHS),
            results: Results::new(PATHS + T::LANES),
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
    /// What samples of each pixel of a tile find, from sample `first` on: `tell` hears of as many samples of each pixel as go
    /// on together, the first of them and how many there are.
    pub fn trace_tile(
        &self,
        tile: &Tile,
        wave: &mut Wave<T>,
        [first, count]: [u32; 2],
        mut tell: impl FnMut([u32; 2], &Results<T::Scalar>),
    ) {
        for from in (first..first + count).step_by(WAVE_SAMPLES as usize) {
            let samples = [from, WAVE_SAMPLES.min(first + count - from)];
            let is_background = self.trace_wave(tile, samples, wave);
            if !is_background {
                let results = (0..wave.paths.count()).map(|number| self.result(&wave.paths, number));
                wave.results.fill(results);
                wave.results.cut = wave.paths.cut;
            }
            tell(samples, &wave.results);
        }
    }

    /// Follows the paths of some samples to their end; true where none of them met anything, and `results` has what is there.
    fn trace_wave(&self, tile: &Tile, samples: [u32; 2], wave: &mut Wave<T>) -> bool {
        self.add_paths(tile, samples, &mut wave.paths);
        let has_more = self.firefly_clamp.is_some() || samples[0] < self.guide_samples;
        wave.results.start(wave.paths.count(), has_more);
        if !self.has_holes {
            self.trace_camera_rays(&wave.paths, &mut wave.packets, &mut wave.hits);
            if self.has_plain_background() && wave.hits.iter().all(Option::is_none) {
                self.see_background(&wave.paths, &mut wave.results);
                return true;
            }
            wave.hits.resize(wave.paths.count(), None);
        }
        wave.paths.start(std::iter::repeat(Unrecorded), &self.beginning());
        wave.under_way.clear();
        wave.under_way.extend(0..wave.paths.count() as u16);
        for bounce in 0.. {
            if bounce > 0 && !self.has_holes {
                self.trace_rays(wave);
            }
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

    /// Finds what the rays meet with which paths go on, where no surface has holes: those that go the same way together.
    fn trace_rays(&self, wave: &mut Wave<T>) {
        let Wave {
            paths,
            under_way,
            ways,
            hits,
            ..
        } = wave;
        ways.clear();
        for &place in &*under_way {
            let place = usize::from(place);
            if !paths.leaves[place] {
                ways.add(ray_way(paths.state.direction.get(place).to_f32()), place);
            }
        }
        let ray = |place: &u16| {
            let place = usize::from(*place);
            let (origin, direction) = (paths.origin.get(place), paths.state.direction.get(place));
            (origin.to_f32(), direction.to_f32(), f32::MAX)
        };
        for group in ways.groups() {
            let mut met = [None; PACKET];
            if group.len() < RAYS_MIN {
                for (met, (origin, direction, t_max)) in met.iter_mut().zip(group.iter().map(ray)) {
                    *met = self.geometry.intersect(origin, direction, t_max);
                }
            } else {
                let packet = Packet::of(group.iter().map(ray));
                met = self.geometry.intersect_packet(instructions::level(), &packet);
            }
            for (&place, met) in group.iter().zip(met) {
                hits[usize::from(place)] = met;
            }
        }
    }

    /// Traces the rays of all paths under way where surfaces have holes, has the processor fetch what shading will look up,
    /// and puts those side by side that met the same material.
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
        for &member in &*under_way {
            let place = usize::from(member);
            let is_stopped = if self.has_holes {
                self.stop(bounce, place, paths)
            } else {
                !paths.leaves[place] && paths.note(place, hits[place])
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
                    T::out_of_line(
                        #[inline(always)]
                        || self.leave(&Arrival::new(group, bounce, paths), place, paths),
                    );
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
        let point = T::out_of_line(
            #[inline(always)]
            || self.surfaces(&arrival, slot, paths),
        );
        let passed = self.pass_catcher(&point, &mut arrival, paths);
        let is_passed = arrival.on & !passed.is_there;
        if is_passed.any() {
            let ray = Arrival {
                on: is_passed,
                ..arrival
            };
            T::out_of_line(
                #[inline(always)]
                || self.leave(&ray, self.left_places(ray.direction, ray.bounce), paths),
            );
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
            let layers = &material_layers(material, self.tables, &point.surface);
            if self.meet(&point, material, layers, &mut arrival, paths) {
                if self.samples_light() && !is_caught_mirrored {
                    T::out_of_line(
                        #[inline(always)]
                        || self.aim(&point, material, layers, &arrival, paths),
                    );
                }
                T::out_of_line(
                    #[inline(always)]
                    || self.scatter(&point, material, layers, &arrival, paths),
                );
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
        for group in ways.groups() {
            self.look_together(group, paths);
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
        if places.len() < LIGHT_RAYS_MIN {
            for (is_hidden, (origin, direction, distance)) in is_hidden.iter_mut().zip(rays) {
                *is_hidden = self.geometry.occluded(origin, direction, distance);
            }
        } else {
            is_hidden = self.geometry.occluded_packet(instructions::level(), &Packet::of(rays));
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
        paths.take_arriving(lit, self.samples_emitters);
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

    /// Those that go the same way, as many as a packet has at most.
    fn groups(&self) -> impl Iterator<Item = &[u16]> {
        let of_way = self.places.iter().zip(self.counts);
        of_way.flat_map(|(places, count)| places[..usize::from(count)].chunks(PACKET))
    }
}

impl Tile {
    /// The tile at a place of the picture, of a size in pixels.
    pub fn new(origin: [u32; 2], size: [u32; 2]) -> Self {
        // Along Morton's curve: squares of 2 × 2, of which four make a square again.
        let every_second = |bits: u32| (bits & 1) | (bits >> 1 & 2) | (bits >> 2 & 4);
        let places = (0..PIXELS as u32).map(|place| [every_second(place), every_second(place >> 1)]);
        let places = places.filter(|[x, y]| *x < size[0] && *y < size[1]).collect();
        Self { origin, places }
    }

    /// Its pixels, those near each other together.
    pub fn near(&self) -> impl Iterator<Item = Near<'_>> {
        let firsts = (0..).step_by(NEAR);
        let near = self.places.chunks(NEAR).zip(firsts);
        near.map(|(places, first)| Near { places, first })
    }
}

/// Pixels of a tile near each other, the paths of a sample of which lie side by side.
#[derive(Clone, Copy)]
pub struct Near<'a> {
    /// From the tile's corner on.
    pub places: &'a [[u32; 2]],
    first: usize,
}

impl Near<'_> {
    /// Which path of a wave is a sample, of so many, of the first of the pixels; those of the others follow.
    #[inline(always)]
    pub fn path(&self, [sample, count]: [u32; 2]) -> usize {
        self.first * count as usize + sample as usize * self.places.len()
    }
}
