//! Grounds: the shadow catcher is the background where nothing stands on it, its shadows and reflections have their true
//! values, on both engines.

use crate::renders::{adjust, assert_same_picture, document, render};
use glam::DVec3;
use glossmith::{
    document::{AreaLight, Background, Document, GroundKind, MaterialSettings},
    job::film::Film,
    optics::vector::{Vec3, vec3},
    render::EngineChoice,
    scene::{
        AreaShape, ModelSource, Outline,
        catcher::{CatcherLight, NearLight, catcher_light, catcher_reflectance, catcher_table},
        environment::EnvironmentSource,
    },
};
use std::f64::consts::PI;

const ENGINES: [EngineChoice; 2] = [EngineChoice::Cpu, EngineChoice::Gpu];

/// How far, along the ground, the place that is looked at is from where the sphere touches it.
const AWAY: f64 = 1.5;

/// The sphere's luminance where it shines.
const GLOW: f32 = 3.0;

/// A black sphere on a shadow catcher.
fn caught(environment: EnvironmentSource) -> Document {
    let mut document = document(ModelSource::Sphere, environment, &[]);
    document.materials = vec![MaterialSettings::diffuse("black", [0.0; 3])];
    document.ground = true;
    document.lighting.ground.kind = GroundKind::ShadowCatcher;
    document.render.bounces = 2;
    document
}

/// Looks at one place on the ground from across the sphere, or along it.
fn at_one_place(document: &mut Document, across: bool) {
    document.camera.target = Some([AWAY, -1.0, 0.0]);
    let away = if across { 4.0 } else { 0.0 };
    document.camera.position = Some([AWAY + away, 1.0, 4.0 - away]);
    document.camera.fov_deg = 0.1;
    adjust(
        document,
        "render.width=8 render.height=8 render.samples=2048 render.sequence=sobol",
    );
}

/// Red, green, blue and coverage, averaged over the picture.
fn mean(film: &Film) -> [f64; 4] {
    let pixels = film.colors().count();
    (0..pixels).fold([0.0; 4], |sum, pixel| {
        let of = film.mean(pixel);
        [0, 1, 2, 3].map(|channel| sum[channel] + of[channel] / pixels as f64)
    })
}

#[track_caller]
fn assert_near(found: f64, expected: f64, tolerance: f64, what: &str) {
    near!(found, expected, tolerance, "{what}");
}

/// The share of the light of a uniform environment that the sphere of radius 1 takes from the place: its form factor.
fn shadow() -> f64 {
    let distance = AWAY.hypot(1.0);
    1.0 / distance.powi(3)
}

#[test]
fn nothing_on_it_is_nothing_to_be_seen() {
    for engine in ENGINES {
        let mut document = caught(EnvironmentSource::Studio);
        document.hidden_objects = vec![0];
        document.render.samples = 256;
        (document.camera.pitch_deg, document.camera.yaw_deg) = (30.0, 145.0);
        for (blur, reflection, is_lit) in [(0.0, 0.7, false), (10.0, 0.0, true)] {
            document.lighting.background_blur_deg = blur;
            (document.lighting.ground.reflection, document.lighting.ground.roughness) = (reflection, 0.5);
            // It would be seen mirrored in the ground.
            if is_lit {
                document.lighting.area_lights.push(AreaLight {
                    pitch_deg: 30.0,
                    distance: 2.0,
                    ..AreaLight::default()
                });
            }
            let mut bare = document.clone();
            bare.ground = false;
            let (with, without) = (render(engine, &document), render(engine, &bare));
            let apart = with.difference_in_sigma(&without);
            assert!(
                apart.abs() < 4.0,
                "{engine:?}, blurred by {blur}: off by {apart:.1} sigma"
            );
            let [with, without] = [with, without].map(|film| mean(&film));
            for channel in 0..3 {
                assert_near(with[channel] / without[channel], 1.0, 0.006, "the background");
            }
        }
    }
}

