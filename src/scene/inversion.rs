//! Samples discrete weights by inverting their cumulative sum. That preserves order: well distributed numbers give well
//! distributed samples, while the alias tables of [`alias`](super::alias) would scatter them. A guide table (Chen and Asau
//! 1974) gives the start of the search, so that a sample takes one or two look-ups.
//!
//! Twin: `shaders/scene/inversion.wgsl`.

use crate::optics::real::{Real, Scalar};

/// Random numbers have so many bits ([`unit_from_bits`](crate::optics::random::unit_from_bits)), and so many values.
pub const DRAW_BITS: u32 = 24;
const DRAWS: u32 = 1 << DRAW_BITS;

/// An entry's part of the numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Share {
    /// Count of the 2²⁴ numbers that select this entry or one before it.
    pub upper: u32,
    /// The first entry that the numbers of a slot may draw; the slot is this entry's index. There are as many slots, of
    /// equally many numbers, as the largest power of two that is not above the number of entries.
    pub guide: u32,
}

/// An entry that was drawn.
#[derive(Clone, Copy, Debug)]
pub struct Drawn {
    pub index: u32,
    /// The first of the numbers that draw it.
    pub lower: u32,
    /// The number after the last of them.
    pub upper: u32,
}

/// Ranges of numbers for 1 to 2²⁴ weights. Each positive weight gets at least one number, a zero weight none.
pub fn shares(weights: &[f64]) -> Vec<Share> {
    let total: f64 = weights.iter().sum();
    let mut after = weights.iter().filter(|weight| **weight > 0.0).count() as u32;
    let (mut sum, mut before) = (0.0, 0);
    let upper = |weight: &f64| {
        if *weight > 0.0 {
            sum += weight;
            after -= 1;
            before = ((sum / total * f64::from(DRAWS)).round() as u32).clamp(before + 1, DRAWS - after);
        }
        before
    };
    let uppers: Vec<u32> = weights.iter().map(upper).collect();
    let shift = slot_shift(weights.len() as u32);
    let last = weights.len() - 1;
    let guide = |slot: usize| {
        let first = (slot as u32).checked_shl(shift).filter(|first| *first < DRAWS);
        first.map_or(0, |first| {
            uppers.partition_point(|upper| *upper <= first).min(last) as u32
        })
    };
    uppers
        .iter()
        .enumerate()
        .map(|(index, upper)| Share {
            upper: *upper,
            guide: guide(index),
        })
        .collect()
}

/// A number's slot is the number without so many of its last bits.
fn slot_shift(count: u32) -> u32 {
    DRAW_BITS - count.ilog2()
}

/// The slot of a number among `count` entries.
pub fn slot(count: u32, number: u32) -> u32 {
    number >> slot_shift(count)
}

/// Random numbers in [0, 1) as one of the 2²⁴ each.
#[inline(always)]
pub fn draw_numbers<T: Real>(xi: T) -> T::Each<i32> {
    (xi * T::from_f64(f64::from(DRAWS))).to_integers()
}

/// The entry out of `count` that a number selects.
pub fn find(count: u32, number: u32, share: impl Fn(u32) -> Share) -> u32 {
    let slot = slot(count, number);
    let mut low = share(slot).guide;
    let mut high = count - 1;
    if slot + 1 < 1 << count.ilog2() {
        high = share(slot + 1).guide;
    }
    while low < high {
        let middle = (low + high) / 2;
        if number < share(middle).upper {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    low
}

/// An entry with the numbers that draw it.
pub fn drawn(index: u32, share: impl Fn(u32) -> Share) -> Drawn {
    Drawn {
        index,
        lower: if index == 0 { 0 } else { share(index - 1).upper },
        upper: share(index).upper,
    }
}

/// Relative position in [0, 1] of a number within the range that selects an entry. `jitter` in [0, 1) is added to the
/// number, because an entry of little weight has only few.
pub fn place_in<T: Scalar>(drawn: Drawn, number: u32, jitter: T) -> T {
    let whole = |count: u32| T::from_f64(f64::from(count));
    ((whole(number - drawn.lower) + jitter) / whole((drawn.upper - drawn.lower).max(1))).min(T::ONE)
}
