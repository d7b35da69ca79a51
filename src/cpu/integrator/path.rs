//! A path under way: its sums, and its random numbers as they are drawn.

use super::PathResult;
use super::catcher::Caught;
use super::light::LightRay;
use crate::cpu::recorder::{Event, Recorder};
use crate::job::features::GuideSums;
use crate::optics::random::RandomState;
use crate::optics::real::Scalar;
use crate::optics::vector::Vec3;
use crate::scene::Hit;

/// A path under way.
pub(super) struct Path<S: Scalar, R> {
    /// The counters from which it draws its numbers.
    pub state: RandomState,
    /// Its pixel.
    pub pixel: [u32; 2],
    /// What light from the ray's other end is multiplied by.
    pub throughput: Vec3<S>,
    /// What it has found.
    pub radiance: Vec3<S>,
    /// Luminance that limiting fireflies took.
    pub clamped: S,
    /// Rays traced.
    pub rays: u32,
    /// What is seen first.
    pub seen: GuideSums,
    /// What a shadow catcher has made of it.
    pub caught: Caught<S>,
    /// True while the path is one of those that tell what they see, and has met nothing but mirrors and clear glass.
    pub is_looking: bool,
    /// Where it goes.
    pub ray: Ray<S>,
    /// What its ray met, and how far from the ray's origin.
    pub hit: Hit,
    /// See `hit`: longer where the ray went through surfaces before.
    pub distance: S,
    /// Where it looks at the environment's map.
    pub place: [S; 2],
    /// The numbers that draw its light.
    pub light_numbers: Vec3<S>,
    /// The row of the environment's cells that they draw.
    pub light_row: u32,
    /// The light that it is aimed at.
    pub light: Option<LightRay<S>>,
    /// True until it has come to its end.
    pub goes_on: bool,
    /// 1 where it met something that is not transparent background.
    pub alpha: S,
    recorder: R,
}

/// A ray of a path, and how its direction was drawn.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ray<S> {
    pub origin: Vec3<S>,
    /// Unit vector.
    pub direction: Vec3<S>,
    /// The density of the direction, for what competes with light sampling.
    pub lobe_density: S,
    /// True where light sampling could not have drawn the direction.
    pub is_mirror: bool,
    /// True where it is proven that nothing lies ahead.
    pub leaves: bool,
}

impl<S: Scalar> Ray<S> {
    /// A camera's ray.
    #[inline(always)]
    pub fn of_camera(origin: Vec3<S>, direction: Vec3<S>) -> Self {
        Self {
            origin,
            direction,
            lobe_density: S::zero(),
            is_mirror: true,
            leaves: false,
        }
    }
}

impl<S: Scalar, R: Recorder> Path<S, R> {
    pub fn new(state: RandomState, pixel: [u32; 2], is_looking: bool, recorder: R) -> Self {
        Self {
            state,
            pixel,
            throughput: Vec3::splat(S::one()),
            radiance: Vec3::zero(),
            clamped: S::zero(),
            rays: 0,
            seen: GuideSums::default(),
            caught: Caught::Not,
            is_looking,
            ray: Ray::default(),
            hit: Hit::default(),
            distance: S::zero(),
            place: [S::zero(); 2],
            light_numbers: Vec3::zero(),
            light_row: 0,
            light: None,
            goes_on: true,
            alpha: S::one(),
            recorder,
        }
    }

    /// Takes what its ray was found to meet; false where that is nothing.
    #[inline(always)]
    pub fn take(&mut self, hit: Option<Hit>) -> bool {
        self.rays += 1;
        if let Some(hit) = hit {
            self.hit = hit;
            self.distance = S::from_f64(f64::from(hit.t));
        }
        hit.is_some()
    }

    /// Tells of an event.
    #[inline(always)]
    pub fn record(&mut self, event: impl FnOnce() -> Event) {
        self.recorder.record(event);
    }

    /// The light that it is aimed at: there must be one.
    #[inline(always)]
    pub fn light(&self) -> &LightRay<S> {
        self.light.as_ref().expect("the path is aimed at a light")
    }

    /// What the path found, of all light or of a part.
    pub fn result(&self, is_all_light: bool) -> PathResult<S> {
        let found = PathResult {
            radiance: self.radiance,
            alpha: self.alpha,
            rays: self.rays,
            clamped: self.clamped,
            seen: self.seen,
        };
        self.caught.result(found, is_all_light)
    }
}
