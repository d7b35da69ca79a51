//! Curves D(ξ): distance of the geometric lobe's samples from the mirror direction (paper, section 4.6 and eq. 13).
//!
//! A curve is the quantile function of the distance D. The lobe's density needs h(D) = f_D(D)/D, with the density f_D of D
//! (docs/MATHEMATICS.md, section 1). A curve module has two functions of a table, which only the custom curve reads:
//! `distance` is D(ξ) for ξ in [0, 1]; `h` is h(D) for D in [0, the maximum], bounded at singularities.
//!
//! To add a curve: one Rust file with its [`CurveTraits`], one WGSL file of the same name, one line in the registry below.

use super::real::Real;
use crate::named::named;

pub use custom::{CUSTOM_INTERVALS, CUSTOM_LENGTH, custom_table};
pub use long_tail::LONG_TAIL_MAX;

macro_rules! curves {
    ($($module:ident $variant:ident = $index:literal, $name:literal, $label:literal, $help:literal;)*) => {
        $(mod $module;)*

        named! {
            /// The curve D(ξ).
            Curve {
                $($variant = $index, $name, $label, $help;)*
            }
        }

        impl Curve {
            /// The name of its Rust module and WGSL file, and the prefix of its WGSL functions.
            pub fn module(self) -> &'static str {
                match self { $(Curve::$variant => stringify!($module),)* }
            }

            pub const fn traits(self) -> CurveTraits {
                match self { $(Curve::$variant => $module::TRAITS,)* }
            }
        }

        /// D(ξ) for ξ in [0, 1]. `table` holds the custom curve and is not read for the others.
        #[inline(always)]
        pub fn curve_distance<T: Real>(curve: Curve, table: &[f32], xi: T) -> T {
            match curve { $(Curve::$variant => $module::distance(table, xi),)* }
        }

        /// h(D) = f_D(D)/D, for D in [0, D's maximum]; bounded at singularities.
        #[inline(always)]
        pub fn curve_h<T: Real>(curve: Curve, table: &[f32], distance: T) -> T {
            match curve { $(Curve::$variant => $module::h(table, distance),)* }
        }
    };
}

curves! {
    linear Linear = 0, "linear", "Linear", "Crowded around the mirror direction.";
    sqrt Sqrt = 1, "sqrt", "Square root", "The simplest: an even disc with a sharp edge.";
    cbrt Cbrt = 2, "cbrt", "Cube root", "Pushed outwards, with a sharp edge.";
    smooth Smooth = 3, "smooth", "Smooth", "A soft edge, closest to Phong.";
    long_tail LongTail = 4, "long-tail", "Long tail", "A wide glow like GGX; crosses the surface at any roughness.";
    custom Custom = 5, "custom", "Custom", "A monotone curve of your own.";
}

/// Properties of a curve, stated in its own file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveTraits {
    /// Formula of D(ξ).
    pub formula: &'static str,
    /// Integration of the lobe's density over it.
    pub integral: Integral,
    /// D's maximum; `None` where the table has it.
    pub reach: Option<f64>,
    /// Largest D worth plotting.
    pub plotted_max: f64,
}

/// Integration method of the lobe's density, an integral over h (`super::chord`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Integral {
    /// In closed form: h is 1/D.
    Reciprocal,
    /// In closed form: h is a polynomial, with these coefficients of 1, D, D².
    Polynomial([f64; 3]),
    /// The same with an h that vanishes at D's maximum: near the silhouette, where the closed form cancels, quadrature
    /// replaces it.
    PolynomialToZero([f64; 3]),
    /// By Gauss–Legendre nodes.
    Quadrature,
    /// In closed form in each interval of the table.
    Table,
}

impl Integral {
    /// The number that the shaders know it by, and its name there.
    pub const fn in_shaders(self) -> (u32, &'static str) {
        match self {
            Self::Reciprocal => (0, "RECIPROCAL"),
            Self::Polynomial(_) => (1, "POLYNOMIAL"),
            Self::PolynomialToZero(_) => (2, "POLYNOMIAL_TO_ZERO"),
            Self::Quadrature => (3, "QUADRATURE"),
            Self::Table => (4, "TABLE"),
        }
    }

    /// h as coefficients of 1, D, D²; zeros if it is no polynomial.
    pub const fn polynomial(self) -> [f64; 3] {
        match self {
            Self::Polynomial(h) | Self::PolynomialToZero(h) => h,
            _ => [0.0; 3],
        }
    }
}

impl Curve {
    /// True if the curve is a table.
    pub fn has_table(self) -> bool {
        self.traits().integral == Integral::Table
    }

    /// True if D(ξ) is at most 1 for every ξ.
    pub fn is_within_unit(self) -> bool {
        !self.has_table() && curve_distance_max::<f64>(self, &[]) <= 1.0
    }

    /// Formula of D(ξ).
    pub fn formula(self) -> &'static str {
        self.traits().formula
    }

    /// The curves with a formula.
    pub fn with_formulas() -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(|curve| !curve.has_table())
    }
}

/// D's maximum.
#[inline(always)]
pub fn curve_distance_max<T: Real>(curve: Curve, table: &[f32]) -> T {
    curve
        .traits()
        .reach
        .map_or_else(|| custom::distance_max(table), T::from_f64)
}

/// f_D(D), the density of the distance (paper, eq. 14).
pub fn curve_density<T: Real>(curve: Curve, table: &[f32], distance: T) -> T {
    curve_h(curve, table, distance) * distance
}
