//! Camera rays of tiles, and the shortcut for tiles of background alone.

use super::*;
use super::{group::groups, vectors::Vectors};
use crate::{instructions, job::BackgroundKind, scene::Packet};
use std::ops::Range;

impl<T: Single> Integrator<'_, T> {
    /// Adds the paths of `samples` (first, count) of all pixels of tiles, with their camera rays. Paths of a pixel block
    /// are adjacent.
    pub fn add_paths<R: Recorder>(&self, tiles: &Tiles, samples: [u32; 2], paths: &mut Paths<R>) {
        let [first, count] = samples;
        paths.clear();
        for block in tiles.blocks() {
            for sample in first..first + count {
                paths.add(tiles.origin, block.places, sample);
            }
        }
        if R::KEEPS {
            paths.add_outputs();
        }
        vectorized!(T, {
            paths.set_counters(self.settings.seed);
            for group in groups(0..paths.count) {
                self.camera_rays(&group, paths);
            }
        });
    }

    /// Intersects camera rays tile by tile in packets of adjacent paths. A tile of background alone ends here, which is
    /// cheaper, because no path state is set up; `wave.traced` are the others. Surfaces with holes need a random number per
    /// hit instead (`intersect`).
    pub fn trace_camera_rays<R: Recorder>(&self, tiles: impl Iterator<Item = Range<usize>>, wave: &mut Wave<R>) {
        let Wave {
            paths,
            packets,
            intersections,
            results,
            traced,
            ..
        } = wave;
        traced.clear();
        if self.has_holes {
            traced.push(0..paths.count);
            return;
        }
        let is_short =
            !R::KEEPS && self.light_groups == 0 && !matches!(self.settings.background, BackgroundKind::Blurred(_));
        intersections.clear();
        for tile in tiles {
            packets.clear();
            packets.extend(tile.clone().step_by(PACKET).map(|first| {
                let mut packet = Packet {
                    origins: packet_axes(&paths.origin, first),
                    directions: packet_axes(&paths.state.direction, first),
                    t_max: [f32::MAX; PACKET],
                };
                packet.fill(PACKET.min(tile.end - first));
                packet
            }));
            self.geometry
                .intersect_packets(instructions::level(), packets, |found| intersections.extend(found));
            // None are found where none hits, and more than there are by the last packet.
            intersections.resize(tile.end, None);
            if is_short && intersections[tile.clone()].iter().all(Option::is_none) {
                self.shade_background(tile, paths, results);
            } else {
                traced.push(tile);
            }
        }
    }

    /// Results of paths whose camera rays all miss.
    fn shade_background<R: Recorder>(&self, paths_of: Range<usize>, paths: &Paths<R>, results: &mut Results) {
        vectorized!(T, {
            for group in groups::<T>(paths_of.clone()) {
                let uv = self.escaped_uv(group.vector(&paths.state.direction), 0);
                let (radiance, alpha) = self.plain_background(uv);
                let [added, clamped] = self.clamp_fireflies(radiance, 0);
                results.set(&group, added, alpha, clamped.luminance());
            }
        });
    }
}

/// A packet's vectors from index `first` on; the fields have room past the last path.
fn packet_axes(vectors: &Vectors, first: usize) -> [[f32; PACKET]; 3] {
    let mut axes = [[0.0; PACKET]; 3];
    for (axis, numbers) in axes.iter_mut().zip([&vectors.x, &vectors.y, &vectors.z]) {
        axis.copy_from_slice(&numbers[first..first + PACKET]);
    }
    axes
}
