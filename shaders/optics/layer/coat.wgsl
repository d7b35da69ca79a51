// A clear dielectric coat over everything else. Twin of src/optics/layer/coat.rs.
#import "optics/albedo"
#import "optics/layer/registry"
#import "optics/material"

fn coat_is_there(material: Material, surface: Surface) -> bool {
    return PLAN_COAT == 1u && material.coat_weight > 0.0 && !is_within(material, surface);
}

fn coat_lobe(material: Material, surface: Surface) -> LayerLobe {
    return LayerLobe(coat_shape(material), frame_from_normal(surface.coat_normal));
}

fn coat_shape(material: Material) -> LobeShape {
    return LobeShape(LOBE_GEOMETRIC, CURVE_SMOOTH, HORIZON_MIRROR, 0u, material.coat_roughness, 0.0, 0.0);
}

fn coat_albedo(material: Material, surface: Surface, left: vec3f) -> LayerAlbedo {
    let cosine = dot(surface.coat_normal, surface.wo);
    let share = material.coat_weight * albedo_lookup(material.coat_table, cosine).x;
    let color = mix(vec3f(1.0), material.coat_color, material.coat_weight);
    return LayerAlbedo(vec3f(share), color * max(1.0 - share, 0.0));
}

fn coat_toward(material: Material, layers: Layers, surface: Surface, shape: LobeShape, wi: vec3f) -> LayerToward {
    return LayerToward(vec3f(1.0), layers.coat.probability);
}

fn coat_refined_sample(material: Material, surface: Surface, xi: vec3f, drawn: LobeSample) -> LobeSample {
    return LobeSample(drawn.wi, coat_fresnel(material, surface.wo, drawn.wi) * drawn.weight);
}

fn coat_refined(material: Material, surface: Surface, wi: vec3f, evaluated: vec2f) -> vec2f {
    return vec2f(evaluated.x * coat_fresnel(material, surface.wo, wi), evaluated.y);
}

fn coat_fresnel(material: Material, wo: vec3f, wi: vec3f) -> f32 {
    return material.coat_weight * fresnel_dielectric(half_vector_cosine(wo, wi), material.coat_ior);
}
