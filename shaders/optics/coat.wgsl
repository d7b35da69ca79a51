// A clear dielectric coat over everything else. Twin of src/optics/coat.rs.
#import "optics/albedo"
#import "optics/material"
#import "optics/numeric"

fn material_has_coat(material: Material, surface: Surface) -> bool {
    return PLAN_COAT == 1u && material.coat_weight > 0.0 && !(surface.is_inside && material_transmits(material));
}

fn coat_shape(material: Material) -> LobeShape {
    return LobeShape(LOBE_GEOMETRIC, CURVE_SMOOTH, HORIZON_MIRROR, 0u, material.coat_roughness, 0.0, 0.0);
}

fn coat_share(material: Material, surface: Surface) -> f32 {
    if !material_has_coat(material, surface) {
        return 0.0;
    }
    return material.coat_weight * albedo_lookup(material.coat_table, dot(surface.coat_normal, surface.wo)).x;
}

fn coat_transmittance(material: Material, surface: Surface, share: f32) -> vec3f {
    if !material_has_coat(material, surface) {
        return vec3f(1.0);
    }
    return mix(vec3f(1.0), material.coat_color, material.coat_weight) * max(1.0 - share, 0.0);
}

fn coat_probability(share: f32, below: f32) -> f32 {
    let rest = (1.0 - share) * below;
    let probability = sampled_share(share / max(share + rest, 1e-9));
    return select(0.0, select(1.0, probability, rest > 0.0), share > 0.0);
}

fn coat_fresnel(material: Material, wo: vec3f, wi: vec3f) -> f32 {
    return material.coat_weight * fresnel_dielectric(half_vector_cosine(wo, wi), material.coat_ior);
}
