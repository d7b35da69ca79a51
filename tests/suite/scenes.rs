//! One matrix: small scenes with every layer, texture, light and kind of geometry, each held to the same promises. The engines
//! trace the same paths, the strategies find the same light, the same seed gives the same bits, all is finite, and what
//! absorbs nothing is white where light comes evenly from everywhere.

use std::time::Duration;

use glossmith::{
    document::{AreaLight, Document, GroundKind, Strategy},
    job::film::Film,
    optics::random::Sequence,
    render::{Assets, EngineChoice, Precision, Session},
    scene::{ModelSource, environment::EnvironmentSource},
    study::evaluate::Evaluator,
};

use crate::{
    cli_support::Workplace,
    fuzz_layer::fuzzy_on_a_box,
    gltf_meaning::shining_by_vertices,
    light_profiles::{LAMP, floor},
    lights::lit_scenes,
    own_textures::{coated_on_a_box, dressed},
    parting::Pair,
    paths,
    paths::Scene,
    renders::{adjust, document, material},
    terminator::coarse,
    textures::{all_at_once, coated_all_over},
    thin_film::filmed_on_a_box,
};

const CLEAR: &str = "base.metalness=0 transmission.weight=1";
/// Materials on the teapot under the studio, in which light is reflected often.
const MATERIALS: [(&str, &str); 9] = [
    ("metal", "specular.roughness=0.4 base.metalness=1"),
    (
        "gloss",
        "specular.roughness=0.2 base.metalness=0 specular.fresnel=dielectric",
    ),
    (
        "brushed",
        "specular.lobe=ggx specular.anisotropy=0.6 specular.fresnel=conductor",
    ),
    ("long tail", "specular.curve=long-tail specular.horizon=absorb"),
    (
        "coat over metal",
        "base.metalness=0.3 base.color=0.7,0.1,0.05 base.weight=0.8 specular.roughness=0.5 \
         specular.edge_tint=0.2,0.6,1 coat.weight=0.9 coat.roughness=0.5 coat.color=0.6,0.9,0.8",
    ),
    (
        "all layers",
        "base.metalness=0.4 base.diffuse_roughness=0.5 fuzz.weight=0.3 thin_film.weight=0.5 coat.weight=0.5 \
         coat.lobe=ggx coat.roughness=0.4 specular.lobe=ggx specular.roughness=0.5",
    ),
    (
        "amber glass",
        "specular.roughness=0 transmission.color=0.8,0.4,0.2 transmission.depth=0.5",
    ),
    ("rough glass", "specular.roughness=0.4 transmission.color=0.5,0.9,0.7"),
    (
        "frosted",
        "specular.lobe=ggx-ndf specular.roughness=0.5 transmission.roughness=-0.2",
    ),
];

/// All scenes; their files lie in the folders.
fn scenes(folders: &[Workplace; 3]) -> Vec<Scene> {
    let mut scenes = paths::scenes();
    let mut add = |name, document| {
        scenes.push(Scene {
            name,
            document,
            model: None,
        });
    };
    for (name, assignments) in MATERIALS {
        let clear = if ["amber glass", "rough glass", "frosted"].contains(&name) {
            CLEAR
        } else {
            ""
        };
        let all = [clear, assignments];
        add(name, document(ModelSource::Teapot, EnvironmentSource::Studio, &all));
    }
    for (name, document) in lit_scenes() {
        add(name, document);
    }
    let shining = ["emission.strength=3 base.metalness=0 coat.weight=0.8 coat.ior=1.1 coat.color=0.9,0.4,0.1"];
    let mut below_a_coat = document(ModelSource::Sphere, EnvironmentSource::Furnace, &shining);
    below_a_coat.ground = true;
    below_a_coat.lighting.strength = 0.0;
    // From above: rays from ground far away meet the ball too rarely for means that are normal.
    below_a_coat.camera.pitch_deg = 75.0;
    add("emission below a coat", below_a_coat);
    let mut caught = document(ModelSource::Sphere, EnvironmentSource::Sky, &["base.metalness=0"]);
    (caught.ground, caught.lighting.ground.kind) = (true, GroundKind::ShadowCatcher);
    caught.lighting.ground.reflection = 0.5;
    caught.lighting.area_lights = vec![AreaLight::spot(), AreaLight::sun()];
    add("shadow catcher", caught);
    let [one, two, three] = folders;
    let mut half = all_at_once(one);
    half.materials[0].textures = Default::default();
    (half.materials[0].opacity, half.materials[0].emission_strength) = (0.5, 0.0);
    half.lighting.environment = EnvironmentSource::Sky;
    add("half transparent", half);
    add("textures", all_at_once(one));
    let mut coated = coated_all_over(two);
    (coated.materials[0].coat_on_base, coated.materials[0].coat_ior) = (true, 2.2);
    coated.materials[0].coat_color = [0.9, 0.6, 0.3];
    add("textured coat", coated);
    add("coat on a box", coated_on_a_box(three));
    add("fuzz on a box", fuzzy_on_a_box(three));
    add("film on a box", filmed_on_a_box(three));
    add("a picture on everything", dressed(three));
    add("colours of vertices", shining_by_vertices(three));
    add("coarse", coarse(three));
    let lamp = three.path("lamp.ies");
    std::fs::write(&lamp, LAMP).unwrap();
    add("profile", floor(&lamp).0);
    for scene in &mut scenes {
        let render = &mut scene.document.render;
        (render.width, render.height, render.samples) = (32, 32, 1);
        render.sequence = Sequence::Independent;
    }
    scenes
}