#[test]
fn shadows_are_the_light_that_is_missing() {
    for engine in ENGINES {
        let mut document = caught(EnvironmentSource::Furnace);
        at_one_place(&mut document, false);
        let color = [0.2, 0.5, 0.8];
        document.lighting.background = Background::Color(color);
        let found = mean(&render(engine, &document));
        for (found, color) in found.iter().zip(color) {
            assert_near(*found, f64::from(color) * (1.0 - shadow()), 0.002, "over a colour");
        }
        document.lighting.background = Background::Transparent;
        let [red, green, blue, alpha] = mean(&render(engine, &document));
        assert_eq!([red, green, blue], [0.0; 3], "a shadow is black");
        assert_near(alpha, shadow(), 0.002, "alpha");
    }
}

#[test]
fn shadows_of_area_lights_are_black_without_other_light() {
    for engine in ENGINES {
        let mut document = caught(EnvironmentSource::Furnace);
        document.lighting.strength = 0.0;
        document.lighting.background = Background::Color([1.0; 3]);
        // Behind the sphere, seen from the place.
        document.lighting.area_lights.push(AreaLight {
            yaw_deg: -90.0,
            pitch_deg: 30.0,
            distance: 3.0,
            width: 0.2,
            height: 0.2,
            ..AreaLight::default()
        });
        at_one_place(&mut document, false);
        let [dark, ..] = mean(&render(engine, &document));
        assert_near(dark, 0.0, 1e-6, "in the core");
        document.camera.target = Some([0.0, -1.0, 6.0]);
        document.camera.position = Some([0.0, 3.0, 10.0]);
        let [bright, ..] = mean(&render(engine, &document));
        assert_near(bright, 1.0, 0.01, "aside");
    }
}

#[test]
fn reflections_lie_over_the_background() {
    for engine in ENGINES {
        let mut document = caught(EnvironmentSource::Furnace);
        document.lighting.background = Background::Color([0.5; 3]);
        document.lighting.ground.roughness = 0.0;
        // The mirrored view meets the sphere.
        at_one_place(&mut document, true);
        document.materials[0].emission_color = [1.0; 3];
        document.materials[0].emission_strength = GLOW;
        let [plain, ..] = mean(&render(engine, &document));
        document.lighting.ground.reflection = 1.0;
        let [shiny, ..] = mean(&render(engine, &document));
        let cosine = 2.0 / 4.0_f64.hypot(2.0);
        let share = 0.04 + 0.96 * (1.0 - cosine).powi(5);
        let expected = plain * (1.0 - share) + f64::from(GLOW) * share;
        assert_near(shiny, expected, 0.004, "over a colour");
        document.lighting.background = Background::Transparent;
        let [red, .., alpha] = mean(&render(engine, &document));
        assert_near(red, f64::from(GLOW) * share, 0.004, "premultiplied");
        assert!(alpha > share - 0.2 && alpha < 1.0, "{alpha}");
    }
}

/// From below, and where no light would be, there is no ground.
#[test]
fn it_is_not_there_from_below() {
    for engine in ENGINES {
        let mut document = caught(EnvironmentSource::Studio);
        document.hidden_objects = vec![0];
        document.camera.pitch_deg = -40.0;
        let mut bare = document.clone();
        bare.ground = false;
        assert_same_picture(&render(engine, &document), &render(engine, &bare), "from below");
    }
}

#[test]
fn a_plane_under_a_uniform_environment_shows_its_radiance() {
    let environment = EnvironmentSource::Furnace.computed().expect("loads");
    let light = CatcherLight {
        environment: &environment,
        rotation: [1.0, 0.0],
        strength: 2.0,
        area_lights: &[],
    };
    let table = catcher_table(&light, 0.0, 0.5);
    let found: Vec3<f64> = catcher_light(&table, 0, vec3(3.0, 0.0, -7.0));
    let expected = f64::from(environment.texels[0][0]) * 2.0;
    near!(found.x, expected, 1e-6 * expected);
    near!(catcher_reflectance(&table, 0, 1.0_f64), 0.02, 1e-7);
    near!(catcher_reflectance(&table, 0, 0.0_f64), 0.5, 1e-7);
}

