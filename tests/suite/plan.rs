//! The plan: its rules, those broken on purpose, and switches.

use std::collections::HashSet;
use std::sync::Arc;
use std::time::Duration;

use glossmith::document::effect::{EFFECTS, Effect, EffectSwitches, Switch};
use glossmith::document::{AreaLight, Denoise, Document, GroundKind, MaterialSettings, assign};
use glossmith::gpu::{AdapterKind, GpuDevice, GpuEngine};
use glossmith::job::Job;
use glossmith::job::effect::{ANY, Decision, EffectId};
use glossmith::job::film::Film;
use glossmith::job::plan::Plan;
use glossmith::optics::curve::Curve;
use glossmith::render::{Assets, EngineChoice, Session};
use glossmith::scene::ModelSource;
use glossmith::store::PRESETS;

use crate::cli_support::Workplace;
use crate::fuzz_layer::fuzzy_on_a_box;
use crate::gltf_builder::Folder;
use crate::gltf_meaning::shining_by_vertices;
use crate::own_textures::coated_on_a_box;
use crate::plan_kernels::{ROUNDED_PIXELS, ROUNDED_WHOLE, assert_same_but_for_rounding};
use crate::random_documents::{apart, of_material, small};
use crate::terminator::coarse;
use crate::textures::{all_at_once, coated_all_over};
use crate::thin_film::filmed_on_a_box;

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
fn effects_have_words_and_names_of_their_own() {
    let mut names = HashSet::new();
    for effect in EFFECTS {
        assert!(names.insert(effect.name()), "{} twice", effect.name());
        assert!(
            effect.help.ends_with('.') && !effect.label.is_empty(),
            "{}",
            effect.name()
        );
    }
    for (effect, decision) in job(&Document::default()).plan.table() {
        assert!(decision.reason.len() > 5, "{}: no reason", effect.name());
    }
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

#[test]
fn the_horizon_is_left_out_where_every_view_is_steep_enough() {
    let document = |model: ModelSource, roughness: f32| {
        let material = MaterialSettings {
            roughness,
            ..MaterialSettings::default()
        };
        let mut document = of_material(model, material);
        document.camera.pitch_deg = 60.0;
        document.render.samples = 64;
        document
    };
    let plane = document(ModelSource::Plane, 0.4);
    assert!(!job(&plane).plan.has(EffectId::Horizon));
    // The kernel leaves it out: the processor's engine takes each material's.
    let mut session = Session::open(EngineChoice::Gpu).unwrap();
    let [specialised, general] = [plane.clone(), generally(&plane)].map(|document| film(&mut session, &document));
    assert_same_but_for_rounding(&specialised, &general, "a steep view");
    assert!(
        job(&document(ModelSource::Plane, 0.95)).plan.has(EffectId::Horizon),
        "rough"
    );
    assert!(
        job(&document(ModelSource::Sphere, 0.4)).plan.has(EffectId::Horizon),
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

/// A document for each effect that has code of its own, which calls for it.
fn needing(effect: &str) -> Document {
    let assignments: &[&str] = match effect {
        "base" => &["specular.fresnel=schlick", "base.metalness=0"],
        "coat" => &["coat.weight=1"],
        "coat-ggx" => &["coat.weight=1", "coat.lobe=ggx", "coat.roughness=0.9"],
        "coat-darkening" => &["base.metalness=0", "coat.weight=1", "coat.ior=2"],
        "coat-absorption" => &["base.metalness=0", "coat.weight=1", "coat.color=0.2,0.5,0.9"],
        "fuzz" => &["fuzz.weight=1", "fuzz.roughness=1"],
        "thin-film" => &["thin_film.weight=1", "thin_film.ior=2"],
        "edge-tint" => &["specular.fresnel=schlick", "specular.edge_tint=0.1,0.9,0.1"],
        "diffuse-roughness" => &["base.metalness=0", "base.diffuse_roughness=1"],
        "multiple-scattering" => &["specular.lobe=ggx", "specular.roughness=0.9"],
        "alpha" => &["geometry.opacity=0.4"],
        "lobe" | "curve" | "horizon" => &["specular.roughness=0.8"],
        "anisotropy" => &["specular.anisotropy=0.8", "specular.roughness=0.5"],
        "emission" => &["emission.strength=2"],
        "transmission" => &["base.metalness=0", "transmission.weight=1"],
        "absorption" => &[
            "base.metalness=0",
            "transmission.weight=1",
            "transmission.color=0.2,0.5,0.9",
            "transmission.depth=0.5",
        ],
        _ => &[],
    };
    let mut material = MaterialSettings::default();
    for assignment in assignments {
        assign(&mut material, assignment).unwrap();
    }
    let mut document = of_material(ModelSource::Shaderball, material);
    match effect {
        "depth-of-field" => document.camera.aperture = 0.5,
        "firefly-clamp" => document.render.firefly_clamp = Some(0.01),
        "emitter-sampling" => document.lighting.area_lights.push(AreaLight::default()),
        "spot" => document.lighting.area_lights.push(AreaLight::spot()),
        "guides" => document.view.denoise = Denoise::Fast,
        "light-groups" => document.lighting.light_groups = true,
        "shadow-catcher" => {
            document.ground = true;
            document.lighting.ground.kind = GroundKind::ShadowCatcher;
        }
        _ => {}
    }
    document
}

/// The wrong decision: what is called for is left out, or another is chosen.
fn broken(effect: &Effect, plan: &Plan) -> Decision {
    let is_choice = effect.id.constant().is_some_and(|constant| constant.general == ANY);
    let (_, right) = plan.table().find(|(of, _)| *of == effect.id).unwrap();
    match right.value {
        _ if !is_choice => Decision::off("broken on purpose"),
        0 => Decision::which(1, "broken on purpose"),
        _ => Decision::which(0, "broken on purpose"),
    }
}

/// A kernel made by a wrong decision draws another picture than the general kernel does: by more than the rounding that
/// the kernel of the right decision is allowed (`plan_kernels.rs`), which need not be compiled here.
#[test]
fn a_plan_that_leaves_out_what_is_needed_is_found_out() {
    let folder = Folder::new();
    let switched = |effect: &&Effect| effect.id.constant().is_some();
    // One engine, which keeps the kernels that it has compiled.
    let mut engine = GpuEngine::new(GpuDevice::open(AdapterKind::Any).unwrap()).unwrap();
    let mut picture = |job: Job| {
        engine.submit(Arc::new(job)).unwrap();
        engine.step(Duration::from_secs(60), 4).unwrap();
        let film = engine.film().unwrap();
        let lights: Vec<_> = (0..film.light_groups())
            .map(|group| film.light_image(group).pixels)
            .collect();
        (film.luminance(), (film.guides.clone(), lights))
    };
    for effect in EFFECTS.iter().filter(switched) {
        let is_of_texture =
            effect.name().ends_with("texture") || ["normal-map", "rough-tables"].contains(&effect.name());
        let document = if ["coat-texture", "box-projection"].contains(&effect.name()) {
            coated_on_a_box(&folder)
        } else if effect.id == EffectId::CoatNormalMap {
            small(coated_all_over(&folder))
        } else if effect.id == EffectId::FilmTexture {
            filmed_on_a_box(&folder)
        } else if effect.id == EffectId::FuzzTexture {
            fuzzy_on_a_box(&folder)
        } else if is_of_texture {
            small(all_at_once(&folder))
        } else if effect.id == EffectId::ShadowTerminator {
            small(coarse(&folder))
        } else if effect.id == EffectId::VertexColors {
            small(shining_by_vertices(&folder))
        } else {
            needing(effect.name())
        };
        let right = job(&document);
        assert!(right.plan.has(effect.id), "{} is not called for", effect.name());
        let wrong = Job {
            plan: right.plan.clone().with(effect.id, broken(effect, &right.plan)),
            ..right.clone()
        };
        let general = Job {
            plan: Plan::general(),
            ..right
        };
        let ((general, all_layers), (wrong, layers)) = (picture(general), picture(wrong));
        let [off, whole] = apart(&wrong, &general);
        println!(
            "without {}: {:.0} % of pixels off, the whole by {whole:.1e}",
            effect.name(),
            100.0 * off
        );
        let shows = if [EffectId::Guides, EffectId::LightGroups].contains(&effect.id) {
            layers != all_layers
        } else {
            off >= ROUNDED_PIXELS || whole >= ROUNDED_WHOLE
        };
        assert!(shows, "{}: leaving it out shows nowhere", effect.name());
    }
}

#[test]
fn switching_an_effect_off_takes_it_out_of_the_scene_on_both_engines() {
    let glass = PRESETS.iter().find(|material| material.name == "Amber").unwrap();
    let mut document = of_material(ModelSource::Sphere, glass.clone());
    let plan = job(&document).plan;
    assert!(plan.has(EffectId::Transmission) && plan.has(EffectId::Absorption));
    document.render.effects.set(EffectId::Transmission, Switch::Off);
    let plan = job(&document).plan;
    assert!(!plan.has(EffectId::Transmission) && !plan.has(EffectId::Absorption));
    let (_, decision) = plan
        .table()
        .find(|(effect, _)| *effect == EffectId::Transmission)
        .unwrap();
    assert!(decision.reason.contains("you"), "{}", decision.reason);
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
    let json: serde_json::Value = serde_json::from_str(&place.read("plan.json")).unwrap();
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