/// Asks something of every scene in one session of the processor's.
fn in_all(mut ask: impl FnMut(&mut Session, &Scene)) {
    let folders = [Workplace::new(), Workplace::new(), Workplace::new()];
    let mut session = Session::open_with(EngineChoice::Cpu, Assets::default()).unwrap();
    for scene in scenes(&folders) {
        if let Some(model) = &scene.model {
            session.assets().keep_model(scene.document.model.clone(), model.clone());
        }
        session.reset();
        ask(&mut session, &scene);
    }
}

fn render(session: &mut Session, document: &Document, step: Duration) -> Film {
    session.submit(document).unwrap();
    while !session.step(step).unwrap().is_done {}
    session.film().unwrap().clone()
}

/// On the same random numbers a number that is used twice, or a lobe that one engine gets wrong, shows in most pixels: one
/// sample sees what no comparison of noisy images would. Rounding decides now and then otherwise which way a path goes,
/// most often in glass.
#[test]
fn engines_trace_the_same_paths() {
    let folders = [Workplace::new(), Workplace::new(), Workplace::new()];
    let mut pair = Pair::open();
    for scene in scenes(&folders) {
        pair.keep(&scene.document.model, scene.model.clone());
        let limits = match scene.name {
            // One pixel of forty bounces is 0.002 of the whole.
            "room" => [0.005, 0.003],
            "amber glass" | "rough glass" | "frosted" | "glass" | "amber" | "a picture on everything" => [0.02, 0.002],
            _ => [0.005, 0.001],
        };
        let mut document = scene.document;
        for strategy in Strategy::ALL {
            document.render.strategy = *strategy;
            pair.assert_same_paths(&document, limits, &format!("{}, {strategy:?}", scene.name));
        }
        adjust(&mut document, "render.sequence=sobol render.firefly_clamp=0.2");
        pair.assert_same_paths(&document, limits, &format!("{}, limited", scene.name));
    }
}

/// Relative standard error of a difference of two images at which a fault of 1 % of the light is seen with 99.9 %: it is
/// 4 + 3.1 of these.
const SHARP: f64 = 0.01 / 7.1;
/// Where rare bright paths need more samples than this, the fault that is seen is so much larger.
const MOST_SAMPLES: u32 = 128;

/// The sum of the luminances and its standard error, from as many samples as the relative error `allowed` needs.
fn sharp(session: &mut Session, document: &Document, (strategy, seed): (Strategy, u32), allowed: f64) -> [f64; 2] {
    let mut document = document.clone();
    let render_of = &mut document.render;
    (render_of.strategy, render_of.seed, render_of.samples) = (strategy, seed, 32);
    session.reset();
    loop {
        let film = render(session, &document, Duration::from_secs(1));
        let sum: f64 = film.luminance().iter().sum();
        let error = film.variance_of_mean().iter().sum::<f64>().sqrt();
        let times = (error / (allowed * sum)).powi(2);
        let samples = document.render.samples;
        if times < 1.0 || samples >= MOST_SAMPLES {
            return [sum, error];
        }
        // A tenth more, since the error is estimated.
        document.render.samples = ((f64::from(samples) * times * 1.1).ceil() as u32).min(MOST_SAMPLES);
    }
}

