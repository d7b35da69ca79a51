//! The lobes behind one interface, and their registry.
//!
//! A lobe module has three functions. `sample` turns uniform numbers into a direction to the light; `density` is the density
//! of `sample`'s results, per steradian over the whole sphere; `weight` is evaluate/density, the factor of a sample. The
//! horizon policy is common to all lobes ([`lobe_sample`]).
//!
//! To add a lobe: one Rust file with its [`LobeTraits`], one WGSL file of the same name, one line in the registry below.

pub mod model;

use super::{
    curve::Curve,
    frame::{Frame, local_from_world},
    microfacet::{Alpha, facet, smith_g1_over_cosine},
    refraction::{facet_density_factor, facet_mirror, facet_refracted, refracted, refracting_normal},
};
use crate::named::named;
use crate::optics::prelude::*;

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
                "Perfectly diffuse: equally bright from everywhere, at any roughness.";
        }
    };
}
pub use crate::lobe_list as list;

macro_rules! lobes {
    ($($module:ident $variant:ident = $index:literal, $name:literal, $label:literal, $help:literal;)*) => {
        $(pub mod $module;)*

        named! {
            Lobe {
                $($variant = $index, $name, $label, $help;)*
            }
        }

        impl Lobe {
            /// The name of its Rust module and WGSL file, and the prefix of its WGSL functions.
            pub fn module(self) -> &'static str {
                match self { $(Lobe::$variant => stringify!($module),)* }
            }
            pub const fn traits(self) -> LobeTraits {
                match self { $(Lobe::$variant => $module::TRAITS,)* }
            }
        }

        /// The direction that the lobe itself draws, on either side of the horizon.
        pub fn raw_sample<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, xi: [T; 3]) -> Vec3<T> {
            vectorized!(T, match shape.lobe { $(Lobe::$variant => $module::sample(shape, frame, wo, xi),)* })
        }

        /// The density of [`raw_sample`], per steradian, not negative.
        pub fn raw_density<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, wi: Vec3<T>) -> T {
            vectorized!(T, match shape.lobe { $(Lobe::$variant => $module::density(shape, frame, wo, wi),)* })
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
    pub const fn is_hemispherical(self) -> bool {
        self.traits().is_hemispherical
    }

    /// See [`LobeTraits::is_anisotropic`].
    pub const fn is_anisotropic(self) -> bool {
        self.traits().is_anisotropic
    }

    /// See [`LobeTraits::facets`].
    pub const fn facets(self) -> Facets {
        self.traits().facets
    }

    /// See [`LobeTraits::has_curves`].
    pub const fn has_curves(self) -> bool {
        self.traits().has_curves
    }

    /// The curves that affect the lobe; a single one if none does.
    pub fn curves(self) -> &'static [Curve] {
        if self.has_curves() { Curve::ALL } else { &[Curve::Sqrt] }
    }

    /// True if the lobe depends on roughness.
    pub fn has_roughness(self) -> bool {
        self.traits().width != Width::Fixed
    }
}

/// Properties of a lobe, stated in its own file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeTraits {
    /// True if the model loses samples below the shading normal's horizon; otherwise the horizon policy decides.
    pub is_hemispherical: bool,
    /// True if it depends on anisotropy.
    pub is_anisotropic: bool,
    /// Whether it is made of facets, each of which refracts by itself.
    pub facets: Facets,
    /// Dependence of its width.
    pub width: Width,
    /// True if it is a ball around the mirror direction whose radius follows a curve D(ξ): for D ≤ 1 no sample is lower
    /// above the surface than (1 − R)(n·r − R).
    pub has_curves: bool,
    /// True if evaluate over density is always 1. Then the light that a mirror does not reflect is passed on to the layers
    /// below, and the mirror policy loses no light.
    pub weighs_one: bool,
    /// True if it loses the light that meets a second facet, which [`scattering`](super::scattering) gives back.
    pub loses_light: bool,
    /// Radius about the mirror direction, in radians per roughness, that plots omit: the density has an integrable
    /// singularity there.
    pub peak: f64,
}

/// Dependence of a lobe's angular width.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// Constant width.
    Fixed,
    /// Proportional to roughness.
    Roughness,
    /// Proportional to its square, α: the roughness of GGX, for which textures and files are made.
    Alpha,
}

