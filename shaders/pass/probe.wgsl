// Single functions of the optics and the traversal on given inputs: tests of hard cases run the renderer's own code. Twin of
// src/cpu/probe.rs; src/job/probe.rs describes inputs and outputs. The entry points are generated; q and a are the first words
// of the question and of its answer.
#import "optics/layer/density"
#import "pass/probe_entries"
#import "optics/layer/scatter"
#import "scene/traversal"

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
fn answer_lobe(q: u32, a: u32) {
    let shape = LobeShape(
        questions[q], questions[q + 1u], questions[q + 2u], questions[q + 3u], asked(q + 4u), asked(q + 5u), asked(q + 6u),
    );
    let frame = frame_from_normal(asked_vector(q + 7u));
    let normal = asked_vector(q + 10u);
    let wo = asked_vector(q + 13u);
    let drawn = lobe_sample(shape, frame, normal, wo, asked_vector(q + 16u));
    let given = lobe_evaluate(shape, frame, normal, wo, asked_vector(q + 19u));
    answer_vector(a, drawn.wi);
    answer_vector(a + 3u, vec3f(drawn.weight, lobe_evaluate(shape, frame, normal, wo, drawn.wi)));
    answer(a + 6u, given.x);
    answer(a + 7u, given.y);
}

// The share reflected by a dielectric (model 0) or a conductor (model 1), or by one under a thin film (2, 3).
fn answer_fresnel(q: u32, a: u32) {
    var share = fresnel_dielectric(asked(q + 1u), asked(q + 2u));
    if questions[q] == 1u {
        share = fresnel_conductor(asked(q + 1u), asked(q + 2u), asked(q + 3u));
    }
    if questions[q] > 1u {
        let film = FilmTerms(asked(q + 4u), asked(q + 5u), asked(q + 2u), vec3f(asked(q + 6u)), false);
        let terms = FresnelTerms(
            select(FRESNEL_CONDUCTOR, FRESNEL_DIELECTRIC, questions[q] == 2u), WHITE, 0.0, WHITE, WHITE, WHITE, 1.0,
            asked(q + 2u), vec3f(asked(q + 2u)), vec3f(asked(q + 3u)), 1.0, true, film,
        );
        share = fresnel(terms, asked(q + 1u)).x;
    }
    answer(a, share);
}

// The bits of a pair of random numbers.
fn answer_random(q: u32, a: u32) {
    let state = random_state(questions[q], questions[q + 1u], questions[q + 2u], questions[q + 3u], questions[q + 4u]);
    let bits = random_pair_bits(state, questions[q + 5u]);
    answers[a] = bits.x;
    answers[a + 1u] = bits.y;
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
fn answer_material(q: u32, a: u32) {
    let surface = seen(q);
    let material = material_at(questions[q]);
    let layers = material_layers(material, surface);
    answer_vector(a, material_evaluate(material, surface, layers, asked_vector(q + 14u), asked(q + 17u), asked(q + 18u)));
}

// The density with which a material draws a direction.
fn answer_density(q: u32, a: u32) {
    let surface = seen(q);
    let material = material_at(questions[q]);
    answer(a, material_density(material, surface, material_layers(material, surface), asked_vector(q + 14u)));
}

// A direction drawn from a material, and value over density.
fn answer_draw(q: u32, a: u32) {
    let surface = seen(q);
    let material = material_at(questions[q]);
    let numbers = MaterialNumbers(asked_vector(q + 14u), asked(q + 17u), asked_vector(q + 18u));
    let drawn = material_sample(material, surface, material_layers(material, surface), numbers, false);
    answer_vector(a, drawn.wi);
    answer_vector(a + 3u, drawn.throughput);
}

// The nearest triangle on a ray and its distance.
fn answer_ray(q: u32, a: u32) {
    let hit = trace(asked_vector(q), asked_vector(q + 3u), asked(q + 6u), false);
    answers[a] = hit.triangle;
    answer(a + 1u, hit.t);
}
