//! Sharing of a direction between the specular and the refracting lobe: one facet that both mirrors and refracts, or a
//! mirrored direction that is passed on.

use super::*;
use crate::optics::{
    fresnel::fresnel_left,
    lobe::{Facets, Lobe},
    material::by_index,
    refraction::refracted_square,
};

inlined! {
    /// Lanes where a mirrored direction is sampled first and the rest is passed on: then all weights are 1, however often light
    /// is reflected inside. The lobe's own weights must be 1.
    pub fn passes_on<T: Real>(material: &Material<T>) -> T::Mask {
        material.transmits() & T::Mask::splat(by_index(Lobe::ALL, material.lobe).traits().weighs_one)
    }

    /// Lanes where one facet is sampled, and its Fresnel factor decides between mirroring and refracting: for microfacet lobes
    /// of the same roughness on both sides. So no weight depends on the factor's variation over the facets, which near the
    /// critical angle is from almost none to all (Walter et al. 2007, section 5.3).
    pub fn shares_facets<T: Real>(material: &Material<T>) -> T::Mask {
        let has_facets = by_index(Lobe::ALL, material.lobe).facets() != Facets::None;
        let is_apart = material.transmission_roughness.differs(material.roughness);
        material.transmits() & T::Mask::splat(has_facets) & !is_apart & bends(material)
    }

    /// Lanes whose dielectric bends light. One of index 1 under a film or a cover does not: then no facet can be told from the
    /// directions, and all that the specular lobe does not reflect goes straight on.
    pub fn bends<T: Real>(material: &Material<T>) -> T::Mask {
        material.ior.differs(T::ONE)
    }

    /// Lanes where the Fresnel factor of a sampled direction decides its layer ([`passes_on`], or shared facets); otherwise the
    /// layer is chosen first.
    pub fn decides_by_facet<T: Real>(material: &Material<T>) -> T::Mask {
        passes_on(material) | shares_facets(material)
    }

    /// Probability that a facet mirrors, from the luminances of its reflection and refraction, as in [`sampled_share`].
    pub fn mirrored_share<T: Real>(reflected: T, refracted: T) -> T {
        sampled_share(reflected / (reflected + refracted).max(T::from_f64(1e-20)))
    }

    /// Transmittance of a facet, from the cosines between its normal and the view and the refracted direction.
    pub fn left_by_facet<T: Real>(material: &Material<T>, surface: &Surface<T>, [cosine, behind]: [T; 2]) -> Vec3<T> {
        let terms = material.fresnel_terms(surface.is_inside);
        // Under a cover the reflection has another index than the refraction.
        let is_coated = terms.ior.differs(material.ior_ahead(surface.is_inside));
        let mut behind = behind;
        if is_coated.any() {
            let of_reflection = refracted_square(cosine, terms.ior).safe_sqrt() / terms.ior;
            behind = T::select(is_coated, of_reflection, behind);
        }
        let left = fresnel_left(&terms, cosine, behind);
        material.transmission_tint * left * (material.transmission_weight * (T::ONE - material.metalness))
    }
}
