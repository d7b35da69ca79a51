// GGX, visible normals sampled by spherical caps. Twin of src/optics/lobe/ggx.rs.
#import "optics/lobe/lobe"

fn ggx_sample(shape: LobeShape, frame: Frame, wo_world: vec3f, xi: vec3f) -> vec3f {
    let alpha = microfacet_alpha(shape);
    let wo = local_from_world(frame, wo_world);
    let stretched = normalize_or(vec3f(wo.xy * alpha, wo.z), UPWARDS);
    let z = (1.0 - xi.y) * (1.0 + stretched.z) - stretched.z;
    let cap = vec3f(safe_sqrt(1.0 - z * z) * unit_circle(xi.x), z) + stretched;
    return world_from_local(frame, mirrored_about(wo, normalize_or(vec3f(cap.xy * alpha, max(cap.z, 0.0)), UPWARDS)));
}

fn ggx_density(shape: LobeShape, frame: Frame, wo: vec3f, wi: vec3f) -> f32 {
    return visible_density(microfacet_alpha(shape), frame, wo, wi);
}

fn ggx_weight(shape: LobeShape, frame: Frame, wo: vec3f, wi: vec3f) -> f32 {
    return visible_weight(microfacet_alpha(shape), frame, wo, wi);
}
