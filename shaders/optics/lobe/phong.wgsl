// The modified Phong lobe (Lafortune and Willems 1994). Twin of src/optics/lobe/phong.rs.
#import "optics/lobe/lobe"

fn phong_exponent(roughness: f32) -> f32 {
    let alpha = alpha_from_roughness(roughness);
    return max(0.5 / (alpha * alpha) - 0.5, 0.0);
}

fn phong_sample(shape: LobeShape, frame: Frame, wo: vec3f, xi: vec3f) -> vec3f {
    let power = log(1.0 - xi.x) / (phong_exponent(shape.roughness) + 1.0);
    let around_mirror = frame_from_normal(mirrored_about(wo, frame.normal));
    return world_from_local(around_mirror, vec3f(safe_sqrt(-expm1(2.0 * power)) * unit_circle(xi.y), exp(power)));
}

fn phong_density(shape: LobeShape, frame: Frame, wo: vec3f, wi: vec3f) -> f32 {
    let apart = wi - mirrored_about(wo, frame.normal);
    // 1 - cos(alpha) from the difference of the two directions: exact for narrow lobes.
    let versine = 0.5 * dot(apart, apart);
    let in_lobe = versine < 1.0;
    let n = phong_exponent(shape.roughness);
    return select(0.0, (n + 1.0) * (0.5 * INV_PI) * exp(n * log1p(-select(0.0, versine, in_lobe))), in_lobe);
}

fn phong_weight(shape: LobeShape, frame: Frame, wo: vec3f, wi: vec3f) -> f32 {
    let n = phong_exponent(shape.roughness);
    return (n + 2.0) / (n + 1.0) * max(dot(frame.normal, wi), 0.0);
}
