//! The wavefront path tracer of tiles: several samples of all their pixels advance together, one bounce at a time.
//!
//! Rays of the same direction octant are traced in packets. Paths that hit the same material slot are shaded together in SIMD
//! lanes. Each bounce has five steps: intersect the rays, sort the hits by material, shade, trace shadow rays, add direct light.
//!
//! Invariant: a path's result is the same to the last bit in any lane, packet or wave. So the image does not depend on how the
//! work is divided.

use super::group::groups;
use super::*;
use crate::{
    cpu::recorder::Unrecorded,
    instructions,
    job::tiles::TILE_SIDE,
    optics::layer::material_layers,
    scene::{Hit, OCTANTS, Packet, ray_octant},
};
use std::ops::Range;

/// Pixels of a tile at most.
const PIXELS: usize = (TILE_SIDE * TILE_SIDE) as usize;
/// Samples per pixel of a wave at most.
pub const WAVE_SAMPLES: u32 = 16;
/// Paths of a wave at most: enough to fill packets and lanes, and few enough for the second cache.
pub const PATHS: usize = PIXELS * WAVE_SAMPLES as usize;
/// Pixels of a block, 2 × 2: four samples of each make one ray packet.
pub const BLOCK_PIXELS: usize = 4;
/// Fewer shadow rays than this are traced one by one.
const SHADOW_PACKET_MIN: usize = 4;
/// Fewer continuation rays than this are traced one by one. The bound is higher than that of shadow rays, because a packet that
/// needs the closest hits visits more of the hierarchy.
const PACKET_MIN: usize = 8;

/// Neighbouring tiles of a row of the image; any but the last are [`TILE_SIDE`] pixels wide.
pub struct Tiles {
    pub origin: [u32; 2],
    /// Their pixels from the corner on, tile by tile, each in Morton order, so that the pixels of a block are consecutive.
    places: Vec<[u32; 2]>,
    /// Numbers of the pixels up to the end of each.
    ends: Vec<usize>,
}

/// The buffers of a wavefront, reused from tile to tile. A `u16` is the index of a path in the fields of [`Paths`].
pub struct Wave<R = Unrecorded> {
    pub paths: Paths<R>,
    /// The paths of tiles that are not background alone.
    pub(super) traced: Vec<Range<usize>>,
    /// Paths that have not ended.
    active: Vec<u16>,
    /// Paths whose rays hit a surface, with the material slot as sort key.
    hits: Vec<(u32, u16)>,
    /// Paths whose rays left the scene.
    escaped: Vec<u16>,
    /// The order of shading: `hits` sorted by slot, then `escaped`.
    order: Vec<u16>,
    /// The packets of a tile's camera rays.
    pub(super) packets: Vec<Packet>,
    /// Per path the closest hit of its ray; unused if surfaces have holes.
    pub(super) intersections: Vec<Option<Hit>>,
    /// Rays to trace, binned by octant.
    octants: OctantBins,
    /// Paths whose shadow ray is not blocked.
    unoccluded: Vec<u16>,
    pub(super) results: Results,
}

impl<R: Recorder> Wave<R> {
    /// Buffers for so many paths in groups of `lanes`, a packet's at least; the paths draw from `sequence`.
    pub fn new(paths: usize, lanes: usize, sequence: Sequence) -> Self {
        let lanes = lanes.max(PACKET);
        Self {
            paths: Paths::new(paths, lanes, sequence),
            traced: Vec::new(),
            active: Vec::with_capacity(paths),
            hits: Vec::with_capacity(paths),
            escaped: Vec::with_capacity(paths),
            order: Vec::with_capacity(paths),
            packets: Vec::with_capacity(paths / PACKET),
            intersections: Vec::with_capacity(paths),
            octants: OctantBins::default(),
            unoccluded: Vec::with_capacity(paths),
            results: Results::new(paths + lanes),
        }
    }

    /// Indices of the paths that hit a surface, after [`Integrator::sort_hits`].
    fn hit_range(&self) -> Range<usize> {
        0..self.hits.len()
    }
}

