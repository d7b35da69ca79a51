//! Uniform numbers turned into directions, points and choices.

use crate::optics::prelude::*;

inlined! {
    /// A uniform direction on the unit sphere from two uniform numbers (paper, eq. 9). Density 1/(4π).
    pub fn uniform_sphere<T: Real>(xi: [T; 2]) -> Vec3<T> {
        let x = T::TWO * xi[0] - T::ONE;
        let s = (T::ONE - x * x).safe_sqrt();
        let phi_rad = T::TAU * xi[1];
        vec3(x, s * phi_rad.sin(), s * phi_rad.cos())
    }

    /// A uniform point in the unit disc from two uniform numbers, area-preserving and continuous in polar form.
    pub fn uniform_disc<T: Real>(xi: [T; 2]) -> [T; 2] {
        let radius = xi[0].safe_sqrt();
        let phi_rad = T::TAU * xi[1];
        [radius * phi_rad.cos(), radius * phi_rad.sin()]
    }

    /// Whether `number` in [0, 1) is below `share`, and the number remapped to [0, 1) within its part. So one number chooses (a
    /// layer, a kind of light) and is used again. Of well distributed numbers, as the Sobol sequence, each choice gets well
    /// distributed ones. With a separate number for the choice they would be picked at random.
    pub fn split<T: Real>(number: T, share: T) -> (T::Mask, T) {
        let is_below = number.less(share);
        let start = T::select(is_below, T::ZERO, share);
        let length = T::select(is_below, share, T::ONE - share).max(T::from_f64(1e-20));
        let largest = T::from_f64(1.0 - 1.0 / 16_777_216.0);
        (is_below, ((number - start) / length).min(largest))
    }
}
