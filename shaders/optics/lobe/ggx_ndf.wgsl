// GGX, all normals sampled in proportion to D cos(theta). Twin of src/optics/lobe/ggx_ndf.rs.
#import "optics/lobe/lobe"

fn ggx_ndf_sample(shape: LobeShape, frame: Frame, wo: vec3f, xi: vec3f) -> vec3f {
    let tilted = vec3f(microfacet_alpha(shape) * sqrt(xi.x / (1.0 - xi.x)) * unit_circle(xi.y), 1.0);
    return world_from_local(frame, mirrored_about(local_from_world(frame, wo), normalize_or(tilted, UPWARDS)));
}

fn ggx_ndf_density(shape: LobeShape, frame: Frame, wo: vec3f, wi: vec3f) -> f32 {
    let f = facet(frame, wo, wi);
    return max(0.25 * ggx_distribution(microfacet_alpha(shape), f.h) * f.h.z / max(f.cosine, 1e-12), 0.0);
}

fn ggx_ndf_weight(shape: LobeShape, frame: Frame, wo: vec3f, wi: vec3f) -> f32 {
    return distribution_weight(microfacet_alpha(shape), facet(frame, wo, wi));
}
