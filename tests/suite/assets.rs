//! What sessions keep of what documents name: nothing is loaded twice that fits the memory.

use std::sync::Arc;

use glossmith::render::Assets;
use glossmith::scene::environment::{Environment, EnvironmentEncoding, EnvironmentSource};
use glossmith::scene::{Model, ModelOptions, ModelSource};

const SOURCES: [ModelSource; 3] = [ModelSource::Sphere, ModelSource::Plane, ModelSource::Shaderball];

fn model(assets: &Assets, source: &ModelSource) -> Arc<Model> {
    let loaded = assets.model(source, &ModelOptions::default());
    loaded.expect("it is built in")
}

fn environment(assets: &Assets, source: &EnvironmentSource) -> Arc<Environment> {
    let loaded = assets.environment(source, EnvironmentEncoding::default());
    loaded.expect("it is built in")
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
