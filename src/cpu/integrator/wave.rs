//! A sample of every pixel of a tile, the paths going on together: rays that go the same way are traced in packets.
//!
//! Which paths are together does not depend on how the work is shared out, so neither does the picture, to the last bit; each
//! finds what it would find alone, but for the rare rays that `scene::hierarchy::packet` tells of.

use fearless_simd::dispatch;

use super::light::LightRay;
use super::path::{AHEAD, Path, Ray};
use super::{BOUNCE_DIMENSIONS, FIRST_DIMENSION, Integrator, PathResult};
use crate::cpu::recorder::Unrecorded;
use crate::instructions;
use crate::job::tiles::TILE_SIDE;
use crate::optics::random::random_pairs_bits;
use crate::optics::real::Real;
use crate::optics::vector::Vec3;
use crate::scene::surface::SurfacePoint;
use crate::scene::{Hit, PACKET, Packet, WAYS, ray_way};

/// Pixels of a tile at most.
const PIXELS: usize = (TILE_SIDE * TILE_SIDE) as usize;
/// Side of the square of pixels whose camera rays make a packet.
const SIDE: u32 = 4;
const _: () = assert!((SIDE * SIDE) as usize == PACKET);
/// Fewer rays than this are traced one by one.
const RAYS_MIN: usize = 4;

/// A path on its way.
struct Traveller<'r, T> {
    /// The number of its pixel in the tile.
    pixel: usize,
    path: Path<'r, T, Unrecorded>,
    ray: Ray<T>,
    /// What its ray met, once that is known.
    hit: Option<Option<Hit>>,
    /// Where what it sees lies in the environment's map, once it is known to have left.
    place: [T; 2],
    /// The numbers that draw its light.
    numbers: Vec3<T>,
    light: Option<LightRay<T>>,
    goes_on: bool,
}

impl<T> Traveller<'_, T> {
    /// True where it is known that its ray met nothing.
    fn has_left(&self) -> bool {
        matches!(self.hit, Some(None))
    }
}

