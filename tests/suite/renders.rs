//! Pictures: the engines against each other, against analytic values, and the strategies against each other.

use std::sync::{Arc, LazyLock, Mutex, PoisonError};
use std::time::Duration;

use glossmith::analysis::error::{Estimates, z_test};
use glossmith::cpu::CpuEngine;
use glossmith::document::effect::EffectSwitches;
use glossmith::document::{Background, Document, MaterialSettings, PixelFilter, Strategy, assign};
use glossmith::job::Job;
use glossmith::job::film::Film;
use glossmith::job::tiles::TILE_SIDE;
use glossmith::optics::random::Sequence;
use glossmith::render::{Assets, EngineChoice, Session};
use glossmith::scene::ModelSource;
use glossmith::scene::environment::{self, Environment, EnvironmentSource};

/// A small document: one material from assignments, box filter, independent samples (so that variances are honest).
pub fn document(model: ModelSource, light: EnvironmentSource, assignments: &[&str]) -> Document {
    let mut material = MaterialSettings::default();
    for assignment in assignments {
        assign(&mut material, assignment).unwrap();
    }
    let mut document = Document {
        model,
        materials: vec![material],
        ..Document::default()
    };
    document.lighting.environment = light;
    document.render.width = 64;
    document.render.height = 64;
    document.render.samples = 64;
    document.render.filter = PixelFilter::Box;
    document.render.sequence = Sequence::Independent;
    document
}

/// Sessions that no test is using at the moment. They keep their kernels, and share the built-in models and environments.
static IDLE: Mutex<Vec<(EngineChoice, Session)>> = Mutex::new(Vec::new());
static ASSETS: LazyLock<Assets> = LazyLock::new(Assets::default);

/// Renders to the end. The GPU uses the general kernel unless the document switches effects: compiling a kernel for each
/// document would take longer than rendering it, and `plan_kernels.rs` compares specialised kernels with the general one.
pub fn render(choice: EngineChoice, document: &Document) -> Film {
    let mut document = document.clone();
    if choice == EngineChoice::Gpu && document.render.effects == EffectSwitches::default() {
        document.render.effects = EffectSwitches::all_on();
    }
    // Files may be written again under the same name.
    if !is_built_in(&document) {
        return render_with(&mut Session::open(choice).unwrap(), &document);
    }
    let mut idle = IDLE.lock().unwrap_or_else(PoisonError::into_inner);
    let place = idle.iter().position(|(of, _)| *of == choice);
    let kept = place.map(|place| idle.swap_remove(place).1);
    drop(idle);
    let mut session = kept.unwrap_or_else(|| Session::open_with(choice, ASSETS.clone()).unwrap());
    session.reset();
    let film = render_with(&mut session, &document);
    IDLE.lock()
        .unwrap_or_else(PoisonError::into_inner)
        .push((choice, session));
    film
}

fn is_built_in(document: &Document) -> bool {
    !matches!(document.model, ModelSource::File(_))
        && !matches!(document.lighting.environment, EnvironmentSource::File(_))
        && document.pictures().next().is_none()
}

fn render_with(session: &mut Session, document: &Document) -> Film {
    session.submit(document).unwrap();
    while !session.step(Duration::from_secs(1)).unwrap().is_done {}
    session.film().unwrap().clone()
}

/// The share of pixels whose luminances differ by more than three standard deviations of their noise.
pub(super) fn beyond_three_sigma(a: &Film, b: &Film) -> f64 {
    let (mean_a, mean_b) = (a.luminance(), b.luminance());
    // Rounding of f32 radiance beside the noise.
    let floored = |film: &Film, mean: &[f64]| -> Vec<f64> {
        let floor = |(variance, mean): (f64, &f64)| variance + (1e-4 * mean.max(1e-3)).powi(2);
        film.variance_of_mean().into_iter().zip(mean).map(floor).collect()
    };
    let (variance_a, variance_b) = (floored(a, &mean_a), floored(b, &mean_b));
    let (a, b) = (
        Estimates {
            mean: &mean_a,
            variance: &variance_a,
        },
        Estimates {
            mean: &mean_b,
            variance: &variance_b,
        },
    );
    z_test(a, b).beyond_three_sigma
}

/// Fails unless two films show the same picture: their sums agree, few pixels are beyond 3 standard deviations.
#[track_caller]
pub fn assert_same_picture(a: &Film, b: &Film, what: &str) {
    let whole = a.difference_in_sigma(b);
    assert!(whole.abs() < 4.0, "{what}: the whole image is off by {whole:.1} sigma");
    // Pixels with few bright hits are skewed, so the tails are wider than a normal's 0.27 %.
    let beyond = beyond_three_sigma(a, b);
    assert!(
        beyond < 0.02,
        "{what}: {:.2} % of pixels beyond 3 sigma",
        100.0 * beyond
    );
}

