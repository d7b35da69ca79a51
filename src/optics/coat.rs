//! A clear dielectric coat over everything else: OpenPBR's coat, glTF's clearcoat.
//!
//! It reflects by the isotropic geometric lobe with the curve `smooth`, whatever lobe is below, under the exact equations
//! of a dielectric. What it does not reflect on average reaches what is below, tinted by its colour: coat + (1 − albedo of
//! the coat) · colour · below, so that no energy is made (the layering of OpenPBR 1.1, section on the coat). It does not
//! roughen what is seen through it, and lies smooth over a normal texture. From within a solid it is not there.

use super::albedo::albedo_lookup;
use super::curve::Curve;
use super::frame::frame_from_normal;
use super::fresnel::{fresnel_dielectric, half_vector_cosine};
use super::lobe::{Horizon, Lobe, LobeShape, is_mirror, lobe_evaluate, lobe_sample};
use super::material::{Layer, Material, MaterialSample, Surface};
use super::numeric::sampled_share;
use super::real::{Mask, Real};
use super::vector::Vec3;

impl<T: Real> Material<T> {
    /// True where this side of the surface has a coat.
    #[inline(always)]
    pub fn has_coat(&self, surface: &Surface<T>) -> T::Mask {
        T::zero().less(self.coat_weight) & !(surface.is_inside & self.transmits())
    }
}

/// The coat's lobe.
#[inline(always)]
pub fn coat_shape<T: Real>(material: &Material<T>) -> LobeShape<'static, T> {
    LobeShape {
        lobe: Lobe::Geometric,
        curve: Curve::Smooth,
        horizon: Horizon::Mirror,
        roughness: material.coat_roughness,
        anisotropy: T::zero(),
        eta: T::zero(),
        table: &[],
    }
}

/// What the coat reflects of this view, in [0, 1].
#[inline(always)]
pub fn coat_share<T: Real>(material: &Material<T>, tables: &[f32], surface: &Surface<T>) -> T {
    let has_coat = material.has_coat(surface);
    if !has_coat.any() {
        return T::zero();
    }
    let cosine = surface.coat_normal.dot(surface.wo);
    let share = material.coat_weight * albedo_lookup(tables, material.coat_table, cosine).x;
    T::select(has_coat, share, T::zero())
}

/// What a coat that reflects `share` leaves of the light that the layers below it reflect.
#[inline(always)]
pub fn coat_transmittance<T: Real>(material: &Material<T>, surface: &Surface<T>, share: T) -> Vec3<T> {
    let white = Vec3::splat(T::one());
    let has_coat = material.has_coat(surface);
    if !has_coat.any() {
        return white;
    }
    let left = white.mix(material.coat_color, material.coat_weight) * (T::one() - share).max(T::zero());
    Vec3::select(has_coat, left, white)
}

/// How often the coat is sampled where it reflects `share` and what is below would reflect `below`: as [`sampled_share`]
/// says; always where there is nothing below.
#[inline(always)]
pub fn coat_probability<T: Real>(share: T, below: T) -> T {
    let (zero, one) = (T::zero(), T::one());
    let rest = (one - share) * below;
    let probability = sampled_share(share / (share + rest).max(T::from_f64(1e-9)));
    let probability = T::select(zero.less(rest), probability, one);
    T::select(zero.less(share), probability, zero)
}

/// The share that the coat reflects into a direction of its lobe.
#[inline(always)]
fn coat_fresnel<T: Real>(material: &Material<T>, wo: Vec3<T>, wi: Vec3<T>) -> T {
    material.coat_weight * fresnel_dielectric(half_vector_cosine(wo, wi), material.coat_ior)
}

/// Draws a direction from the coat, which was chosen with this probability.
#[inline(always)]
pub fn coat_sample<T: Real>(
    material: &Material<T>,
    surface: &Surface<T>,
    xi: [T; 3],
    probability: T,
    wants_density: bool,
) -> MaterialSample<T> {
    let shape = coat_shape(material);
    let frame = frame_from_normal(surface.coat_normal);
    let drawn = lobe_sample(&shape, &frame, surface.normal, surface.wo, xi);
    let is_mirror = is_mirror(&shape);
    let mut density = T::zero();
    if wants_density && !is_mirror.all() {
        let [_, of_shape] = lobe_evaluate(&shape, &frame, surface.normal, surface.wo, drawn.wi);
        density = T::select(is_mirror, T::zero(), probability * of_shape);
    }
    let reflected = coat_fresnel(material, surface.wo, drawn.wi);
    MaterialSample {
        wi: drawn.wi,
        throughput: Vec3::splat(reflected * drawn.weight / probability.max(T::from_f64(1e-20))),
        density,
        is_mirror,
        layer: Layer::Coat,
    }
}

/// (evaluate, density) of the coat for a direction; both 0 where it is weighed as a mirror.
#[inline(always)]
pub fn coat_evaluate<T: Real>(material: &Material<T>, surface: &Surface<T>, wi: Vec3<T>) -> [T; 2] {
    let shape = coat_shape(material);
    let is_mirror = is_mirror(&shape);
    if is_mirror.all() {
        return [T::zero(), T::zero()];
    }
    let frame = frame_from_normal(surface.coat_normal);
    let [value, density] = lobe_evaluate(&shape, &frame, surface.normal, surface.wo, wi);
    let value = value * coat_fresnel(material, surface.wo, wi);
    [
        T::select(is_mirror, T::zero(), value),
        T::select(is_mirror, T::zero(), density),
    ]
}
