// GGX, visible normals sampled as by Heitz 2018. Twin of src/optics/lobe/ggx_2018.rs.
#import "optics/lobe/lobe"

fn ggx_2018_sample(shape: LobeShape, frame: Frame, wo_world: vec3f, xi: vec3f) -> vec3f {
    let alpha = microfacet_alpha(shape);
    let wo = local_from_world(frame, wo_world);
    let v = normalize_or(vec3f(wo.xy * alpha, wo.z), UPWARDS);
    let t1 = normalize_or(vec3f(-v.y, v.x, 0.0), vec3f(1.0, 0.0, 0.0));
    let radius = safe_sqrt(xi.x);
    let around = unit_circle(xi.y);
    let p1 = radius * around.x;
    let s = 0.5 * (1.0 + v.z);
    let p2 = (1.0 - s) * safe_sqrt(1.0 - p1 * p1) + s * radius * around.y;
    let n = t1 * p1 + cross(v, t1) * p2 + v * safe_sqrt(1.0 - p1 * p1 - p2 * p2);
    return world_from_local(frame, mirrored_about(wo, normalize_or(vec3f(n.xy * alpha, max(n.z, 0.0)), UPWARDS)));
}

fn ggx_2018_density(shape: LobeShape, frame: Frame, wo: vec3f, wi: vec3f) -> f32 {
    return visible_density(microfacet_alpha(shape), frame, wo, wi);
}

fn ggx_2018_weight(shape: LobeShape, frame: Frame, wo: vec3f, wi: vec3f) -> f32 {
    return visible_weight(microfacet_alpha(shape), frame, wo, wi);
}
