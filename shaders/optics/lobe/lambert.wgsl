// Lambert's lobe. Twin of src/optics/lobe/lambert.rs.
#import "optics/lobe/lobe"

fn lambert_sample(shape: LobeShape, frame: Frame, wo: vec3f, xi: vec3f) -> vec3f {
    return normalize_or(frame.normal + uniform_sphere(xi.xy), frame.normal);
}

fn lambert_density(shape: LobeShape, frame: Frame, wo: vec3f, wi: vec3f) -> f32 {
    return max(dot(frame.normal, wi), 0.0) * INV_PI;
}

fn lambert_weight(shape: LobeShape, frame: Frame, wo: vec3f, wi: vec3f) -> f32 {
    return 1.0;
}