impl<T: Single> Integrator<'_, T> {
    /// Renders `count` samples per pixel of tiles, from sample `first` on. Calls `report` once per wave with that wave's first
    /// sample, its number of samples per pixel, and their results.
    pub fn trace_tiles(
        &self,
        tiles: &Tiles,
        wave: &mut Wave,
        [first, count]: [u32; 2],
        mut report: impl FnMut([u32; 2], &Results),
    ) {
        for from in (first..first + count).step_by(WAVE_SAMPLES as usize) {
            let samples = [from, WAVE_SAMPLES.min(first + count - from)];
            self.trace_wave(tiles, samples, wave);
            for path in wave.traced.iter().cloned().flatten() {
                wave.results.put(path, self.result(&wave.paths, path));
            }
            wave.paths.finish_groups();
            wave.results.light_groups.clone_from(&wave.paths.light_groups);
            wave.results.cut = wave.paths.cut;
            report(samples, &wave.results);
        }
    }

    /// Traces the paths of `samples` (first, count) to their ends. The results of tiles whose camera rays all miss are then
    /// complete; the others are those of `wave.traced`.
    pub fn trace_wave<R: Recorder>(&self, tiles: &Tiles, samples: [u32; 2], wave: &mut Wave<R>) {
        // One path per pixel and sample, with its camera ray.
        self.add_paths(tiles, samples, &mut wave.paths);
        let has_extras = self.firefly_clamp.is_some() || samples[0] < self.guide_samples;
        wave.results.start(wave.paths.count, has_extras);
        self.trace_camera_rays(tiles.paths(samples[1]), wave);
        wave.active.clear();
        wave.active
            .extend(wave.traced.iter().cloned().flatten().map(|path| path as u16));
        if wave.active.is_empty() {
            return;
        }
        self.start(&mut wave.paths);
        for bounce in 0.. {
            // 1. Continuation rays; those of the camera have been traced above.
            if bounce > 0 && !self.has_holes {
                self.trace_rays(wave);
            }
            // 2. Sort by material, so that the lanes of a group shade the same one.
            self.sort_hits(bounce, wave);
            // 3. Emission, a shadow ray per path (next-event estimation), and the next direction.
            self.shade(bounce, wave);
            // 4. and 5. Shadow rays are traced only now, all of the wave together, because packets need many rays. Their light
            // is added last, where they arrive.
            self.trace_shadow_rays(wave);
            self.shade_direct_light(bounce, wave);
            // Paths that ended leave the wave. The others keep their order, which is nearly sorted for the next bounce.
            let Wave {
                active, paths, order, ..
            } = wave;
            active.clear();
            active.extend((0..order.len() as u16).filter(|&index| paths.is_active[usize::from(index)]));
            if active.is_empty() {
                break;
            }
        }
    }

    /// Intersects the continuation rays of the active paths, in packets by octant. For scenes without holes.
    fn trace_rays<R: Recorder>(&self, wave: &mut Wave<R>) {
        let Wave {
            paths,
            active,
            octants,
            intersections,
            ..
        } = wave;
        // Rays that are known to miss, as those that leave a convex body, need no traversal.
        octants.clear();
        for &index in &*active {
            let index = usize::from(index);
            if !paths.is_known_miss[index] {
                octants.add(ray_octant(paths.state.direction.get(index).to_f32()), index);
            }
        }
        let ray = |index: &u16| {
            let index = usize::from(*index);
            let (origin, direction) = (paths.origin.get(index), paths.state.direction.get(index));
            (origin.to_f32(), direction.to_f32(), f32::MAX)
        };
        for group in octants.groups() {
            let mut found = [None; PACKET];
            if group.len() < PACKET_MIN {
                for (found, (origin, direction, t_max)) in found.iter_mut().zip(group.iter().map(ray)) {
                    *found = self.geometry.intersect(origin, direction, t_max);
                }
            } else {
                let packet = Packet::of(group.iter().map(ray));
                found = self.geometry.intersect_packet(instructions::level(), &packet);
            }
            for (&index, hit) in group.iter().zip(found) {
                intersections[usize::from(index)] = hit;
            }
        }
    }

    /// Splits the active paths into hits, sorted by material slot, and escaped ones, and puts the paths' state in that order.
    /// Traces the rays first if surfaces have holes.
    fn sort_hits<R: Recorder>(&self, bounce: u32, wave: &mut Wave<R>) {
        let Wave {
            paths,
            active,
            hits,
            escaped,
            order,
            intersections,
            ..
        } = wave;
        hits.clear();
        escaped.clear();
        for &member in &*active {
            let index = usize::from(member);
            let is_hit = if self.has_holes {
                self.intersect(bounce, index, paths)
            } else {
                !paths.is_known_miss[index] && paths.record_hit(index, intersections[index])
            };
            if is_hit {
                // Shading waits for these vertices otherwise: the sort hides the latency.
                let triangle = paths.state.hits[index].triangle;
                self.geometry.prefetch(triangle);
                hits.push((self.geometry.slot(triangle as usize), member));
            } else {
                escaped.push(member);
            }
        }
        hits.sort_unstable();
        order.clear();
        order.extend(hits.iter().map(|(_, member)| *member).chain(escaped.iter().copied()));
        paths.reorder(order);
    }

    /// Ends escaped paths with the environment's light, and shades the hits slot by slot.
    fn shade<R: Recorder>(&self, bounce: u32, wave: &mut Wave<R>) {
        let (hits, escaped) = (wave.hit_range(), wave.hits.len()..wave.order.len());
        let paths = &mut wave.paths;
        paths.shadow_rays.is_pending[hits.clone()].fill(false);
        // A recorded path draws them later (`shade_group`), so that its events are in order.
        let samples_light = !R::KEEPS && self.samples_light() && bounce < self.settings.bounces;
        // Look-ups into the environment miss the cache. So each group's addresses are computed and prefetched in one pass and
        // read in a later one; the numbers of light sampling are drawn in between.
        vectorized!(T, {
            for group in groups(escaped.clone()) {
                self.locate_escaped(&group, bounce, paths);
            }
            if samples_light {
                for group in groups(hits.clone()) {
                    self.light_xi(&group, bounce, paths);
                }
            }
            for group in groups::<T>(escaped.clone()) {
                let [u, v] = &paths.environment_uv;
                let uv = [group.number(u), group.number(v)];
                out_of_line!(T, self.escape(&PathVertex::new(group, bounce, paths), uv, paths));
            }
            if samples_light && self.samples_environment {
                for group in groups(hits.clone()) {
                    self.prefetch_lights(&group, paths);
                }
            }
        });
        // Groups must not span slots: a group's material is uniform over its lanes.
        let mut first = 0;
        for same in wave.hits.chunk_by(|(a, _), (b, _)| a == b) {
            let indices = first..first + same.len();
            first = indices.end;
            self.shade_slot(same[0].0, indices, bounce, paths);
        }
    }

    /// Shades hits of one slot, but for direct light.
    fn shade_slot<R: Recorder>(&self, slot: u32, indices: Range<usize>, bounce: u32, paths: &mut Paths<R>) {
        vectorized!(T, {
            for group in groups(indices.clone()) {
                self.shade_group(slot, group, bounce, paths);
            }
        });
    }

    #[inline(always)]
    fn shade_group<R: Recorder>(&self, slot: u32, group: Group<T>, bounce: u32, paths: &mut Paths<R>) {
        let mut vertex = PathVertex::new(group, bounce, paths);
        let point = out_of_line!(T, self.surfaces(&vertex, slot, paths));
        // The shadow catcher is not there from below or without light: those camera rays escape to the background.
        let [is_visible, is_mirrored] = self.apply_catcher(&point, &mut vertex, paths);
        let is_passed = vertex.active & !is_visible;
        if is_passed.any() {
            let ray = PathVertex {
                active: is_passed,
                ..vertex
            };
            out_of_line!(T, self.escape(&ray, self.escaped_uv(ray.direction, ray.bounce), paths));
        }
        // Lanes that the catcher mirrors shade with another material: two passes, usually one of them empty.
        let passes = [(is_visible & !is_mirrored, false), (is_visible & is_mirrored, true)];
        for (active, is_catcher_mirror) in passes {
            if !active.any() {
                continue;
            }
            let mut vertex = PathVertex {
                active,
                is_catcher_mirror,
                ..vertex
            };
            let material = &*self.material(&point, &vertex);
            let layers = &material_layers(material, self.tables, &point.surface);
            if self.shade_hit(&point, material, layers, &mut vertex, paths) {
                // A mirror of the catcher reflects in one direction, which light sampling cannot hit.
                if self.samples_light() && !is_catcher_mirror {
                    if R::KEEPS {
                        self.light_xi(&group, bounce, paths);
                    }
                    out_of_line!(T, self.sample_direct_light(&point, material, layers, &vertex, paths));
                }
                out_of_line!(T, self.scatter(&point, material, layers, &vertex, paths));
            }
        }
    }

    /// Traces the pending shadow rays and clears the visibility of those that are blocked.
    fn trace_shadow_rays<R: Recorder>(&self, wave: &mut Wave<R>) {
        let hits = wave.hit_range();
        let Wave { paths, octants, .. } = wave;
        octants.clear();
        for index in hits {
            if !paths.shadow_rays.is_pending[index] || paths.shadow_rays.is_known_miss[index] {
                continue;
            }
            let rays = &mut paths.outputs[usize::from(paths.state.ids[index])].rays;
            if self.has_holes {
                paths.shadow_rays.visibility[index] = self.transmittance(&paths.shadow_rays, index, rays);
            } else {
                *rays += 1;
                octants.add(ray_octant(paths.shadow_rays.direction.get(index).to_f32()), index);
            }
        }
        for group in octants.groups() {
            self.trace_shadow_packet(group, paths);
        }
    }

    /// Traces shadow rays of one octant, at most a packet.
    fn trace_shadow_packet<R: Recorder>(&self, indices: &[u16], paths: &mut Paths<R>) {
        let shadow_rays = &mut paths.shadow_rays;
        let ray = |index: usize| {
            (
                shadow_rays.origin.get(index).to_f32(),
                shadow_rays.direction.get(index).to_f32(),
                shadow_rays.distance[index],
            )
        };
        let rays = indices.iter().map(|&index| ray(usize::from(index)));
        let mut is_occluded = [false; PACKET];
        if indices.len() < SHADOW_PACKET_MIN {
            for (is_occluded, (origin, direction, distance)) in is_occluded.iter_mut().zip(rays) {
                *is_occluded = self.geometry.occluded(origin, direction, distance);
            }
        } else {
            is_occluded = self.geometry.occluded_packet(instructions::level(), &Packet::of(rays));
        }
        for (&index, is_occluded) in indices.iter().zip(is_occluded) {
            if is_occluded {
                shadow_rays.visibility[usize::from(index)] = 0.0;
            }
        }
    }

    /// Adds the light of the shadow rays that are not blocked.
    fn shade_direct_light<R: Recorder>(&self, bounce: u32, wave: &mut Wave<R>) {
        let hits = wave.hit_range();
        let Wave { paths, unoccluded, .. } = wave;
        let shadow_rays = &paths.shadow_rays;
        let is_unoccluded = |index: &u16| {
            let index = usize::from(*index);
            shadow_rays.is_pending[index] && shadow_rays.visibility[index] > 0.0
        };
        // Compacted, so that no lane evaluates the environment in vain.
        unoccluded.clear();
        unoccluded.extend((0..hits.len() as u16).filter(is_unoccluded));
        paths.gather_unoccluded(unoccluded, self.samples_emitters);
        vectorized!(T, {
            for group in groups(0..unoccluded.len()) {
                self.locate_unoccluded(&group, paths);
            }
            for group in groups(0..unoccluded.len()) {
                self.add_direct_light(&group, bounce, paths);
            }
        });
    }
}