inlined! {
    /// The angular width of a lobe, near enough.
    pub fn lobe_width<T: Real>(lobe: Lobe, roughness: T) -> T {
        match lobe.traits().width {
            Width::Fixed => T::ONE,
            Width::Roughness => roughness,
            Width::Alpha => roughness * roughness,
        }
    }

    /// Roughness of a lobe that is as wide as a microfacet refraction of this roughness. Facets turn refracted light by |1 −
    /// 1/η| of their tilt, mirrored light by twice the tilt (mathematics, section 7).
    pub fn refracting_roughness<T: Real>(lobe: Lobe, roughness: T, eta: T) -> T {
        let share = (T::ONE - T::ONE / eta).abs() * T::HALF;
        match lobe.traits().width {
            Width::Fixed => roughness,
            Width::Roughness => refracting_roughness_of(roughness, share),
            Width::Alpha => roughness * share.sqrt(),
        }
        .min(T::ONE)
    }

    /// The roughness at which a lobe whose width goes with it is as wide as facets make it that turn the light by this share.
    fn refracting_roughness_of<T: Real>(roughness: T, share: T) -> T {
        let number = T::from_f64;
        let square = roughness * roughness;
        let tilt = roughness * number(3.0) + square * number(3.2) + square * square * number(2.2);
        let turn = share * tilt;
        // The positive root of 4 x² + 3 x = turn, written without cancellation.
        let root = (number(9.0) + number(16.0) * turn).sqrt();
        (turn + turn) / (number(3.0) + root)
    }
}

named! {
    /// Horizon policy: treatment of samples below the surface.
    Horizon {
        Mirror = 0, "mirror", "Mirror", "They are reflected at the surface: no light is lost.";
        Absorb = 1, "absorb", "Absorb", "They are lost: the surface darkens towards grazing angles.";
        None = 2, "none", "None", "They go through the surface: for plots of the lobe itself.";
    }
}

/// Sampling of a microfacet lobe's facets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Facets {
    None = 0,
    /// Visible facets, in proportion to D G1 (wo·h)/cosθo.
    Visible = 1,
    /// All facets, in proportion to D cosθh.
    All = 2,
}

/// Parameters of a lobe, besides directions.
#[derive(Clone, Copy, Debug)]
pub struct LobeShape<'a, T> {
    /// Model of the lobe.
    pub lobe: Lobe,
    /// The geometric lobe's curve.
    pub curve: Curve,
    /// The policy below the horizon.
    pub horizon: Horizon,
    /// Perceptual roughness in [0, 1]: the geometric lobe's R; its square is the microfacet lobes' α.
    pub roughness: T,
    /// Stretch along the tangent in [−1, 1]; 0 is isotropic.
    pub anisotropy: T,
    /// Relative index of refraction, behind over before the surface; 0 for reflection.
    pub eta: T,
    /// Table of the custom curve; empty for a named curve.
    pub table: &'a [f32],
}

impl<T: Real> LobeShape<'_, T> {
    /// True if the lobe refracts, in all lanes or none.
    #[inline(always)]
    pub fn refracts(&self) -> bool {
        self.eta.differs(T::ZERO).any()
    }
}

/// A direction drawn from a lobe.
#[derive(Clone, Copy, Debug)]
pub struct LobeSample<T> {
    /// Unit direction to the light, above the geometric horizon; below it under [`Horizon::None`], or if absorbed.
    pub wi: Vec3<T>,
    /// Evaluate over density; 0 if absorbed.
    pub weight: T,
}

/// The smallest α of the microfacet lobes and roughness of the cosine powers: a cone of a hundredth of a degree.
pub const ALPHA_MIN: f64 = 0.0001;

/// Below this angular width (R or α) light sampling cannot help and f32 densities lose digits: the lobe still samples,
/// but is weighed as a mirror.
pub const MIRROR_WIDTH: f64 = 0.001;

inlined! {
    /// α of the microfacet lobes.
    pub fn alpha_from_roughness<T: Real>(roughness: T) -> T {
        (roughness * roughness).max(T::from_f64(ALPHA_MIN))
    }

    /// Scale of the widths along tangent and bitangent: √((1 + s)/(1 − s)), s = 0.9 × anisotropy, so that the product of both is
    /// unchanged.
    pub fn stretch_from_anisotropy<T: Real>(anisotropy: T) -> T {
        let s = T::from_f64(0.9) * anisotropy.clamp(-T::ONE, T::ONE);
        ((T::ONE + s) / (T::ONE - s)).sqrt()
    }

    /// The widths of a shape, anisotropy applied.
    pub fn microfacet_alpha<T: Real>(shape: &LobeShape<'_, T>) -> Alpha<T> {
        let alpha = alpha_from_roughness(shape.roughness);
        let stretch = stretch_from_anisotropy(shape.anisotropy);
        Alpha {
            x: alpha * stretch,
            y: alpha / stretch,
        }
    }

    /// Equal widths.
    pub fn isotropic_alpha<T: Real>(shape: &LobeShape<'_, T>) -> Alpha<T> {
        let alpha = alpha_from_roughness(shape.roughness);
        Alpha { x: alpha, y: alpha }
    }
}

