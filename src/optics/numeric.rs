//! Elementary functions in forms that do not cancel.

use crate::optics::prelude::*;

inlined! {
    /// eˣ − 1, accurate for small |x|.
    pub fn expm1<T: Real>(x: T) -> T {
        let c = T::from_f64;
        let series = x * (T::ONE + x * (c(0.5) + x * (c(1.0 / 6.0) + x * c(1.0 / 24.0))));
        T::select(x.abs().less(c(0.01)), series, x.exp() - T::ONE)
    }

    /// ln(1 + x), accurate for small |x|; x > −1.
    pub fn log1p<T: Real>(x: T) -> T {
        let c = T::from_f64;
        let series = x * (T::ONE - x * (c(0.5) - x * (c(1.0 / 3.0) - x * (c(0.25) - x * c(0.2)))));
        T::select(x.abs().less(c(0.01)), series, (T::ONE + x).ln())
    }

    /// Sampling probability of a layer with this share in [0, 1] of the light: the share itself, but at least 1/20 for the
    /// smaller side. Continuous at a share of 0, so that its rounding does not matter.
    pub fn sampled_share<T: Real>(share: T) -> T {
        let is_small = share.less(T::HALF);
        T::select(is_small, raised(share), T::ONE - raised(T::ONE - share))
    }

    /// The share of the smaller of two layers.
    fn raised<T: Real>(small: T) -> T {
        small.max((T::from_f64(20.0) * small).min(T::from_f64(0.05)))
    }

    /// `v` normalised, or `fallback` if `v` is so short that its direction is rounding noise.
    pub fn normalize_or<T: Real>(v: Vec3<T>, fallback: Vec3<T>) -> Vec3<T> {
        let square = v.dot(v);
        let usable = T::from_f64(1e-30).less(square);
        let scale = T::ONE / T::select(usable, square, T::ONE).sqrt();
        Vec3::select(usable, v * scale, fallback)
    }
}
