//! The camera rays of a tile, and tiles in which they meet nothing: most of many a picture, of which no path goes on.

use super::group::Groups;
use super::paths::Paths;
use super::wave::{NEAR, Tile};
use super::{Integrator, PathResult};
use crate::cpu::recorder::Recorder;
use crate::instructions;
use crate::job::BackgroundKind;
use crate::job::features::GuideSums;
use crate::optics::real::Real;
use crate::scene::{Hit, PACKET, Packet};

impl<T: Real> Integrator<'_, T> {
    /// Adds the paths of some samples of all pixels of a tile, with their camera rays: those of pixels near each other side by
    /// side.
    pub(super) fn add_paths<R: Recorder>(&self, tile: &Tile, samples: [u32; 2], paths: &mut Paths<T::Scalar, R>) {
        let [first, count] = samples;
        paths.clear();
        for near in tile.places.chunks(NEAR) {
            for sample in first..first + count {
                for [x, y] in near {
                    paths.add([tile.origin[0] + x, tile.origin[1] + y], sample);
                }
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

    /// What camera rays meet where no surface has holes, those side by side together.
    pub(super) fn trace_camera_rays<R: Recorder>(&self, paths: &Paths<T::Scalar, R>, hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        let count = paths.count();
        for first in (0..count).step_by(PACKET) {
            let together = PACKET.min(count - first);
            let mut packet = Packet::default();
            for lane in 0..together {
                let (origin, direction) = (paths.origin.get(first + lane), paths.state.direction.get(first + lane));
                packet.set(lane, origin.to_f32(), direction.to_f32(), f32::MAX);
            }
            packet.fill(together);
            let met = self.geometry.intersect_packet(instructions::level(), &packet);
            hits.extend_from_slice(&met[..together]);
        }
    }

    /// Whether what is seen behind everything takes no more than looking it up.
    pub(super) fn has_plain_background(&self) -> bool {
        !matches!(self.settings.background, BackgroundKind::Blurred(_))
    }

    /// What paths find whose camera rays meet nothing, by their places.
    pub(super) fn see_background<R: Recorder>(
        &self,
        paths: &Paths<T::Scalar, R>,
        found: &mut Vec<PathResult<T::Scalar>>,
    ) {
        found.clear();
        let count = paths.count();
        T::vectorize(
            #[inline(always)]
            || {
                for group in Groups::<T>::new(0..count) {
                    let place = self.left_places(group.vector(&paths.state.direction), 0);
                    let (radiance, alpha) = self.plain_background(place);
                    let [added, taken] = self.limited(radiance, 0);
                    let (radiances, alphas) = (added.to_each(), alpha.to_each());
                    let clamped = taken.luminance().to_each();
                    found.extend((0..T::LANES.min(count - found.len())).map(
                        #[inline(always)]
                        |lane| PathResult {
                            radiance: radiances.as_ref()[lane],
                            alpha: alphas.as_ref()[lane],
                            rays: 1,
                            clamped: clamped.as_ref()[lane],
                            seen: GuideSums::default(),
                        },
                    ));
                }
            },
        );
    }
}
