// Blinn-Phong as a microfacet lobe. Twin of src/optics/lobe/blinn_phong.rs.
#import "optics/lobe/lobe"

fn blinn_phong_exponent(roughness: f32) -> f32 {
    let alpha = alpha_from_roughness(roughness);
    return max(2.0 / (alpha * alpha) - 2.0, 0.0);
}

fn blinn_phong_sample(shape: LobeShape, frame: Frame, wo: vec3f, xi: vec3f) -> vec3f {
    let power = log(1.0 - xi.x) / (blinn_phong_exponent(shape.roughness) + 2.0);
    let h = vec3f(safe_sqrt(-expm1(2.0 * power)) * unit_circle(xi.y), exp(power));
    return world_from_local(frame, mirrored_about(local_from_world(frame, wo), h));
}

fn blinn_phong_density(shape: LobeShape, frame: Frame, wo: vec3f, wi: vec3f) -> f32 {
    let f = facet(frame, wo, wi);
    let n = blinn_phong_exponent(shape.roughness);
    // Logarithm of the cosine; for narrow lobes from sin^2 by the tangential components.
    let sine2 = dot(f.h.xy, f.h.xy);
    let power = exp((n + 1.0) * select(log(max(f.h.z, 1e-30)), 0.5 * log1p(-min(sine2, 0.5)), sine2 < 0.5));
    return select(0.0, (n + 2.0) * (0.125 * INV_PI) * power / max(f.cosine, 1e-12), f.h.z > 0.0);
}

fn blinn_phong_weight(shape: LobeShape, frame: Frame, wo: vec3f, wi: vec3f) -> f32 {
    return distribution_weight(isotropic_alpha(shape), facet(frame, wo, wi));
}
