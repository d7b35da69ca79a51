//! What the camera sees: parallel rays, and lights that are hidden from it, on both engines.

use glossmith::{
    document::{AreaLight, AreaLightShape, Background, Document},
    job::film::{Film, luminance},
    render::EngineChoice,
    scene::{ModelSource, camera::Projection, environment::EnvironmentSource},
};

use crate::renders::{document, render};

const ENGINES: [EngineChoice; 2] = [EngineChoice::Cpu, EngineChoice::Gpu];
const BACKGROUND: [f32; 3] = [0.2, 0.3, 0.4];

/// A sphere of radius 1 at a distance from the camera, with a lamp beside it.
fn lamp_beside_a_sphere(assignments: &[&str]) -> Document {
    let mut document = document(ModelSource::Sphere, EnvironmentSource::Furnace, assignments);
    document.lighting.strength = 0.0;
    document.lighting.background = Background::Color(BACKGROUND);
    document.lighting.area_lights = vec![AreaLight {
        shape: AreaLightShape::Sphere,
        yaw_deg: 100.0,
        pitch_deg: 0.0,
        distance: 2.0,
        width: 0.5,
        ..AreaLight::default()
    }];
    let camera = &mut document.camera;
    (camera.yaw_deg, camera.pitch_deg, camera.distance) = (0.0, 0.0, Some(10.0));
    document.render.samples = 32;
    document
}

fn at(film: &Film, [x, y]: [usize; 2]) -> [f64; 3] {
    let [r, g, b, _] = film.mean(64 * y + x);
    [r, g, b]
}

/// The mean luminance of the middle half of the image, where the sphere is.
fn of_sphere(film: &Film) -> f64 {
    let pixels = (16..48).flat_map(|y| (16..48).map(move |x| [x, y]));
    pixels.map(|pixel| luminance(at(film, pixel))).sum::<f64>() / 1024.0
}

/// It lights the sphere as before and is seen in a mirror, but the camera looks through it.
#[test]
fn a_light_hidden_from_the_camera_shines_and_is_not_seen() {
    let white = ["base.color=1,1,1 base.metalness=0 specular.weight=0"];
    let mirror = ["base.metalness=1 specular.roughness=0"];
    let place = [54, 31];
    for engine in ENGINES {
        let [seen, hidden] = [false, true].map(|is_hidden| {
            let mut document = lamp_beside_a_sphere(&white);
            document.lighting.area_lights[0].is_hidden = is_hidden;
            render(engine, &document)
        });
        assert!(luminance(at(&seen, place)) > 9.0, "{engine:?}: {:?}", at(&seen, place));
        for (channel, background) in std::iter::zip(at(&hidden, place), BACKGROUND) {
            near!(channel, f64::from(background), 1e-5, "{engine:?}");
        }
        let (before, now) = (of_sphere(&seen), of_sphere(&hidden));
        near!(now / before, 1.0, 0.02, "{engine:?}");
        let mut document = lamp_beside_a_sphere(&mirror);
        document.lighting.area_lights[0].is_hidden = true;
        let mirrored = render(engine, &document);
        let brightest = mirrored.luminance().into_iter().fold(0.0, f64::max);
        assert!(
            brightest > 2.0,
            "{engine:?}: the mirror shows nothing brighter than {brightest}"
        );
    }
}

/// The share of the image that a sphere covers, by hand: in parallel rays its disc over the image; else what its cone cuts.
#[test]
fn parallel_rays_show_true_sizes_wherever_the_camera_is() {
    let cases = [
        (Projection::Perspective, 3.0, 60.0, 0.2945),
        (Projection::Orthographic, 3.0, 60.0, 0.2618),
        // The camera is in the sphere, of which nothing is cut off.
        (Projection::Orthographic, 0.5, 130.0, 0.6831),
    ];
    for engine in ENGINES {
        for (projection, distance, fov_deg, covered) in cases {
            let mut document = document(ModelSource::Sphere, EnvironmentSource::Furnace, &[]);
            document.lighting.background = Background::Transparent;
            let camera = &mut document.camera;
            (camera.projection, camera.distance, camera.fov_deg) = (projection, Some(distance), fov_deg);
            document.render.samples = 16;
            let film = render(engine, &document);
            let alpha = (0..film.pixel_count()).map(|pixel| film.mean(pixel)[3]).sum::<f64>();
            let share = alpha / film.pixel_count() as f64;
            // The sphere's triangles lie a little within it.
            near!(share, covered, 0.004, "{engine:?}, {projection:?} at {distance}");
        }
    }
}
