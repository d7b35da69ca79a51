//! The lobes behind one interface, and their registry.
//!
//! A lobe module has three functions. `sample` turns uniform numbers into a direction towards the light; `density` is
//! the density of what `sample` returns, per steradian over the whole sphere; `weight` is evaluate/density, the factor
//! that a sample carries. What lies below the horizon is settled here, once for all lobes ([`lobe_sample`]).
//!
//! To add a lobe: one Rust file, one WGSL file of the same name, one line in the registry below.

use serde::{Deserialize, Serialize};

use super::curve::Curve;
use super::frame::Frame;
use super::real::{Mask, Real};
use super::vector::Vec3;

macro_rules! lobes {
    ($($module:ident $variant:ident = $index:literal, $name:literal, $label:literal, $help:literal;)*) => {
        $(pub mod $module;)*

        /// A reflection lobe.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
        #[repr(u32)]
        pub enum Lobe {
            $(#[doc = $help] #[serde(rename = $name)] $variant = $index,)*
        }

        impl Lobe {
            /// Every lobe, in the order of the menus.
            pub const ALL: &'static [Lobe] = &[$(Lobe::$variant),*];

            /// Name in presets and on the command line.
            pub fn name(self) -> &'static str {
                match self { $(Lobe::$variant => $name,)* }
            }
            /// Name in the menus.
            pub fn label(self) -> &'static str {
                match self { $(Lobe::$variant => $label,)* }
            }
            /// What the lobe is, with its source.
            pub fn help(self) -> &'static str {
                match self { $(Lobe::$variant => $help,)* }
            }
            /// The name of its Rust module and WGSL file, and the prefix of its WGSL functions.
            pub fn module(self) -> &'static str {
                match self { $(Lobe::$variant => stringify!($module),)* }
            }
            /// True where the model loses what it samples below the shading normal's horizon; false where the horizon
            /// policy decides.
            pub fn is_hemispherical(self) -> bool {
                match self { $(Lobe::$variant => $module::HEMISPHERICAL,)* }
            }
            /// True where the lobe reads the anisotropy.
            pub fn is_anisotropic(self) -> bool {
                match self { $(Lobe::$variant => $module::ANISOTROPIC,)* }
            }
        }

        /// The direction that the lobe itself draws, on either side of the horizon.
        pub fn raw_sample<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, xi: [T; 3]) -> Vec3<T> {
            match shape.lobe { $(Lobe::$variant => $module::sample(shape, frame, wo, xi),)* }
        }

        /// The density of [`raw_sample`], per steradian, not negative.
        pub fn raw_density<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, wi: Vec3<T>) -> T {
            match shape.lobe { $(Lobe::$variant => $module::density(shape, frame, wo, wi),)* }
        }

        /// Evaluate over density for a direction of [`raw_sample`].
        pub fn raw_weight<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, wi: Vec3<T>) -> T {
            match shape.lobe { $(Lobe::$variant => $module::weight(shape, frame, wo, wi),)* }
        }
    };
}

lobes! {
    geometric Geometric = 0, "geometric", "Geometric",
        "Samples are the mirror direction plus a random vector: no basis, no rotation (the paper, eqs. 8 to 10).";
    ggx Ggx = 1, "ggx", "GGX",
        "Microfacets with visible normals sampled by spherical caps (Dupuy and Benyoub 2023).";
    ggx_2018 Ggx2018 = 2, "ggx-2018", "GGX (2018)",
        "The same model, visible normals sampled as by Heitz (2018).";
    ggx_ndf GgxNdf = 3, "ggx-ndf", "GGX (2007)",
        "The same model, all normals sampled as by Walter et al. (2007): noisier at grazing angles.";
    blinn_phong BlinnPhong = 4, "blinn-phong", "Blinn-Phong",
        "Microfacets with a cosine-power distribution of normals (Blinn 1977, Walter et al. 2007).";
    phong Phong = 5, "phong", "Phong",
        "A cosine power around the mirror direction (Lafortune and Willems 1994).";
    lambert Lambert = 6, "lambert", "Lambert",
        "Perfectly diffuse: equally bright from everywhere, whatever the roughness.";
}

/// What happens to a sample that points below the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[repr(u32)]
pub enum Horizon {
    /// It is reflected at the surface: no energy is lost (the paper's "invert").
    Mirror = 0,
    /// It is lost.
    Absorb = 1,
    /// It stays where it is: for plots of the lobe itself.
    None = 2,
}

impl Horizon {
    /// Every policy, in the order of the menus.
    pub const ALL: &'static [Horizon] = &[Horizon::Mirror, Horizon::Absorb, Horizon::None];

    /// Name in presets and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Horizon::Mirror => "mirror",
            Horizon::Absorb => "absorb",
            Horizon::None => "none",
        }
    }
}