/// Anisotropy in [0, 1] with this ratio of the narrower width to the wider one; 1 for smaller ratios.
pub fn anisotropy_from_ratio(ratio: f64) -> f64 {
    ((1.0 - ratio) / (0.9 * (1.0 + ratio))).clamp(0.0, 1.0)
}

inlined! {
    /// Lanes where the lobe is so narrow that it counts as a mirror ([`MIRROR_WIDTH`]). Facets turn the refracted direction by
    /// |1 − 1/η| of their tilt: for similar indices, light passes straight through.
    pub fn is_mirror<T: Real>(shape: &LobeShape<'_, T>) -> T::Mask {
        let mut width = lobe_width(shape.lobe, shape.roughness);
        if refracts_at_facets(shape) {
            width = width * (T::ONE - T::ONE / shape.eta).abs();
        } else if shape.refracts() {
            width = lobe_width(shape.lobe, refracting_roughness(shape.lobe, shape.roughness, shape.eta));
        }
        width.less(T::from_f64(MIRROR_WIDTH))
    }

    /// Lanes where the lobe refracts facet by facet.
    pub fn refracts_at_facets<T: Real>(shape: &LobeShape<'_, T>) -> bool {
        shape.refracts() && shape.lobe.facets() != Facets::None
    }
}

/// Evaluate over density of a direction refracted at a facet, without the Fresnel factor: Smith's masking of both
/// directions, separately as they are on different sides, over that of the sampled normals. 0 if `wi` is not below the
/// shading normal's horizon. `mirrored`: [`facet_mirror`].
#[inline(always)]
pub fn facet_weight<T: Real>(
    shape: &LobeShape<'_, T>,
    frame: &Frame<T>,
    wo: Vec3<T>,
    wi: Vec3<T>,
    mirrored: Vec3<T>,
) -> T {
    let alpha = if shape.lobe.is_anisotropic() {
        microfacet_alpha(shape)
    } else {
        isotropic_alpha(shape)
    };
    let (wo_local, wi_local) = (local_from_world(frame, wo), local_from_world(frame, wi));
    let mut weight = smith_g1_over_cosine(alpha, wi_local) * wi_local.z.abs();
    if shape.lobe.facets() == Facets::All {
        // Of the mirror direction, as in the density: otherwise facets near the horizon differ by the rounding of their height.
        let facet = facet(frame, wo, mirrored);
        let ratio = facet.cosine / facet.h.z.max(T::from_f64(1e-6));
        // Normals on the far side of the facets are drawn too; the viewer sees none of them.
        let ratio = ratio.masked(facet.h.z.above_zero());
        weight = weight * smith_g1_over_cosine(alpha, wo_local) * ratio;
    }
    let is_behind = wi_local.z.below_zero() & wo_local.z.above_zero();
    // What nothing bends meets no facet.
    let weight = T::select(shape.eta.differs(T::ONE), weight, T::ONE);
    weight.masked(is_behind)
}

