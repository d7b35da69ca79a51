//! Any document on both engines: it renders to numbers that are finite and not negative, and what is passive reflects no
//! more than it is given.

use std::time::Duration;

use glossmith::{
    document::{Document, effect::EffectSwitches},
    job::film::Film,
    render::{EngineChoice, Session},
    scene::environment::EnvironmentSource,
};

use super::{random_documents::random_document, renders::adjust, support::Random};

fn film(session: &mut Session, document: &Document) -> Film {
    session.submit(document).expect("built-in scenes");
    while !session.step(Duration::from_secs(1)).unwrap().is_done {}
    session.film().unwrap().clone()
}

fn assert_sound(film: &Film, what: &str) {
    for pixel in 0..film.pixel_count() {
        for sum in film.color(pixel) {
            assert!(sum.is_finite() && sum >= 0.0, "{what}: a sum of {sum}");
        }
        // The GPU's is a difference of sums in single precision.
        let sums = film.sums(pixel);
        let least = -1e-5 * sums.color.iter().map(|x| x * x).sum::<f64>();
        let deviations = sums.squared_deviations;
        assert!(
            deviations.is_finite() && deviations >= least,
            "{what}: squared deviations of {deviations}"
        );
    }
    assert_eq!(film.dropped(), 0, "{what}: samples dropped");
}

/// The same document where nothing emits and light of 1 comes from everywhere.
fn in_the_furnace(document: &Document) -> Document {
    let mut document = document.clone();
    document.lighting = glossmith::document::Lighting {
        environment: EnvironmentSource::Furnace,
        ground_color: document.lighting.ground_color,
        ..Default::default()
    };
    document.render.firefly_clamp = None;
    adjust(&mut document, "render.samples=32 render.sequence=independent");
    document.materials[0].emission_strength = 0.0;
    document
}

fn assert_documents_sound(engine: EngineChoice, count: usize) {
    let mut session = Session::open(engine).expect("a Vulkan driver: install mesa-vulkan-drivers");
    let mut random = Random::new(2026);
    for number in 0..count {
        let mut document = random_document(&mut random);
        adjust(&mut document, "render.width=8 render.height=8");
        if engine == EngineChoice::Gpu {
            // The general kernel for all: a kernel for each document would have to be compiled.
            document.render.effects = EffectSwitches::all_on();
        }
        let what = format!("document {number}: {document:?}");
        assert_sound(&film(&mut session, &document), &what);
        let furnace = film(&mut session, &in_the_furnace(&document));
        assert_sound(&furnace, &what);
        let pixels = furnace.luminance();
        let count = pixels.len() as f64;
        let mean = pixels.iter().sum::<f64>() / count;
        let sigma = furnace.variance_of_mean().iter().sum::<f64>().sqrt() / count;
        assert!(
            mean <= 1.0 + 5.0 * sigma + 0.005,
            "{what}: {mean} ± {sigma} in the furnace"
        );
    }
}

#[test]
fn any_document_is_sound_on_the_processor() {
    assert_documents_sound(EngineChoice::Cpu, 100);
}

#[test]
fn any_document_is_sound_on_the_gpu() {
    assert_documents_sound(EngineChoice::Gpu, 10);
}
