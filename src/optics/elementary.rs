//! Elementary functions of f32 in plain arithmetic: the same bits on every processor, and quicker than the system's, whose
//! calls hold up everything around them. The GPU has its own, and f64, the oracle, the system's.

use std::f32::consts::{FRAC_PI_2, PI};

/// What π/2 in f32 is too large by; twice that for π.
const FRAC_PI_2_EXCESS: f32 = 4.371_139e-8;

/// Of (atan(t)/t − 1)/t² over t² in [0, 1]: minimax.
const ATAN: [f32; 8] = [
    -0.333_331_02,
    0.199_926_96,
    -0.142_027_36,
    0.106_347_93,
    -0.074_890_09,
    0.042_504_99,
    -0.015_956_903,
    0.002_823_639,
];

/// The angle of the vector (`x`, `y`), both finite, in radians, in [−π, π]: within two units in the last place. 0 where both
/// are.
#[inline(always)]
pub fn atan2(y: f32, x: f32) -> f32 {
    let (width, height) = (x.abs(), y.abs());
    let is_steep = width < height;
    let (less, more) = if is_steep { (width, height) } else { (height, width) };
    let t = less / more.max(f32::MIN_POSITIVE);
    let square = t * t;
    let fourth = square * square;
    let [a, b, c, d, e, f, g, h] = ATAN;
    let low = (a + b * square) + (c + d * square) * fourth;
    let high = (e + f * square) + (g + h * square) * fourth;
    let angle = t + t * (square * (low + high * (fourth * fourth)));
    let angle = if is_steep {
        FRAC_PI_2 - (angle + FRAC_PI_2_EXCESS)
    } else {
        angle
    };
    let angle = if x < 0.0 {
        PI - (angle + 2.0 * FRAC_PI_2_EXCESS)
    } else {
        angle
    };
    angle.copysign(y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::random::{Sequence, random_pair, random_state};

    /// Off by so many units in the last place of the right value.
    fn units_off(value: f32, right: f64) -> f64 {
        let nearest = (right as f32).abs();
        let unit = f64::from(f32::from_bits(nearest.to_bits() + 1)) - f64::from(nearest);
        (f64::from(value) - right).abs() / unit
    }

    #[test]
    fn the_angle_of_a_vector_is_within_two_units_in_the_last_place() {
        let mut worst: f64 = 0.0;
        for i in 0..1_000_000 {
            let state = random_state(0, 0, 1, i, Sequence::Independent);
            let ([a, b], [c, _]) = (random_pair::<f32>(state, 0), random_pair::<f32>(state, 1));
            let small = 10.0_f32.powf(-8.0 * c);
            let (x, y) = (2.0 * a - 1.0, 2.0 * b - 1.0);
            for (x, y) in [(x, y), (x * small, y), (x, y * small)] {
                worst = worst.max(units_off(atan2(y, x), f64::from(y).atan2(f64::from(x))));
            }
        }
        assert!((0.5..2.0).contains(&worst), "{worst}");
        assert_eq!(atan2(0.0, 0.0), 0.0);
        assert_eq!(atan2(0.0, -1.0), PI);
        assert_eq!(atan2(-1.0, 0.0), -FRAC_PI_2);
    }
}
