// Single functions of the optics and the traversal on given inputs: tests of hard cases run the renderer's own code. Twin of
// src/cpu/probe.rs; src/job/probe.rs describes inputs and outputs.
#import "optics/layer/scatter"
#import "optics/random"
#import "scene/traversal"

// Words of a question of each kind.
const LOBE_WORDS: u32 = 22u;
const FRESNEL_WORDS: u32 = 4u;
const RANDOM_WORDS: u32 = 6u;
const MATERIAL_WORDS: u32 = 15u;
const RAY_WORDS: u32 = 7u;

@group(1) @binding(0) var<storage, read> questions: array<u32>;
@group(1) @binding(1) var<storage, read_write> answers: array<u32>;

fn asked(word: u32) -> f32 {
    return bitcast<f32>(questions[word]);
}

fn asked_vector(word: u32) -> vec3f {
    return vec3f(asked(word), asked(word + 1u), asked(word + 2u));
}

fn answer(word: u32, x: f32) {
    answers[word] = bitcast<u32>(x);
}

fn answer_vector(word: u32, v: vec3f) {
    answer(word, v.x);
    answer(word + 1u, v.y);
    answer(word + 2u, v.z);
}

// A direction drawn from a lobe, its weight, (evaluate, density) there, and (evaluate, density) for a given direction.
@compute @workgroup_size(64)
fn probe_lobe(@builtin(global_invocation_id) id: vec3u) {
    let q = id.x * LOBE_WORDS;
    if q >= arrayLength(&questions) {
        return;
    }
    let shape = LobeShape(
        questions[q], questions[q + 1u], questions[q + 2u], questions[q + 3u], asked(q + 4u), asked(q + 5u), asked(q + 6u),
    );
    let frame = frame_from_normal(asked_vector(q + 7u));
    let normal = asked_vector(q + 10u);
    let wo = asked_vector(q + 13u);
    let drawn = lobe_sample(shape, frame, normal, wo, asked_vector(q + 16u));
    let there = lobe_evaluate(shape, frame, normal, wo, drawn.wi);
    let given = lobe_evaluate(shape, frame, normal, wo, asked_vector(q + 19u));
    let a = id.x * 8u;
    answer_vector(a, drawn.wi);
    answer(a + 3u, drawn.weight);
    answer(a + 4u, there.x);
    answer(a + 5u, there.y);
    answer(a + 6u, given.x);
    answer(a + 7u, given.y);
}

// The share reflected by a dielectric (model 0) or a conductor (model 1).
@compute @workgroup_size(64)
fn probe_fresnel(@builtin(global_invocation_id) id: vec3u) {
    let q = id.x * FRESNEL_WORDS;
    if q >= arrayLength(&questions) {
        return;
    }
    var share = fresnel_dielectric(asked(q + 1u), asked(q + 2u));
    if questions[q] == 1u {
        share = fresnel_conductor(asked(q + 1u), asked(q + 2u), asked(q + 3u));
    }
    answer(id.x, share);
}

// The bits of a pair of random numbers.
@compute @workgroup_size(64)
fn probe_random(@builtin(global_invocation_id) id: vec3u) {
    let q = id.x * RANDOM_WORDS;
    if q >= arrayLength(&questions) {
        return;
    }
    let state = random_state(questions[q], questions[q + 1u], questions[q + 2u], questions[q + 3u], questions[q + 4u]);
    let bits = random_pair_bits(state, questions[q + 5u]);
    answers[id.x * 2u] = bits.x;
    answers[id.x * 2u + 1u] = bits.y;
}

// A material's evaluate for light from a direction that was drawn with some density.
@compute @workgroup_size(64)
fn probe_material(@builtin(global_invocation_id) id: vec3u) {
    let q = id.x * MATERIAL_WORDS;
    if q >= arrayLength(&questions) {
        return;
    }
    let shading = asked_vector(q + 2u);
    let surface = Surface(
        frame_from_normal(shading), asked_vector(q + 5u), asked_vector(q + 8u), shading, questions[q + 1u] == 1u,
    );
    let material = material_at(questions[q]);
    let layers = material_layers(material, surface);
    let value = material_evaluate(material, surface, layers, asked_vector(q + 11u), asked(q + 14u), 1.0);
    answer_vector(id.x * 3u, value);
}

// The nearest triangle on a ray and its distance.
@compute @workgroup_size(64)
fn probe_ray(@builtin(global_invocation_id) id: vec3u) {
    let q = id.x * RAY_WORDS;
    if q >= arrayLength(&questions) {
        return;
    }
    let hit = trace(asked_vector(q), asked_vector(q + 3u), asked(q + 6u), false);
    answers[id.x * 2u] = hit.triangle;
    answer(id.x * 2u + 1u, hit.t);
}
