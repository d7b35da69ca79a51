// GGX, all normals sampled in proportion to D cos(theta). Twin of src/optics/lobe/ggx_ndf.rs.
#import "optics/lobe/lobe"

fn ggx_ndf_sample(shape: LobeShape, frame: Frame, wo: vec3f, xi: vec3f) -> vec3f {
    let alpha = microfacet_alpha(shape);
    let slope = sqrt(xi.x / (1.0 - xi.x));
    let tilted = vec3f(alpha * slope * unit_circle(xi.y), 1.0);
    let h = normalize_or(tilted, vec3f(0.0, 0.0, 1.0));
    return world_from_local(frame, mirrored_about(local_from_world(frame, wo), h));
}

fn ggx_ndf_density(shape: LobeShape, frame: Frame, wo: vec3f, wi: vec3f) -> f32 {
    let f = facet(frame, wo, wi);
    let value = 0.25 * ggx_distribution(microfacet_alpha(shape), f.h) * f.h.z / max(f.cosine, 1e-12);
    return max(value, 0.0);
}

fn ggx_ndf_weight(shape: LobeShape, frame: Frame, wo: vec3f, wi: vec3f) -> f32 {
    return distribution_weight(microfacet_alpha(shape), facet(frame, wo, wi));
}
