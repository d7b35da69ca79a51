//! The map of what in a picture's numbers is not to be trusted: black on shipped scenes, lit where a scene is made to fail.

use std::sync::Arc;
use std::time::Duration;

use glossmith::cpu::CpuEngine;
use glossmith::cpu::precision::precision;
use glossmith::document::Document;
use glossmith::job::Job;
use glossmith::job::precision::{Fault, Finding, PrecisionMap};
use glossmith::optics::material::Material;
use glossmith::render::{EngineChoice, Session};
use glossmith::scene::{Geometry, Model, ModelSource, shapes};
use glossmith::store::PRESETS;

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
    Fault::ALL.map(|(fault, ..)| map.count(fault))
}

#[test]
fn shipped_scenes_have_nothing_to_show() {
    let models = [ModelSource::Teapot, ModelSource::Shaderball, ModelSource::Sphere];
    for (i, material) in PRESETS.iter().enumerate() {
        let document = Document {
            model: models[i % models.len()].clone(),
            ground: i % 2 == 0,
            materials: vec![material.clone()],
            ..Document::default()
        };
        let map = map(&job(&document));
        assert_eq!(counts(&map), [0; 3], "{}", material.name);
        let met = map.findings.iter().filter(|finding| finding.cosine > 0.0).count();
        assert!(
            met > map.findings.len() / 5,
            "{}: it sees next to nothing",
            material.name
        );
    }
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
    while engine.samples_per_pixel() < 4 {
        engine.step(Duration::from_secs(1), 4);
    }
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
    // It is round.
    let radius = (disc.len() as f64 / std::f64::consts::PI).sqrt();
    let farthest = disc
        .iter()
        .map(|&(x, y)| (f64::from(x) + 0.5 - middle[0]).hypot(f64::from(y) + 0.5 - middle[1]));
    let farthest = farthest.fold(0.0, f64::max);
    assert!((farthest - radius).abs() < 1.5, "{farthest} {radius}");
}

/// Two panes closer together than rays are moved off them.
#[test]
fn rays_that_start_inside_are_lit() {
    let mut mesh = shapes::plane();
    let mut lower = shapes::plane();
    for place in &mut lower.positions {
        place.y -= 5e-8;
    }
    mesh.append(lower);
    let model = Model {
        mesh,
        ..Model::default()
    };
    let mut document = Document {
        model: ModelSource::Plane,
        ..Document::default()
    };
    document.materials[0].metalness = 0.0;
    let opaque = job(&document);
    let panes = Arc::new(Geometry::build(&model, false));
    let clear = Material {
        transmission_weight: 1.0,
        ..opaque.materials[0]
    };
    let of = |geometry: &Arc<Geometry>| {
        let job = Job {
            geometry: geometry.clone(),
            materials: Arc::new(vec![clear; opaque.materials.len()]),
            ..opaque.clone()
        };
        map(&job)
    };
    assert_eq!(of(&opaque.geometry).count(Fault::Astray), 0);
    // Rays that go in would start below the lower pane.
    let map = of(&panes);
    let met = map.findings.iter().filter(|finding| finding.cosine > 0.0).count();
    let lit = map.count(Fault::Astray);
    assert!(met > 50 && lit > met / 2, "{lit} of {met}");
}

#[test]
fn the_gravest_fault_gives_the_colour() {
    let grey = Finding {
        cosine: 1.0,
        ..Finding::default()
    };
    let astray = Finding {
        starts_astray: true,
        ..grey
    };
    let differs = Finding { error: 2e-3, ..astray };
    let dropped = Finding { dropped: 1, ..differs };
    let map = PrecisionMap {
        width: 5,
        height: 1,
        bound: 1e-3,
        findings: vec![Finding::default(), grey, astray, differs, dropped],
    };
    let colors: Vec<[u8; 3]> = map.colors().chunks(4).map(|rgba| [rgba[0], rgba[1], rgba[2]]).collect();
    assert_eq!(colors[0], [0; 3], "nothing is met");
    assert!(colors[1][0] > 0 && colors[1][0] < 80, "{:?}", colors[1]);
    assert_eq!(
        colors[2..],
        [Fault::Astray, Fault::Differs, Fault::Dropped].map(Fault::color)
    );
    assert_eq!(counts(&map), [1, 2, 3]);
}

#[test]
fn a_map_nobody_waits_for_is_not_made() {
    assert!(precision(&job(&Document::default()), SIZE, || true).is_none());
}