pub fn with_strategy(document: &Document, strategy: Strategy, seed: u32) -> Document {
    let mut document = document.clone();
    document.render.strategy = strategy;
    document.render.seed = seed;
    document
}

/// Sees the z-test fail: another roughness is found.
#[test]
fn a_different_material_is_a_different_picture() {
    let one = document(
        ModelSource::Teapot,
        EnvironmentSource::Studio,
        &["specular.roughness=0.4"],
    );
    let other = document(
        ModelSource::Teapot,
        EnvironmentSource::Studio,
        &["specular.roughness=0.6"],
    );
    let other = render(EngineChoice::Cpu, &with_strategy(&other, Strategy::Mis, 3));
    let beyond = beyond_three_sigma(&render(EngineChoice::Cpu, &one), &other);
    assert!(beyond > 0.02, "only {:.2} % of pixels differ", 100.0 * beyond);
}

#[test]
fn strategies_converge_to_the_same_picture() {
    for (light, assignments) in [
        (EnvironmentSource::Studio, &["specular.roughness=0.6"][..]),
        (
            EnvironmentSource::Studio,
            &["base.metalness=0", "specular.roughness=0.7", "specular.lobe=ggx"],
        ),
        (
            EnvironmentSource::Sky,
            &["base.metalness=0", "specular.weight=0", "base.color=0.7,0.7,0.7"],
        ),
    ] {
        let mut document = document(ModelSource::Teapot, light, assignments);
        // The sun is found by chance only: the lobe strategy needs a broad lobe and many samples to have an honest
        // variance, so it is compared where there is no sun.
        let has_sun = document.lighting.environment == EnvironmentSource::Sky;
        document.lighting.background = Background::Transparent;
        document.render.samples = 256;
        let mis = render(EngineChoice::Cpu, &document);
        let light = render(EngineChoice::Cpu, &with_strategy(&document, Strategy::Light, 1));
        assert_same_picture(&mis, &light, &format!("mis against light, {assignments:?}"));
        if !has_sun {
            let lobe = render(EngineChoice::Cpu, &with_strategy(&document, Strategy::Lobe, 2));
            assert_same_picture(&mis, &lobe, &format!("mis against lobe, {assignments:?}"));
        }
    }
}

/// Issue 2's furnace: F = 1 under a constant environment, geometric lobe, mirror policy, every pixel 1 ± 0.5 %.
#[test]
fn white_furnace_is_white() {
    for choice in [EngineChoice::Cpu, EngineChoice::Gpu] {
        for curve in ["smooth", "sqrt", "long-tail"] {
            for roughness in ["0", "0.001", "0.1", "0.5", "0.9", "1"] {
                let assignments = [
                    &format!("specular.curve={curve}")[..],
                    &format!("specular.roughness={roughness}"),
                    "specular.fresnel=none",
                ];
                let mut document = document(ModelSource::Teapot, EnvironmentSource::Furnace, &assignments);
                document.render.samples = 8;
                let film = render(choice, &document);
                assert_eq!(film.dropped(), 0);
                for (i, pixel) in film.image().pixels.iter().enumerate() {
                    let worst = pixel[..3].iter().map(|x| (x - 1.0).abs()).fold(0.0, f32::max);
                    assert!(worst < 0.005, "{choice:?}, {assignments:?}: pixel {i} is {pixel:?}");
                }
            }
        }
    }
}

/// A white dielectric neither loses nor makes light: its base gets what its lobe leaves over.
#[test]
fn a_white_dielectric_is_white_in_the_furnace() {
    let assignments = [
        "base.metalness=0",
        "base.color=1,1,1",
        "specular.roughness=0.3",
        "specular.fresnel=dielectric",
    ];
    let mut document = document(ModelSource::Teapot, EnvironmentSource::Furnace, &assignments);
    document.render.samples = 256;
    let film = render(EngineChoice::Cpu, &document);
    let greens = (0..film.pixel_count()).map(|pixel| film.mean(pixel)[1]);
    let mean = greens.sum::<f64>() / film.pixel_count() as f64;
    assert!((mean - 1.0).abs() < 0.003, "mean {mean}");
}