/// What a lobe needs to know besides directions.
#[derive(Clone, Copy, Debug)]
pub struct LobeShape<'a, T> {
    /// The lobe.
    pub lobe: Lobe,
    /// The geometric lobe's curve.
    pub curve: Curve,
    /// The policy below the horizon.
    pub horizon: Horizon,
    /// Perceptual roughness in [0, 1]: the geometric lobe's R; its square is the microfacet lobes' α.
    pub roughness: T,
    /// Stretch along the tangent in [−1, 1]; 0 is isotropic.
    pub anisotropy: T,
    /// The custom curve's table; empty where the curve has a name.
    pub table: &'a [f32],
}

/// A direction drawn from a lobe.
#[derive(Clone, Copy, Debug)]
pub struct LobeSample<T> {
    /// Towards the light, above the geometric horizon (or below, under [`Horizon::None`]).
    pub wi: Vec3<T>,
    /// Evaluate over density: 0 where the sample was absorbed.
    pub weight: T,
}

/// The smallest α of the microfacet lobes and roughness of the cosine powers: a cone of a hundredth of a degree.
pub const ALPHA_MIN: f64 = 1e-4;

/// Below this angular width (R or α) light sampling cannot help and f32 densities lose digits: the lobe still samples,
/// but is weighed as a mirror.
pub const MIRROR_WIDTH: f64 = 1e-3;

/// α of the microfacet lobes.
#[inline(always)]
pub fn alpha_from_roughness<T: Real>(roughness: T) -> T {
    (roughness * roughness).max(T::from_f64(ALPHA_MIN))
}

/// The stretch of a width along tangent and bitangent: √((1 + s)/(1 − s)), s = 0.9 × anisotropy, so that the product
/// of both widths stays what it was.
#[inline(always)]
pub fn stretch_from_anisotropy<T: Real>(anisotropy: T) -> T {
    let s = T::from_f64(0.9) * anisotropy.clamp(-T::one(), T::one());
    ((T::one() + s) / (T::one() - s)).sqrt()
}

/// True where the lobe is so narrow that it is weighed as a mirror ([`MIRROR_WIDTH`]).
#[inline(always)]
pub fn is_mirror<T: Real>(shape: &LobeShape<'_, T>) -> T::Mask {
    let width = match shape.lobe {
        Lobe::Geometric => shape.roughness,
        Lobe::Lambert => T::one(),
        _ => shape.roughness * shape.roughness,
    };
    width.less(T::from_f64(MIRROR_WIDTH))
}

/// Draws a direction. `surface_normal` is the geometric normal, on the side of `wo`: it is its horizon that counts, so
/// that no ray enters the surface where the shading normal leans. Source of the mirror policy: mathematics, section 3.
pub fn lobe_sample<T: Real>(
    shape: &LobeShape<'_, T>,
    frame: &Frame<T>,
    surface_normal: Vec3<T>,
    wo: Vec3<T>,
    xi: [T; 3],
) -> LobeSample<T> {
    let raw = raw_sample(shape, frame, wo, xi);
    let mut weight = raw_weight(shape, frame, wo, raw);
    if shape.lobe.is_hemispherical() {
        weight = T::select(T::zero().less(frame.normal.dot(raw)), weight, T::zero());
    }
    let below = surface_normal.dot(raw).less(T::zero());
    match shape.horizon {
        Horizon::Mirror => LobeSample {
            wi: Vec3::select(below, raw.reflected_at_plane(surface_normal), raw),
            weight,
        },
        Horizon::Absorb => LobeSample {
            wi: raw,
            weight: T::select(below, T::zero(), weight),
        },
        Horizon::None => LobeSample { wi: raw, weight },
    }
}

/// (evaluate, density) of [`lobe_sample`] for a direction: evaluate with the cosine included, density per steradian of
/// what is kept. Both 0 below the horizon, except under [`Horizon::None`].
pub fn lobe_evaluate<T: Real>(
    shape: &LobeShape<'_, T>,
    frame: &Frame<T>,
    surface_normal: Vec3<T>,
    wo: Vec3<T>,
    wi: Vec3<T>,
) -> [T; 2] {
    let height = surface_normal.dot(wi);
    if shape.horizon == Horizon::None {
        return raw_evaluate(shape, frame, wo, wi);
    }
    let visible = T::zero().less(height);
    let [mut value, mut density] = raw_evaluate(shape, frame, wo, wi);
    if shape.horizon == Horizon::Mirror {
        let [folded, folded_density] = raw_evaluate(shape, frame, wo, wi.reflected_at_plane(surface_normal));
        value += folded;
        density += folded_density;
    }
    [
        T::select(visible, value, T::zero()),
        T::select(visible, density, T::zero()),
    ]
}

/// (evaluate, density) before the horizon policy.
fn raw_evaluate<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, wi: Vec3<T>) -> [T; 2] {
    if shape.lobe.is_hemispherical() && !T::zero().less(frame.normal.dot(wi)).any() {
        return [T::zero(), T::zero()];
    }
    let density = raw_density(shape, frame, wo, wi);
    [density * raw_weight(shape, frame, wo, wi), density]
}
