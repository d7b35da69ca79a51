// Cost of sampling directions in isolation: the paper's Fig. 8. Twin of src/cpu/sampling.rs.
#import "optics/frame"
#import "optics/lobe/registry"
#import "optics/random"

// One lobe and curve a kernel, as a renderer would have it.
override SAMPLED_LOBE: u32 = 0u;
override SAMPLED_CURVE: u32 = 0u;
// 0: random numbers alone; 1: directions, too; 2: and a test against a triangle.
override SAMPLED_STAGE: u32 = 0u;

struct Sampling {
    // The quad's normal: not known when the kernel is made.
    normal: vec3f,
    roughness: f32,
    width: u32,
    rows: u32,
    height: u32,
    samples: u32,
    seed: u32,
    reserved_a: u32,
    reserved_b: u32,
    reserved_c: u32,
}

@group(1) @binding(0) var<uniform> sampling: Sampling;
// A sum per pixel, so that the compiler removes nothing as unused.
@group(1) @binding(1) var<storage, read_write> sampled: array<f32>;

// The corner of the shining triangle and two of its sides, seen from the quad.
const LIGHT_CORNER: vec3f = vec3f(-0.5, -0.5, 1.0);
const LIGHT_SIDES: mat2x3f = mat2x3f(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0));

fn hits_light(direction: vec3f) -> bool {
    let across = cross(direction, LIGHT_SIDES[1]);
    let determinant = dot(LIGHT_SIDES[0], across);
    let from_corner = -LIGHT_CORNER;
    let u = dot(from_corner, across) / determinant;
    let along = cross(from_corner, LIGHT_SIDES[0]);
    let v = dot(direction, along) / determinant;
    let distance = dot(LIGHT_SIDES[1], along) / determinant;
    return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0;
}

@compute @workgroup_size(8, 8)
fn measure(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= sampling.width || id.y >= sampling.rows {
        return;
    }
    let frame = frame_from_normal(sampling.normal);
    let place = (vec2f(id.xy) + 0.5) / vec2f(f32(sampling.width), f32(sampling.height)) - 0.5;
    let wo = normalize(vec3f(-1.5 * place, 1.0));
    let shape = LobeShape(SAMPLED_LOBE, SAMPLED_CURVE, 0u, 0u, sampling.roughness, 0.0, 0.0);
    var sum = vec3f(0.0);
    for (var sample = 0u; sample < sampling.samples; sample += 1u) {
        let state = random_state(id.x, id.y, sampling.seed, sample, 1u);
        let xi = vec3f(random_pair(state, 0u), random_pair(state, 1u).x);
        if SAMPLED_STAGE == 0u {
            sum += xi;
            continue;
        }
        let wi = raw_sample(shape, frame, wo, xi);
        if SAMPLED_STAGE == 1u || hits_light(wi) {
            sum += wi;
        }
    }
    sampled[id.y * sampling.width + id.x] = sum.x + sum.y + sum.z;
}