impl<T: Real> Integrator<'_, T> {
    /// What sample number `sample` of each pixel of the tile at `origin` finds, row by row.
    pub fn trace_tile(&self, origin: [u32; 2], size: [u32; 2], sample: u32) -> Vec<PathResult<T>> {
        let mut recorders = [const { Unrecorded }; PIXELS];
        let mut travellers: Vec<Traveller<'_, T>> = Vec::with_capacity(PIXELS);
        for (recorder, [x, y]) in recorders.iter_mut().zip(squares(size)) {
            let pixel = [origin[0] + x, origin[1] + y];
            travellers.push(Traveller {
                pixel: (y * size[0] + x) as usize,
                ray: Ray::default(),
                path: self.begin(pixel, sample, recorder),
                hit: None,
                place: [T::zero(); 2],
                numbers: Vec3::zero(),
                light: None,
                goes_on: true,
            });
        }
        let mut results = vec![PathResult::default(); travellers.len()];
        draw_ahead(&mut travellers, 0, FIRST_DIMENSION as usize);
        for traveller in &mut travellers {
            let place = traveller.pixel as u32;
            let pixel = [origin[0] + place % size[0], origin[1] + place / size[0]];
            traveller.ray = self.first_ray(pixel, &mut traveller.path);
        }
        if !self.has_holes {
            travellers.chunks_mut(PACKET).for_each(|group| self.first_hits(group));
        }
        for bounce in 0.. {
            self.trace(&mut travellers, bounce);
            travellers.retain_mut(|traveller| self.go(traveller, bounce, &mut results));
            self.arrive_all(&mut travellers, bounce);
            travellers.retain(|traveller| {
                if !traveller.goes_on {
                    results[traveller.pixel] = self.result(&traveller.path, T::one());
                }
                traveller.goes_on
            });
            if travellers.is_empty() {
                break;
            }
        }
        results
    }

    /// Traces the rays of all paths and asks for what they will look up; rays through surfaces with holes follow later.
    fn trace(&self, travellers: &mut [Traveller<'_, T>], bounce: u32) {
        for traveller in &mut *travellers {
            let Traveller { ray, path, hit, .. } = traveller;
            if ray.leaves {
                *hit = Some(None);
            } else if !self.has_holes && hit.is_none() {
                path.rays += 1;
                *hit = Some(
                    self.geometry
                        .intersect(ray.origin.to_f32(), ray.direction.to_f32(), f32::MAX),
                );
            }
            if let Some(Some(hit)) = hit {
                self.geometry.fetch(hit.triangle);
            }
        }
        for Traveller { ray, hit, place, .. } in &mut *travellers {
            if let Some(None) = hit {
                *place = self.left_place(ray, bounce);
                self.fetch_far(*place, !ray.is_mirror);
            }
        }
        if bounce >= self.settings.bounces {
            return;
        }
        draw_ahead(travellers, FIRST_DIMENSION + bounce * BOUNCE_DIMENSIONS, AHEAD);
        for traveller in &mut *travellers {
            if !traveller.has_left() {
                traveller.numbers = self.light_numbers(bounce, &mut traveller.path);
                self.fetch_light(traveller.numbers, false);
            }
        }
        for traveller in travellers.iter().filter(|traveller| !traveller.has_left()) {
            self.fetch_light(traveller.numbers, true);
        }
    }

    /// What the camera rays of a square of pixels meet.
    fn first_hits(&self, group: &mut [Traveller<'_, T>]) {
        let mut packet = Packet::default();
        for (lane, traveller) in group.iter().enumerate() {
            let Ray { origin, direction, .. } = &traveller.ray;
            packet.set(lane, origin.to_f32(), direction.to_f32(), f32::MAX);
        }
        packet.fill(group.len());
        let hits = self.geometry.intersect_packet(instructions::level(), &packet);
        for (traveller, hit) in group.iter_mut().zip(hits) {
            traveller.path.rays += 1;
            traveller.hit = Some(hit);
        }
    }

    /// The surface that stops a path's ray.
    #[inline(always)]
    fn stopped(&self, traveller: &mut Traveller<'_, T>, bounce: u32) -> Option<(SurfacePoint<T>, T)> {
        let Traveller { path, ray, hit, .. } = traveller;
        let Some(known) = hit.take() else {
            return self.stop(ray, bounce, path);
        };
        let hit = known?;
        let distance = T::from_f64(f64::from(hit.t));
        Some((self.met(&hit, ray, distance, bounce, path), distance))
    }

    /// A path's way to its next surface and what it does there, but for the light that arrives from elsewhere; false where
    /// there is nothing to be done any more.
    fn go(&self, traveller: &mut Traveller<'_, T>, bounce: u32, results: &mut [PathResult<T>]) -> bool {
        let has_place = traveller.hit.is_some();
        let Some((point, distance)) = self.stopped(traveller, bounce) else {
            let Traveller { path, ray, place, .. } = traveller;
            if !has_place {
                *place = self.left_place(ray, bounce);
            }
            results[traveller.pixel] = self.left(ray, *place, bounce, path);
            return false;
        };
        let Traveller { path, ray, numbers, .. } = traveller;
        if !self.pass_catcher(&point, ray, bounce, path) {
            results[traveller.pixel] = self.left(ray, self.left_place(ray, bounce), bounce, path);
            return false;
        }
        let material = &*self.material(&point, path);
        traveller.goes_on = self.meet(&point, material, distance, ray, bounce, path);
        if traveller.goes_on {
            traveller.light = self.aim(&point, material, *numbers, path);
            match self.scatter(&point, material, bounce, path) {
                Some(next) => *ray = next,
                None => traveller.goes_on = false,
            }
        }
        true
    }

    /// Has the light arrive that paths were aimed at, where it is visible.
    fn arrive_all(&self, travellers: &mut [Traveller<'_, T>], bounce: u32) {
        let mut visible = [T::one(); PIXELS];
        let mut ways = Ways::default();
        for (index, Traveller { light, path, .. }) in travellers.iter_mut().enumerate() {
            let Some(light) = light else { continue };
            if self.has_holes {
                visible[index] = self.visible(light, &mut path.rays);
            } else if !light.meets_nothing {
                path.rays += 1;
                ways.add(ray_way(light.drawn.direction.to_f32()), index);
            }
        }
        for way in 0..WAYS {
            for group in ways.of(way).chunks(PACKET) {
                self.look_together(travellers, group, &mut visible);
            }
        }
        for (Traveller { light, place, .. }, visible) in travellers.iter_mut().zip(visible) {
            if visible.to_f64() <= 0.0 {
                *light = None;
            } else if let Some(light) = light {
                *place = self.light_place(light);
                self.fetch_far(*place, false);
            }
        }
        for (Traveller { light, place, path, .. }, visible) in travellers.iter_mut().zip(visible) {
            if let Some(light) = light.take() {
                self.arrive(&light, (visible, *place), bounce, path, Vec3::zero);
            }
        }
    }

    /// Whether the lights of some paths are visible whose rays go the same way.
    fn look_together(&self, travellers: &[Traveller<'_, T>], group: &[u8], visible: &mut [T; PIXELS]) {
        let rays = group.iter().filter_map(|&index| {
            let light = travellers[usize::from(index)].light.as_ref()?;
            let distance = light.drawn.distance.to_f64() as f32;
            Some((light.origin.to_f32(), light.drawn.direction.to_f32(), distance))
        });
        let mut is_hidden = [false; PACKET];
        if group.len() < RAYS_MIN {
            for (is_hidden, (origin, direction, distance)) in is_hidden.iter_mut().zip(rays) {
                *is_hidden = self.geometry.occluded(origin, direction, distance);
            }
        } else {
            let mut packet = Packet::default();
            for (lane, (origin, direction, distance)) in rays.enumerate() {
                packet.set(lane, origin, direction, distance);
            }
            packet.fill(group.len());
            is_hidden = self.geometry.occluded_packet(instructions::level(), &packet);
        }
        for (&index, is_hidden) in group.iter().zip(is_hidden) {
            if is_hidden {
                visible[usize::from(index)] = T::zero();
            }
        }
    }
}

/// Paths whose numbers are drawn at once.
const DRAWN: usize = 16;

/// Draws so many pairs of numbers from this dimension on for the paths that have not left.
fn draw_ahead<T: Real>(travellers: &mut [Traveller<'_, T>], dimension: u32, count: usize) {
    let level = instructions::level();
    let mut staying = travellers.iter_mut().filter(|traveller| !traveller.has_left());
    loop {
        let mut group: [Option<&mut Traveller<'_, T>>; DRAWN] = std::array::from_fn(|_| staying.next());
        let Some(state) = group[0].as_ref().map(|traveller| traveller.path.state()) else {
            return;
        };
        let key = |traveller: &Option<&mut Traveller<'_, T>>| traveller.as_ref().map_or(0, |t| t.path.state().key);
        let keys = group.each_ref().map(key);
        let mut drawn = [[[0; DRAWN]; 2]; AHEAD];
        for (pair, dimension) in drawn.iter_mut().take(count).zip(dimension..) {
            *pair = dispatch!(level, _simd => random_pairs_bits(keys, state, dimension));
        }
        for (lane, traveller) in group.iter_mut().enumerate() {
            if let Some(traveller) = traveller {
                let pairs = drawn.map(|[a, b]| [a[lane], b[lane]]);
                traveller.path.set_ahead(dimension, count, pairs);
            }
        }
    }
}

/// The paths whose rays go each way, in their order.
struct Ways {
    members: [[u8; PIXELS]; WAYS],
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
    fn add(&mut self, way: usize, index: usize) {
        let count = &mut self.counts[way];
        self.members[way][usize::from(*count)] = index as u8;
        *count += 1;
    }

    #[inline(always)]
    fn of(&self, way: usize) -> &[u8] {
        &self.members[way][..usize::from(self.counts[way])]
    }
}

/// The places in a tile of this size, square by square.
fn squares(size: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    let corners = |size: u32| (0..size).step_by(SIDE as usize);
    let in_square = move |top: u32, left: u32| {
        let rows = top..(top + SIDE).min(size[1]);
        rows.flat_map(move |y| (left..(left + SIDE).min(size[0])).map(move |x| [x, y]))
    };
    corners(size[1]).flat_map(move |top| corners(size[0]).flat_map(move |left| in_square(top, left)))
}
