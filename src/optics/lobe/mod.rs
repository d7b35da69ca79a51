//! The lobes behind one interface, and their registry.
//!
//! A lobe module has three functions. `sample` turns uniform numbers into a direction towards the light; `density` is
//! the density of what `sample` returns, per steradian over the whole sphere; `weight` is evaluate/density, the factor
//! that a sample carries. What lies below the horizon is settled here, once for all lobes ([`lobe_sample`]).
//!
//! To add a lobe: one Rust file with its [`LobeTraits`], one WGSL file of the same name, one line in the registry below.

pub mod model;

use super::curve::Curve;
use super::frame::Frame;
use super::numeric::normalize_or;
use super::real::{Mask, Real};
use super::refraction::{facet_density_factor, facet_refracted, facet_weight, refracted, refracting_normal};
use super::vector::Vec3;
use crate::named::named;

/// Hands the list of the lobes to a macro: module, type, number in the shaders, name, label, help.
#[doc(hidden)]
#[macro_export]
macro_rules! lobe_list {
    ($make:ident) => {
        $make! {
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
    };
}
pub use crate::lobe_list as list;

macro_rules! lobes {
    ($($module:ident $variant:ident = $index:literal, $name:literal, $label:literal, $help:literal;)*) => {
        $(pub mod $module;)*

        named! {
            /// A reflection lobe.
            Lobe {
                $($variant = $index, $name, $label, $help;)*
            }
        }

        impl Lobe {
            /// The name of its Rust module and WGSL file, and the prefix of its WGSL functions.
            pub fn module(self) -> &'static str {
                match self { $(Lobe::$variant => stringify!($module),)* }
            }
            /// What is special about it.
            #[inline(always)]
            pub const fn traits(self) -> LobeTraits {
                match self { $(Lobe::$variant => $module::TRAITS,)* }
            }
        }

        /// The direction that the lobe itself draws, on either side of the horizon.
        pub fn raw_sample<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, xi: [T; 3]) -> Vec3<T> {
            T::vectorize(
                #[inline(always)]
                || match shape.lobe { $(Lobe::$variant => $module::sample(shape, frame, wo, xi),)* },
            )
        }

        /// [`raw_sample`] of a lobe, without the choice at each call.
        pub fn raw_sampler<T: Real>(lobe: Lobe) -> RawSampler<T> {
            match lobe { $(Lobe::$variant => $module::sample,)* }
        }

        /// The density of [`raw_sample`], per steradian, not negative.
        pub fn raw_density<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, wi: Vec3<T>) -> T {
            T::vectorize(
                #[inline(always)]
                || match shape.lobe { $(Lobe::$variant => $module::density(shape, frame, wo, wi),)* },
            )
        }

        /// Evaluate over density for a direction of [`raw_sample`].
        #[inline(always)]
        pub fn raw_weight<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, wi: Vec3<T>) -> T {
            match shape.lobe { $(Lobe::$variant => $module::weight(shape, frame, wo, wi),)* }
        }
    };
}

list!(lobes);

impl Lobe {
    /// See [`LobeTraits::is_hemispherical`].
    #[inline(always)]
    pub const fn is_hemispherical(self) -> bool {
        self.traits().is_hemispherical
    }

    /// See [`LobeTraits::is_anisotropic`].
    #[inline(always)]
    pub const fn is_anisotropic(self) -> bool {
        self.traits().is_anisotropic
    }

    /// See [`LobeTraits::facets`].
    #[inline(always)]
    pub const fn facets(self) -> Facets {
        self.traits().facets
    }

    /// See [`LobeTraits::has_curves`].
    #[inline(always)]
    pub const fn has_curves(self) -> bool {
        self.traits().has_curves
    }

    /// The curves that make a difference: any one where it reads none.
    pub fn curves(self) -> &'static [Curve] {
        if self.has_curves() { Curve::ALL } else { &[Curve::Sqrt] }
    }

    /// True where the roughness makes a difference.
    pub fn has_roughness(self) -> bool {
        self.traits().width != Width::Fixed
    }
}

