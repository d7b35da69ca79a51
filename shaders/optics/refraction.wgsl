// Refraction at a dielectric interface. Twin of src/optics/refraction.rs, which explains the mathematics.
#import "optics/frame"

struct Refracted {
    wi: vec3f,
    is_total: bool,
}

fn refracted_square(cosine: f32, eta: f32) -> f32 {
    return (eta - 1.0) * (eta + 1.0) + cosine * cosine;
}

fn refracted(wo: vec3f, axis: vec3f, eta: f32) -> Refracted {
    let cosine = dot(wo, axis);
    let square = refracted_square(cosine, eta);
    let is_total = square < 0.0;
    return Refracted(select((axis * (cosine - safe_sqrt(square)) - wo) / eta, -wo, is_total), is_total);
}

fn facet_refracted(wo: vec3f, mirrored: vec3f, eta: f32) -> Refracted {
    return refracted(wo, normalize_or(wo + mirrored, wo), eta);
}

fn refracting_normal(wo: vec3f, wi: vec3f, eta: f32) -> vec3f {
    let sum = wo + wi * eta;
    return select(-sum, sum, eta < 1.0);
}

fn refracting_cosines(wo: vec3f, wi: vec3f, eta: f32) -> vec2f {
    let h = normalize_or(refracting_normal(wo, wi, eta), wo);
    return saturate(vec2f(dot(wo, h), -dot(wi, h)));
}

fn facet_mirror(frame: Frame, wo: vec3f, wi: vec3f, eta: f32) -> vec3f {
    return mirrored_about(wo, normalize_or(refracting_normal(wo, wi, eta), frame.normal));
}

// Factor from the density of the facet's mirror direction of `wo` to the density of `wi`. 0 if no facet refracts one to the
// other, or if `wi` is not below the shading normal's horizon. `along`: the facet's refracting_normal.
fn facet_density_factor(frame: Frame, wo: vec3f, wi: vec3f, eta: f32, along: vec3f) -> f32 {
    let square = max(dot(along, along), 1e-30);
    let h = along / sqrt(square);
    let before = dot(wo, h);
    let behind = -dot(wi, h);
    let is_seen = before > 0.0 && dot(frame.normal, h) > 0.0 && dot(frame.normal, wi) < 0.0 && behind > 0.0;
    return select(0.0, 4.0 * before * eta * eta * behind / square, is_seen);
}
