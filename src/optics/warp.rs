//! Uniform numbers turned into directions and points.

use super::real::Real;
use super::vector::{Vec3, vec3};

/// A uniform direction on the unit sphere from two uniform numbers (paper, eq. 9). Density 1/(4π).
#[inline(always)]
pub fn uniform_sphere<T: Real>(xi: [T; 2]) -> Vec3<T> {
    let x = T::from_f64(2.0) * xi[0] - T::one();
    let s = (T::one() - x * x).safe_sqrt();
    let phi_rad = T::from_f64(std::f64::consts::TAU) * xi[1];
    vec3(x, s * phi_rad.sin(), s * phi_rad.cos())
}

/// A uniform point in the unit disc from two uniform numbers, area-preserving and continuous in polar form.
#[inline(always)]
pub fn uniform_disc<T: Real>(xi: [T; 2]) -> [T; 2] {
    let radius = xi[0].safe_sqrt();
    let phi_rad = T::from_f64(std::f64::consts::TAU) * xi[1];
    [radius * phi_rad.cos(), radius * phi_rad.sin()]
}
