//! What drawing directions costs on the CPU, for all lobes: the paper's Fig. 8; quoted in docs/PERFORMANCE.md.
//!
//! `cargo bench --bench sampling [-- quick]`. An image of a glossy quad with 100 directions a pixel: random numbers alone, with
//! directions, and with rays against a triangle; the differences are the costs. The whole frame is the path tracer's, of a quad
//! under an area light. Lobes and stages take turns; times are medians of the turns. Rows that take too long are measured in
//! part and scaled.

use std::time::{Duration, Instant};

use glossmith::{
    document::{AreaLight, Document, Strategy},
    optics::{
        curve::Curve,
        frame::frame_from_normal,
        lobe::{Horizon, Lobe, LobeShape, raw_sample},
        random::{Sequence, random_pair, random_state},
        vector::{Vec3, vec3},
    },
    render::{EngineChoice, Session},
    scene::{ModelSource, environment::EnvironmentSource},
};
use rayon::prelude::*;

/// Image and directions a pixel, as in the paper; the image of `quick`.
const SIZE: [u32; 2] = [1880, 1812];
const QUICK_SIZE: [u32; 2] = [48, 32];
const SAMPLES: u32 = 100;
/// Of all lobes: it changes no lobe's time.
const ROUGHNESS: f32 = 0.3;
/// Turns after one that warms.
const TURNS: usize = 21;
/// Longest time of a measurement, and the fewest rows of it.
const BUDGET: Duration = Duration::from_millis(130);
const ROWS_MIN: u32 = 8;
/// Milliseconds of the paper's Fig. 8 for sampling: the geometric lobe, and those that it compares.
const PAPER: f64 = 8.36;
const PAPERS: [(Lobe, f64); 3] = [(Lobe::Phong, 27.3), (Lobe::BlinnPhong, 30.6), (Lobe::Ggx, 40.5)];
/// Normal of the quad: not an axis, so that no special case applies.
const QUAD_NORMAL: [f64; 3] = [0.05, -0.03, 0.998_299_55];
/// A corner of the emitting triangle and two of its edges, relative to the quad.
const LIGHT_CORNER: [f32; 3] = [-0.5, -0.5, 1.0];
const LIGHT_SIDES: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// A lobe with a curve, and its seconds by turn: of each stage, and of a sample of a frame.
struct Shape {
    lobe: Lobe,
    curve: Curve,
    name: String,
    stages: [Vec<f64>; 3],
    frames: Vec<f64>,
}

