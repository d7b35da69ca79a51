//! Parts of the light: direct and indirect light are all of it, path by path, on both engines.

use std::f32::consts::SQRT_2;

use glossmith::{
    document::{Background, Document, GroundKind, LightPaths},
    render::EngineChoice,
    scene::{ModelSource, environment::EnvironmentSource},
};

use super::{
    cli_support::Workplace,
    lights::lit_scenes,
    renders::{adjust, document, render},
};

/// Scenes where light is reflected between surfaces, with lights and without, and with a shadow catcher.
fn scenes() -> Vec<(&'static str, Document)> {
    let mut scenes = lit_scenes();
    let glass = ["base.metalness=0 transmission.weight=0.9 specular.roughness=0.3"];
    scenes.push((
        "glass",
        document(ModelSource::Teapot, EnvironmentSource::Studio, &glass),
    ));
    let mut caught = document(ModelSource::Teapot, EnvironmentSource::Sky, &["base.metalness=0"]);
    caught.ground = true;
    (caught.lighting.ground.kind, caught.lighting.ground.reflection) = (GroundKind::ShadowCatcher, 0.5);
    caught.lighting.background = Background::Environment;
    scenes.push(("shadow catcher", caught));
    for (_, document) in &mut scenes {
        adjust(
            document,
            "render.width=24 render.height=24 render.samples=4 render.bounces=6",
        );
    }
    scenes
}

fn of(document: &Document, paths: LightPaths) -> Document {
    let mut document = document.clone();
    document.render.light_paths = paths;
    document
}

#[test]
fn direct_and_indirect_light_are_all_light() {
    for engine in [EngineChoice::Cpu, EngineChoice::Gpu] {
        let mut with_both = 0;
        for (name, document) in scenes() {
            let film = |paths| render(engine, &of(&document, paths));
            let [all, direct, indirect] = [LightPaths::All, LightPaths::Direct, LightPaths::Indirect].map(film);
            let sum = |film: &glossmith::job::film::Film| film.colors().map(|[r, g, b, _]| r + g + b).sum::<f64>();
            assert!(sum(&direct) > 0.001 * sum(&all), "{name}: there is direct light");
            with_both += usize::from(sum(&indirect) > 0.001 * sum(&all));
            let mut off = 0;
            for pixel in 0..all.pixel_count() {
                let [whole, direct, indirect] = [&all, &direct, &indirect].map(|film| film.color(pixel));
                let differs = (0..3).any(|channel| {
                    let parts = direct[channel] + indirect[channel];
                    (parts - whole[channel]).abs() > 0.0001 * (1.0 + whole[channel])
                });
                off += usize::from(differs);
            }
            // The GPU sums in single precision.
            let allowed = if engine == EngineChoice::Cpu {
                0
            } else {
                all.pixel_count() / 100
            };
            assert!(
                off <= allowed,
                "{engine:?}, {name}: {off} pixels are not the sum of their parts"
            );
        }
        assert!(with_both >= 4, "light is reflected twice in most scenes");
    }
}

#[test]
fn a_convex_body_in_the_open_has_no_indirect_light() {
    let sphere = document(ModelSource::Sphere, EnvironmentSource::Studio, &[]);
    let film = render(EngineChoice::Cpu, &of(&sphere, LightPaths::Indirect));
    assert!(film.colors().all(|[r, g, b, _]| [r, g, b] == [0.0; 3]));
    near!(
        film.image().pixels[0][3],
        1.0,
        SQRT_2 * f32::EPSILON,
        "what is covered stays so"
    );
}

#[test]
fn the_command_line_renders_parts_of_the_light() {
    let place = Workplace::new();
    // What is left out is told.
    let told = place
        .done("explain --pixel 8,8 --size 16x16 --samples 4 --engine cpu --light-paths indirect")
        .stdout;
    assert!(told.contains("is not of the light that is shown"), "{told}");
    place.refused(2, "render --light-paths some", &["direct", "indirect"]);
}
