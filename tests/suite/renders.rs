//! Rendering for tests, and pictures against each other.

use std::sync::{LazyLock, Mutex, PoisonError};
use std::time::Duration;

use glossmith::{
    analysis::error::{Estimates, z_test},
    document::{Document, MaterialSettings, assign, effect::EffectSwitches},
    job::film::Film,
    render::{Assets, EngineChoice, Session},
    scene::{ModelSource, environment::EnvironmentSource},
};

/// Makes assignments that blanks part.
pub fn set(material: &mut MaterialSettings, assignments: &str) {
    for assignment in assignments.split_whitespace() {
        assign(material, assignment).unwrap();
    }
}

/// Makes assignments to the settings of a document and to all its materials.
pub fn adjust(document: &mut Document, assignments: &str) {
    for assignment in assignments.split_whitespace() {
        document.assign(assignment).unwrap();
    }
}

/// The default material but for these assignments.
pub fn material(assignments: &str) -> MaterialSettings {
    let mut material = MaterialSettings::default();
    set(&mut material, assignments);
    material
}

/// A small document: one material from assignments, box filter, independent samples (so that variances are honest).
pub fn document(model: ModelSource, light: EnvironmentSource, assignments: &[&str]) -> Document {
    let mut document = Document {
        model,
        materials: vec![material(&assignments.join(" "))],
        ..Document::default()
    };
    document.lighting.environment = light;
    adjust(
        &mut document,
        "render.width=64 render.height=64 render.samples=64 render.filter=box render.sequence=independent",
    );
    document
}

/// Sessions that no test is using at the moment, for files or without. They keep their kernels; those without files share the
/// built-in models and environments.
static IDLE: Mutex<Vec<(EngineChoice, bool, Session)>> = Mutex::new(Vec::new());
static ASSETS: LazyLock<Assets> = LazyLock::new(Assets::default);

/// Renders to the end. The GPU uses the general kernel unless the document switches effects: compiling a kernel for each
/// document would take longer than rendering it, and `plan_kernels.rs` compares specialised kernels with the general one.
pub fn render(choice: EngineChoice, document: &Document) -> Film {
    let mut document = document.clone();
    if choice == EngineChoice::Gpu && document.render.effects == EffectSwitches::default() {
        document.render.effects = EffectSwitches::all_on();
    }
    let has_files = !is_built_in(&document);
    let mut idle = IDLE.lock().unwrap_or_else(PoisonError::into_inner);
    let place = idle
        .iter()
        .position(|(of, files, _)| (*of, *files) == (choice, has_files));
    let kept = place.map(|place| idle.swap_remove(place).2);
    drop(idle);
    let assets = || if has_files { Assets::default() } else { ASSETS.clone() };
    let mut session = kept.unwrap_or_else(|| Session::open_with(choice, assets()).unwrap());
    session.reset();
    if has_files {
        // Files may be written again under the same name.
        session.reload(&document).unwrap();
    }
    let film = render_with(&mut session, &document);
    IDLE.lock()
        .unwrap_or_else(PoisonError::into_inner)
        .push((choice, has_files, session));
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
pub fn beyond_three_sigma(a: &Film, b: &Film) -> f64 {
    let (mean_a, mean_b) = (a.luminance(), b.luminance());
    // Rounding of f32 radiance beside the noise.
    let floored = |film: &Film, mean: &[f64]| -> Vec<f64> {
        let floor = |(variance, mean): (f64, &f64)| variance + (0.0001 * mean.max(0.001)).powi(2);
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
