//! Limiting fireflies: off unless asked for, and honest about what it takes.

use crate::renders::adjust;
use std::time::Duration;

use glossmith::{
    document::{AreaLight, Document},
    job::film::Film,
    render::{EngineChoice, Session},
    scene::ModelSource,
};

/// A shader ball in front of its light: much is reflected twice.
fn scene(firefly_clamp: Option<f32>) -> Document {
    let mut document = Document {
        model: ModelSource::Shaderball,
        ground: true,
        ..Document::default()
    };
    document.materials[0].roughness = 0.2;
    document.lighting.area_lights = vec![AreaLight {
        strength: 200.0,
        ..AreaLight::default()
    }];
    adjust(
        &mut document,
        "render.width=48 render.height=48 render.samples=16 render.filter=box",
    );
    document.render.firefly_clamp = firefly_clamp;
    document
}

fn film(session: &mut Session, document: &Document) -> (Film, Vec<&'static str>) {
    session.submit(document).unwrap();
    while !session.step(Duration::from_secs(1)).unwrap().is_done {}
    let effects = session.job().unwrap().plan.effects();
    (session.film().unwrap().clone(), effects)
}

fn energy(film: &Film) -> f64 {
    let luminance = |sum: [f64; 4]| 0.2126 * sum[0] + 0.7152 * sum[1] + 0.0722 * sum[2];
    film.colors().map(luminance).sum()
}

/// The same paths are traced: what is missing from the picture is what the film says was taken, and both engines take the
/// same.
#[test]
fn what_is_taken_is_told() {
    let mut taken = Vec::new();
    for engine in [EngineChoice::Cpu, EngineChoice::Gpu] {
        let mut session = Session::open(engine).unwrap();
        let (free, effects) = film(&mut session, &scene(None));
        assert_eq!(free.clamped(), 0.0);
        assert!(!effects.contains(&"firefly-clamp"));
        let (limited, effects) = film(&mut session, &scene(Some(0.5)));
        assert!(effects.contains(&"firefly-clamp"));
        let missing = energy(&free) - energy(&limited);
        assert!(
            missing > 0.01 * energy(&free),
            "{engine:?}: {missing} of {}",
            energy(&free)
        );
        near!(limited.clamped() / missing, 1.0, 0.001, "{engine:?}");
        near!(limited.clamped_share(), missing / energy(&free), 0.0001);
        // A limit that nothing reaches takes nothing, to the bit on the processor.
        let (loose, _) = film(&mut session, &scene(Some(1e9)));
        assert_eq!(loose.clamped(), 0.0, "{engine:?}");
        if engine == EngineChoice::Cpu {
            assert!(loose.colors().eq(free.colors()));
        }
        taken.push(limited.clamped());
    }
    near!(taken[0] / taken[1], 1.0, 0.01);
}
