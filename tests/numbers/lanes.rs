//! Functions in lanes against the same functions alone, on each of this processor's instruction sets: the same to the last bit.
//! So what is proven of f32, and of f64 in other tests, holds of what the processor renders with.

use glossmith::optics::{lanes::InLanes, lanes::in_lanes, real::Real};

use crate::support::{Random, sets};

/// A function of two numbers, in lanes or alone.
trait Function {
    fn of<T: Real>(x: T, y: T) -> T;
}

macro_rules! functions {
    ($($name:ident = |$x:ident, $y:ident| $value:expr;)*) => {
        $(
            struct $name;
            impl Function for $name {
                #[inline(always)]
                fn of<T: Real>($x: T, $y: T) -> T {
                    $value
                }
            }
        )*
    };
}

functions! {
    Sin = |x, _y| x.sin();
    Cos = |x, _y| x.cos();
    Exp = |x, _y| x.exp();
    Ln = |x, _y| x.ln();
    Powf = |x, y| x.powf(y);
    Atan2 = |x, y| x.atan2(y);
}

/// What a function makes of pairs of numbers, sixteen at a time.
struct Values<'a, F>(&'a [[f32; 2]], std::marker::PhantomData<F>);

impl<F: Function> InLanes for Values<'_, F> {
    type Output = Vec<f32>;
    fn run<T: Real<Scalar = f32>>(self) -> Vec<f32> {
        let mut values = Vec::with_capacity(self.0.len());
        for pairs in self.0.chunks_exact(T::LANES) {
            T::vectorize(
                #[inline(always)]
                || {
                    let (x, y) = (
                        T::from_lanes(|lane| pairs[lane][0]),
                        T::from_lanes(|lane| pairs[lane][1]),
                    );
                    values.extend_from_slice(F::of(x, y).to_each().as_ref());
                },
            );
        }
        values
    }
}

/// Off by so many units in the last place of the right value.
fn units_off(value: f32, right: f64) -> f64 {
    let nearest = (right as f32).abs();
    let unit = f64::from(f32::from_bits(nearest.to_bits() + 1)) - f64::from(nearest);
    (f64::from(value) - right).abs() / unit
}

/// Asserts that a function is within two units in the last place, and the same alone and in lanes.
#[track_caller]
fn assert_close<F: Function>(name: &str, mut draw: impl FnMut(&mut Random) -> [f32; 2]) {
    let mut random = Random::new(11);
    let pairs: Vec<_> = (0..1 << 20).map(|_| draw(&mut random)).collect();
    let alone: Vec<f32> = pairs.iter().map(|&[x, y]| F::of(x, y)).collect();
    let mut worst: f64 = 0.0;
    for (&[x, y], &value) in pairs.iter().zip(&alone) {
        let right = F::of(f64::from(x), f64::from(y));
        if (right as f32).is_normal() {
            worst = worst.max(units_off(value, right));
        }
    }
    println!("{name}: within {worst:.2} units in the last place");
    assert!((0.4..2.0).contains(&worst), "{name}: off by {worst} units");
    for (set, level) in sets() {
        let values = in_lanes(level, Values::<F>(&pairs, std::marker::PhantomData));
        assert_eq!(values.len(), pairs.len());
        let other = (0..pairs.len()).find(|&i| values[i].to_bits() != alone[i].to_bits());
        if let Some(i) = other {
            panic!(
                "{name} of {:?} under {set}: {} instead of {}",
                pairs[i], values[i], alone[i]
            );
        }
    }
}

/// A number whose size may be any of many, of either sign.
fn any_size(random: &mut Random, from: f32, to: f32) -> f32 {
    let size = 10.0_f32.powf(from + (to - from) * random.unit());
    if random.below(2) == 0 { size } else { -size }
}

#[test]
fn elementary_functions_are_within_two_units_in_the_last_place_alone_and_in_lanes() {
    let turns = |random: &mut Random| [20.0 * (random.unit() - 0.5), 0.0];
    assert_close::<Sin>("sin", turns);
    assert_close::<Cos>("cos", turns);
    assert_close::<Exp>("exp", |random| [any_size(random, -6.0, 1.9), 0.0]);
    assert_close::<Ln>("ln", |random| [any_size(random, -37.0, 38.0).abs(), 0.0]);
    assert_close::<Ln>("ln near 1", |random| [1.0 + 0.5 * (random.unit() - 0.5), 0.0]);
    assert_close::<Powf>("powf", |random| [random.unit(), any_size(random, -2.0, 3.0)]);
    assert_close::<Atan2>("atan2", |random| {
        [any_size(random, -8.0, 1.0), any_size(random, -8.0, 1.0)]
    });
}
