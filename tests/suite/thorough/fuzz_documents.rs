//! Any document: values in and out of every range on both engines. What is taken renders to numbers that are finite and not
//! negative; what is passive reflects no more than it is given.

use std::time::Duration;

use glossmith::document::effect::EffectSwitches;
use glossmith::document::{
    AreaLight, AreaLightShape, Background, Document, GroupName, Kind, MaterialSettings, PARAMETERS, PixelFilter,
    Strategy, Value,
};
use glossmith::job::film::Film;
use glossmith::optics::random::Sequence;
use glossmith::render::{EngineChoice, Session};
use glossmith::scene::ModelSource;
use glossmith::scene::camera::Projection;
use glossmith::scene::environment::EnvironmentSource;
use proptest::prelude::*;

use super::support::Random;

/// Numbers that are nobody's friend.
const ODD: [f32; 10] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    1e-38,
    1e30,
    -1e30,
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
];

/// In the range, at its ends, beside it, or odd.
fn number(random: &mut Random, [low, high]: [f32; 2]) -> f32 {
    match random.below(10) {
        0 => low,
        1 => high,
        2 => low.next_down(),
        3 => high.next_up(),
        4 => ODD[random.below(ODD.len())],
        _ => low + (high - low) * random.unit(),
    }
}

fn color(random: &mut Random) -> [f32; 3] {
    [(); 3].map(|()| number(random, [0.0, 1.0]))
}

/// A number of a document: one out of range has the whole document refused, so that is rare.
fn setting(random: &mut Random, range: [f32; 2]) -> f32 {
    match random.below(100) {
        0 => number(random, range),
        1..6 => range[0],
        6..11 => range[1],
        _ => range[0] + (range[1] - range[0]) * random.unit(),
    }
}

fn setting_color(random: &mut Random) -> [f32; 3] {
    [(); 3].map(|()| setting(random, [0.0, 1.0]))
}

fn value(random: &mut Random, kind: &Kind) -> Value {
    match kind {
        Kind::Number { range, .. } => Value::Number(number(random, *range)),
        Kind::Color | Kind::Tint { .. } => Value::Color(color(random)),
        Kind::Triple { range } => Value::Triple([(); 3].map(|()| number(random, *range))),
        Kind::Choice(all) => Value::Choice(all[random.below(all.len())].name),
        Kind::Toggle => Value::Toggle(random.below(2) == 0),
        Kind::Curve => {
            let count = random.below(6) as u32;
            let point = |i: u32, random: &mut Random| {
                let xi = i as f32 / (count.max(2) - 1) as f32;
                [
                    if random.below(8) == 0 {
                        number(random, [0.0, 1.0])
                    } else {
                        xi
                    },
                    i as f32 * random.unit(),
                ]
            };
            Value::Curve((0..count).map(|i| point(i, random)).collect())
        }
        other => panic!("no material has a parameter of this kind: {other:?}"),
    }
}

