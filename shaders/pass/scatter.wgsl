// Draws samples with the very function that the path tracer runs: scatter plots show the shader. Twin of
// src/cpu/scatter.rs.
#import "optics/lobe/registry"

@group(1) @binding(0) var<uniform> scatter: Scatter;
// Direction and density; density -1 where the sample was absorbed.
@group(1) @binding(1) var<storage, read_write> scattered: array<vec4f>;

@compute @workgroup_size(64)
fn draw(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= scatter.count {
        return;
    }
    let frame = Frame(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), UPWARDS);
    let shape = LobeShape(
        scatter.lobe, scatter.curve, scatter.horizon, 0u, scatter.roughness, scatter.anisotropy, scatter.eta,
    );
    let state = random_state(0u, 0u, scatter.seed, scatter.first + id.x, 1u);
    let xi = vec3f(random_pair(state, 0u), random_pair(state, 1u).x);
    let drawn = lobe_sample(shape, frame, UPWARDS, scatter.wo, xi);
    var density = lobe_evaluate(shape, frame, UPWARDS, scatter.wo, drawn.wi).y;
    if drawn.weight <= 0.0 {
        density = -1.0;
    }
    scattered[id.x] = vec4f(drawn.wi, density);
}
