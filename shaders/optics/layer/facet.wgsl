// Sharing of a direction between the specular and the refracting lobe. Twin of src/optics/layer/facet.rs.
#import "optics/material"

fn passes_on(material: Material) -> bool {
    return material_transmits(material) && weighs_one(planned(material.lobe, PLAN_LOBE));
}

// One facet is drawn that mirrors or refracts, as its Fresnel factor has it.
fn shares_facets(material: Material) -> bool {
    return material_transmits(material) && facets(planned(material.lobe, PLAN_LOBE)) != FACETS_NONE
        && material.transmission_roughness == material.roughness && bends(material);
}

fn bends(material: Material) -> bool {
    return material.ior != 1.0;
}

fn decides_by_facet(material: Material) -> bool {
    return passes_on(material) || shares_facets(material);
}

fn mirrored_share(reflected: f32, refracted: f32) -> f32 {
    return sampled_share(reflected / max(reflected + refracted, 1e-20));
}

fn left_by_facet(material: Material, surface: Surface, cosines: vec2f) -> vec3f {
    let terms = material_fresnel_terms(material, surface.is_inside);
    var behind = cosines.y;
    // Under a cover the reflection has another index than the refraction.
    if PLAN_COAT && terms.ior != material_ior_ahead(material, surface.is_inside) {
        behind = safe_sqrt(refracted_square(cosines.x, terms.ior)) / terms.ior;
    }
    let left = fresnel_left(terms, cosines.x, behind);
    return material.transmission_tint * left * (material.transmission_weight * (1.0 - material.metalness));
}