/// A document of any values; those that the parameters refuse stay as they were.
fn any_document(seed: u64) -> Document {
    let mut random = Random::new(seed);
    let random = &mut random;
    let mut material = MaterialSettings::default();
    for parameter in PARAMETERS.iter() {
        let value = value(random, &parameter.kind);
        let before = material.clone();
        if parameter.set(&mut material, value).is_err() {
            assert_eq!(material, before, "{}: refused, but changed", parameter.key);
        }
    }
    let models = [ModelSource::Sphere, ModelSource::Plane, ModelSource::Shaderball];
    let lights = [
        EnvironmentSource::Furnace,
        EnvironmentSource::Studio,
        EnvironmentSource::Sky,
    ];
    let mut document = Document {
        model: models[random.below(models.len())].clone(),
        ground: random.below(2) == 0,
        materials: vec![material],
        ..Document::default()
    };
    let lighting = &mut document.lighting;
    lighting.environment = lights[random.below(lights.len())].clone();
    lighting.strength = setting(random, [0.0, 1e6]);
    lighting.rotation_deg = setting(random, [-3600.0, 3600.0]);
    lighting.ground_color = setting_color(random);
    lighting.background = match random.below(3) {
        0 => Background::Environment,
        1 => Background::Transparent,
        _ => Background::Color(setting_color(random)),
    };
    if random.below(3) == 0 {
        lighting.area_lights = vec![AreaLight {
            yaw_deg: f64::from(setting(random, [-180.0, 180.0])),
            pitch_deg: f64::from(setting(random, [-90.0, 90.0])),
            distance: f64::from(setting(random, [1e-3, 1e3])),
            width: f64::from(setting(random, [1e-3, 1e3])),
            height: f64::from(setting(random, [1e-3, 1e3])),
            target: [(); 3].map(|()| f64::from(setting(random, [-1e3, 1e3]))),
            turn_deg: f64::from(setting(random, [-180.0, 180.0])),
            shape: AreaLightShape::ALL[random.below(AreaLightShape::ALL.len())],
            profile: None,
            group: GroupName::new(["", "key", "rim"][random.below(3)]),
            cone_deg: f64::from(setting(random, [1.0, 180.0])),
            softness: f64::from(setting(random, [0.0, 1.0])),
            angle_deg: f64::from(setting(random, [0.01, 90.0])),
            color: setting_color(random),
            strength: setting(random, [0.0, 1e6]),
            is_hidden: random.below(3) == 0,
            is_muted: false,
        }];
    }
    let camera = &mut document.camera;
    camera.fov_deg = f64::from(setting(random, [0.1, 170.0]));
    camera.yaw_deg = f64::from(setting(random, [-180.0, 180.0]));
    camera.pitch_deg = f64::from(setting(random, [-90.0, 90.0]));
    if random.below(3) == 0 {
        camera.projection = Projection::Orthographic;
    }
    if random.below(4) == 0 {
        camera.distance = Some(f64::from(setting(random, [1e-6, 1e9])));
    }
    if random.below(4) == 0 {
        camera.position = Some([(); 3].map(|()| f64::from(setting(random, [-1e9, 1e9]))));
    }
    let render = &mut document.render;
    (render.width, render.height, render.samples) = (8, 8, 4);
    render.bounces = 1 + random.below(64) as u32;
    render.strategy = Strategy::ALL[random.below(Strategy::ALL.len())];
    render.sequence = Sequence::ALL[random.below(2)];
    render.filter = PixelFilter::ALL[random.below(2)];
    render.seed = random.bits() as u32;
    render.firefly_clamp = (random.below(4) == 0).then(|| setting(random, [1e-6, 1e9]));
    document
}

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
    document.render.samples = 32;
    document.render.sequence = Sequence::Independent;
    document.materials[0].emission_strength = 0.0;
    document
}

/// True where the document's numbers are in range, so that the program would take it.
fn try_document(session: &mut Session, seed: u64, effects: EffectSwitches) -> bool {
    let mut document = any_document(seed);
    document.render.effects = effects;
    if document.check().is_err() {
        return false;
    }
    let what = format!("seed {seed}: {document:?}");
    assert_sound(&film(session, &document), &what);
    let furnace = film(session, &in_the_furnace(&document));
    assert_sound(&furnace, &what);
    let pixels = furnace.luminance();
    let count = pixels.len() as f64;
    let mean = pixels.iter().sum::<f64>() / count;
    let sigma = furnace.variance_of_mean().iter().sum::<f64>().sqrt() / count;
    assert!(
        mean <= 1.0 + 5.0 * sigma + 5e-3,
        "{what}: {mean} ± {sigma} in the furnace"
    );
    true
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_document_is_refused_or_sound_on_the_processor(seed in any::<u64>()) {
        let mut session = Session::open(EngineChoice::Cpu).unwrap();
        try_document(&mut session, seed, EffectSwitches::default());
    }
}

#[test]
fn any_document_is_refused_or_sound_on_the_gpu() {
    let mut session = Session::open(EngineChoice::Gpu).expect("a Vulkan driver: install mesa-vulkan-drivers");
    let taken = (1000..1400)
        // The general kernel for all: a kernel for each document would have to be compiled.
        .filter(|seed| try_document(&mut session, *seed, EffectSwitches::all_on()))
        .take(10)
        .count();
    assert_eq!(taken, 10);
}
