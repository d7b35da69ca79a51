//! The map of what in a picture's numbers is not to be trusted: lit where a scene is made to fail.

use std::{sync::Arc, time::Duration};

use glossmith::{
    cpu::{CpuEngine, precision::precision},
    document::Document,
    job::Job,
    job::precision::{Fault, PrecisionMap},
    render::{EngineChoice, Session},
    scene::ModelSource,
};

const SIZE: [u32; 2] = [40, 32];

fn job(document: &Document) -> Job {
    let mut session = Session::open(EngineChoice::Cpu).unwrap();
    session.submit(document).unwrap();
    Job::clone(session.job().unwrap())
}

fn map(job: &Job) -> PrecisionMap {
    let map = precision(job, SIZE, || false).expect("it is not superseded");
    assert_eq!(map.findings.len() as u32, map.width * map.height, "one a pixel");
    map
}

fn counts(map: &PrecisionMap) -> [usize; 3] {
    [0, 1, 2].map(|fault| map.count(Fault::ALL[fault]))
}

#[test]
fn errors_beyond_the_bound_are_lit() {
    let mut map = map(&job(&Document::default()));
    map.bound = 0.0;
    let met = map.findings.iter().filter(|finding| finding.cosine > 0.0).count();
    let lit = map.count(Fault::Differs);
    assert!(lit > met / 2, "f32 is never exact: {lit} of {met}");
}

#[test]
fn dropped_samples_are_lit() {
    let mut job = job(&Document::default());
    job.settings.environment_strength = 1e30;
    let map = map(&job);
    assert!(map.count(Fault::Dropped) > map.findings.len() / 2, "{:?}", counts(&map));
}

#[test]
fn samples_that_are_not_finite_are_dropped_and_counted() {
    let mut job = job(&Document::default());
    job.settings.environment_strength = f64::INFINITY;
    job.settings.image_size = [16, 12];
    let mut engine = CpuEngine::default();
    engine.submit(Arc::new(job));
    engine.step(Duration::from_secs(60), 4);
    let film = engine.film();
    assert!(
        film.dropped() > 0 && film.samples() + film.dropped() >= 4 * 16 * 12,
        "{} {}",
        film.samples(),
        film.dropped()
    );
    assert!(film.image().luminance().iter().all(|luminance| luminance.is_finite()));
}

#[test]
fn findings_are_where_the_picture_has_them() {
    let mut document = Document {
        model: ModelSource::Sphere,
        ..Document::default()
    };
    document.ground = false;
    document.camera.distance = Some(6.0);
    let map = map(&job(&document));
    let met = |x: u32, y: u32| map.findings[(y * map.width + x) as usize].cosine > 0.0;
    let pixels = || (0..map.height).flat_map(|y| (0..map.width).map(move |x| (x, y)));
    let disc: Vec<(u32, u32)> = pixels().filter(|&(x, y)| met(x, y)).collect();
    let mean = |of: &dyn Fn(&(u32, u32)) -> f64| disc.iter().map(of).sum::<f64>() / disc.len() as f64 + 0.5;
    let middle = [mean(&|at| f64::from(at.0)), mean(&|at| f64::from(at.1))];
    let expected = [f64::from(map.width) / 2.0, f64::from(map.height) / 2.0];
    assert!((0..2).all(|i| (middle[i] - expected[i]).abs() < 0.75), "{middle:?}");
}

#[test]
fn a_map_nobody_waits_for_is_not_made() {
    assert!(precision(&job(&Document::default()), SIZE, || true).is_none());
}
