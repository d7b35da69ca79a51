//! Cost of sampling directions: the paper's Fig. 8 on this machine, for all lobes.
//!
//! An image of a glossy quad, with 1 and with 100 directions per pixel. Measured are random numbers alone, with directions,
//! and with rays against a triangle; the differences are the costs. The whole frame is the path tracer's, of a quad under an
//! area light. Lobes and stages are interleaved; times are medians, and ratios are medians of those within a trial.

use std::time::Duration;

use serde::Serialize;

use super::{Machine, Steps, StudyError, Watch, median, quantile};
use crate::document::{AreaLight, Document, Strategy};
use crate::gpu::sampling::SamplingMeter;
use crate::gpu::{AdapterKind, GpuDevice};
use crate::job::sampling::{SamplingRequest, SamplingRun, SamplingStage};
use crate::optics::curve::Curve;
use crate::optics::lobe::Lobe;
use crate::render::{EngineChoice, EngineKind, Session};
use crate::scene::ModelSource;
use crate::scene::environment::EnvironmentSource;

/// Directions a pixel, as in the paper.
pub const SAMPLES: [u32; 2] = [1, 100];
/// Image size of the paper, in pixels.
pub const SIZE: [u32; 2] = [1880, 1812];
/// Minimum rows to measure of an image that takes too long.
const ROWS_MIN: u32 = 8;

/// The paper's Fig. 8 in milliseconds: sampling with 1 and with 100 samples, and the frame.
pub const PAPER: [(&str, Lobe, [f64; 3]); 4] = [
    ("phong", Lobe::Phong, [0.256, 27.3, 42.7]),
    ("blinn-phong", Lobe::BlinnPhong, [0.289, 30.6, 46.0]),
    ("ggx", Lobe::Ggx, [0.388, 40.5, 56.8]),
    ("ours", Lobe::Geometric, [0.067, 8.36, 23.2]),
];

/// Options of the measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SamplingOptions {
    /// Engine to measure.
    pub engine: EngineChoice,
    /// Width and height of the image, in pixels.
    pub size: [u32; 2],
    /// Roughness of all lobes, in (0, 1]: it changes no lobe's time.
    pub roughness: f32,
    /// Number of interleaved trials.
    pub turns: usize,
    /// Whether whole frames are measured, too. Without them a row's `frame_ms` is NaN.
    pub has_frames: bool,
    /// Time limit of one measurement; slower images are measured in part and scaled.
    pub budget: Duration,
}

impl SamplingOptions {
    /// Options for the paper's image.
    pub fn new(engine: EngineChoice) -> Self {
        Self {
            engine,
            size: SIZE,
            roughness: 0.3,
            turns: 21,
            has_frames: true,
            budget: Duration::from_millis(130),
        }
    }
}

/// The times of a lobe.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SamplingRow {
    /// The lobe, with the curve of the geometric one.
    pub name: String,
    /// Lobe that was sampled.
    pub lobe: Lobe,
    /// Directions per pixel.
    pub samples: u32,
    /// Drawing the directions alone, random numbers and rays left out, milliseconds.
    pub sampling_ms: f64,
    /// Quartiles of `sampling_ms` over the trials.
    pub sampling_quartiles_ms: [f64; 2],
    /// The same with rays against a triangle.
    pub with_rays_ms: f64,
    /// The path tracer's whole frame.
    pub frame_ms: f64,
    /// Sampling against the geometric lobe's with the smooth curve, median over the turns: above 1 it is slower.
    pub against_geometric: f64,
}

/// Report of all times.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SamplingReport {
    /// Machine of the measurement.
    pub machine: Machine,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Random numbers alone, milliseconds, with 1 and with 100 samples per pixel.
    pub numbers_ms: [f64; 2],
    /// Share of the rows that were measured, with 1 and with 100 samples.
    pub measured_share: [f64; 2],
    /// The lobes, with 1 and with 100 samples.
    pub rows: Vec<SamplingRow>,
    /// Speed of the geometric lobe against others, in words.
    pub verdict: Vec<String>,
}

/// The CPU function, or the shader.
enum Meter {
    Cpu,
    Gpu(Box<SamplingMeter>),
}

impl Meter {
    fn run(&mut self, request: &SamplingRequest) -> Result<SamplingRun, StudyError> {
        match self {
            Meter::Cpu => Ok(crate::cpu::sampling::run(request)),
            Meter::Gpu(meter) => Ok(meter.run(request)?),
        }
    }
}

/// Lobes and curves that are drawn: Lambert's is no reflection to choose.
fn shapes() -> Vec<(Lobe, Curve, String)> {
    let reflecting = Lobe::ALL.iter().copied().filter(|lobe| lobe.has_roughness());
    let of_lobe = |lobe: Lobe| -> Vec<_> {
        if lobe.has_curves() {
            let curves = Curve::with_formulas();
            curves
                .map(|curve| (lobe, curve, format!("{}/{}", lobe.name(), curve.name())))
                .collect()
        } else {
            vec![(lobe, Curve::Smooth, lobe.name().to_owned())]
        }
    };
    reflecting.flat_map(of_lobe).collect()
}

