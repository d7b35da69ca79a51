//! The camera rays of a tile, and tiles in which they meet nothing: most of many a picture, of which no path goes on.

use super::Integrator;
use super::group::Groups;
use super::paths::{Paths, Vectors};
use super::results::Results;
use super::wave::Tile;
use crate::cpu::recorder::{Recorder, single};
use crate::instructions;
use crate::job::BackgroundKind;
use crate::optics::real::{Real, Scalar};
use crate::scene::{Hit, PACKET, Packet};

impl<T: Real> Integrator<'_, T> {
    /// Adds the paths of some samples of all pixels of a tile, with their camera rays: those of pixels near each other side by
    /// side.
    pub(super) fn add_paths<R: Recorder>(&self, tile: &Tile, samples: [u32; 2], paths: &mut Paths<T::Scalar, R>) {
        let [first, count] = samples;
        paths.clear();
        for near in tile.near() {
            for sample in first..first + count {
                paths.add(tile.origin, near.places, sample);
            }
        }
        T::vectorize(
            #[inline(always)]
            || {
                paths.set_counters(self.settings.seed);
                for group in Groups::new(0..paths.count()) {
                    self.first_rays(&group, paths);
                }
            },
        );
    }

    /// What camera rays meet where no surface has holes, those side by side together; nothing if none of them meets anything.
    pub(super) fn trace_camera_rays<R: Recorder>(
        &self,
        paths: &Paths<T::Scalar, R>,
        packets: &mut Vec<Packet>,
        hits: &mut Vec<Option<Hit>>,
    ) {
        let count = paths.count();
        packets.clear();
        for first in (0..count).step_by(PACKET) {
            let mut packet = Packet {
                origins: side_by_side(&paths.origin, first),
                directions: side_by_side(&paths.state.direction, first),
                t_max: [f32::MAX; PACKET],
            };
            packet.fill(PACKET.min(count - first));
            packets.push(packet);
        }
        hits.clear();
        self.geometry
            .intersect_packets(instructions::level(), packets, |met| hits.extend(met));
        hits.truncate(count);
    }

    /// Whether what is seen behind everything takes no more than looking it up.
    pub(super) fn has_plain_background(&self) -> bool {
        !matches!(self.settings.background, BackgroundKind::Blurred(_))
    }

    /// What paths find whose camera rays meet nothing.
    pub(super) fn see_background<R: Recorder>(&self, paths: &Paths<T::Scalar, R>, results: &mut Results<T::Scalar>) {
        let count = paths.count();
        T::vectorize(
            #[inline(always)]
            || {
                for group in Groups::<T>::new(0..count) {
                    let place = self.left_places(group.vector(&paths.state.direction), 0);
                    let (radiance, alpha) = self.plain_background(place);
                    let [added, taken] = self.limited(radiance, 0);
                    results.set(&group, added, alpha, taken.luminance());
                }
            },
        );
    }
}

/// As many vectors as a packet has, from one on: behind the last one there is room for them.
#[inline(always)]
fn side_by_side<S: Scalar>(vectors: &Vectors<S>, first: usize) -> [[f32; PACKET]; 3] {
    let mut axes = [[0.0; PACKET]; 3];
    for (axis, numbers) in axes.iter_mut().zip([&vectors.x, &vectors.y, &vectors.z]) {
        for (to, number) in axis.iter_mut().zip(&numbers[first..first + PACKET]) {
            *to = single(*number);
        }
    }
    axes
}
