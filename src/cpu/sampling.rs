//! Cost of sampling directions on the CPU in isolation. Twin of `shaders/pass/sampling.wgsl`.

use std::time::Instant;

use crate::job::sampling::{QUAD_NORMAL, SamplingRequest, SamplingRun, SamplingStage};
use crate::optics::frame::frame_from_normal;
use crate::optics::lobe::{Horizon, LobeShape, raw_sampler};
use crate::optics::random::{Sequence, random_pair, random_state};
use crate::optics::vector::{Vec3, vec3};
use crate::parallel;

/// A corner of the emitting triangle and two of its edges, relative to the quad.
const LIGHT_CORNER: [f32; 3] = [-0.5, -0.5, 1.0];
const LIGHT_SIDES: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// Samples on all cores and measures the time.
pub fn run(request: &SamplingRequest) -> SamplingRun {
    let begun = Instant::now();
    let of_rows = |row: &(dyn Fn(u32) -> f64 + Sync)| parallel::map(request.rows as usize, |y| row(y as u32));
    // A kernel for each stage, as on the GPU: no choice inside the loop.
    let sums = match request.stage {
        SamplingStage::Numbers => of_rows(&|y| row(request, y, |xi, _| Vec3::from_f32(xi))),
        SamplingStage::Directions => of_rows(&|y| directions(request, y, |_| true)),
        SamplingStage::Rays => of_rows(&|y| directions(request, y, hits_light)),
    };
    SamplingRun {
        seconds: begun.elapsed().as_secs_f64(),
        sum: sums.into_iter().sum(),
    }
}

/// Sum over a row of the directions for which `counts` holds.
fn directions(request: &SamplingRequest, y: u32, counts: impl Fn(Vec3<f32>) -> bool) -> f64 {
    let frame = frame_from_normal(Vec3::from_f64(QUAD_NORMAL));
    let shape = LobeShape {
        lobe: request.lobe,
        curve: request.curve,
        horizon: Horizon::Mirror,
        roughness: request.roughness,
        anisotropy: 0.0,
        eta: 0.0,
        table: &[],
    };
    let sample = raw_sampler::<f32>(request.lobe);
    row(request, y, |xi, wo| {
        let wi = sample(&shape, &frame, wo, xi);
        if counts(wi) { wi } else { Vec3::zero() }
    })
}

#[inline(always)]
fn row(request: &SamplingRequest, y: u32, draw: impl Fn([f32; 3], Vec3<f32>) -> Vec3<f32>) -> f64 {
    let place = |i: u32, count: u32| (i as f32 + 0.5) / count as f32 - 0.5;
    let pixel = |x: u32| {
        let [u, v] = [place(x, request.width), place(y, request.height)];
        let wo = vec3(-1.5 * u, -1.5 * v, 1.0);
        let wo = wo * (1.0 / wo.dot(wo).sqrt());
        let mut sum = Vec3::zero();
        for sample in 0..request.samples {
            let state = random_state(x, y, request.seed, sample, Sequence::Independent);
            let ([a, b], [c, _]) = (random_pair(state, 0), random_pair::<f32>(state, 1));
            sum += draw([a, b, c], wo);
        }
        f64::from(sum.x + sum.y + sum.z)
    };
    (0..request.width).map(pixel).sum()
}

/// Whether a direction from the quad hits the triangle (Möller and Trumbore 1997).
fn hits_light(direction: Vec3<f32>) -> bool {
    let [side_u, side_v] = LIGHT_SIDES.map(Vec3::from_f32);
    let across = direction.cross(side_v);
    let determinant = side_u.dot(across);
    let from_corner = -Vec3::from_f32(LIGHT_CORNER);
    let u = from_corner.dot(across) / determinant;
    let along = from_corner.cross(side_u);
    let v = direction.dot(along) / determinant;
    let distance = side_v.dot(along) / determinant;
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0
}