/// View of a lobe; if it refracts as a whole, that of a viewer behind the surface.
#[derive(Clone, Copy, Debug)]
pub struct LobeView<T> {
    /// Shading frame on the lobe's side; on the viewer's side if facets refract.
    pub frame: Frame<T>,
    /// The geometric normal on the side that the lobe fills.
    pub normal: Vec3<T>,
    /// Unit direction to the viewer whose mirror direction is the lobe's centre; the real viewer if facets refract.
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

/// View in which a refracting lobe is a reflecting one. Facets refract individually, so only the side changes. Any other
/// lobe is centred on the refracted direction: the reflection seen by a viewer behind the surface, whose mirror direction
/// that is, by a lobe as narrow as facets would make it ([`refracting_roughness`]; mathematics, section 7). Under total
/// reflection, and for `eta` 0, the lobe reflects.
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

/// Centre of the lobe: the mirror direction, or the refracted one. Beyond the critical angle a microfacet lobe has none, and
/// its remainder is on the other side of the view.
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

/// Samples a direction. `surface_normal` is the geometric normal, on the side of `wo`. Its horizon is decisive, so that no
/// reflected ray enters the surface, and no refracted one stays outside, under a leaning shading normal. Source of the
/// mirror policy: mathematics, section 3.
pub fn lobe_sample<T: Real>(
    shape: &LobeShape<'_, T>,
    frame: &Frame<T>,
    surface_normal: Vec3<T>,
    wo: Vec3<T>,
    xi: [T; 3],
) -> LobeSample<T> {
    lobe_sample_density(shape, frame, surface_normal, wo, xi, false).0
}

/// [`lobe_sample`] with the density of [`lobe_evaluate`] for what it draws, if that is needed, else 0.
pub fn lobe_sample_density<T: Real>(
    shape: &LobeShape<'_, T>,
    frame: &Frame<T>,
    surface_normal: Vec3<T>,
    wo: Vec3<T>,
    xi: [T; 3],
    needs_density: bool,
) -> (LobeSample<T>, T) {
    out_of_line!(T, {
        let view = lobe_view(shape, frame, surface_normal, wo);
        let seen = view.seen_lobe(shape);
        let mut raw = raw_sample(&seen, &view.frame, view.wo, xi);
        let weight = if refracts_at_facets(shape) {
            let facet = facet_refracted(wo, raw, shape.eta);
            raw = facet.wi;
            // Not the sampled one, so that the weight is exactly evaluate over density.
            let mirrored = facet_mirror(frame, wo, raw, shape.eta);
            let weight = facet_weight(shape, frame, wo, raw, mirrored);
            T::select(facet.is_total, T::ZERO, weight)
        } else {
            let weight = raw_weight(&seen, &view.frame, view.wo, raw);
            let is_lost = !view.frame.normal.dot(raw).above_zero();
            if shape.lobe.is_hemispherical() {
                T::select(is_lost, T::ZERO, weight)
            } else {
                weight
            }
        };
        let below = view.normal.dot(raw).below_zero();
        let drawn = match shape.horizon {
            // A lost sample keeps its direction, which identifies its facet.
            Horizon::Mirror => LobeSample {
                wi: Vec3::select(below & weight.above_zero(), raw.reflected_at_plane(view.normal), raw),
                weight,
            },
            Horizon::Absorb => LobeSample {
                wi: raw,
                weight: T::select(below, T::ZERO, weight),
            },
            Horizon::None => LobeSample { wi: raw, weight },
        };
        let mut density = T::ZERO;
        if needs_density {
            [_, density] = kept_evaluate(shape, &view, drawn.wi, false);
        }
        (drawn, density)
    })
}

/// (evaluate, density) of [`lobe_sample`] for a direction: evaluate includes the cosine, density is per steradian, of kept
/// samples. Both 0 on the side that the lobe does not fill, except under [`Horizon::None`].
pub fn lobe_evaluate<T: Real>(
    shape: &LobeShape<'_, T>,
    frame: &Frame<T>,
    surface_normal: Vec3<T>,
    wo: Vec3<T>,
    wi: Vec3<T>,
) -> [T; 2] {
    out_of_line!(T, {
        let view = lobe_view(shape, frame, surface_normal, wo);
        kept_evaluate(shape, &view, wi, true)
    })
}

inlined! {
    /// (evaluate, density) of a view; evaluate is 0 if it is not needed.
    fn kept_evaluate<T: Real>(shape: &LobeShape<'_, T>, view: &LobeView<T>, wi: Vec3<T>, needs_value: bool) -> [T; 2] {
        // One that comes from below is added by the mirror policy. A loop, so that the code is there once.
        let directions = [wi, wi.reflected_at_plane(view.normal)];
        let count = if shape.horizon == Horizon::Mirror { 2 } else { 1 };
        let mut sums = [T::ZERO; 2];
        for direction in &directions[..count] {
            let [value, density] = raw_evaluate(shape, view, *direction, needs_value);
            sums = [sums[0] + value, sums[1] + density];
        }
        if shape.horizon == Horizon::None {
            return sums;
        }
        let visible = view.normal.dot(wi).above_zero();
        mapped!([sums[0], sums[1]], |sum| sum.masked(visible))
    }

    /// (evaluate, density) before the horizon policy.
    fn raw_evaluate<T: Real>(shape: &LobeShape<'_, T>, view: &LobeView<T>, wi: Vec3<T>, needs_value: bool) -> [T; 2] {
        let LobeView { frame, wo, .. } = view;
        if refracts_at_facets(shape) {
            let along = refracting_normal(*wo, wi, shape.eta);
            let mirrored = facet_mirror(frame, *wo, wi, shape.eta);
            let factor = facet_density_factor(frame, *wo, wi, shape.eta, along);
            let density = (factor * raw_density(shape, frame, *wo, mirrored)).masked(factor.above_zero());
            if !needs_value {
                return [T::ZERO, density];
            }
            return [density * facet_weight(shape, frame, *wo, wi, mirrored), density];
        }
        let is_above = frame.normal.dot(wi).above_zero() | T::Mask::splat(!shape.lobe.is_hemispherical());
        if !is_above.any() {
            return [T::ZERO, T::ZERO];
        }
        let seen = view.seen_lobe(shape);
        let density = raw_density(&seen, frame, *wo, wi).masked(is_above);
        if !needs_value {
            return [T::ZERO, density];
        }
        [(density * raw_weight(&seen, frame, *wo, wi)).masked(is_above), density]
    }
}
