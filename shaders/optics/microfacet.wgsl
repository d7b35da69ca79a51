// Common part of the microfacet lobes. Twin of src/optics/microfacet.rs; local frame, n = +z.
#import "optics/frame"
#import "optics/fresnel"

struct Facet {
    wo: vec3f,
    wi: vec3f,
    h: vec3f,
    // Between h and either direction.
    cosine: f32,
}

fn facet(frame: Frame, wo_world: vec3f, wi_world: vec3f) -> Facet {
    return Facet(
        local_from_world(frame, wo_world),
        local_from_world(frame, wi_world),
        local_from_world(frame, normalize_or(wo_world + wi_world, frame.normal)),
        half_vector_cosine(wo_world, wi_world),
    );
}

fn ggx_distribution(alpha: vec2f, h: vec3f) -> f32 {
    let xy = h.xy / alpha;
    let square = dot(xy, xy) + h.z * h.z;
    return INV_PI / (alpha.x * alpha.y * square * square);
}

fn smith_length(alpha: vec2f, w: vec3f) -> f32 {
    let xy = alpha * w.xy;
    return sqrt(w.z * w.z + dot(xy, xy));
}

fn smith_g1_over_cosine(alpha: vec2f, wo: vec3f) -> f32 {
    return 2.0 / max(abs(wo.z) + smith_length(alpha, wo), 1e-12);
}

fn smith_g2_over_cosine(alpha: vec2f, wo: vec3f, wi: vec3f) -> f32 {
    let sum = wo.z * smith_length(alpha, wi) + wi.z * smith_length(alpha, wo);
    return select(0.0, 2.0 * wi.z / max(sum, 1e-12), wo.z > 0.0 && wi.z > 0.0);
}

fn visible_density(alpha: vec2f, frame: Frame, wo: vec3f, wi: vec3f) -> f32 {
    let f = facet(frame, wo, wi);
    return select(0.0, 0.25 * ggx_distribution(alpha, f.h) * smith_g1_over_cosine(alpha, f.wo), f.h.z > 0.0);
}

fn visible_weight(alpha: vec2f, frame: Frame, wo_world: vec3f, wi_world: vec3f) -> f32 {
    let wo = local_from_world(frame, wo_world);
    return smith_g2_over_cosine(alpha, wo, local_from_world(frame, wi_world)) / smith_g1_over_cosine(alpha, wo);
}

fn distribution_weight(alpha: vec2f, f: Facet) -> f32 {
    return smith_g2_over_cosine(alpha, f.wo, f.wi) * f.cosine / max(f.h.z, 1e-6);
}
