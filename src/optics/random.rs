//! Counter-based random numbers: (pixel, sample, dimension) gives the same bits on every CPU and GPU.
//!
//! A *dimension* counts a path's pairs of numbers. Two sequences: `Independent` hashes the three counters; `Sobol` takes the
//! first two dimensions of the Sobol sequence, shuffled and Owen-scrambled per pixel and pair by the hash of Laine and
//! Karras (Burley, "Practical hash-based Owen scrambling", JCGT 2020; constants by Vegdahl).

use super::real::{Real, inlined};
use crate::named::named;

named! {
    /// Random sequence of a render.
    #[derive(Default)]
    Sequence {
        #[default]
        Sobol = 0, "sobol", "Sobol", "Owen-scrambled Sobol points: the error falls faster than 1/√n where the integrand is smooth.";
        Independent = 1, "independent", "Independent", "Independent hashed numbers.";
    }
}

/// The counters from which a path draws its numbers.
#[derive(Clone, Copy, Debug, Default)]
pub struct RandomState {
    /// Hash of pixel and seed.
    pub key: u32,
    /// Index of the sample in its pixel.
    pub sample: u32,
    /// Sequence to draw from.
    pub sequence: Sequence,
}

/// The pixel's stream. `x`, `y` in pixels, below 65 536.
pub fn random_state(x: u32, y: u32, seed: u32, sample: u32, sequence: Sequence) -> RandomState {
    RandomState {
        key: hash_bits((x | (y << 16)) ^ hash_bits(seed)),
        sample,
        sequence,
    }
}

/// Random state of sample number `sample` of a render. Even and odd samples are two independent randomisations of the Sobol
/// sequence, each in its order. So the difference of their means gives the error of the whole, which the samples' spread
/// does not if they are dependent (docs/MATHEMATICS.md, section 8).
pub fn path_state(x: u32, y: u32, seed: u32, sample: u32, sequence: Sequence) -> RandomState {
    let state = random_state(x, y, seed, sample, sequence);
    match sequence {
        Sequence::Sobol => RandomState {
            key: if sample.is_multiple_of(2) {
                state.key
            } else {
                hash_bits(state.key ^ 0x5851_f42d)
            },
            sample: sample / 2,
            sequence,
        },
        Sequence::Independent => state,
    }
}

