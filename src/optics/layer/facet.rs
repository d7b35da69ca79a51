//! How the specular and the refracting lobe share a direction: where one facet both mirrors and refracts, and where what is
//! not mirrored is passed on.

use crate::optics::fresnel::fresnel_left;
use crate::optics::lobe::{Facets, Lobe};
use crate::optics::material::{Material, Surface, by_index};
use crate::optics::numeric::sampled_share;
use crate::optics::real::{Mask, Real};
use crate::optics::vector::Vec3;

/// True where a mirrored direction is drawn first and what it does not reflect is passed on: then all weights are 1
/// however often light is reflected inside. It takes a lobe whose own weights are 1.
#[inline(always)]
pub fn passes_on<T: Real>(material: &Material<T>) -> T::Mask {
    material.transmits() & T::Mask::splat(by_index(Lobe::ALL, material.lobe).traits().weighs_one)
}

/// True where one facet is drawn, and its Fresnel factor decides whether it mirrors or refracts: where the lobe is made of
/// facets that are as rough seen either way. So no sample's weight depends on how the factor changes over the facets, which
/// near the critical angle it does from almost none to all (Walter et al. 2007, section 5.3).
#[inline(always)]
pub(super) fn shares_facets<T: Real>(material: &Material<T>) -> T::Mask {
    let has_facets = by_index(Lobe::ALL, material.lobe).facets() != Facets::None;
    material.transmits() & T::Mask::splat(has_facets) & !material.transmission_roughness.differs(material.roughness)
}

/// True where the Fresnel factor of a direction that was drawn decides which layer it is of ([`passes_on`], or facets are
/// shared): elsewhere the layer is chosen first.
#[inline(always)]
pub fn decides_by_facet<T: Real>(material: &Material<T>) -> T::Mask {
    passes_on(material) | shares_facets(material)
}

/// How often a facet mirrors, by the luminances of what it mirrors and what it refracts, as [`sampled_share`] says.
#[inline(always)]
pub(super) fn mirrored_share<T: Real>(reflected: T, refracted: T) -> T {
    sampled_share(reflected / (reflected + refracted).max(T::from_f64(1e-20)))
}

/// What a facet refracts of the light, by the cosines between its normal and the view and the refracted direction.
#[inline(always)]
pub(super) fn left_by_facet<T: Real>(
    material: &Material<T>,
    surface: &Surface<T>,
    [cosine, behind]: [T; 2],
) -> Vec3<T> {
    let left = fresnel_left(&material.fresnel_terms(surface.is_inside), cosine, behind);
    material.transmission_tint * left * (material.transmission_weight * (T::one() - material.metalness))
}
