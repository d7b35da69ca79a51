//! The plan: its rules and switches.

use std::time::Duration;

use glossmith::{
    document::{
        AreaLight, Document, MaterialSettings,
        effect::{EFFECTS, EffectSwitches, Switch},
    },
    job::{Job, effect::EffectId, film::Film},
    optics::curve::Curve,
    render::{Assets, EngineChoice, Session},
    scene::ModelSource,
};

use crate::{
    cli_support::Workplace,
    plan_kernels::assert_same_but_for_rounding,
    random_documents::{of_material, small},
};

type Edit = fn(&mut Document);

pub fn film(session: &mut Session, document: &Document) -> Film {
    session.submit(document).unwrap();
    while !session.step(Duration::from_secs(1)).unwrap().is_done {}
    session.film().unwrap().clone()
}

fn generally(document: &Document) -> Document {
    let mut document = document.clone();
    document.render.effects = EffectSwitches::all_on();
    document
}

pub fn job(document: &Document) -> Job {
    job_in(&mut Session::open(EngineChoice::Cpu).unwrap(), document)
}

/// The same in a session that keeps what it has loaded.
pub fn job_in(session: &mut Session, document: &Document) -> Job {
    session.submit(document).unwrap();
    Job::clone(session.job().unwrap())
}

#[test]
fn a_convex_body_alone_sees_nothing_but_the_light() {
    let sees = |model: ModelSource, edit: fn(&mut Document)| {
        let mut document = of_material(model, MaterialSettings::default());
        edit(&mut document);
        job(&document).plan.has(EffectId::Interreflection)
    };
    assert!(!sees(ModelSource::Sphere, |_| {}));
    assert!(!sees(ModelSource::Plane, |_| {}));
    assert!(sees(ModelSource::Teapot, |_| {}));
    assert!(sees(ModelSource::Sphere, |d| d.ground = true));
    assert!(sees(ModelSource::Sphere, |d| d.lighting.area_lights =
        vec![AreaLight::default()]));
}

#[test]
fn a_mirror_calls_for_no_light_sampling_but_under_a_rough_coat() {
    let samples_light = |edit: fn(&mut MaterialSettings)| {
        let mut mirror = MaterialSettings {
            roughness: 0.0,
            ..MaterialSettings::default()
        };
        edit(&mut mirror);
        job(&of_material(ModelSource::Sphere, mirror))
            .plan
            .has(EffectId::LightSampling)
    };
    assert!(!samples_light(|_| {}));
    assert!(samples_light(|m| (m.coat_weight, m.coat_roughness) = (0.5, 0.2)));
    assert!(!samples_light(|m| (m.coat_weight, m.coat_roughness) = (0.5, 0.0)));
}

/// A body seen from high above.
fn from_above(model: ModelSource, roughness: f32) -> Document {
    let material = MaterialSettings {
        roughness,
        ..MaterialSettings::default()
    };
    let mut document = of_material(model, material);
    document.camera.pitch_deg = 60.0;
    document.render.samples = 64;
    document
}

/// The kernel leaves it out: the processor's engine takes each material's.
#[test]
fn a_kernel_without_a_horizon_draws_the_same() {
    let plane = from_above(ModelSource::Plane, 0.4);
    let mut session = Session::open(EngineChoice::Gpu).unwrap();
    let [specialised, general] = [plane.clone(), generally(&plane)].map(|document| film(&mut session, &document));
    assert_same_but_for_rounding(&specialised, &general, "a steep view");
}

#[test]
fn the_horizon_is_left_out_where_every_view_is_steep_enough() {
    let plane = from_above(ModelSource::Plane, 0.4);
    assert!(!job(&plane).plan.has(EffectId::Horizon));
    assert!(
        job(&from_above(ModelSource::Plane, 0.95)).plan.has(EffectId::Horizon),
        "rough"
    );
    assert!(
        job(&from_above(ModelSource::Sphere, 0.4)).plan.has(EffectId::Horizon),
        "a silhouette"
    );
    let edits: [(&str, Edit); 4] = [
        ("a shallow view", |document| document.camera.pitch_deg = 10.0),
        ("views from a lens", |document| document.camera.aperture = 0.1),
        ("rays from the ground", |document| document.ground = true),
        ("a curve beyond the lobe's ball", |document| {
            document.materials[0].curve = Curve::LongTail;
        }),
    ];
    for (what, edit) in edits {
        let mut other = plane.clone();
        edit(&mut other);
        assert!(job(&other).plan.has(EffectId::Horizon), "{what}");
    }
}