/// Path indices binned by the octant of their rays, in the order in which they were added.
struct OctantBins {
    indices: [[u16; PATHS]; OCTANTS],
    counts: [u16; OCTANTS],
}

impl Default for OctantBins {
    fn default() -> Self {
        Self {
            indices: [[0; PATHS]; OCTANTS],
            counts: [0; OCTANTS],
        }
    }
}

impl OctantBins {
    fn clear(&mut self) {
        self.counts = [0; OCTANTS];
    }

    fn add(&mut self, octant: usize, index: usize) {
        let count = &mut self.counts[octant];
        self.indices[octant][usize::from(*count)] = index as u16;
        *count += 1;
    }

    /// Runs of at most [`PACKET`] indices, each of one octant.
    fn groups(&self) -> impl Iterator<Item = &[u16]> {
        let of_octant = self.indices.iter().zip(self.counts);
        of_octant.flat_map(|(indices, count)| indices[..usize::from(count)].chunks(PACKET))
    }
}

impl Tiles {
    /// Tiles from their top left pixel and their size together, both in pixels.
    pub fn new(origin: [u32; 2], [width, height]: [u32; 2]) -> Self {
        // Morton order: a block of 2 × 2 pixels, then the next three blocks of a square, and so on.
        let every_second = |bits: u32| (bits & 1) | (bits >> 1 & 2) | (bits >> 2 & 4);
        let (mut places, mut ends) = (Vec::new(), Vec::new());
        for left in (0..width).step_by(TILE_SIDE as usize) {
            let in_tile = (0..PIXELS as u32).map(|place| [left + every_second(place), every_second(place >> 1)]);
            places.extend(in_tile.filter(|[x, y]| *x < width && *y < height));
            ends.push(places.len());
        }
        Self { origin, places, ends }
    }

