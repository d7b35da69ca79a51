//! A vector of three numbers: a direction, a point or a linear RGB colour. Unlike glam's it is generic, so that one formula
//! serves f32 and f64.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

use super::real::{Real, Scalar, inlined};

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

inlined! {
    /// Shorthand for [`Vec3`].
    pub fn vec3<T>(x: T, y: T, z: T) -> Vec3<T> {
        Vec3 { x, y, z }
    }
}

impl<T: Real> Vec3<T> {
    pub const ZERO: Self = Self {
        x: T::ZERO,
        y: T::ZERO,
        z: T::ZERO,
    };
    pub const ONE: Self = Self {
        x: T::ONE,
        y: T::ONE,
        z: T::ONE,
    };
    inlined! {
        /// The same number three times.
        pub fn splat(value: T) -> Self {
            vec3(value, value, value)
        }
        /// The components as the nearest numbers of this type.
        pub fn from_f64(value: [f64; 3]) -> Self {
            vec3(T::from_f64(value[0]), T::from_f64(value[1]), T::from_f64(value[2]))
        }
        pub fn from_f32(value: [f32; 3]) -> Self {
            Self::from_f64(value.map(f64::from))
        }
        /// The vectors that `f` says for the lanes.
        pub fn from_lanes(f: impl Fn(usize) -> Vec3<T::Scalar>) -> Self {
            let vectors = T::each(f);
            vec3(
                T::from_lanes(|lane| vectors[lane].x),
                T::from_lanes(|lane| vectors[lane].y),
                T::from_lanes(|lane| vectors[lane].z),
            )
        }
        /// The vectors of the lanes.
        pub fn to_each(self) -> T::Each<Vec3<T::Scalar>> {
            let (x, y, z) = (self.x.to_each(), self.y.to_each(), self.z.to_each());
            T::each(|lane| vec3(x[lane], y[lane], z[lane]))
        }
        /// The vector of one lane.
        pub fn lane(self, lane: usize) -> Vec3<T::Scalar> {
            vec3(self.x.lane(lane), self.y.lane(lane), self.z.lane(lane))
        }
        /// Lanes with a component other than 0.
        pub fn is_any(self) -> T::Mask {
            self.x.differs(T::ZERO) | self.y.differs(T::ZERO) | self.z.differs(T::ZERO)
        }
        pub fn dot(self, other: Self) -> T {
            self.x * other.x + self.y * other.y + self.z * other.z
        }
        pub fn cross(self, other: Self) -> Self {
            vec3(
                self.y * other.z - self.z * other.y,
                self.z * other.x - self.x * other.z,
                self.x * other.y - self.y * other.x,
            )
        }
        pub fn length(self) -> T {
            self.dot(self).sqrt()
        }
        /// Scaled to length 1; the vector must not be zero.
        pub fn normalize(self) -> Self {
            self / self.length()
        }
        pub fn map(self, f: impl Fn(T) -> T) -> Self {
            vec3(f(self.x), f(self.y), f(self.z))
        }
        pub fn max_component(self) -> T {
            self.x.max(self.y).max(self.z)
        }
        /// The absolute values of the components.
        pub fn abs(self) -> Self {
            self.map(T::abs)
        }
        /// No component below 0.
        pub fn at_least_zero(self) -> Self {
            self.map(|x| x.max(T::ZERO))
        }
        /// `if_true` where the mask holds, else `if_false`.
        pub fn select(mask: T::Mask, if_true: Self, if_false: Self) -> Self {
            vec3(
                T::select(mask, if_true.x, if_false.x),
                T::select(mask, if_true.y, if_false.y),
                T::select(mask, if_true.z, if_false.z),
            )
        }
        /// The vector where the mask holds, else 0.
        pub fn masked(self, mask: T::Mask) -> Self {
            self.map(|x| x.masked(mask))
        }
        /// `self` at t = 0, `other` at t = 1.
        pub fn mix(self, other: Self, t: T) -> Self {
            self * (T::ONE - t) + other * t
        }
        /// The mirror image of a direction about the axis `axis` (both pointing away): 2 (axis·d) axis − d.
        pub fn mirrored_about(self, axis: Self) -> Self {
            axis * (T::TWO * axis.dot(self)) - self
        }
        /// The mirror image behind the plane through the origin with normal `normal`: d − 2 (normal·d) normal.
        pub fn reflected_at_plane(self, normal: Self) -> Self {
            self - normal * (T::TWO * normal.dot(self))
        }
        /// Luminance of a linear Rec. 709 colour (CIE Y).
        pub fn luminance(self) -> T {
            T::from_f64(0.2126) * self.x + T::from_f64(0.7152) * self.y + T::from_f64(0.0722) * self.z
        }
    }
}

impl<T: Scalar> Vec3<T> {
    inlined! {
        pub fn to_f64(self) -> [f64; 3] {
            [self.x.to_f64(), self.y.to_f64(), self.z.to_f64()]
        }
        pub fn to_f32(self) -> [f32; 3] {
            self.to_f64().map(|v| v as f32)
        }
    }
}

/// Operators, component by component. Colours multiply so.
macro_rules! operators {
    ($($trait:ident<$other:ty> $function:ident: $self:ident $argument:ident $result:expr;)*) => {
        $(
            impl<T: Real> $trait<$other> for Vec3<T> {
                type Output = Self;
                inlined! {
                    fn $function($self, $argument: $other) -> Self { $result }
                }
            }
        )*
    };
}

operators! {
    Add<Self> add: self other vec3(self.x + other.x, self.y + other.y, self.z + other.z);
    Sub<Self> sub: self other vec3(self.x - other.x, self.y - other.y, self.z - other.z);
    Mul<Self> mul: self other vec3(self.x * other.x, self.y * other.y, self.z * other.z);
    Mul<T> mul: self factor vec3(self.x * factor, self.y * factor, self.z * factor);
    Div<T> div: self divisor self * (T::ONE / divisor);
}

impl<T: Real> AddAssign for Vec3<T> {
    inlined! {
        fn add_assign(&mut self, other: Self) { *self = *self + other; }
    }
}

impl<T: Real> Neg for Vec3<T> {
    type Output = Self;
    inlined! {
        fn neg(self) -> Self { self.map(|x| -x) }
    }
}