/// What is special about a lobe: said in its own file, read by everything else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeTraits {
    /// The model loses what it samples below the shading normal's horizon; else the horizon policy decides.
    pub is_hemispherical: bool,
    /// It reads the anisotropy.
    pub is_anisotropic: bool,
    /// Whether it is made of facets, each of which refracts by itself.
    pub facets: Facets,
    /// How wide it is.
    pub width: Width,
    /// It is a ball around the mirror direction whose radius is drawn by a curve D(ξ): for D ≤ 1 no sample is lower above
    /// the surface than (1 − R)(n·r − R).
    pub has_curves: bool,
    /// Evaluate over density is always 1. Then what a mirror does not reflect is passed on to what is below it, and under
    /// the mirror policy no light is lost.
    pub weighs_one: bool,
    /// Radius about the mirror direction, in radians per roughness, where plots leave the density out: its peak is infinite
    /// there, though integrable.
    pub peak: f64,
}

/// What the angular width of a lobe goes with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// It is as wide at any roughness.
    Fixed,
    /// With the roughness.
    Roughness,
    /// With its square, α: the roughness of GGX, which textures and files are made for.
    Alpha,
}

/// The angular width of a lobe, near enough.
#[inline(always)]
pub fn lobe_width<T: Real>(lobe: Lobe, roughness: T) -> T {
    match lobe.traits().width {
        Width::Fixed => T::one(),
        Width::Roughness => roughness,
        Width::Alpha => roughness * roughness,
    }
}

/// The roughness at which a lobe is as wide as one of this roughness that is turned about a refracted direction. Facets turn
/// what they refract by |1 − 1/η| of their tilt, what they mirror by twice the tilt (mathematics, section 7).
#[inline(always)]
pub fn refracting_roughness<T: Real>(lobe: Lobe, roughness: T, eta: T) -> T {
    let share = (T::one() - T::one() / eta).abs() * T::from_f64(0.5);
    match lobe.traits().width {
        Width::Fixed => roughness,
        Width::Roughness => refracting_roughness_of(roughness, share),
        Width::Alpha => roughness * share.sqrt(),
    }
    .min(T::one())
}

/// The roughness at which a lobe whose width goes with it is as wide as facets make it that turn the light by this share.
#[inline(always)]
fn refracting_roughness_of<T: Real>(roughness: T, share: T) -> T {
    let number = T::from_f64;
    let square = roughness * roughness;
    let tilt = roughness * number(3.0) + square * number(3.2) + square * square * number(2.2);
    let turn = share * tilt;
    // The positive root of 4 x² + 3 x = turn, so written that nothing cancels.
    let root = (number(9.0) + number(16.0) * turn).sqrt();
    (turn + turn) / (number(3.0) + root)
}

/// Draws a direction from one lobe.
pub type RawSampler<T> = for<'a> fn(&LobeShape<'a, T>, &Frame<T>, Vec3<T>, [T; 3]) -> Vec3<T>;

named! {
    /// What happens to samples that point below the surface.
    Horizon {
        Mirror = 0, "mirror", "Mirror", "They are reflected at the surface: no light is lost.";
        Absorb = 1, "absorb", "Absorb", "They are lost: the surface darkens towards grazing angles.";
        None = 2, "none", "None", "They go through the surface: for plots of the lobe itself.";
    }
}

/// How a lobe draws the facets that it is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Facets {
    /// It has none.
    None = 0,
    /// Those that the viewer sees, in proportion to D G1 (wo·h)/cosθo.
    Visible = 1,
    /// All, in proportion to D cosθh.
    All = 2,
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
    /// 0 where the lobe reflects. Where it refracts: the index of refraction behind the surface over that before it.
    pub eta: T,
    /// The custom curve's table; empty where the curve has a name.
    pub table: &'a [f32],
}

impl<T: Real> LobeShape<'_, T> {
    /// True where the lobe refracts, which it does in all lanes or in none.
    #[inline(always)]
    pub fn refracts(&self) -> bool {
        self.eta.differs(T::zero()).any()
    }
}