#[test]
fn either_kind_of_light_sampling_is_taken_out_alone() {
    let mut document = of_material(ModelSource::Sphere, MaterialSettings::default());
    document.lighting.area_lights.push(AreaLight::default());
    let has = |document: &Document| {
        let plan = job(document).plan;
        [EffectId::LightSampling, EffectId::EmitterSampling].map(|effect| plan.has(effect))
    };
    assert_eq!(has(&document), [true, true]);
    let mut reference = document.clone();
    reference.render.samples = 256;
    let mut session = Session::open(EngineChoice::Cpu).unwrap();
    let both = film(&mut session, &reference);
    for (effect, left) in [
        (EffectId::LightSampling, [false, true]),
        (EffectId::EmitterSampling, [true, false]),
    ] {
        document.render.effects = EffectSwitches::default();
        document.render.effects.set(effect, Switch::Off);
        assert_eq!(has(&document), left, "without {effect}");
        // The light that is not sampled is still met.
        reference.render.effects = document.render.effects;
        let without = film(&mut session, &reference);
        super::renders::assert_same_picture(&both, &without, effect.name());
    }
}

#[test]
fn the_plan_is_printed_and_effects_are_chosen_on_the_command_line() {
    let place = Workplace::new();
    let text = place.done("plan --model sphere --json plan.json").stdout;
    for effect in EFFECTS {
        assert!(text.contains(effect.name()), "{} is missing:\n{text}", effect.name());
    }
    let json: serde_json::Value = place.json("plan.json");
    assert_eq!(json["effects"].as_array().unwrap().len(), EFFECTS.len());
    let effects = |arguments: &str| -> Vec<String> {
        serde_json::from_value(place.report(&format!("--model sphere --ground {arguments}"))["effects"].clone())
            .unwrap()
    };
    let has = |effects: &[String], name: &str| effects.iter().any(|effect| effect == name);
    assert!(has(&effects("--effects auto"), "ground"));
    assert!(!has(&effects("--effects -ground"), "ground"));
    let all = effects("--effects all");
    for effect in EFFECTS.iter().filter(|effect| effect.id.constant().is_some()) {
        assert!(has(&all, effect.name()), "{} is left out", effect.name());
    }
    assert!(has(&effects("--noise 0.5"), "adaptive-sampling"));
    assert!(!has(
        &effects("--noise 0.5 --effects -adaptive-sampling"),
        "adaptive-sampling"
    ));
    let chosen = effects("--effects environment,specular");
    assert!(has(&chosen, "specular") && !has(&chosen, "ground") && !has(&chosen, "base"));
    place.refused(2, "render --effects no-such-effect", &["no-such-effect"]);
    place.refused(2, "render --effects -lobe", &["lobe"]);
    place.refused(2, "render --effects +ground", &["ground"]);
    assert!(has(&effects("--aovs --output layers.exr"), "picture-layers"));
}

#[test]
fn a_kernel_is_compiled_beside_the_picture() {
    let mut document = small(Document::default());
    document.render.samples = 100_000;
    let mut session = Session::open_fluid(EngineChoice::Gpu, Assets::default()).unwrap();
    let mut is_stood_in_for = |document: &Document| {
        session.submit(document).unwrap();
        let first = session.step(Duration::from_millis(10)).unwrap();
        assert!(first.mean_samples > 0.0, "there is a picture before there is a kernel");
        let begun = std::time::Instant::now();
        let mut kept = first.mean_samples;
        while session.step(Duration::from_millis(10)).unwrap().is_fallback {
            assert!(begun.elapsed() < Duration::from_secs(300), "the kernel never came");
            let now = session.progress().mean_samples;
            assert!(now >= kept, "what was drawn is lost");
            kept = now;
        }
        assert!(session.progress().mean_samples >= kept);
        // Enough to know how noisy they are.
        while session.progress().mean_samples < 16.0 {
            session.step(Duration::from_millis(10)).unwrap();
        }
        (first.is_fallback, session.film().unwrap().clone())
    };
    let (stood_in, picture) = is_stood_in_for(&document);
    assert!(stood_in);
    let mut clear = document.clone();
    (clear.materials[0].metalness, clear.materials[0].transmission_weight) = (0.0, 0.1);
    let (stood_in, other) = is_stood_in_for(&clear);
    assert!(stood_in && other.colors().ne(picture.colors()));
    // The kernel of the first document was kept.
    let (stood_in, again) = is_stood_in_for(&document);
    assert!(!stood_in);
    let sigma = again.difference_in_sigma(&picture);
    assert!(sigma.abs() < 5.0, "another picture: {sigma:.1} sigma");
}