    /// The paths of each tile in a wave of `count` samples per pixel.
    pub fn paths(&self, count: u32) -> impl Iterator<Item = Range<usize>> {
        let firsts = std::iter::once(&0).chain(&self.ends);
        std::iter::zip(firsts, &self.ends).map(move |(first, end)| first * count as usize..end * count as usize)
    }

    /// Their pixels in blocks of up to [`BLOCK_PIXELS`].
    pub fn blocks(&self) -> impl Iterator<Item = PixelBlock<'_>> {
        let firsts = (0..).step_by(BLOCK_PIXELS);
        let blocks = self.places.chunks(BLOCK_PIXELS).zip(firsts);
        blocks.map(|(places, first)| PixelBlock { places, first })
    }
}

/// Neighbouring pixels of a tile; the paths of one sample of them have consecutive ids.
#[derive(Clone, Copy)]
pub struct PixelBlock<'a> {
    /// From the tiles' corner on, in pixels.
    pub places: &'a [[u32; 2]],
    /// Index of the first pixel in the tiles' order.
    first: usize,
}

impl PixelBlock<'_> {
    /// The id in the wave of the first pixel's path for a sample out of `count` per pixel; the other pixels' follow.
    pub fn path(&self, [sample, count]: [u32; 2]) -> usize {
        self.first * count as usize + sample as usize * self.places.len()
    }
}