#[test]
fn strategies_find_the_same_light() {
    let mut wrong = Vec::new();
    in_all(|session, scene| {
        let mut document = scene.document.clone();
        // Few paths that find much light would make the lobe's variance dishonest.
        document.render.bounces = document.render.bounces.min(4);
        let [mis, error] = sharp(session, &document, (Strategy::Mis, 0), SHARP / std::f64::consts::SQRT_2);
        // The other may take what is left of the difference's error.
        let left = SHARP.powi(2) - (error / mis).powi(2);
        let allowed = left.max(SHARP.powi(2) / 2.0).sqrt();
        // What the sun or a small lamp lights is found by lobes too rarely for means that are normal.
        let is_small = ["coat", "shadow catcher", "half transparent", "profile"].contains(&scene.name);
        let others: &[Strategy] = if is_small {
            &[Strategy::Light]
        } else {
            &[Strategy::Light, Strategy::Lobe]
        };
        for (seed, &strategy) in (1..).zip(others) {
            let [other, its] = sharp(session, &document, (strategy, seed), allowed);
            let off = (other - mis) / error.hypot(its);
            println!(
                "{}, {strategy:?}: {off:+.1} sigma, {:+.2} %",
                scene.name,
                100.0 * (other / mis - 1.0)
            );
            if off.abs() > 4.0 {
                wrong.push(format!("{}, {strategy:?}: {off:+.1} sigma", scene.name));
            }
        }
    });
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn the_same_bits_however_steps_are_cut_and_all_finite() {
    in_all(|session, scene| {
        let mut document = scene.document.clone();
        document.render.samples = 4;
        let whole = render(session, &document, Duration::from_secs(1000));
        assert_eq!(whole.dropped(), 0, "{}", scene.name);
        assert!(
            whole.colors().flatten().all(|value| value.is_finite()),
            "{}",
            scene.name
        );
        session.reset();
        assert!(
            whole == render(session, &document, Duration::from_micros(200)),
            "{}: other bits",
            scene.name
        );
    });
}

/// Stacks that absorb nothing, and what tables and mean facets may take from their light or add to it.
const WHITE: [(&str, f64); 49] = [
    (
        "base.metalness=0 specular.roughness=0.3 specular.fresnel=dielectric",
        0.003,
    ),
    ("specular.fresnel=none specular.roughness=0.5", 0.003),
    (
        "specular.fresnel=none specular.roughness=1 specular.curve=long-tail",
        0.003,
    ),
    ("base.metalness=1 specular.lobe=ggx specular.roughness=0.2", 0.003),
    ("base.metalness=1 specular.lobe=ggx specular.roughness=0.9", 0.003),
    (
        "base.metalness=0 specular.lobe=ggx specular.roughness=0.6 specular.fresnel=dielectric",
        0.003,
    ),
    ("base.metalness=0.5 specular.lobe=ggx specular.roughness=0.4", 0.005),
    ("base.metalness=0 specular.weight=0 base.diffuse_roughness=1", 0.003),
    (
        "base.metalness=0 specular.roughness=0.3 base.diffuse_roughness=0.7",
        0.003,
    ),
    ("transmission.weight=1 specular.roughness=0", 0.003),
    ("transmission.weight=1 specular.roughness=0.3", 0.003),
    (
        "transmission.weight=1 specular.roughness=0.4 specular.anisotropy=0.6",
        0.005,
    ),
    ("transmission.weight=1 specular.lobe=ggx specular.roughness=0.6", 0.005),
    ("transmission.weight=0.5 specular.roughness=0.6", 0.003),
    (
        "transmission.weight=1 specular.roughness=0.3 specular.weight=0.5",
        0.003,
    ),
    ("base.metalness=0.5 transmission.weight=1 specular.roughness=0.3", 0.005),
    ("base.metalness=0 coat.weight=1 coat.roughness=0", 0.003),
    (
        "base.metalness=0 coat.weight=0.5 coat.roughness=0.5 specular.roughness=0.3",
        0.003,
    ),
    ("base.metalness=0 coat.weight=1 coat.lobe=ggx coat.roughness=0.5", 0.003),
    (
        "base.metalness=1 coat.weight=1 coat.ior=2.2 coat.roughness=0.8 specular.roughness=0.3",
        0.004,
    ),
    (
        "transmission.weight=1 coat.weight=1 coat.roughness=0.2 specular.roughness=0.3",
        0.004,
    ),
    (
        "base.metalness=0 fuzz.weight=1 fuzz.roughness=0.6 specular.weight=0",
        0.004,
    ),
    (
        "base.metalness=0 fuzz.weight=1 fuzz.roughness=0 coat.weight=1 coat.roughness=0.3",
        0.01,
    ),
    (
        "base.metalness=1 fuzz.weight=0.3 fuzz.roughness=0.6 specular.roughness=0.4",
        0.004,
    ),
    (
        "base.metalness=0 specular.fresnel=dielectric thin_film.weight=1 thin_film.ior=2 specular.lobe=ggx",
        0.003,
    ),
    (
        "base.metalness=1 thin_film.weight=0.5 thin_film.ior=2 thin_film.thickness=1 specular.roughness=0.2",
        0.003,
    ),
    (
        "transmission.weight=1 thin_film.weight=1 thin_film.ior=1.33 thin_film.thickness=0.3 specular.roughness=0",
        0.003,
    ),
    (
        "transmission.weight=1 thin_film.weight=1 thin_film.ior=2 specular.lobe=ggx specular.roughness=0.5",
        0.005,
    ),
    (
        "base.metalness=0.5 specular.fresnel=dielectric thin_film.weight=1 thin_film.ior=1.4 specular.roughness=0.3",
        0.03,
    ),
    (
        "base.metalness=0 coat.weight=0 fuzz.weight=0 thin_film.weight=0 specular.fresnel=dielectric",
        0.003,
    ),
    ("base.metalness=1 specular.lobe=ggx-2018 specular.roughness=0.8", 0.003),
    ("base.metalness=1 specular.lobe=ggx-ndf specular.roughness=0.5", 0.003),
    (
        "transmission.weight=1 specular.ior=1 thin_film.weight=1 thin_film.thickness=0.45 thin_film.ior=1.33 specular.lobe=ggx specular.roughness=0.0",
        0.01,
    ),
    (
        "transmission.weight=1 specular.ior=1 thin_film.weight=1 thin_film.thickness=0.45 thin_film.ior=1.33 specular.lobe=ggx-2018 specular.roughness=0.8",
        0.01,
    ),
    (
        "transmission.weight=1 specular.ior=1 thin_film.weight=1 thin_film.thickness=0.45 thin_film.ior=1.33 specular.lobe=ggx-ndf specular.roughness=0.3",
        0.01,
    ),
    (
        "transmission.weight=1 specular.ior=1 thin_film.weight=1 thin_film.thickness=0.45 thin_film.ior=1.33 specular.lobe=geometric specular.roughness=0.3",
        0.01,
    ),
    (
        "transmission.weight=1 specular.ior=1 coat.weight=1 coat.ior=1.5 coat.roughness=0.2 specular.lobe=ggx specular.roughness=0.3",
        0.01,
    ),
    (
        "transmission.weight=1 specular.ior=1 coat.weight=1 coat.ior=1.5 coat.roughness=0.2 specular.lobe=geometric specular.roughness=0.3",
        0.01,
    ),
    (
        "base.metalness=1 specular.fresnel=none specular.roughness=0.7 specular.lobe=ggx specular.anisotropy=0.9 specular.rotation=0",
        0.02,
    ),
    (
        "base.metalness=1 specular.fresnel=none specular.roughness=0.7 specular.lobe=ggx specular.anisotropy=0.9 specular.rotation=45",
        0.02,
    ),
    (
        "base.metalness=1 specular.fresnel=none specular.roughness=0.7 specular.lobe=ggx specular.anisotropy=0.9 specular.rotation=70",
        0.02,
    ),
    (
        "transmission.weight=1 specular.fresnel=dielectric specular.roughness=0.5 specular.lobe=ggx specular.anisotropy=0.9 specular.rotation=0",
        0.02,
    ),
    (
        "transmission.weight=1 specular.fresnel=dielectric specular.roughness=0.5 specular.lobe=ggx specular.anisotropy=0.9 specular.rotation=45",
        0.02,
    ),
    (
        "transmission.weight=1 specular.fresnel=dielectric specular.roughness=0.5 specular.lobe=ggx specular.anisotropy=0.9 specular.rotation=70",
        0.02,
    ),
    (
        "base.metalness=0 specular.fresnel=dielectric specular.roughness=0.3 specular.lobe=ggx specular.anisotropy=0.9 specular.rotation=0",
        0.02,
    ),
    (
        "base.metalness=0 specular.fresnel=dielectric specular.roughness=0.3 specular.lobe=ggx specular.anisotropy=0.9 specular.rotation=45",
        0.02,
    ),
    (
        "base.metalness=0 specular.fresnel=dielectric specular.roughness=0.3 specular.lobe=ggx specular.anisotropy=0.9 specular.rotation=70",
        0.02,
    ),
    (
        "transmission.weight=1 specular.fresnel=dielectric specular.lobe=ggx-2018 specular.roughness=0.6 specular.ior=2.5 specular.weight=0",
        0.01,
    ),
    (
        "transmission.weight=1 specular.fresnel=dielectric specular.lobe=ggx-2018 specular.roughness=0.6 specular.ior=2.5 specular.weight=0.4",
        0.01,
    ),
];

/// Half a percent of the energy is seen where a row allows no more.
#[test]
fn white_stays_white() {
    let mut wrong = Vec::new();
    for (stack, allowed) in WHITE {
        let default = if stack.contains("transmission.weight=1") {
            "base.metalness=0"
        } else {
            "base.color=1,1,1"
        };
        let material = material(&format!("{default} base.color=1,1,1 {stack}"));
        let evaluator = Evaluator::open(&material, EngineChoice::Cpu, Precision::Single).unwrap();
        let within: &[f64] = if stack.contains("transmission.weight=1") {
            &[-1.0, -0.8]
        } else {
            &[]
        };
        for cosine in [1.0, 0.6, 0.2].iter().chain(within).copied() {
            let found = evaluator.albedo(cosine, 1 << 14, 1).unwrap();
            let off = [0, 1, 2].map(|i| (found.reflected[i] + found.transmitted[i] - 1.0).abs());
            let worst = off.into_iter().fold(0.0, f64::max);
            println!("{worst:.4} {stack} at {cosine}");
            if worst.is_nan() || worst >= allowed {
                wrong.push(format!("{stack} at {cosine}: off by {worst:.4}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// The same of the first thirty in images, where light that goes through a body is refracted and reflected within it many times.
#[test]
fn white_bodies_are_not_seen_in_even_light() {
    let mut session = Session::open(EngineChoice::Cpu).unwrap();
    for (number, (stack, allowed)) in WHITE.iter().take(30).enumerate() {
        let default = if stack.contains("transmission") {
            "base.metalness=0"
        } else {
            "base.color=1,1,1"
        };
        let all = [default, "base.color=1,1,1", stack];
        let model = [ModelSource::Sphere, ModelSource::Teapot][number % 2].clone();
        let mut document = document(model, EnvironmentSource::Furnace, &all);
        adjust(&mut document, "render.width=24 render.height=24 render.samples=64");
        let film = render(&mut session, &document, Duration::from_secs(10));
        let pixels = film.pixel_count();
        let mean = (0..pixels).map(|pixel| film.mean(pixel)[1]).sum::<f64>() / pixels as f64;
        let off = (mean + film.cut_share() - 1.0).abs();
        let error = film.variance_of_mean().iter().sum::<f64>().sqrt() / pixels as f64;
        println!("{off:.4} ± {error:.4} {stack}");
        let limit = allowed + 2.0 * error;
        assert!(off < limit, "{stack}: {mean} ± {error}, cut {}", film.cut_share());
    }
}
