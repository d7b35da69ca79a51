//! Some samples of every pixel of a tile, the paths going on together: rays that go the same way are traced in packets, paths
//! that met the same material are shaded side by side in lanes.
//!
//! Lanes hold what each path would have by itself, to the last bit, so it does not matter which paths are shaded together.
//! Rays in packets may differ from rays alone, if rarely (`scene::hierarchy::packet`): their company is always the same, rays
//! of one sample of one tile. So no picture depends on how the work is shared out.

use super::group::Group;
use super::path::Path;
use super::{Arrival, Integrator, PathResult, places};
use crate::cpu::recorder::Unrecorded;
use crate::instructions;
use crate::job::tiles::TILE_SIDE;
use crate::optics::real::{Mask, Real, Scalar};
use crate::optics::vector::Vec3;
use crate::scene::{Hit, PACKET, Packet, WAYS, ray_way};

/// Pixels of a tile at most.
const PIXELS: usize = (TILE_SIDE * TILE_SIDE) as usize;
/// Samples of each pixel that go on together.
pub const WAVE_SAMPLES: u32 = 4;
/// Side of the square of pixels whose camera rays make a packet.
const SIDE: u32 = 4;
const _: () = assert!((SIDE * SIDE) as usize == PACKET);
/// Fewer rays than this are traced one by one.
const RAYS_MIN: usize = 4;

/// A tile of a picture.
pub struct Tile {
    pub(super) origin: [u32; 2],
    size: [u32; 2],
    /// Its pixels, square by square.
    pub(super) places: Vec<[u32; 2]>,
}

pub(super) type WavePath<T> = Path<<T as Real>::Scalar, Unrecorded>;

/// The paths of a wave by their places, in lists that are made anew at each bounce.
#[derive(Default)]
struct Lists {
    /// Those on their way, sample by sample.
    under_way: Vec<u16>,
    /// Those whose rays met nothing.
    left: Vec<u16>,
    /// Those whose rays met a surface, each with its slot.
    met: Vec<(u32, u16)>,
    /// One list of those, without the slots.
    members: Vec<u16>,
    /// What the camera rays of all of them met.
    hits: Vec<Option<Hit>>,
}

