//! Numbers in lanes against the same numbers alone, on each of this processor's instruction sets: the same to the last bit.
//! So what is proven of f32, and of f64 in other tests, holds of what the processor renders with.

use glossmith::optics::lanes::{InLanes, in_lanes};
use glossmith::optics::lobe::{Horizon, LobeShape, lobe_evaluate, lobe_sample};
use glossmith::optics::real::Real;
use glossmith::optics::vector::Vec3;

use crate::lobe_cases::{Case, lobes_and_curves};
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

/// Directions drawn from a lobe, with their values and densities: eight numbers each.
struct Drawn<'a>(&'a Case, &'a [[f32; 3]]);

/// Of one draw: where to, weight, value and density there, value and density elsewhere.
fn draw<T: Real>(case: &Case, xi: [T; 3]) -> [T; 8] {
    let shape = case.shape();
    let c = T::from_f64;
    let shape = LobeShape {
        lobe: shape.lobe,
        curve: shape.curve,
        horizon: shape.horizon,
        roughness: c(shape.roughness),
        anisotropy: c(shape.anisotropy),
        eta: c(shape.eta),
        table: shape.table,
    };
    let vector = |v: Vec3<f64>| Vec3::<T>::from_f64(v.to_f64());
    let frame = case.frame();
    let frame = glossmith::optics::frame::Frame {
        tangent: vector(frame.tangent),
        bitangent: vector(frame.bitangent),
        normal: vector(frame.normal),
    };
    let (normal, wo) = (vector(case.surface_normal()), vector(case.wo()));
    let drawn = lobe_sample(&shape, &frame, normal, wo, xi);
    let [value, density] = lobe_evaluate(&shape, &frame, normal, wo, drawn.wi);
    let elsewhere = glossmith::optics::warp::uniform_sphere([xi[2], xi[0]]);
    let [other, other_density] = lobe_evaluate(&shape, &frame, normal, wo, elsewhere);
    let wi = drawn.wi;
    [wi.x, wi.y, wi.z, drawn.weight, value, density, other, other_density]
}

impl InLanes for Drawn<'_> {
    type Output = Vec<[f32; 8]>;
    fn run<T: Real<Scalar = f32>>(self) -> Self::Output {
        let mut all = Vec::with_capacity(self.1.len());
        for numbers in self.1.chunks_exact(T::LANES) {
            let xi = [0, 1, 2].map(|i| T::from_lanes(|lane| numbers[lane][i]));
            let drawn = draw(self.0, xi).map(|number| number.to_each());
            all.extend((0..T::LANES).map(|lane| std::array::from_fn(|i| drawn[i].as_ref()[lane])));
        }
        all
    }
}

/// Every lobe, so many draws of each case on each instruction set.
#[test]
fn lobes_give_the_same_bits_in_lanes_as_alone() {
    const COUNT: usize = if cfg!(feature = "thorough") { 3072 } else { 128 };
    let mut random = Random::new(5);
    let numbers: Vec<[f32; 3]> = (0..COUNT).map(|_| std::array::from_fn(|_| random.unit())).collect();
    for (lobe, curve) in lobes_and_curves() {
        for &horizon in Horizon::ALL {
            let mut cases = Case::grid(
                lobe,
                curve,
                horizon,
                &[0.0, 0.6],
                &[1e-4, 0.05, 0.3, 0.6, 1.0],
                &[0.0, 60.0, 89.0],
            );
            let leaning = cases.iter().map(|case| Case {
                lean_deg: 20.0,
                ..case.clone()
            });
            let refracting = cases.iter().map(|case| Case {
                eta: 1.5,
                ..case.clone()
            });
            let inside = cases.iter().map(|case| Case {
                eta: 1.0 / 1.5,
                ..case.clone()
            });
            let more: Vec<_> = leaning.chain(refracting).chain(inside).collect();
            cases.extend(more);
            for case in &cases {
                let alone: Vec<[f32; 8]> = numbers.iter().map(|&xi| draw::<f32>(case, xi)).collect();
                for (set, level) in sets() {
                    let drawn = in_lanes(level, Drawn(case, &numbers));
                    for (i, (lane, alone)) in drawn.iter().zip(&alone).enumerate() {
                        let is_same = |(a, b): (&f32, &f32)| {
                            a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()) || (*a == 0.0 && *b == 0.0)
                        };
                        assert!(
                            lane.iter().zip(alone).all(is_same),
                            "{case:?} under {set}, numbers {:?}: {lane:?} instead of {alone:?}",
                            numbers[i]
                        );
                    }
                }
            }
        }
    }
}
