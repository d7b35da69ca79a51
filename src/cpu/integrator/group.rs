//! Groups of paths, one path per SIMD lane: loads from and stores to the wave's fields.

use super::*;
use super::{paths::PathOutput, vectors::Vectors};
use crate::{cpu::recorder::Purpose, optics::random::random_pairs};
use std::{marker::PhantomData, ops::Range};

/// A run of paths with consecutive indices, at most [`Real::LANES`]. Lanes beyond the run load the elements that follow;
/// their results are ignored.
#[derive(Clone, Copy)]
pub struct Group<T: Single> {
    first: usize,
    count: usize,
    of: PhantomData<T>,
}

/// The groups of an index range.
pub fn groups<T: Single>(indices: Range<usize>) -> impl Iterator<Item = Group<T>> {
    let end = indices.end;
    indices.step_by(T::LANES).map(move |first| Group {
        first,
        count: T::LANES.min(end - first),
        of: PhantomData,
    })
}

impl<T: Single> Group<T> {
    inlined! {
        /// Lanes that have a path.
        pub fn mask(&self) -> T::Mask {
            T::Mask::from_bits((1 << self.count) - 1)
        }

        /// A field's element per path; lanes beyond the group repeat the first path's.
        pub fn each<E: Copy + Default>(&self, field: &[E]) -> T::Each<E> {
            let field = &field[self.first..self.first + T::LANES];
            // Nearly all groups are full: a plain copy.
            match self.count == T::LANES {
                true => T::each(|lane| field[lane]),
                false => T::each(|lane| field[if lane < self.count { lane } else { 0 }]),
            }
        }

        pub fn members(&self, ids: &[u16]) -> Members<T> {
            Members(self.each(ids))
        }

        /// A field's number per path.
        pub fn number(&self, field: &[f32]) -> T {
            T::load(&field[self.first..])
        }

        /// A field's integer per path, as a number.
        pub fn integer(&self, field: &[u32]) -> T {
            let field = &field[self.first..self.first + T::LANES];
            T::from_lanes(|lane| field[lane] as f32)
        }

        /// A field's number per path; lanes beyond the group repeat the first path's.
        pub fn padded_number(&self, field: &[f32]) -> T {
            let first = T::from_f64(field[self.first].to_f64());
            T::select(self.mask(), self.number(field), first)
        }

        /// A field's vector per path.
        pub fn vector(&self, field: &Vectors) -> Vec3<T> {
            Vec3 {
                x: self.number(&field.x),
                y: self.number(&field.y),
                z: self.number(&field.z),
            }
        }

        /// A field's flag per path, as a mask.
        pub fn flags(&self, field: &[bool]) -> T::Mask {
            let field = &field[self.first..self.first + T::LANES];
            mask_of::<T>(|lane| field[lane])
        }

        /// Stores a number in the masked lanes.
        pub fn set_number(&self, field: &mut [f32], mask: T::Mask, value: T) {
            let field = &mut field[self.first..];
            T::select(mask, value, T::load(field)).store(field);
        }

        /// Stores a vector in the masked lanes.
        pub fn set_vector(&self, field: &mut Vectors, mask: T::Mask, value: Vec3<T>) {
            self.set_number(&mut field.x, mask, value.x);
            self.set_number(&mut field.y, mask, value.y);
            self.set_number(&mut field.z, mask, value.z);
        }

        /// Stores a flag in the masked lanes.
        pub fn set_flags(&self, field: &mut [bool], mask: T::Mask, value: T::Mask) {
            let (mask, value) = (mask.to_bits(), value.to_bits());
            let field = &mut field[self.first..self.first + T::LANES];
            for (lane, is_true) in field.iter_mut().enumerate() {
                if mask >> lane & 1 == 1 {
                    *is_true = value >> lane & 1 == 1;
                }
            }
        }

        /// Stores an element per path.
        pub fn set_each<E: Copy + Default>(&self, field: &mut [E], values: &T::Each<E>) {
            field[self.first..self.first + self.count].copy_from_slice(&values.as_ref()[..self.count]);
        }

        /// The random pair of a dimension per path; `purposes` are for the recorder.
        pub fn pairs<R: Recorder>(&self, paths: &mut Paths<R>, dimension: u32, purposes: [Purpose; 2]) -> [T; 2] {
            let keys = self.each(&paths.state.keys);
            let samples = self.each(&paths.state.samples);
            let pair = random_pairs::<T>(&keys, &samples, paths.sequence, dimension);
            if R::KEEPS {
                let members = self.members(&paths.state.ids);
                for (half, purpose) in (0..).zip(purposes) {
                    if purpose != Purpose::Unused {
                        members.record(&mut paths.outputs, self.mask(), |lane| Event::Number {
                            dimension,
                            half,
                            value: pair[half as usize].lane(lane),
                            purpose,
                        });
                    }
                }
            }
            pair
        }
    }
}

/// The ids of a group's paths, by which results and other per-path data are indexed.
#[derive(Clone, Copy)]
pub struct Members<T: Single>(T::Each<u16>);

impl<T: Single> Members<T> {
    inlined! {
        /// The path of a lane.
        pub fn path(&self, lane: usize) -> usize {
            usize::from(self.0[lane])
        }

        /// Lanes for whose path a predicate holds.
        pub fn flags<F>(&self, per_path: &[F], is_true: impl Fn(&F) -> bool) -> T::Mask {
            mask_of::<T>(|lane| is_true(&per_path[self.path(lane)]))
        }

        /// Calls `f` with the path and lane of each path in the mask.
        pub fn each_path(&self, mask: T::Mask, mut f: impl FnMut(usize, usize)) {
            let mut bits = mask.to_bits();
            while bits != 0 {
                let lane = bits.trailing_zeros() as usize % T::LANES;
                bits &= bits - 1;
                f(self.path(lane), lane);
            }
        }

        /// Calls `f` with the element and lane of each path in the mask.
        pub fn for_each<F>(&self, per_path: &mut [F], mask: T::Mask, mut f: impl FnMut(&mut F, usize)) {
            self.each_path(mask, |path, lane| f(&mut per_path[path], lane));
        }

        /// Records an event per path in the mask.
        pub fn record<R: Recorder>(&self, outputs: &mut [PathOutput<R>], mask: T::Mask, event: impl Fn(usize) -> Event) {
            if R::KEEPS {
                self.for_each(outputs, mask, |path, lane| path.recorder.record(|| event(lane)));
            }
        }
    }
}

inlined! {
    /// Mask of the lanes for which a predicate holds.
    fn mask_of<T: Single>(is_true: impl Fn(usize) -> bool) -> T::Mask {
        let bits = (0..T::LANES).fold(0, |bits, lane| bits | (u32::from(is_true(lane)) << lane));
        T::Mask::from_bits(bits)
    }
}