/// A direction drawn from a lobe.
#[derive(Clone, Copy, Debug)]
pub struct LobeSample<T> {
    /// Towards the light, above the geometric horizon; below it under [`Horizon::None`], or where the sample was absorbed.
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

/// The anisotropy in [0, 1] whose narrower width is this share of the wider one; 1 where none is so narrow.
pub fn anisotropy_from_ratio(ratio: f64) -> f64 {
    ((1.0 - ratio) / (0.9 * (1.0 + ratio))).clamp(0.0, 1.0)
}

/// True where the lobe is so narrow that it is weighed as a mirror ([`MIRROR_WIDTH`]). Facets turn the refracted
/// direction by |1 − 1/η| of their own tilt: where both sides are nearly alike, everything goes straight on.
#[inline(always)]
pub fn is_mirror<T: Real>(shape: &LobeShape<'_, T>) -> T::Mask {
    let mut width = lobe_width(shape.lobe, shape.roughness);
    if refracts_at_facets(shape) {
        width = width * (T::one() - T::one() / shape.eta).abs();
    } else if shape.refracts() {
        width = lobe_width(shape.lobe, refracting_roughness(shape.lobe, shape.roughness, shape.eta));
    }
    width.less(T::from_f64(MIRROR_WIDTH))
}

/// True where the lobe refracts, and does so facet by facet.
#[inline(always)]
pub fn refracts_at_facets<T: Real>(shape: &LobeShape<'_, T>) -> bool {
    shape.refracts() && shape.lobe.facets() != Facets::None
}

/// How a lobe is seen: where it refracts as a whole, by a viewer behind the surface.
#[derive(Clone, Copy, Debug)]
pub struct LobeView<T> {
    /// The shading frame on the side that the lobe fills; on the viewer's where facets refract.
    pub frame: Frame<T>,
    /// The geometric normal on the side that the lobe fills.
    pub normal: Vec3<T>,
    /// Towards the viewer whose mirror direction is the lobe's middle; the real viewer where facets refract.
    pub wo: Vec3<T>,
    /// The roughness of the lobe that is seen reflected there.
    pub roughness: T,
}

impl<T: Real> LobeView<T> {
    /// The lobe that this viewer sees reflected.
    #[inline(always)]
    fn seen_lobe<'a>(&self, shape: &LobeShape<'a, T>) -> LobeShape<'a, T> {
        LobeShape {
            roughness: self.roughness,
            ..*shape
        }
    }
}

/// The view in which a refracting lobe is a reflecting one. Facets refract each by itself, so only the side changes. Any
/// other lobe is turned about the refracted direction: what a viewer behind the surface, whose mirror direction that is,
/// sees reflected, by a lobe as narrow as facets would make it ([`refracting_roughness`]; mathematics, section 7). Under
/// total reflection, and for `eta` 0, the lobe reflects.
#[inline(always)]
pub fn lobe_view<T: Real>(
    shape: &LobeShape<'_, T>,
    frame: &Frame<T>,
    surface_normal: Vec3<T>,
    wo: Vec3<T>,
) -> LobeView<T> {
    let seen = LobeView {
        frame: *frame,
        normal: surface_normal,
        wo,
        roughness: shape.roughness,
    };
    if !shape.refracts() {
        return seen;
    }
    if refracts_at_facets(shape) {
        return LobeView {
            normal: -surface_normal,
            ..seen
        };
    }
    let behind = refracted(wo, frame.normal, shape.eta);
    let is_total = behind.is_total;
    LobeView {
        frame: Frame {
            tangent: frame.tangent,
            bitangent: Vec3::select(is_total, frame.bitangent, -frame.bitangent),
            normal: Vec3::select(is_total, frame.normal, -frame.normal),
        },
        normal: Vec3::select(is_total, surface_normal, -surface_normal),
        wo: Vec3::select(is_total, wo, behind.wi.mirrored_about(frame.normal)),
        roughness: T::select(
            is_total,
            shape.roughness,
            refracting_roughness(shape.lobe, shape.roughness, shape.eta),
        ),
    }
}

/// The middle of the lobe: the mirror direction, or the refracted one. Behind the critical angle a lobe made of facets
/// has none, and what is left of it lies on the other side of the view.
pub fn lobe_middle<T: Real>(
    shape: &LobeShape<'_, T>,
    frame: &Frame<T>,
    surface_normal: Vec3<T>,
    wo: Vec3<T>,
) -> Vec3<T> {
    if refracts_at_facets(shape) {
        return refracted(wo, frame.normal, shape.eta).wi;
    }
    let view = lobe_view(shape, frame, surface_normal, wo);
    view.wo.mirrored_about(view.frame.normal)
}

