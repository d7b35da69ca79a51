//! Camera rays of a tile, and the shortcut for tiles of background alone.

use super::*;
use super::{group::groups, vectors::Vectors};
use crate::{instructions, scene::Hit, scene::Packet};

impl<T: Single> Integrator<'_, T> {
    /// Adds the paths of `samples` (first, count) of all pixels of a tile, with their camera rays. Paths of a pixel block
    /// are adjacent.
    pub fn add_paths<R: Recorder>(&self, tile: &Tile, samples: [u32; 2], paths: &mut Paths<R>) {
        let [first, count] = samples;
        paths.clear();
        for block in tile.blocks() {
            for sample in first..first + count {
                paths.add(tile.origin, block.places, sample);
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

    /// Intersects camera rays in packets of adjacent paths, for scenes without holes. `hits` is left empty if none hits.
    pub fn trace_camera_rays<R: Recorder>(
        &self,
        paths: &Paths<R>,
        packets: &mut Vec<Packet>,
        hits: &mut Vec<Option<Hit>>,
    ) {
        let count = paths.count;
        packets.clear();
        for first in (0..count).step_by(PACKET) {
            let mut packet = Packet {
                origins: packet_axes(&paths.origin, first),
                directions: packet_axes(&paths.state.direction, first),
                t_max: [f32::MAX; PACKET],
            };
            packet.fill(PACKET.min(count - first));
            packets.push(packet);
        }
        hits.clear();
        self.geometry
            .intersect_packets(instructions::level(), packets, |found| hits.extend(found));
        hits.truncate(count);
    }

    /// Results of paths whose camera rays all miss.
    pub fn shade_background<R: Recorder>(&self, paths: &Paths<R>, results: &mut Results) {
        let count = paths.count;
        vectorized!(T, {
            for group in groups::<T>(0..count) {
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
