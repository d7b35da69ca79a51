// Common part of the layers. Twin of src/optics/layer/mod.rs, which explains it, and of src/optics/layer/shares.rs.
#import "optics/material"

struct LayerAlbedo {
    reflected: vec3f,
    transmittance: vec3f,
}

struct LayerToward {
    color: vec3f,
    probability: f32,
}

struct LayerShare {
    albedo: vec3f,
    probability: f32,
    transmittance: vec3f,
    reached: f32,
}

// A layer at a surface point: its lobe, and its share of the view.
struct LayerLobe {
    is_there: bool,
    shape: LobeShape,
    frame: Frame,
    share: LayerShare,
}

// The place of a layer that is chosen, and the number that chose it, stretched again.
struct LayerChoice {
    place: u32,
    number: f32,
}

// Sampling probability of a cover with this albedo, and its luminance plus that of everything after it (`below`).
fn cover_choose(albedo: vec3f, below: f32) -> vec2f {
    let reflected = max_component(albedo);
    let rest = (1.0 - reflected) * below;
    let share = select(1.0, sampled_share(reflected / max(reflected + rest, 1e-9)), rest > 0.0);
    return vec2f(select(0.0, share, reflected > 0.0), reflected + rest);
}