/// Draws a direction. `surface_normal` is the geometric normal, on the side of `wo`: it is its horizon that counts, so
/// that no reflected ray enters the surface, and no refracted one stays outside, where the shading normal leans. Source
/// of the mirror policy: mathematics, section 3.
pub fn lobe_sample<T: Real>(
    shape: &LobeShape<'_, T>,
    frame: &Frame<T>,
    surface_normal: Vec3<T>,
    wo: Vec3<T>,
    xi: [T; 3],
) -> LobeSample<T> {
    T::out_of_line(
        #[inline(always)]
        || {
            let view = lobe_view(shape, frame, surface_normal, wo);
            let seen = view.seen_lobe(shape);
            let mut raw = raw_sample(&seen, &view.frame, view.wo, xi);
            let weight = if refracts_at_facets(shape) {
                let facet = facet_refracted(wo, raw, shape.eta);
                raw = facet.wi;
                T::select(facet.is_total, T::zero(), facet_weight(shape, frame, wo, raw))
            } else {
                let weight = raw_weight(&seen, &view.frame, view.wo, raw);
                let is_lost = !T::zero().less(view.frame.normal.dot(raw));
                if shape.lobe.is_hemispherical() {
                    T::select(is_lost, T::zero(), weight)
                } else {
                    weight
                }
            };
            let below = view.normal.dot(raw).less(T::zero());
            match shape.horizon {
                // What is lost in any case is left where it is: it tells of the facet that it was drawn for.
                Horizon::Mirror => LobeSample {
                    wi: Vec3::select(below & T::zero().less(weight), raw.reflected_at_plane(view.normal), raw),
                    weight,
                },
                Horizon::Absorb => LobeSample {
                    wi: raw,
                    weight: T::select(below, T::zero(), weight),
                },
                Horizon::None => LobeSample { wi: raw, weight },
            }
        },
    )
}

/// (evaluate, density) of [`lobe_sample`] for a direction: evaluate with the cosine included, density per steradian of
/// what is kept. Both 0 on the side of the surface that the lobe does not fill, except under [`Horizon::None`].
pub fn lobe_evaluate<T: Real>(
    shape: &LobeShape<'_, T>,
    frame: &Frame<T>,
    surface_normal: Vec3<T>,
    wo: Vec3<T>,
    wi: Vec3<T>,
) -> [T; 2] {
    T::out_of_line(
        #[inline(always)]
        || {
            let view = lobe_view(shape, frame, surface_normal, wo);
            if shape.horizon == Horizon::None {
                return raw_evaluate(shape, &view, wi);
            }
            let visible = T::zero().less(view.normal.dot(wi));
            let [mut value, mut density] = raw_evaluate(shape, &view, wi);
            if shape.horizon == Horizon::Mirror {
                let [folded, folded_density] = raw_evaluate(shape, &view, wi.reflected_at_plane(view.normal));
                value += folded;
                density += folded_density;
            }
            [
                T::select(visible, value, T::zero()),
                T::select(visible, density, T::zero()),
            ]
        },
    )
}

/// (evaluate, density) before the horizon policy.
#[inline(always)]
fn raw_evaluate<T: Real>(shape: &LobeShape<'_, T>, view: &LobeView<T>, wi: Vec3<T>) -> [T; 2] {
    let LobeView { frame, wo, .. } = view;
    if refracts_at_facets(shape) {
        let along = refracting_normal(*wo, wi, shape.eta);
        let mirrored = wo.mirrored_about(normalize_or(along, frame.normal));
        let factor = facet_density_factor(frame, *wo, wi, shape.eta, along);
        let density = T::select(
            T::zero().less(factor),
            factor * raw_density(shape, frame, *wo, mirrored),
            T::zero(),
        );
        return [density * facet_weight(shape, frame, *wo, wi), density];
    }
    let is_above = T::zero().less(frame.normal.dot(wi)) | T::Mask::splat(!shape.lobe.is_hemispherical());
    if !is_above.any() {
        return [T::zero(), T::zero()];
    }
    let seen = view.seen_lobe(shape);
    let density = raw_density(&seen, frame, *wo, wi);
    let value = density * raw_weight(&seen, frame, *wo, wi);
    [
        T::select(is_above, value, T::zero()),
        T::select(is_above, density, T::zero()),
    ]
}
