//! Glass: light cut at the last bounce, roulette behind clear panes, and glass that is not there.

use glossmith::{
    document::{Background, Document},
    job::film::Film,
    render::EngineChoice,
    scene::{ModelSource, environment::EnvironmentSource},
};

use super::renders::{adjust, document, render};

const ENGINES: [EngineChoice; 2] = [EngineChoice::Cpu, EngineChoice::Gpu];

/// A sphere of clear glass, but for the assignments.
fn glass(light: EnvironmentSource, assignments: &[&str]) -> Document {
    let clear = ["base.metalness=0 transmission.weight=1 specular.roughness=0"];
    let mut document = document(ModelSource::Sphere, light, &[&clear, assignments].concat());
    document.lighting.background = Background::Transparent;
    document
}

/// Mean colour of what the camera sees of the model.
fn mean(film: &Film) -> [f64; 3] {
    let alpha: f64 = film.colors().map(|color| color[3]).sum();
    [0, 1, 2].map(|i| film.colors().map(|color| color[i]).sum::<f64>() / alpha)
}

/// Light that paths are cut off from at their last bounce is missing from the picture, and told.
#[test]
fn light_cut_at_the_last_bounce_is_told() {
    for choice in ENGINES {
        let cut = |bounces: u32, weight: &str| {
            let white = ["base.color=1,1,1", weight];
            let mut document = glass(EnvironmentSource::Furnace, &white);
            document.lighting.background = Background::Environment;
            adjust(
                &mut document,
                &format!("render.width=32 render.height=32 render.bounces={bounces}"),
            );
            let film = render(choice, &document);
            let [value, ..] = mean(&film);
            (1.0 - value, film.cut_share())
        };
        let (missing, estimate) = cut(3, "transmission.weight=0.5");
        assert!(missing > 0.02, "{choice:?}: {missing}");
        near!(estimate, missing, 0.001, "{choice:?}");
        let (missing, estimate) = cut(64, "transmission.weight=1");
        assert!(
            missing.abs() < 0.001 && estimate < 0.001,
            "{choice:?}: {estimate} estimate, {missing} missing"
        );
    }
}

/// Mirrors and clear glass do not count towards the bounces from which on Russian roulette is played: what is behind a clear
/// pane has no noise in even light.
#[test]
fn no_albedo_is_gambled_for_behind_clear_glass() {
    let mut document = glass(EnvironmentSource::Furnace, &["specular.ior=1"]);
    document.ground = true;
    document.lighting.ground_color = [0.3, 0.2, 0.1];
    adjust(&mut document, "render.width=32 render.height=32 render.samples=8");
    for choice in ENGINES {
        let mut without = document.clone();
        without.materials[0].transmission_weight = 0.0;
        without.materials[0].opacity = 0.0;
        let [seen, expected] = [&document, &without].map(|document| spread(&render(choice, document)));
        assert!(seen < 1.05 * expected + 1e-6, "{choice:?}: {seen} against {expected}");
    }
}

/// The sum of the variances of a picture's pixels.
fn spread(film: &Film) -> f64 {
    film.variance_of_mean().iter().sum()
}
