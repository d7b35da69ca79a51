//! Samples of a lobe, drawn as the path tracer draws them. Twin of `shaders/pass/scatter.wgsl`.

use crate::{
    job::scatter::{ScatterCloud, ScatterRequest},
    optics::lobe::{lobe_evaluate, lobe_sample},
    optics::random::{Sequence, random_pair, random_state},
    parallel,
};

pub fn scatter(request: &ScatterRequest) -> ScatterCloud {
    let shape = request.model.shape::<f32>();
    let frame = ScatterRequest::frame();
    let wo = request.wo();
    let draw = |i: usize| {
        let state = random_state(0, 0, request.seed, i as u32, Sequence::Independent);
        let ([a, b], [c, _]) = (random_pair(state, 0), random_pair::<f32>(state, 1));
        let drawn = lobe_sample(&shape, &frame, frame.normal, wo, [a, b, c]);
        let [_, density] = lobe_evaluate(&shape, &frame, frame.normal, wo, drawn.wi);
        let [x, y, z] = drawn.wi.to_f32();
        [x, y, z, if drawn.weight > 0.0 { density } else { -1.0 }]
    };
    ScatterCloud::from_raw(parallel::map(request.count as usize, draw))
}