/// A mirror sphere shows the environment where the mirrored ray points: against a direct look-up.
#[test]
fn mirror_sphere_shows_the_environment() {
    // A smooth map of our own: bright in +X, so that a turned or mirrored map is noticed.
    let texel = |i: u32| {
        let u = (f64::from(i % 256) + 0.5) / 256.0 * std::f64::consts::TAU;
        [
            (1.5 + u.sin()) as f32,
            (1.5 + u.cos()) as f32,
            (0.5 + f64::from(i / 256) / 128.0) as f32,
            1.0,
        ]
    };
    let map = Environment::from_texels("test", 256, 128, (0..256 * 128).map(texel).collect()).unwrap();
    let mut document = document(
        ModelSource::Sphere,
        EnvironmentSource::Furnace,
        &["specular.roughness=0", "specular.fresnel=none"],
    );
    document.lighting.rotation_deg = 30.0;
    document.render.samples = 64;
    let mut session = Session::open(EngineChoice::Cpu).unwrap();
    session.submit(&document).unwrap();
    let job = Job {
        environment: Arc::new(map.clone()),
        ..Job::clone(session.job().unwrap())
    };
    let mut engine = CpuEngine::default();
    let camera = job.settings.camera;
    let rotation = job.settings.environment_rotation;
    engine.submit(Arc::new(job));
    engine.step(Duration::from_secs(100), 64);
    let image = engine.film().image();
    // The pixel in the middle of the picture's upper half: its ray meets the unit sphere analytically.
    for (x, y) in [(32, 20), (20, 32), (44, 32), (32, 32), (32, 44)] {
        let place = [f64::from(x) + 0.5, f64::from(y) + 0.5];
        let [origin, direction] = glossmith::scene::camera::camera_ray(&camera, place, [64, 64], [0.0, 0.0]);
        let b = origin.dot(direction);
        let hit = origin + direction * (-b - (b * b - origin.dot(origin) + 1.0).sqrt());
        let mirrored = -direction.reflected_at_plane(hit) * -1.0;
        let local = environment::environment_local_from_world(mirrored, rotation);
        let expected = environment::environment_radiance(&map, local).to_f64();
        let pixel = image.pixels[y as usize * 64 + x as usize];
        for i in 0..3 {
            let error = (f64::from(pixel[i]) - expected[i]).abs();
            assert!(error < 0.02, "pixel {x},{y}: {pixel:?}, expected {expected:?}");
        }
    }
}

/// A step ends with its time: where there is none, each core renders a tile at most. However many steps a picture takes, it
/// is the same.
#[test]
fn a_step_on_the_processor_ends_with_its_time() {
    let mut document = document(ModelSource::Sphere, EnvironmentSource::Studio, &[]);
    (document.render.width, document.render.height) = (128, 128);
    document.render.samples = 2;
    let mut session = Session::open(EngineChoice::Cpu).unwrap();
    session.submit(&document).unwrap();
    let rendered_in = |time: Duration| {
        let mut engine = CpuEngine::default();
        engine.submit(session.job().unwrap().clone());
        let mut steps = Vec::new();
        while !engine.schedule().is_at_goal() || steps.is_empty() {
            let before = engine.schedule().pixel_samples();
            engine.step(time, document.render.samples);
            steps.push(engine.schedule().pixel_samples() - before);
        }
        let means: Vec<_> = (0..engine.film().pixel_count())
            .map(|pixel| engine.film().mean(pixel))
            .collect();
        (steps, means)
    };
    let (at_once, whole) = rendered_in(Duration::MAX);
    let (steps, cut) = rendered_in(Duration::ZERO);
    assert_eq!(at_once, [128 * 128 * 2]);
    let most = u64::from(TILE_SIDE * TILE_SIDE) * rayon::current_num_threads() as u64;
    assert!(steps.iter().all(|samples| (1..=most).contains(samples)), "{steps:?}");
    assert_eq!(whole, cut);
}

/// Sums do not stall: the mean of a constant picture after many flushes is what it was after one sample.
#[test]
fn sums_do_not_stall() {
    let mut document = document(
        ModelSource::Sphere,
        EnvironmentSource::Furnace,
        &["specular.fresnel=none"],
    );
    (document.render.width, document.render.height) = (8, 8);
    document.lighting.strength = 0.1;
    document.render.samples = 20_000;
    for choice in [EngineChoice::Cpu, EngineChoice::Gpu] {
        let film = render(choice, &document);
        for pixel in 0..film.pixel_count() {
            let mean = film.mean(pixel)[1];
            assert!((mean / 0.1 - 1.0).abs() < 1e-5, "{choice:?}: {mean}");
        }
    }
}

/// A picture does not depend on how the work was cut into steps, on the CPU to the bit.
#[test]
fn steps_do_not_change_the_picture() {
    let mut document = document(ModelSource::Teapot, EnvironmentSource::Studio, &[]);
    document.render.samples = 3;
    let whole = render(EngineChoice::Cpu, &document);
    let mut session = Session::open(EngineChoice::Cpu).unwrap();
    session.submit(&document).unwrap();
    while !session.step(Duration::from_micros(200)).unwrap().is_done {}
    assert_eq!(&whole, session.film().unwrap());
}