impl Shape {
    /// Seconds beyond the random numbers in each turn: a slow turn cancels.
    fn beyond_numbers(&self, stage: usize) -> Vec<f64> {
        std::iter::zip(&self.stages[stage], &self.stages[0])
            .map(|(a, b)| a - b)
            .collect()
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let is_quick = std::env::args().any(|argument| argument == "quick");
    let size = if is_quick { QUICK_SIZE } else { SIZE };
    let (mut shapes, mut session) = (shapes(), Session::open(EngineChoice::Cpu)?);
    // Rows that fit the budget by the slowest stage; the first run warms up.
    let few = |_| seconds(Lobe::Ggx, Curve::Smooth, size, ROWS_MIN, 2, 0);
    let slowest = [0, 1].map(few)[1];
    let rows = (f64::from(ROWS_MIN) * BUDGET.as_secs_f64() / slowest) as u32;
    let rows = rows.clamp(ROWS_MIN, size[1]);
    for turn in 0..=TURNS {
        for shape in &mut shapes {
            for stage in 0..3 {
                let time = seconds(shape.lobe, shape.curve, size, rows, stage, turn as u32);
                shape.stages[stage].extend((turn > 0).then_some(time));
            }
            let mut document = quad(shape.lobe, shape.curve, size);
            document.render.seed = turn as u32;
            session.submit(&document)?;
            let progress = session.step(BUDGET)?;
            let time = progress.engine_seconds / progress.mean_samples.max(1e-9);
            shape.frames.extend((turn > 0).then_some(time));
        }
    }
    let scale = 1e3 * f64::from(size[1]) / f64::from(rows);
    let is_unit = |shape: &&Shape| (shape.lobe, shape.curve) == (Lobe::Geometric, Curve::Smooth);
    let unit = shapes
        .iter()
        .find(is_unit)
        .map_or_else(Vec::new, |shape| shape.beyond_numbers(1));
    println!(
        "{} × {} pixels with {SAMPLES} directions each, {rows} rows measured, ms\n",
        size[0], size[1]
    );
    println!("| lobe | sampling alone | with rays | whole frame | alone, against smooth | in the paper |");
    println!("| --- | --- | --- | --- | --- | --- |");
    for shape in &shapes {
        let alone = shape.beyond_numbers(1);
        let ratios = std::iter::zip(&alone, &unit).map(|(time, unit)| time / unit).collect();
        let paper = PAPERS.iter().find(|(lobe, _)| *lobe == shape.lobe);
        println!(
            "| {} | {:.0} | {:.0} | {:.0} | {:.2} | {} |",
            shape.name,
            scale * median(alone),
            scale * median(shape.beyond_numbers(2)),
            1e3 * f64::from(SAMPLES) * median(shape.frames.clone()),
            median(ratios),
            paper.map_or_else(String::new, |(_, ms)| format!("{:.2}", ms / PAPER))
        );
    }
    Ok(())
}

/// Lobes and curves that are drawn: Lambert's is no reflection to choose.
fn shapes() -> Vec<Shape> {
    let reflecting = Lobe::ALL.iter().copied().filter(|lobe| lobe.has_roughness());
    let of_lobe = |lobe: Lobe| {
        let curves = match lobe.has_curves() {
            true => Curve::with_formulas().collect(),
            false => vec![Curve::Smooth],
        };
        curves.into_iter().map(move |curve| Shape {
            lobe,
            curve,
            name: match lobe.has_curves() {
                true => format!("{}, {}", lobe.name(), curve.name()),
                false => lobe.name().to_owned(),
            },
            stages: Default::default(),
            frames: Vec::new(),
        })
    };
    reflecting.flat_map(of_lobe).collect()
}

/// Seconds of a stage over the first rows of the image, on all cores.
fn seconds(lobe: Lobe, curve: Curve, size: [u32; 2], rows: u32, stage: usize, seed: u32) -> f64 {
    let frame = frame_from_normal(Vec3::from_f64(QUAD_NORMAL));
    let shape = LobeShape {
        lobe,
        curve,
        horizon: Horizon::Mirror,
        roughness: ROUGHNESS,
        anisotropy: 0.0,
        eta: 0.0,
        table: &[],
    };
    let direction = |xi, wo| raw_sample(&shape, &frame, wo, xi);
    let lit = |wi: Vec3<f32>| if hits_light(wi) { wi } else { Vec3::ZERO };
    let begun = Instant::now();
    let all = (0..rows).into_par_iter();
    // A loop for each stage: no choice inside it.
    let sum: f64 = match stage {
        0 => all.map(|y| row(size, y, seed, |xi, _| Vec3::from_f32(xi))).sum(),
        1 => all.map(|y| row(size, y, seed, direction)).sum(),
        _ => all.map(|y| row(size, y, seed, |xi, wo| lit(direction(xi, wo)))).sum(),
    };
    std::hint::black_box(sum);
    begun.elapsed().as_secs_f64()
}

/// Sum over a row of what is drawn.
fn row([width, height]: [u32; 2], y: u32, seed: u32, draw: impl Fn([f32; 3], Vec3<f32>) -> Vec3<f32>) -> f64 {
    let place = |i: u32, count: u32| (i as f32 + 0.5) / count as f32 - 0.5;
    let pixel = |x: u32| {
        let wo = vec3(-1.5 * place(x, width), -1.5 * place(y, height), 1.0);
        let wo = wo * (1.0 / wo.dot(wo).sqrt());
        let mut sum = Vec3::ZERO;
        for sample in 0..SAMPLES {
            let state = random_state(x, y, seed, sample, Sequence::Independent);
            let ([a, b], [c, _]) = (random_pair(state, 0), random_pair::<f32>(state, 1));
            sum += draw([a, b, c], wo);
        }
        f64::from(sum.x + sum.y + sum.z)
    };
    (0..width).map(pixel).sum()
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

/// A glossy quad under an area light, seen from above.
fn quad(lobe: Lobe, curve: Curve, size: [u32; 2]) -> Document {
    let mut document = Document {
        model: ModelSource::Plane,
        ..Document::default()
    };
    let material = &mut document.materials[0];
    (material.lobe, material.curve, material.roughness) = (lobe, curve, ROUGHNESS);
    document.lighting.environment = EnvironmentSource::Furnace;
    document.lighting.strength = 0.0;
    document.lighting.area_lights = vec![AreaLight::default()];
    // Close enough to fill the image.
    (document.camera.pitch_deg, document.camera.distance) = (70.0, Some(2.0));
    let render = &mut document.render;
    [render.width, render.height] = size;
    (render.samples, render.bounces, render.strategy) = (SAMPLES, 1, Strategy::Lobe);
    document
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