/// Measures. `watch` receives the progress and may stop it.
///
/// # Errors
/// A GPU that fails; [`StudyError::Stopped`].
pub fn sampling(options: &SamplingOptions, watch: &mut Watch<'_>) -> Result<SamplingReport, StudyError> {
    let mut session = Session::open(options.engine)?;
    let mut meter = match session.engine().kind {
        EngineKind::Gpu => Meter::Gpu(Box::new(SamplingMeter::new(GpuDevice::open(AdapterKind::Any)?))),
        EngineKind::Cpu => Meter::Cpu,
    };
    let shapes = shapes();
    let mut steps = Steps::new(watch, 2.0 * SAMPLES.len() as f64);
    let [width, height] = options.size;
    let mut report = SamplingReport {
        machine: Machine::of(session.engine()),
        width,
        height,
        numbers_ms: [0.0; 2],
        measured_share: [1.0; 2],
        rows: Vec::new(),
        verdict: Vec::new(),
    };
    for (index, samples) in SAMPLES.into_iter().enumerate() {
        let kernels = kernels(&mut meter, &shapes, samples, options, &mut steps)?;
        steps.finish(1.0);
        let frames = if options.has_frames {
            frames(&mut session, &shapes, samples, options, &mut steps)?
        } else {
            vec![f64::NAN; shapes.len()]
        };
        steps.finish(1.0);
        report.numbers_ms[index] = kernels.numbers_ms;
        report.measured_share[index] = kernels.measured_share;
        let times = std::iter::zip(kernels.shapes, frames);
        for ((lobe, _, name), (kernel, frame_ms)) in std::iter::zip(&shapes, times) {
            let [sampling_ms, with_rays_ms] = kernel.stages_ms;
            report.rows.push(SamplingRow {
                name: name.clone(),
                lobe: *lobe,
                samples,
                sampling_ms,
                sampling_quartiles_ms: kernel.quartiles_ms,
                with_rays_ms,
                frame_ms,
                against_geometric: kernel.against_geometric,
            });
        }
    }
    report.verdict = verdict(&report.rows);
    Ok(report)
}

/// Times of the kernels scaled to the whole image, in milliseconds.
struct Kernels {
    numbers_ms: f64,
    measured_share: f64,
    shapes: Vec<KernelTimes>,
}

/// Times of one lobe and curve.
struct KernelTimes {
    /// Time beyond the random numbers of directions, and of directions with rays, in milliseconds.
    stages_ms: [f64; 2],
    /// Quartiles of the directions' time.
    quartiles_ms: [f64; 2],
    /// Directions against those of the geometric lobe with the smooth curve.
    against_geometric: f64,
}

fn kernels(
    meter: &mut Meter,
    shapes: &[(Lobe, Curve, String)],
    samples: u32,
    options: &SamplingOptions,
    steps: &mut Steps<'_, '_>,
) -> Result<Kernels, StudyError> {
    let [width, height] = options.size;
    let request = |lobe, curve, stage, rows, seed| SamplingRequest {
        lobe,
        curve,
        roughness: options.roughness,
        stage,
        width,
        rows,
        height,
        samples,
        seed,
    };
    // Rows that fit the budget by the slowest stage, from a small part; the first run warms up.
    let few = ROWS_MIN.min(height);
    let mut seconds = 0.0;
    for _ in 0..2 {
        seconds = meter
            .run(&request(Lobe::Ggx, Curve::Smooth, SamplingStage::Rays, few, 0))?
            .seconds;
    }
    let affordable = f64::from(few) * options.budget.as_secs_f64() / seconds.max(1e-9);
    let rows = (affordable as u32).clamp(few, height);
    let scale = 1e3 * f64::from(height) / f64::from(rows);
    let mut times = vec![[const { Vec::new() }; 3]; shapes.len()];
    for turn in 0..=options.turns {
        for (place, (lobe, curve, name)) in shapes.iter().enumerate() {
            let within = (turn as f64 + place as f64 / shapes.len() as f64) / (options.turns + 1) as f64;
            steps.report(format!("{name}, {samples} a pixel"), within)?;
            for stage in SamplingStage::ALL {
                let run = meter.run(&request(*lobe, *curve, stage, rows, turn as u32))?;
                // Turn 0 warms: caches, clocks, kernels.
                if turn > 0 {
                    times[place][stage as usize].push(run.seconds);
                }
            }
        }
    }
    let numbers: Vec<f64> = times.iter().flat_map(|stages| stages[0].iter().copied()).collect();
    let is_unit = |(lobe, curve, _): &(Lobe, Curve, String)| *lobe == Lobe::Geometric && *curve == Curve::Smooth;
    let unit = shapes.iter().position(is_unit);
    let unit = unit.map_or_else(Vec::new, |place| beyond_numbers(&times[place], 1));
    let of_shape = |stages: &[Vec<f64>; 3]| {
        let directions = beyond_numbers(stages, 1);
        let ratios: Vec<f64> = std::iter::zip(&directions, &unit)
            .map(|(time, unit)| time / unit)
            .collect();
        KernelTimes {
            stages_ms: [median(&directions), median(&beyond_numbers(stages, 2))].map(|seconds| scale * seconds),
            quartiles_ms: [0.25, 0.75].map(|share| scale * quantile(&directions, share)),
            against_geometric: median(&ratios),
        }
    };
    Ok(Kernels {
        numbers_ms: scale * median(&numbers),
        measured_share: f64::from(rows) / f64::from(height),
        shapes: times.iter().map(of_shape).collect(),
    })
}

