// What all lobes share, and what happens below the horizon. Twin of src/optics/lobe/mod.rs.
// raw_sample, raw_density, raw_weight, is_hemispherical and LOBE_* are generated from the registry.
#import "optics/frame"
#import "optics/lobe/registry"

const HORIZON_MIRROR: u32 = 0u;
const HORIZON_ABSORB: u32 = 1u;
const HORIZON_NONE: u32 = 2u;
const ALPHA_MIN: f32 = 1e-4;
const MIRROR_WIDTH: f32 = 1e-3;

struct LobeShape {
    lobe: u32,
    curve: u32,
    horizon: u32,
    // Index of the custom curve in `tables`.
    table: u32,
    roughness: f32,
    anisotropy: f32,
}

struct LobeSample {
    wi: vec3f,
    weight: f32,
}

fn alpha_from_roughness(roughness: f32) -> f32 {
    return max(roughness * roughness, ALPHA_MIN);
}

fn stretch_from_anisotropy(anisotropy: f32) -> f32 {
    let s = 0.9 * clamp(anisotropy, -1.0, 1.0);
    return sqrt((1.0 + s) / (1.0 - s));
}

fn is_mirror(shape: LobeShape) -> bool {
    var width = shape.roughness * shape.roughness;
    if shape.lobe == LOBE_GEOMETRIC { width = shape.roughness; }
    if shape.lobe == LOBE_LAMBERT { width = 1.0; }
    return width < MIRROR_WIDTH;
}

fn lobe_sample(shape: LobeShape, frame: Frame, surface_normal: vec3f, wo: vec3f, xi: vec3f) -> LobeSample {
    let raw = raw_sample(shape, frame, wo, xi);
    var weight = raw_weight(shape, frame, wo, raw);
    if is_hemispherical(shape.lobe) {
        weight = select(0.0, weight, dot(frame.normal, raw) > 0.0);
    }
    let below = dot(surface_normal, raw) < 0.0;
    switch shape.horizon {
        case HORIZON_MIRROR: { return LobeSample(select(raw, reflected_at_plane(raw, surface_normal), below), weight); }
        case HORIZON_ABSORB: { return LobeSample(raw, select(weight, 0.0, below)); }
        default: { return LobeSample(raw, weight); }
    }
}

// (evaluate, density), the cosine included.
fn lobe_evaluate(shape: LobeShape, frame: Frame, surface_normal: vec3f, wo: vec3f, wi: vec3f) -> vec2f {
    if shape.horizon != HORIZON_NONE && !(dot(surface_normal, wi) > 0.0) {
        return vec2f(0.0);
    }
    // A loop, so that the lobes' code is there once: drivers inline, and compile in more than proportion to the size.
    var result = vec2f(0.0);
    var direction = wi;
    let count = select(1u, 2u, shape.horizon == HORIZON_MIRROR);
    for (var i = 0u; i < count; i++) {
        result += raw_evaluate(shape, frame, wo, direction);
        direction = reflected_at_plane(wi, surface_normal);
    }
    return result;
}

fn raw_evaluate(shape: LobeShape, frame: Frame, wo: vec3f, wi: vec3f) -> vec2f {
    if is_hemispherical(shape.lobe) && dot(frame.normal, wi) <= 0.0 {
        return vec2f(0.0);
    }
    let density = raw_density(shape, frame, wo, wi);
    return vec2f(density * raw_weight(shape, frame, wo, wi), density);
}
