//! What sessions keep of what documents name: nothing is loaded twice that fits the memory.

use std::sync::Arc;

use glossmith::render::Assets;
use glossmith::scene::environment::{Environment, EnvironmentEncoding, EnvironmentSource};
use glossmith::scene::{AreaShape, Outline};
use glossmith::scene::{Geometry, Model, ModelOptions, ModelSource};

const SOURCES: [ModelSource; 3] = [ModelSource::Sphere, ModelSource::Plane, ModelSource::Shaderball];

fn model(assets: &Assets, source: &ModelSource) -> Arc<Model> {
    let loaded = assets.model(source, &ModelOptions::default());
    loaded.expect("it is built in")
}

fn environment(assets: &Assets, source: &EnvironmentSource) -> Arc<Environment> {
    let loaded = assets.environment(source, EnvironmentEncoding::default());
    loaded.expect("it is built in")
}

/// A sphere under a light in this direction.
fn lit(assets: &Assets, yaw_deg: f64) -> Arc<Geometry> {
    let light = AreaShape {
        yaw_deg,
        pitch_deg: 30.0,
        distance: 3.0,
        width: 1.0,
        height: 1.0,
        target: [0.0; 3],
        turn_deg: 0.0,
        outline: Outline::Rectangle,
    };
    let made = assets.geometry(
        &ModelSource::Sphere,
        &ModelOptions::default(),
        true.into(),
        vec![light],
        Vec::new(),
    );
    made.expect("it is built in")
}

#[test]
fn going_back_and_forth_loads_nothing_again() {
    let assets = Assets::default();
    let first = SOURCES.each_ref().map(|source| model(&assets, source));
    let again = SOURCES.each_ref().map(|source| model(&assets, source));
    assert!(std::iter::zip(&first, &again).all(|(a, b)| Arc::ptr_eq(a, b)));
    let skies = [EnvironmentSource::Furnace, EnvironmentSource::Studio];
    let first = skies.each_ref().map(|source| environment(&assets, source));
    let again = skies.each_ref().map(|source| environment(&assets, source));
    assert!(std::iter::zip(&first, &again).all(|(a, b)| Arc::ptr_eq(a, b)));
}

#[test]
fn what_was_not_used_for_longest_goes_first_where_memory_is_short() {
    let bytes = SOURCES
        .each_ref()
        .map(|source| model(&Assets::default(), source).bytes());
    assert!(bytes.iter().all(|bytes| *bytes > 100), "{bytes:?}");
    let assets = Assets::within(bytes.iter().sum::<usize>() - 1);
    let first = SOURCES.each_ref().map(|source| model(&assets, source));
    assert!(Arc::ptr_eq(&model(&assets, &SOURCES[2]), &first[2]));
    assert!(Arc::ptr_eq(&model(&assets, &SOURCES[1]), &first[1]), "it fits");
    assert!(!Arc::ptr_eq(&model(&assets, &SOURCES[0]), &first[0]), "it had to go");
    // However short it is, what was used last stays.
    let assets = Assets::within(0);
    let only = model(&assets, &SOURCES[0]);
    assert!(Arc::ptr_eq(&model(&assets, &SOURCES[0]), &only));
}

#[test]
fn lights_that_are_dragged_leave_no_trail_of_geometries() {
    let assets = Assets::default();
    let made: Vec<_> = (0..5).map(|i| lit(&assets, f64::from(i))).collect();
    assert!(Arc::ptr_eq(&lit(&assets, 4.0), &made[4]));
    assert!(Arc::ptr_eq(&lit(&assets, 3.0), &made[3]), "two that are compared");
    assert!(made[..3].iter().all(|geometry| Arc::strong_count(geometry) == 1));
    assert!(made.iter().all(|geometry| Arc::ptr_eq(&geometry.model, &made[0].model)));
}