impl<T: Real> Integrator<'_, T> {
    /// What samples of each pixel of a tile find, from sample `first` on, at most [`WAVE_SAMPLES`]: `tell` hears of each
    /// sample, in their order, with the number of its pixel in the tile.
    pub fn trace_tile(
        &self,
        tile: &Tile,
        [first, count]: [u32; 2],
        mut tell: impl FnMut(usize, u32, &PathResult<T::Scalar>),
    ) {
        let pixels = tile.places.len();
        let rays = self.camera_rays(tile, first..first + count);
        let mut lists = Lists::default();
        if !self.has_holes {
            self.trace_camera_rays(tile, &rays, &mut lists.hits);
            if self.has_plain_background() && lists.hits.iter().all(Option::is_none) {
                self.see_background(&rays, |ray, found| {
                    let [x, y] = tile.places[ray % pixels];
                    tell((y * tile.size[0] + x) as usize, first + (ray / pixels) as u32, found);
                });
                return;
            }
        }
        let mut paths = self.paths(tile, first, &rays);
        lists.under_way = (0..paths.len() as u16).collect();
        for bounce in 0.. {
            self.trace(bounce, &mut lists, &mut paths);
            self.shade(bounce, &mut lists, &mut paths);
            self.look_for_lights(pixels, &lists.under_way, &mut paths);
            self.light(bounce, &mut lists, &mut paths);
            lists.under_way.retain(|&path| paths[usize::from(path)].goes_on);
            if lists.under_way.is_empty() {
                break;
            }
        }
        for (sample, paths) in (first..).zip(paths.chunks(pixels)) {
            for ([x, y], path) in tile.places.iter().zip(paths) {
                tell((y * tile.size[0] + x) as usize, sample, &self.result(path));
            }
        }
    }

    /// Traces the rays of all paths under way and has the processor fetch what shading will look up.
    fn trace(&self, bounce: u32, lists: &mut Lists, paths: &mut [WavePath<T>]) {
        lists.left.clear();
        lists.met.clear();
        // What camera rays meet is known where no surface has holes.
        let is_known = bounce == 0 && !self.has_holes;
        for &member in &lists.under_way {
            let path = &mut paths[usize::from(member)];
            let is_stopped = if is_known {
                path.take(lists.hits[usize::from(member)])
            } else {
                self.stop(bounce, path)
            };
            if is_stopped {
                lists.met.push((self.meets(path), member));
            } else {
                lists.left.push(member);
            }
        }
        // Paths that met the same material side by side, in their order.
        lists.met.sort_unstable();
    }

    /// The slot of the surface that a path met; what shading it takes is fetched.
    #[inline(always)]
    fn meets(&self, path: &WavePath<T>) -> u32 {
        self.geometry.fetch(path.hit.triangle);
        self.geometry.slot(path.hit.triangle as usize)
    }

    /// What all paths find where they are, and where they go on.
    fn shade(&self, bounce: u32, lists: &mut Lists, paths: &mut [WavePath<T>]) {
        T::vectorize(
            #[inline(always)]
            || {
                for members in lists.left.chunks(T::LANES) {
                    self.locate_left(&Group::new(members), bounce, paths);
                }
                let draws = self.samples_light() && bounce < self.settings.bounces;
                lists.members.clear();
                lists.members.extend(lists.met.iter().map(|(_, member)| member));
                if draws {
                    for members in lists.members.chunks(T::LANES) {
                        self.light_numbers(&Group::new(members), bounce, paths);
                    }
                }
                for members in lists.left.chunks(T::LANES) {
                    let group = Group::new(members);
                    let arrival = Arrival::new(group, bounce, paths);
                    self.leave(&arrival, places(&group, paths), paths);
                }
                if draws && self.samples_environment {
                    for members in lists.members.chunks(T::LANES) {
                        self.fetch_lights(&Group::new(members), paths);
                    }
                }
            },
        );
        for same in lists.met.chunk_by(|(a, _), (b, _)| a == b) {
            lists.members.clear();
            lists.members.extend(same.iter().map(|(_, member)| member));
            for members in lists.members.chunks(T::LANES) {
                self.bounce_together(same[0].0, Arrival::new(Group::new(members), bounce, paths), paths);
            }
        }
    }

    /// What paths do at surfaces of one slot, but for the light that arrives from elsewhere.
    fn bounce_together(&self, slot: u32, arrival: Arrival<T>, paths: &mut [WavePath<T>]) {
        T::vectorize(
            #[inline(always)]
            || {
                let mut arrival = arrival;
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
            },
        );
    }

    /// Finds which of the lights that paths are aimed at are visible.
    fn look_for_lights(&self, pixels: usize, under_way: &[u16], paths: &mut [WavePath<T>]) {
        // Rays of one sample keep company, whatever others are traced at the same time.
        for sample in under_way.chunk_by(|&a, &b| usize::from(a) / pixels == usize::from(b) / pixels) {
            let mut ways = Ways::default();
            for &member in sample {
                let path = &mut paths[usize::from(member)];
                let Some(light) = &mut path.light else { continue };
                if self.has_holes {
                    light.visible = self.visible(light, &mut path.rays);
                } else if !light.meets_nothing {
                    path.rays += 1;
                    ways.add(ray_way(light.drawn.direction.to_f32()), member);
                }
            }
            for way in 0..WAYS {
                for group in ways.of(way).chunks(PACKET) {
                    self.look_together(group, paths);
                }
            }
        }
    }

    /// The same of paths whose rays go the same way.
    fn look_together(&self, members: &[u16], paths: &mut [WavePath<T>]) {
        let ray = |&member: &u16| {
            let light = paths[usize::from(member)].light();
            let distance = light.drawn.distance.to_f64() as f32;
            (light.origin.to_f32(), light.drawn.direction.to_f32(), distance)
        };
        let rays = members.iter().map(ray);
        let mut is_hidden = [false; PACKET];
        if members.len() < RAYS_MIN {
            for (is_hidden, (origin, direction, distance)) in is_hidden.iter_mut().zip(rays) {
                *is_hidden = self.geometry.occluded(origin, direction, distance);
            }
        } else {
            let mut packet = Packet::default();
            for (lane, (origin, direction, distance)) in rays.enumerate() {
                packet.set(lane, origin, direction, distance);
            }
            packet.fill(members.len());
            is_hidden = self.geometry.occluded_packet(instructions::level(), &packet);
        }
        for (&member, is_hidden) in members.iter().zip(is_hidden) {
            if let Some(light) = &mut paths[usize::from(member)].light
                && is_hidden
            {
                light.visible = T::Scalar::zero();
            }
        }
    }

    /// Adds the light that arrives.
    fn light(&self, bounce: u32, lists: &mut Lists, paths: &mut [WavePath<T>]) {
        let members = &mut lists.members;
        members.clear();
        for &member in &lists.under_way {
            let light = &mut paths[usize::from(member)].light;
            match light {
                Some(light) if light.visible > T::Scalar::zero() => members.push(member),
                _ => *light = None,
            }
        }
        T::vectorize(
            #[inline(always)]
            || {
                for members in members.chunks(T::LANES) {
                    self.locate_lights(&Group::new(members), paths);
                }
                for members in members.chunks(T::LANES) {
                    self.arrive(&Group::new(members), bounce, Vec3::zero(), paths);
                }
            },
        );
        for &member in &*members {
            paths[usize::from(member)].light = None;
        }
    }
}

/// The paths whose rays go each way, in their order.
struct Ways {
    members: [[u16; PIXELS]; WAYS],
    counts: [u8; WAYS],
}

impl Default for Ways {
    fn default() -> Self {
        Self {
            members: [[0; PIXELS]; WAYS],
            counts: [0; WAYS],
        }
    }
}

impl Ways {
    #[inline(always)]
    fn add(&mut self, way: usize, member: u16) {
        let count = &mut self.counts[way];
        self.members[way][usize::from(*count)] = member;
        *count += 1;
    }

    #[inline(always)]
    fn of(&self, way: usize) -> &[u16] {
        &self.members[way][..usize::from(self.counts[way])]
    }
}

impl Tile {
    /// The tile at a place of the picture, of a size in pixels.
    pub fn new(origin: [u32; 2], size: [u32; 2]) -> Self {
        let mut places = Vec::with_capacity(PIXELS);
        let squares = |axis: usize| (0..size[axis]).step_by(SIDE as usize);
        for top in squares(1) {
            for left in squares(0) {
                for y in top..(top + SIDE).min(size[1]) {
                    places.extend((left..(left + SIDE).min(size[0])).map(|x| [x, y]));
                }
            }
        }
        Self { origin, size, places }
    }
}
