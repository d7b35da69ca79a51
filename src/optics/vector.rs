//! A vector of three numbers: a direction, a point or a linear RGB colour. Unlike glam's it is generic, so that one formula
//! serves f32 and f64.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

use super::real::{Real, Scalar};

/// Three components; directions are unit vectors that point away from the surface unless a name says otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[repr(C)]
pub struct Vec3<T> {
    /// First component, or red.
    pub x: T,
    /// Second component, or green.
    pub y: T,
    /// Third component, or blue.
    pub z: T,
}

// SAFETY: three f32 without padding, any bit pattern is valid.
unsafe impl bytemuck::Zeroable for Vec3<f32> {}
// SAFETY: as above.
unsafe impl bytemuck::Pod for Vec3<f32> {}

/// Shorthand for [`Vec3`].
#[inline(always)]
pub fn vec3<T>(x: T, y: T, z: T) -> Vec3<T> {
    Vec3 { x, y, z }
}

impl<T: Real> Vec3<T> {
    /// The same number three times.
    #[inline(always)]
    pub fn splat(value: T) -> Self {
        vec3(value, value, value)
    }
    /// All zero.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::splat(T::zero())
    }
    /// The components as the nearest numbers of this type.
    #[inline(always)]
    pub fn from_f64(value: [f64; 3]) -> Self {
        vec3(T::from_f64(value[0]), T::from_f64(value[1]), T::from_f64(value[2]))
    }
    /// The components of an f32 array.
    #[inline(always)]
    pub fn from_f32(value: [f32; 3]) -> Self {
        Self::from_f64(value.map(f64::from))
    }
    /// The vectors that `f` says for the lanes.
    #[inline(always)]
    pub fn from_lanes(f: impl Fn(usize) -> Vec3<T::Scalar>) -> Self {
        let vectors = T::each(f);
        let vectors = vectors.as_ref();
        vec3(
            T::from_each(&T::each(|lane| vectors[lane].x)),
            T::from_each(&T::each(|lane| vectors[lane].y)),
            T::from_each(&T::each(|lane| vectors[lane].z)),
        )
    }
    /// The vectors of the lanes.
    #[inline(always)]
    pub fn to_each(self) -> T::Each<Vec3<T::Scalar>> {
        let (x, y, z) = (self.x.to_each(), self.y.to_each(), self.z.to_each());
        T::each(|lane| vec3(x.as_ref()[lane], y.as_ref()[lane], z.as_ref()[lane]))
    }
    /// Lanes with a component other than 0.
    #[inline(always)]
    pub fn is_any(self) -> T::Mask {
        let zero = T::zero();
        self.x.differs(zero) | self.y.differs(zero) | self.z.differs(zero)
    }
    #[inline(always)]
    pub fn dot(self, other: Self) -> T {
        self.x * other.x + self.y * other.y + self.z * other.z
    }
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        vec3(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }
    #[inline(always)]
    pub fn length(self) -> T {
        self.dot(self).sqrt()
    }
    /// Scaled to length 1; the vector must not be zero.
    #[inline(always)]
    pub fn normalize(self) -> Self {
        self * (T::one() / self.length())
    }
    #[inline(always)]
    pub fn map(self, f: impl Fn(T) -> T) -> Self {
        vec3(f(self.x), f(self.y), f(self.z))
    }
    #[inline(always)]
    pub fn max_component(self) -> T {
        self.x.max(self.y).max(self.z)
    }
    /// The absolute values of the components.
    #[inline(always)]
    pub fn abs(self) -> Self {
        vec3(self.x.abs(), self.y.abs(), self.z.abs())
    }
    /// No component below 0.
    #[inline(always)]
    pub fn at_least_zero(self) -> Self {
        let zero = T::zero();
        vec3(self.x.max(zero), self.y.max(zero), self.z.max(zero))
    }
    /// `if_true` where the mask holds, else `if_false`.
    #[inline(always)]
    pub fn select(mask: T::Mask, if_true: Self, if_false: Self) -> Self {
        vec3(
            T::select(mask, if_true.x, if_false.x),
            T::select(mask, if_true.y, if_false.y),
            T::select(mask, if_true.z, if_false.z),
        )
    }
    /// `self` at t = 0, `other` at t = 1.
    #[inline(always)]
    pub fn mix(self, other: Self, t: T) -> Self {
        self * (T::one() - t) + other * t
    }
    /// The mirror image of a direction about the axis `axis` (both pointing away): 2 (axis·d) axis − d.
    #[inline(always)]
    pub fn mirrored_about(self, axis: Self) -> Self {
        axis * (T::from_f64(2.0) * axis.dot(self)) - self
    }
    /// The mirror image behind the plane through the origin with normal `normal`: d − 2 (normal·d) normal.
    #[inline(always)]
    pub fn reflected_at_plane(self, normal: Self) -> Self {
        self - normal * (T::from_f64(2.0) * normal.dot(self))
    }
    /// Luminance of a linear Rec. 709 colour (CIE Y).
    #[inline(always)]
    pub fn luminance(self) -> T {
        T::from_f64(0.2126) * self.x + T::from_f64(0.7152) * self.y + T::from_f64(0.0722) * self.z
    }
}

impl<T: Scalar> Vec3<T> {
    /// The components as f64.
    #[inline(always)]
    pub fn to_f64(self) -> [f64; 3] {
        [self.x.to_f64(), self.y.to_f64(), self.z.to_f64()]
    }
    /// The components as f32.
    #[inline(always)]
    pub fn to_f32(self) -> [f32; 3] {
        self.to_f64().map(|v| v as f32)
    }
}

impl<T: Real> Add for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        vec3(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<T: Real> AddAssign for Vec3<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Real> Sub for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        vec3(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl<T: Real> Mul<T> for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: T) -> Self {
        vec3(self.x * factor, self.y * factor, self.z * factor)
    }
}

/// Component by component, as colours multiply.
impl<T: Real> Mul for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        vec3(self.x * other.x, self.y * other.y, self.z * other.z)
    }
}

impl<T: Real> Div<T> for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn div(self, divisor: T) -> Self {
        self * (T::one() / divisor)
    }
}

impl<T: Real> Neg for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        vec3(-self.x, -self.y, -self.z)
    }
}
