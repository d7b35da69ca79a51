//! The shadow catcher: a ground of which the camera sees shadows and reflections alone. Twin of the functions of that name
//! in `shaders/pass/path_trace.wgsl`.
//!
//! Seen by the camera it is the background, a share of it mirrored as in varnish, the rest times what light reaches the
//! place over what would reach it were nothing there. Both are the background itself where nothing stands in the way.
//! Over a transparent background the shadow's light is taken from 1, which is its alpha.

use super::paths::Paths;
use super::{Arrival, Integrator, PathResult};
use crate::cpu::recorder::{Event, Purpose, Recorder, Source};
use crate::job::Catcher;
use crate::optics::real::{Mask, Real, Scalar};
use crate::optics::vector::Vec3;
use crate::scene::catcher::{catcher_light, catcher_reflectance};
use crate::scene::surface::SurfacePoint;

/// Pairs of numbers for what a shadow catcher does with a camera ray, and for the blur of the background below it: beyond
/// those of every path.
pub const CATCHER_DIMENSION: u32 = 12288;

/// What a shadow catcher makes of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Caught<S> {
    /// It has met none.
    #[default]
    Not,
    /// The light that arrives tells how much of the background is seen.
    Shadow {
        /// The background is transparent.
        is_transparent: bool,
    },
    /// It is mirrored: where it then meets nothing it shows the background with its alpha.
    Mirrored {
        /// Linear RGB.
        background: Vec3<S>,
        /// See [`PathResult`].
        alpha: S,
    },
}

/// What a shadow catcher does with the paths of a group.
#[derive(Clone, Copy)]
pub(super) struct Passed<T: Real> {
    /// Where there is a surface: elsewhere the background is shown as it is.
    pub is_there: T::Mask,
    /// Where it mirrors the path.
    pub is_mirrored: T::Mask,
}

impl<T: Real> Integrator<'_, T> {
    /// What a shadow catcher has to do with paths that met a surface.
    #[inline(always)]
    pub(super) fn pass_catcher<R: Recorder>(
        &self,
        point: &SurfacePoint<T>,
        arrival: &mut Arrival<T>,
        paths: &mut Paths<T::Scalar, R>,
    ) -> Passed<T> {
        let nothing = T::Mask::splat(false);
        let mut passed = Passed {
            is_there: arrival.on,
            is_mirrored: nothing,
        };
        let Some(catcher) = self.settings.catcher else {
            return passed;
        };
        if arrival.bounce > 0 {
            arrival.members.for_each(&mut paths.caught, arrival.on, |caught, _| {
                if caught.is_mirrored() {
                    *caught = Caught::Not;
                }
            });
        } else if catcher.slot == point.slot {
            passed = T::out_of_line(
                #[inline(always)]
                || self.catch(catcher, point, arrival, paths),
            );
        }
        passed
    }

    /// Begins paths anew at the shadow catcher. It is not there where it is seen from below, or gets no light.
    #[inline(always)]
    fn catch<R: Recorder>(
        &self,
        catcher: Catcher,
        point: &SurfacePoint<T>,
        arrival: &mut Arrival<T>,
        paths: &mut Paths<T::Scalar, R>,
    ) -> Passed<T> {
        let (zero, one) = (T::zero(), T::one());
        let (group, members) = (arrival.group, arrival.members);
        let positions = point.position.to_each();
        let light = Vec3::from_lanes(|lane| catcher_light(self.tables, catcher.table, positions.as_ref()[lane]));
        let is_there = arrival.on & arrival.direction.y.less(zero) & zero.less(light.max_component());
        let place = self.left_places(arrival.direction, 0);
        let (background, alpha) =
            self.camera_background(&group, arrival.direction, place, CATCHER_DIMENSION + 1, paths);
        let [choice, _] = group.pairs(paths, CATCHER_DIMENSION, [Purpose::Catcher, Purpose::Unused]);
        let share = catcher_reflectance(self.tables, catcher.table, -arrival.direction.y);
        let is_mirrored = is_there & choice.less(share);
        let is_transparent = !zero.less(alpha);
        let white = Vec3::splat(one);
        let shown = Vec3::select(is_transparent, white, background);
        let albedo = self.materials[catcher.slot as usize].base_color;
        let lit = |light: T| T::select(zero.less(light), one, zero);
        let is_lit = Vec3 {
            x: lit(light.x),
            y: lit(light.y),
            z: lit(light.z),
        };
        let reflected = light * albedo + (white - is_lit);
        let kept = Vec3 {
            x: one / reflected.x,
            y: one / reflected.y,
            z: one / reflected.z,
        };
        arrival.throughput = Vec3::select(is_mirrored, arrival.throughput, shown * is_lit * kept);
        let (backgrounds, alphas) = (background.to_each(), alpha.to_each());
        let (mirrors, gaps) = (is_mirrored.to_bits(), is_transparent.to_bits());
        members.for_each(&mut paths.caught, is_there, |caught, lane| {
            *caught = if mirrors >> lane & 1 == 1 {
                Caught::Mirrored {
                    background: backgrounds.as_ref()[lane],
                    alpha: alphas.as_ref()[lane],
                }
            } else {
                Caught::Shadow {
                    is_transparent: gaps >> lane & 1 == 1,
                }
            };
        });
        let throughput = arrival.throughput;
        members.record(&mut paths.found, is_there, |lane| Event::Caught {
            is_mirrored: mirrors >> lane & 1 == 1,
            background: shown.to_each().as_ref()[lane].to_f32(),
            light: light.to_each().as_ref()[lane].to_f32(),
            throughput: throughput.to_each().as_ref()[lane].to_f32(),
        });
        // A colour of which no light would reach the place has no shadow.
        let unshadowed = shown * (white - is_lit);
        self.add(
            &members,
            is_there & !is_mirrored,
            Source::Background,
            unshadowed,
            0,
            &mut paths.found,
        );
        Passed { is_there, is_mirrored }
    }
}

impl<S: Scalar> Caught<S> {
    /// Whether the path's last surface was a shadow catcher that mirrors it.
    #[inline(always)]
    pub(super) fn is_mirrored(&self) -> bool {
        matches!(self, Self::Mirrored { .. })
    }

    /// What the path found, which over a transparent background is a shadow's alpha. A part of the light alone casts none.
    pub(super) fn result(self, found: PathResult<S>, is_all_light: bool) -> PathResult<S> {
        match self {
            Self::Shadow { is_transparent: true } => PathResult {
                alpha: match is_all_light {
                    true => S::one() - found.radiance.luminance(),
                    false => S::zero(),
                },
                radiance: Vec3::zero(),
                ..found
            },
            _ => found,
        }
    }
}
