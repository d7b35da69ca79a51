//! Passes of many samples per pixel on the GPU. Mesa's software driver 22.3 leaves all loops of an invocation after 65 535
//! iterations: the rest of a pass would be missing.

use std::sync::Arc;
use std::time::Duration;

use glossmith::cpu::CpuEngine;
use glossmith::document::{Document, MaterialSettings};
use glossmith::gpu::{AdapterKind, GpuDevice, GpuEngine};
use glossmith::render::{EngineChoice, Session};

use super::plan::job_in;

/// A picture of one pixel takes as many samples per pass as the driver allows.
#[test]
fn small_pictures_get_all_their_samples() {
    let mut session = Session::open(EngineChoice::Cpu).expect("the CPU");
    let device = GpuDevice::open(AdapterKind::Any).expect("an adapter: install mesa-vulkan-drivers");
    let mut engine = GpuEngine::new(device).expect("the shader compiles");
    let glass = MaterialSettings {
        transmission_weight: 1.0,
        ..MaterialSettings::default()
    };
    for (side, bounces, samples) in [(1, 8, 30_000), (8, 64, 4_000)] {
        let mut document = Document::default();
        (document.render.width, document.render.height) = (side, side);
        document.render.bounces = bounces;
        document.materials = vec![glass.clone()];
        let job = Arc::new(job_in(&mut session, &document));
        engine.submit(job.clone()).expect("the adapter holds it");
        engine.step(Duration::from_secs(1000), samples).expect("nothing fails");
        let film = engine.film().expect("nothing fails");
        let lacking = (0..film.pixel_count()).filter(|pixel| film.sums(*pixel).samples != f64::from(samples));
        assert_eq!(lacking.count(), 0, "{side} pixels wide: pixels that lack samples");
        let mut cpu = CpuEngine::default();
        cpu.submit(job);
        cpu.step(Duration::from_secs(1000), samples);
        let sum = |values: Vec<f64>| values.iter().sum::<f64>();
        let ratio = sum(film.luminance()) / sum(cpu.film().luminance());
        // Both engines trace the same paths; rounding moves a decision of a path now and then.
        assert!((ratio - 1.0).abs() < 1e-3, "{side} pixels wide: {ratio}");
    }
}