/// Time of a stage beyond the random numbers in seconds, per trial: a slow trial cancels.
fn beyond_numbers(stages: &[Vec<f64>; 3], stage: usize) -> Vec<f64> {
    std::iter::zip(&stages[stage], &stages[0]).map(|(a, b)| a - b).collect()
}

/// A glossy quad under an area light, seen from above.
fn quad(lobe: Lobe, curve: Curve, samples: u32, options: &SamplingOptions) -> Document {
    let mut document = Document {
        model: ModelSource::Plane,
        ..Document::default()
    };
    let material = &mut document.materials[0];
    (material.lobe, material.curve, material.roughness) = (lobe, curve, options.roughness);
    document.lighting.environment = EnvironmentSource::Furnace;
    document.lighting.strength = 0.0;
    document.lighting.area_lights = vec![AreaLight::default()];
    // Close enough to fill the image.
    (document.camera.pitch_deg, document.camera.distance) = (70.0, Some(2.0));
    let render = &mut document.render;
    [render.width, render.height] = options.size;
    (render.samples, render.bounces, render.strategy) = (samples, 1, Strategy::Lobe);
    document
}

/// Milliseconds of the whole frame for each shape.
fn frames(
    session: &mut Session,
    shapes: &[(Lobe, Curve, String)],
    samples: u32,
    options: &SamplingOptions,
    steps: &mut Steps<'_, '_>,
) -> Result<Vec<f64>, StudyError> {
    let mut times = vec![Vec::new(); shapes.len()];
    for turn in 0..=options.turns {
        for (place, (lobe, curve, name)) in shapes.iter().enumerate() {
            let within = (turn as f64 + place as f64 / shapes.len() as f64) / (options.turns + 1) as f64;
            steps.report(format!("{name}, frame of {samples} a pixel"), within)?;
            let mut document = quad(*lobe, *curve, samples, options);
            document.render.seed = turn as u32;
            session.submit(&document)?;
            let progress = session.step(options.budget)?;
            if turn > 0 {
                let a_sample = progress.engine_seconds / progress.mean_samples.max(1e-9);
                times[place].push(1e3 * a_sample * f64::from(samples));
            }
        }
    }
    Ok(times.iter().map(|times| median(times)).collect())
}

/// Sampling speed of each current lobe against the geometric one, beside the paper's.
fn verdict(rows: &[SamplingRow]) -> Vec<String> {
    let samples = SAMPLES[SAMPLES.len() - 1];
    let others = rows
        .iter()
        .filter(|row| row.samples == samples && row.lobe != Lobe::Geometric);
    let paper = |lobe: Lobe| PAPER.iter().find(|(_, of, _)| *of == lobe).map(|(_, _, ms)| ms[1]);
    let ours = paper(Lobe::Geometric).unwrap_or(f64::NAN);
    let sentence = |row: &SamplingRow| {
        let ratio = row.against_geometric;
        let found = if ratio.is_nan() || ratio <= 0.0 {
            "cannot be compared: the time is too short to be measured".to_owned()
        } else if ratio > 1.02 {
            format!("takes {ratio:.2} × the geometric lobe's time: the geometric lobe is faster")
        } else if ratio < 0.98 {
            format!("takes {ratio:.2} × the geometric lobe's time: the geometric lobe is slower")
        } else {
            "takes the geometric lobe's time".to_owned()
        };
        let paper_ratio = paper(row.lobe).map_or(String::new(), |ms| format!(" (the paper: {:.2} ×)", ms / ours));
        format!("{} {found}{paper_ratio}", row.lobe.label())
    };
    others.map(sentence).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_verdict_says_who_is_faster() {
        let row = |lobe: Lobe, against_geometric| SamplingRow {
            name: lobe.name().to_owned(),
            lobe,
            samples: 100,
            sampling_ms: 1.0,
            sampling_quartiles_ms: [1.0; 2],
            with_rays_ms: 1.0,
            frame_ms: 1.0,
            against_geometric,
        };
        let text = verdict(&[row(Lobe::Ggx, 1.5), row(Lobe::Phong, 0.5), row(Lobe::BlinnPhong, 1.0)]);
        assert!(
            text[0].contains("geometric lobe is faster") && text[0].contains("4.84 ×"),
            "{}",
            text[0]
        );
        assert!(text[1].contains("slower"), "{}", text[1]);
        assert!(text[2].contains("takes the geometric lobe's time"), "{}", text[2]);
    }
}
