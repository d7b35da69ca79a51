//! The shadow catcher: a ground of which the camera sees shadows and reflections alone. Twin of the functions of that name
//! in `shaders/pass/path_trace.wgsl`.
//!
//! Seen by the camera it is the background, a share of it mirrored as in varnish, the rest times what light reaches the
//! place over what would reach it were nothing there. Both are the background itself where nothing stands in the way.
//! Over a transparent background the shadow's light is taken from 1, which is its alpha.

use super::path::{Path, Ray};
use super::{Integrator, PathResult};
use crate::cpu::recorder::{Event, Purpose, Recorder, Source};
use crate::job::Catcher;
use crate::optics::real::{Mask, Real};
use crate::optics::vector::Vec3;
use crate::scene::catcher::{catcher_light, catcher_reflectance};
use crate::scene::surface::SurfacePoint;

/// Pairs of numbers for what a shadow catcher does with a camera ray, and for the blur of the background below it: beyond
/// those of every path.
pub const CATCHER_DIMENSION: u32 = 12288;

/// What a shadow catcher makes of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Caught<T> {
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
        background: Vec3<T>,
        /// See [`PathResult`].
        alpha: T,
    },
}

impl<T: Real> Integrator<'_, T> {
    /// What a shadow catcher has to do with a path that met a surface; false where it shows the background as it is.
    #[inline(always)]
    pub(super) fn pass_catcher<R: Recorder>(
        &self,
        point: &SurfacePoint<T>,
        ray: &Ray<T>,
        bounce: u32,
        path: &mut Path<'_, T, R>,
    ) -> bool {
        if path.caught.is_mirrored() {
            path.caught = Caught::Not;
        }
        let here = |catcher: &Catcher| bounce == 0 && catcher.slot == point.slot;
        match self.settings.catcher.filter(here) {
            Some(catcher) => self.catch(catcher, point, ray, path),
            None => true,
        }
    }

    /// Begins the path anew at the shadow catcher; false where it is not there: seen from below, or without light.
    fn catch<R: Recorder>(
        &self,
        catcher: Catcher,
        point: &SurfacePoint<T>,
        ray: &Ray<T>,
        path: &mut Path<'_, T, R>,
    ) -> bool {
        let light = catcher_light(self.tables, catcher.table, point.position);
        if ray.direction.y.to_f64() >= 0.0 || light.max_component().to_f64() <= 0.0 {
            return false;
        }
        let place = self.left_place(ray, 0);
        let (background, alpha) = self.camera_background(ray.direction, place, CATCHER_DIMENSION + 1, path);
        let [choice, _] = path.pair(CATCHER_DIMENSION, [Purpose::Catcher, Purpose::Unused]);
        let share = catcher_reflectance(self.tables, catcher.table, -ray.direction.y);
        let is_mirrored = choice.less(share).any();
        let is_transparent = alpha.to_f64() <= 0.0;
        let shown = if is_transparent {
            Vec3::splat(T::one())
        } else {
            background
        };
        let albedo = self.materials[catcher.slot as usize].base_color;
        let is_lit = light.map(|light| T::select(T::zero().less(light), T::one(), T::zero()));
        if is_mirrored {
            path.caught = Caught::Mirrored { background, alpha };
        } else {
            path.caught = Caught::Shadow { is_transparent };
            let reflected = light * albedo + (Vec3::splat(T::one()) - is_lit);
            path.throughput = shown * is_lit * reflected.map(|reflected| T::one() / reflected);
        }
        let throughput = path.throughput.to_f32();
        path.record(|| Event::Caught {
            is_mirrored,
            background: shown.to_f32(),
            light: light.to_f32(),
            throughput,
        });
        if is_mirrored {
            return true;
        }
        // A colour of which no light would reach the place has no shadow.
        self.add(Source::Background, shown * (Vec3::splat(T::one()) - is_lit), 0, path);
        true
    }
}

impl<T: Real> Caught<T> {
    /// Whether the path's last surface was a shadow catcher that mirrors it.
    #[inline(always)]
    pub(super) fn is_mirrored(self) -> bool {
        matches!(self, Self::Mirrored { .. })
    }

    /// What the path found, which over a transparent background is a shadow's alpha. A part of the light alone casts none.
    pub(super) fn result(self, found: PathResult<T>, is_all_light: bool) -> PathResult<T> {
        match self {
            Self::Shadow { is_transparent: true } => PathResult {
                alpha: match is_all_light {
                    true => T::one() - found.radiance.luminance(),
                    false => T::zero(),
                },
                radiance: Vec3::zero(),
                ..found
            },
            _ => found,
        }
    }
}