/// The light on a plane below one light of radiance 1, at places of a height.
fn table_of(shape: AreaShape, spot: [f64; 2], height: f64) -> impl Fn(f64, f64) -> f64 {
    let environment = EnvironmentSource::Studio.computed().expect("loads");
    let radiance = [1.0; 3];
    let light = CatcherLight {
        environment: &environment,
        rotation: [1.0, 0.0],
        strength: 0.0,
        area_lights: &[NearLight { shape, radiance, spot }],
    };
    let table = catcher_table(&light, height, 0.0);
    move |x, z| catcher_light(&table, 0, vec3(x, height, z)).x
}

fn lamp(outline: Outline, width: f64, target: [f64; 3]) -> AreaShape {
    AreaShape {
        yaw_deg: 0.0,
        pitch_deg: 90.0,
        distance: 2.0,
        width,
        height: width,
        target,
        turn_deg: 0.0,
        outline,
    }
}

#[test]
fn a_spot_lights_what_its_cone_holds_and_a_sphere_from_its_near_side() {
    // From 30° to 20°.
    let [inner, outer] = [20.0_f64, 30.0].map(|angle| angle.to_radians().cos());
    let spots = [[0.0, 1.0], [1.0 / (inner - outer), -outer / (inner - outer)]];
    let disk = lamp(Outline::Ellipse, 0.02, [1.0, 0.0, 0.0]);
    let [lamp_at, spot_at] = spots.map(|spot| table_of(disk, spot, -0.5));
    // 2.5 below it: tan 10°, tan 25° and tan 45° beside its target.
    let beside = |angle_deg: f64| 1.0 + 2.5 * angle_deg.to_radians().tan();
    let share = |angle_deg: f64| spot_at(beside(angle_deg), 0.0) / lamp_at(beside(angle_deg), 0.0);
    near!(share(10.0), 1.0, 0.001);
    assert!((0.1..0.5).contains(&share(25.0)), "{}", share(25.0));
    assert_eq!(spot_at(beside(45.0), 0.0), 0.0);
    // A sphere: the squared sine of half its angle.
    let found = table_of(lamp(Outline::Sphere, 0.2, [0.0; 3]), [0.0, 1.0], -0.5)(0.0, 0.0);
    assert_near(found / (0.1_f64 / 2.5).powi(2), 1.0, 0.01, "below a sphere");
}

/// Form factors of rectangles above and through the horizon, by quadrature.
#[test]
fn tables_with_lights_are_near_the_true_light() {
    for (pitch_deg, height) in [(35.0, -0.6), (4.0, -0.1)] {
        let shape = AreaShape {
            yaw_deg: 30.0,
            pitch_deg,
            height: 0.6,
            ..lamp(Outline::Rectangle, 1.0, [0.0; 3])
        };
        let found_at = table_of(shape, [0.0, 1.0], height);
        let frame = shape.frame();
        for (x, z) in [
            (0.0, 0.0),
            (0.13, -0.4),
            (0.9, 1.1),
            (-2.3, 0.7),
            (0.3, 6.2),
            (5.0, -8.0),
            (19.9, 19.9),
        ] {
            const STEPS: i32 = 300;
            let steps = || (0..STEPS).map(|step| (f64::from(step) + 0.5) / f64::from(STEPS) - 0.5);
            let mut sum = 0.0;
            for (a, b) in steps().flat_map(|a| steps().map(move |b| (a, b))) {
                let at = frame.middle + frame.across * (shape.width * a) + frame.up * (shape.height * b);
                let way = at - DVec3::new(x, height, z);
                let cosines = (way.y / way.length()).max(0.0) * (frame.outwards.dot(way) / way.length()).abs();
                sum += cosines / way.length_squared();
            }
            let expected = sum * shape.width * shape.height / f64::from(STEPS * STEPS) / PI;
            let found = found_at(x, z);
            near!(found / expected, 1.0, 0.01, "{pitch_deg}, {x}, {z}");
        }
        assert!(found_at(40.0, 0.0) > 0.0);
    }
}
