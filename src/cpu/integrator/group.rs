//! Paths that go on side by side, one a lane: what they hold, put together in lanes, and what becomes of them.

use super::path::Path;
use crate::cpu::recorder::{Event, Purpose, Recorder, single};
use crate::optics::random::random_pairs;
use crate::optics::real::{Mask, Real};
use crate::optics::vector::Vec3;

/// Some paths of a wave, at most as many as there are lanes. Lanes without a path of their own have the first one's.
#[derive(Clone, Copy)]
pub(super) struct Group<T: Real> {
    members: T::Each<u16>,
    count: usize,
}

impl<T: Real> Group<T> {
    /// The paths at these places of a wave: at least one.
    #[inline(always)]
    pub fn new(members: &[u16]) -> Self {
        let first = members[0];
        Self {
            members: T::each(|lane| members.get(lane).copied().unwrap_or(first)),
            count: members.len().min(T::LANES),
        }
    }

    /// The lanes that have a path.
    #[inline(always)]
    pub fn lanes(&self) -> std::ops::Range<usize> {
        0..self.count
    }

    /// True where a lane has a path.
    #[inline(always)]
    pub fn mask(&self) -> T::Mask {
        T::Mask::from_bits((1 << self.count) - 1)
    }

    /// The path of a lane.
    #[inline(always)]
    pub fn of<'p, P>(&self, paths: &'p [P], lane: usize) -> &'p P {
        &paths[usize::from(self.members.as_ref()[lane])]
    }

    /// The path of a lane, to be changed.
    #[inline(always)]
    pub fn of_mut<'p, P>(&self, paths: &'p mut [P], lane: usize) -> &'p mut P {
        &mut paths[usize::from(self.members.as_ref()[lane])]
    }

    /// A number of each path.
    #[inline(always)]
    pub fn numbers<P>(&self, paths: &[P], number: impl Fn(&P) -> T::Scalar) -> T {
        T::from_lanes(|lane| number(self.of(paths, lane)))
    }

    /// Three numbers of each path.
    #[inline(always)]
    pub fn vectors<P>(&self, paths: &[P], vector: impl Fn(&P) -> Vec3<T::Scalar>) -> Vec3<T> {
        Vec3::from_lanes(|lane| vector(self.of(paths, lane)))
    }

    /// Where something holds of a path.
    #[inline(always)]
    pub fn truths<P>(&self, paths: &[P], is_true: impl Fn(&P) -> bool) -> T::Mask {
        let bits = (0..T::LANES).fold(0, |bits, lane| {
            bits | (u32::from(is_true(self.of(paths, lane))) << lane)
        });
        T::Mask::from_bits(bits)
    }

    /// Does something with each path and its lane where the mask holds.
    #[inline(always)]
    pub fn for_each<P>(&self, paths: &mut [P], mask: T::Mask, mut f: impl FnMut(&mut P, usize)) {
        let bits = mask.to_bits();
        for lane in self.lanes() {
            if bits >> lane & 1 == 1 {
                f(self.of_mut(paths, lane), lane);
            }
        }
    }

    /// Tells of an event of each path where the mask holds.
    #[inline(always)]
    pub fn record<R: Recorder>(&self, paths: &mut [Path<T::Scalar, R>], mask: T::Mask, event: impl Fn(usize) -> Event) {
        if R::KEEPS {
            self.for_each(paths, mask, |path, lane| path.record(|| event(lane)));
        }
    }

    /// The pair of numbers number `dimension` of each path, each number with its purpose.
    #[inline(always)]
    pub fn pairs<R: Recorder>(
        &self,
        paths: &mut [Path<T::Scalar, R>],
        dimension: u32,
        purposes: [Purpose; 2],
    ) -> [T; 2] {
        let keys = T::each(|lane| self.of(paths, lane).state.key);
        let samples = T::each(|lane| self.of(paths, lane).state.sample);
        let sequence = self.of(paths, 0).state.sequence;
        let pair = random_pairs::<T>(&keys, &samples, sequence, dimension);
        for (half, purpose) in (0..).zip(purposes) {
            if purpose != Purpose::Unused {
                self.record(paths, self.mask(), |lane| Event::Number {
                    dimension,
                    half,
                    value: single(pair[half as usize].lane(lane)),
                    purpose,
                });
            }
        }
        pair
    }
}
