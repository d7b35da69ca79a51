//! A path under way: its sums, and its random numbers as they are drawn.

use super::catcher::Caught;
use super::{BOUNCE_DIMENSIONS, PathResult};
use crate::cpu::recorder::{Event, Purpose, Recorder, single};
use crate::job::features::GuideSums;
use crate::optics::random::{RandomState, random_pair, unit_from_bits};
use crate::optics::real::Real;
use crate::optics::vector::Vec3;

/// A path under way. Every number that it takes is drawn by [`Path::pair`], every event told by [`Path::record`].
pub(super) struct Path<'r, T, R> {
    state: RandomState,
    /// Numbers that were drawn ahead.
    ahead: Ahead,
    /// What light from the ray's other end is multiplied by.
    pub throughput: Vec3<T>,
    /// What it has found.
    pub radiance: Vec3<T>,
    /// Luminance that limiting fireflies took.
    pub clamped: T,
    /// Rays traced.
    pub rays: u32,
    /// What is seen first.
    pub seen: GuideSums,
    /// What a shadow catcher has made of it.
    pub caught: Caught<T>,
    /// True while the path is one of those that tell what they see, and has met nothing but mirrors and clear glass.
    pub is_looking: bool,
    recorder: &'r mut R,
}

/// Pairs of numbers that are drawn ahead: those of a bounce.
pub(super) const AHEAD: usize = BOUNCE_DIMENSIONS as usize;

/// The bits of pairs of numbers that were drawn for many paths at once, which is quicker.
#[derive(Clone, Copy, Default)]
struct Ahead {
    /// Of the first pair.
    dimension: u32,
    /// How many pairs there are.
    count: usize,
    pairs: [[u32; 2]; AHEAD],
}

impl Ahead {
    #[inline(always)]
    fn pair(&self, dimension: u32) -> Option<[u32; 2]> {
        let place = dimension.wrapping_sub(self.dimension) as usize;
        self.pairs.get(place).filter(|_| place < self.count).copied()
    }
}

/// A ray of a path, and how its direction was drawn.
#[derive(Default)]
pub(super) struct Ray<T> {
    pub origin: Vec3<T>,
    /// Unit vector.
    pub direction: Vec3<T>,
    /// The density of the direction, for what competes with light sampling.
    pub lobe_density: T,
    /// True where light sampling could not have drawn the direction.
    pub is_mirror: bool,
    /// True where it is proven that nothing lies ahead.
    pub leaves: bool,
}

impl<'r, T: Real, R: Recorder> Path<'r, T, R> {
    pub fn new(state: RandomState, is_looking: bool, recorder: &'r mut R) -> Self {
        Self {
            state,
            ahead: Ahead::default(),
            throughput: Vec3::splat(T::one()),
            radiance: Vec3::zero(),
            clamped: T::zero(),
            rays: 0,
            seen: GuideSums::default(),
            caught: Caught::Not,
            is_looking,
            recorder,
        }
    }

    /// The pair of numbers number `dimension`, each with its purpose.
    #[inline(always)]
    pub fn pair(&mut self, dimension: u32, purposes: [Purpose; 2]) -> [T; 2] {
        let pair: [T; 2] = match self.ahead.pair(dimension) {
            Some(bits) => bits.map(unit_from_bits),
            None => random_pair(self.state, dimension),
        };
        for (half, purpose) in (0..).zip(purposes) {
            if purpose != Purpose::Unused {
                self.record(|| Event::Number {
                    dimension,
                    half,
                    value: single(pair[half as usize]),
                    purpose,
                });
            }
        }
        pair
    }

    /// The counters from which it draws its numbers.
    pub fn state(&self) -> RandomState {
        self.state
    }

    /// Takes the bits of so many pairs that were drawn ahead, from this dimension on.
    pub fn set_ahead(&mut self, dimension: u32, count: usize, pairs: [[u32; 2]; AHEAD]) {
        self.ahead = Ahead {
            dimension,
            count,
            pairs,
        };
    }

    /// Tells of an event.
    #[inline(always)]
    pub fn record(&mut self, event: impl FnOnce() -> Event) {
        self.recorder.record(event);
    }

    /// What the path found, of all light or of a part.
    pub fn result(&self, alpha: T, is_all_light: bool) -> PathResult<T> {
        let found = PathResult {
            radiance: self.radiance,
            alpha,
            rays: self.rays,
            clamped: self.clamped,
            seen: self.seen,
        };
        self.caught.result(found, is_all_light)
    }
}