/// A bijection of the 32-bit numbers without visible structure (Wellons' lowbias32).
pub fn hash_bits(bits: u32) -> u32 {
    let mut x = bits;
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// A number in [0, 1) of 24 bits: never 1, in any precision.
#[inline(always)]
pub fn unit_from_bits<T: Real>(bits: u32) -> T {
    T::from_count(bits >> 8) * T::from_f64(1.0 / 16_777_216.0)
}

/// The independent sequence: for a fixed key and dimension a permutation of the 2³² samples, so no number of a pixel's
/// stream repeats before all have been drawn.
pub fn random_bits(key: u32, sample: u32, dimension: u32) -> u32 {
    let stream = hash_bits(key ^ dimension.wrapping_mul(0x9e37_79b9));
    hash_bits(hash_bits(sample ^ stream).wrapping_add(stream.rotate_left(16) ^ key))
}

/// Scrambles as Owen would, from the lowest bit up: each bit is flipped by a hash of the bits below it.
pub fn scramble_from_low(bits: u32, seed: u32) -> u32 {
    let mut x = bits;
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// Sobol's second dimension with its bits reversed: Pascal's triangle modulo 2 applied to the index's bits.
pub fn sobol_second_reversed(index: u32) -> u32 {
    let mut x = index;
    x ^= (x >> 1) & 0x5555_5555;
    x ^= (x >> 2) & 0x3333_3333;
    x ^= (x >> 4) & 0x0f0f_0f0f;
    x ^= (x >> 8) & 0x00ff_00ff;
    x ^ ((x >> 16) & 0x0000_ffff)
}

/// The bits of the pair of numbers number `dimension` of this path.
pub fn random_pair_bits(state: RandomState, dimension: u32) -> [u32; 2] {
    match state.sequence {
        Sequence::Sobol => sobol_pair_bits(state.key, state.sample, dimension),
        Sequence::Independent => independent_pair_bits(state.key, state.sample, dimension),
    }
}

fn sobol_pair_bits(key: u32, sample: u32, dimension: u32) -> [u32; 2] {
    let seed = sobol_seed(key, dimension);
    let index = sobol_index(sample, seed);
    [sobol_first(index, seed), sobol_second(index, seed)]
}

fn sobol_seed(key: u32, dimension: u32) -> u32 {
    hash_bits(key ^ dimension.wrapping_mul(0x9e37_79b9).wrapping_add(0x2545_f491))
}

fn sobol_index(sample: u32, seed: u32) -> u32 {
    scramble_from_low(sample.reverse_bits(), seed).reverse_bits()
}

fn sobol_first(index: u32, seed: u32) -> u32 {
    scramble_from_low(index, hash_bits(seed ^ 0x68bc_21eb)).reverse_bits()
}

fn sobol_second(index: u32, seed: u32) -> u32 {
    scramble_from_low(sobol_second_reversed(index), hash_bits(seed ^ 0x02e5_be93)).reverse_bits()
}

fn independent_pair_bits(key: u32, sample: u32, dimension: u32) -> [u32; 2] {
    [
        random_bits(key, sample, 2 * dimension),
        random_bits(key, sample, 2 * dimension + 1),
    ]
}

inlined! {
    /// The same for several paths, by their keys and samples. Written so that compilers vectorise it.
    fn random_pairs_bits<T: Real>(
        keys: &T::Each<u32>,
        samples: &T::Each<u32>,
        sequence: Sequence,
        dimension: u32,
    ) -> [T::Each<u32>; 2] {
        let (keys, samples) = (keys.as_ref(), samples.as_ref());
        match sequence {
            Sequence::Sobol => {
                let seeds = T::each(|lane| sobol_seed(keys[lane], dimension));
                let seeds = seeds.as_ref();
                let indices = T::each(|lane| sobol_index(samples[lane], seeds[lane]));
                let indices = indices.as_ref();
                [
                    T::each(|lane| sobol_first(indices[lane], seeds[lane])),
                    T::each(|lane| sobol_second(indices[lane], seeds[lane])),
                ]
            }
            Sequence::Independent => [
                T::each(|lane| random_bits(keys[lane], samples[lane], 2 * dimension)),
                T::each(|lane| random_bits(keys[lane], samples[lane], 2 * dimension + 1)),
            ],
        }
    }

    /// The pairs of numbers in [0, 1) number `dimension` of some paths at once.
    pub fn random_pairs<T: Real>(
        keys: &T::Each<u32>,
        samples: &T::Each<u32>,
        sequence: Sequence,
        dimension: u32,
    ) -> [T; 2] {
        let [first, second] = random_pairs_bits::<T>(keys, samples, sequence, dimension);
        [units_from_bits(&first), units_from_bits(&second)]
    }

    fn units_from_bits<T: Real>(bits: &T::Each<u32>) -> T {
        let bits = bits.as_ref();
        T::from_lanes(|lane| unit_from_bits(bits[lane]))
    }

    /// The pair of numbers in [0, 1) number `dimension` of this path.
    pub fn random_pair<T: Real>(state: RandomState, dimension: u32) -> [T; 2] {
        random_pair_bits(state, dimension).map(unit_from_bits)
    }
}

/// Steps of [`even_point`]: of a sequence that covers the unit square evenly, and of two further numbers. Source: Roberts,
/// "The unreasonable effectiveness of quasirandom sequences" (2018).
const EVEN_STEPS: [f64; 4] = [
    0.754_877_666_246_692_7,
    0.569_840_290_998_053_2,
    0.414_213_562_373_095_1,
    0.732_050_807_568_877_2,
];

/// Point of a sequence for integrals of smooth functions in tables, four numbers in [0, 1): at 8192 points its error is a
/// tenth of the Sobol sequence's.
pub(crate) fn even_point(index: u32) -> [f64; 4] {
    EVEN_STEPS.map(|step| ((f64::from(index) + 0.5) * step).fract())
}
