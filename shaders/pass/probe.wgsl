// Single functions of the optics and the traversal on given inputs: tests of hard cases run the renderer's own code. Twin of
// src/cpu/probe.rs; src/job/probe.rs describes inputs and outputs.
#import "optics/layer/density"
#import "optics/layer/scatter"
#import "optics/random"
#import "scene/traversal"

// Words of a question of each kind.
const LOBE_WORDS: u32 = 22u;
const FRESNEL_WORDS: u32 = 7u;
const RANDOM_WORDS: u32 = 6u;
const MATERIAL_WORDS: u32 = 19u;
const DRAW_WORDS: u32 = 21u;
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

// The share reflected by a dielectric (model 0) or a conductor (model 1), or by one under a thin film (2, 3).
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
    if questions[q] > 1u {
        let white = vec3f(1.0);
        let film = FilmTerms(asked(q + 4u), asked(q + 5u), vec3f(asked(q + 6u)));
        let terms = FresnelTerms(
            select(FRESNEL_CONDUCTOR, FRESNEL_DIELECTRIC, questions[q] == 2u), white, 0.0, white, white, white, 1.0,
            asked(q + 2u), vec3f(asked(q + 2u)), vec3f(asked(q + 3u)), true, film,
        );
        share = fresnel(terms, asked(q + 1u)).x;
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

// The surface point of a view, whose words begin at q.
fn seen(q: u32) -> Surface {
    let shading = asked_vector(q + 2u);
    let tangent = asked_vector(q + 5u);
    return Surface(
        Frame(tangent, cross(shading, tangent), shading),
        asked_vector(q + 8u), asked_vector(q + 11u), shading, questions[q + 1u] == 1u,
    );
}

// A material's evaluate for light from a direction that was drawn with some density.
@compute @workgroup_size(64)
fn probe_material(@builtin(global_invocation_id) id: vec3u) {
    let q = id.x * MATERIAL_WORDS;
    if q >= arrayLength(&questions) {
        return;
    }
    let surface = seen(q);
    let material = material_at(questions[q]);
    let layers = material_layers(material, surface);
    let value = material_evaluate(material, surface, layers, asked_vector(q + 14u), asked(q + 17u), asked(q + 18u));
    answer_vector(id.x * 3u, value);
}

// The density with which a material draws a direction.
@compute @workgroup_size(64)
fn probe_density(@builtin(global_invocation_id) id: vec3u) {
    let q = id.x * MATERIAL_WORDS;
    if q >= arrayLength(&questions) {
        return;
    }
    let surface = seen(q);
    let material = material_at(questions[q]);
    answer(id.x, material_density(material, surface, material_layers(material, surface), asked_vector(q + 14u)));
}

// A direction drawn from a material, and value over density.
@compute @workgroup_size(64)
fn probe_draw(@builtin(global_invocation_id) id: vec3u) {
    let q = id.x * DRAW_WORDS;
    if q >= arrayLength(&questions) {
        return;
    }
    let surface = seen(q);
    let material = material_at(questions[q]);
    let numbers = MaterialNumbers(asked_vector(q + 14u), asked(q + 17u), asked_vector(q + 18u));
    let drawn = material_sample(material, surface, material_layers(material, surface), numbers, false);
    answer_vector(id.x * 6u, drawn.wi);
    answer_vector(id.x * 6u + 3u, drawn.throughput);
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
