//! Paths that go on side by side, one a lane: what they hold, put together in lanes, and what becomes of them.

use std::marker::PhantomData;
use std::ops::Range;

use super::paths::{Found, Paths, Vectors};
use crate::cpu::recorder::{Event, Purpose, Recorder, single};
use crate::optics::random::random_pairs;
use crate::optics::real::{Mask, Real, Scalar};
use crate::optics::vector::Vec3;

/// Some paths that lie side by side in the fields of a wave, at most as many as there are lanes. Lanes beyond them have what
/// lies behind: what is made of it counts for nothing.
#[derive(Clone, Copy)]
pub(super) struct Group<T: Real> {
    first: usize,
    count: usize,
    of: PhantomData<T>,
}

/// The groups of paths at these places.
pub(super) struct Groups<T: Real> {
    places: Range<usize>,
    of: PhantomData<T>,
}

impl<T: Real> Groups<T> {
    #[inline(always)]
    pub fn new(places: Range<usize>) -> Self {
        Self {
            places,
            of: PhantomData,
        }
    }
}

impl<T: Real> Iterator for Groups<T> {
    type Item = Group<T>;
    #[inline(always)]
    fn next(&mut self) -> Option<Group<T>> {
        let first = self.places.start;
        let count = self.places.len().min(T::LANES);
        self.places.start += count;
        (count > 0).then_some(Group {
            first,
            count,
            of: PhantomData,
        })
    }
}

impl<T: Real> Group<T> {
    /// The only path of a wave of one.
    pub const ALONE: Self = Self {
        first: 0,
        count: 1,
        of: PhantomData,
    };

    /// True where a lane has a path.
    #[inline(always)]
    pub fn mask(&self) -> T::Mask {
        T::Mask::from_bits((1 << self.count) - 1)
    }

    /// Something of each path; beyond them the first one's.
    #[inline(always)]
    pub fn each<E: Copy + Default>(&self, field: &[E]) -> T::Each<E> {
        let field = &field[self.first..self.first + T::LANES];
        T::each(|lane| field[if lane < self.count { lane } else { 0 }])
    }

    /// Which paths of the wave they are.
    #[inline(always)]
    pub fn members(&self, ids: &[u16]) -> Members<T> {
        Members(self.each(ids))
    }

    /// A number of each path.
    #[inline(always)]
    pub fn number(&self, field: &[T::Scalar]) -> T {
        T::load(&field[self.first..])
    }

    /// A whole number of each path.
    #[inline(always)]
    pub fn whole_number(&self, field: &[u32]) -> T {
        let field = &field[self.first..self.first + T::LANES];
        T::from_lanes(
            #[inline(always)]
            |lane| T::Scalar::from_count(field[lane]),
        )
    }

    /// A number of each path; beyond them the first one's.
    #[inline(always)]
    pub fn own_number(&self, field: &[T::Scalar]) -> T {
        let first = T::from_f64(field[self.first].to_f64());
        T::select(self.mask(), self.number(field), first)
    }

    /// Three numbers of each path.
    #[inline(always)]
    pub fn vector(&self, field: &Vectors<T::Scalar>) -> Vec3<T> {
        Vec3 {
            x: self.number(&field.x),
            y: self.number(&field.y),
            z: self.number(&field.z),
        }
    }

    /// Where something holds of a path.
    #[inline(always)]
    pub fn truth(&self, field: &[bool]) -> T::Mask {
        let field = &field[self.first..self.first + T::LANES];
        mask_of::<T>(|lane| field[lane])
    }

    /// Sets a number of each path where the mask holds.
    #[inline(always)]
    pub fn set_number(&self, field: &mut [T::Scalar], mask: T::Mask, value: T) {
        let field = &mut field[self.first..];
        T::select(mask, value, T::load(field)).store(field);
    }

    /// Sets three numbers of each path where the mask holds.
    #[inline(always)]
    pub fn set_vector(&self, field: &mut Vectors<T::Scalar>, mask: T::Mask, value: Vec3<T>) {
        self.set_number(&mut field.x, mask, value.x);
        self.set_number(&mut field.y, mask, value.y);
        self.set_number(&mut field.z, mask, value.z);
    }

    /// Sets what holds of each path where the mask holds.
    #[inline(always)]
    pub fn set_truth(&self, field: &mut [bool], mask: T::Mask, value: T::Mask) {
        let (mask, value) = (mask.to_bits(), value.to_bits());
        let field = &mut field[self.first..self.first + T::LANES];
        for (lane, is_true) in field.iter_mut().enumerate() {
            if mask >> lane & 1 == 1 {
                *is_true = value >> lane & 1 == 1;
            }
        }
    }

    /// Sets something of each path.
    #[inline(always)]
    pub fn set_each<E: Copy + Default>(&self, field: &mut [E], values: &T::Each<E>) {
        field[self.first..self.first + self.count].copy_from_slice(&values.as_ref()[..self.count]);
    }

    /// The pair of numbers number `dimension` of each path, each number with its purpose.
    #[inline(always)]
    pub fn pairs<R: Recorder>(
        &self,
        paths: &mut Paths<T::Scalar, R>,
        dimension: u32,
        purposes: [Purpose; 2],
    ) -> [T; 2] {
        let keys = self.each(&paths.state.keys);
        let samples = self.each(&paths.state.samples);
        let pair = random_pairs::<T>(&keys, &samples, paths.sequence, dimension);
        if R::KEEPS {
            let members = self.members(&paths.state.ids);
            for (half, purpose) in (0..).zip(purposes) {
                if purpose != Purpose::Unused {
                    members.record(&mut paths.found, self.mask(), |lane| Event::Number {
                        dimension,
                        half,
                        value: single(pair[half as usize].lane(lane)),
                        purpose,
                    });
                }
            }
        }
        pair
    }
}

/// The paths of a group by their numbers in the wave.
#[derive(Clone, Copy)]
pub(super) struct Members<T: Real>(T::Each<u16>);

impl<T: Real> Members<T> {
    /// What the path of a lane has found.
    #[inline(always)]
    pub fn of<'f, F>(&self, found: &'f [F], lane: usize) -> &'f F {
        &found[usize::from(self.0.as_ref()[lane])]
    }

    /// Where something holds of what a path has found.
    #[inline(always)]
    pub fn truths<F>(&self, found: &[F], is_true: impl Fn(&F) -> bool) -> T::Mask {
        mask_of::<T>(|lane| is_true(self.of(found, lane)))
    }

    /// Does something with what each path has found, and its lane, where the mask holds.
    #[inline(always)]
    pub fn for_each<F>(&self, found: &mut [F], mask: T::Mask, mut f: impl FnMut(&mut F, usize)) {
        let mut bits = mask.to_bits();
        while bits != 0 {
            let lane = bits.trailing_zeros() as usize % T::LANES;
            bits &= bits - 1;
            f(&mut found[usize::from(self.0.as_ref()[lane])], lane);
        }
    }

    /// Tells of an event of each path where the mask holds.
    #[inline(always)]
    pub fn record<R: Recorder>(
        &self,
        found: &mut [Found<T::Scalar, R>],
        mask: T::Mask,
        event: impl Fn(usize) -> Event,
    ) {
        if R::KEEPS {
            self.for_each(found, mask, |path, lane| path.record(|| event(lane)));
        }
    }
}

/// True where something holds of a lane.
#[inline(always)]
fn mask_of<T: Real>(is_true: impl Fn(usize) -> bool) -> T::Mask {
    let bits = (0..T::LANES).fold(0, |bits, lane| bits | (u32::from(is_true(lane)) << lane));
    T::Mask::from_bits(bits)
}
