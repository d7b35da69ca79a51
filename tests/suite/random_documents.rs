//! Documents with some of everything, in range: for the tests of plans, and for the benchmark that takes more of them.

use glossmith::{
    document::{
        AreaLight, Denoise, Document, GroundKind, Kind, MaterialSettings, PARAMETERS, Parameter, Strategy, Value,
    },
    scene::{ModelSource, environment::EnvironmentSource},
    store::PRESETS,
};

use crate::support::Random;

/// Small enough that many are rendered.
pub fn small(mut document: Document) -> Document {
    (document.render.width, document.render.height, document.render.samples) = (24, 24, 4);
    document
}

/// A material on a model.
pub fn of_material(model: ModelSource, material: MaterialSettings) -> Document {
    small(Document {
        model,
        materials: vec![material],
        ..Document::default()
    })
}

/// How far pictures (luminances) of the same random numbers are apart: the share of pixels that are off by more than 0.001,
/// and the whole, relative.
pub fn apart(specialised: &[f64], general: &[f64]) -> [f64; 2] {
    let pixels = general.len() as f64;
    let mean = general.iter().sum::<f64>() / pixels;
    let is_off = |(a, b): &(&f64, &f64)| (*a - *b).abs() > 0.001 * b.max(mean);
    let off = std::iter::zip(specialised, general).filter(is_off).count() as f64 / pixels;
    let whole = (specialised.iter().sum::<f64>() / pixels - mean).abs() / mean.max(1e-12);
    [off, whole]
}

fn range(random: &mut Random, low: f32, high: f32) -> f32 {
    low + (high - low) * random.unit()
}

/// Any number between two, one of them exactly, or hardly off the lower one.
fn number(random: &mut Random, low: f32, high: f32) -> f32 {
    match random.below(8) {
        0 => low,
        1 => high,
        2 | 3 => range(random, low, low + 0.02 * (high - low)),
        _ => range(random, low, high),
    }
}

/// Any colour, or white or black but for one channel.
fn color(random: &mut Random) -> [f32; 3] {
    let chosen = random.below(6);
    let other = [0.0, 1.0][random.below(2)];
    [0, 1, 2].map(|channel| match chosen {
        3.. => random.unit(),
        _ if channel == chosen => random.unit(),
        _ => other,
    })
}

fn value(random: &mut Random, parameter: &Parameter, present: &Value) -> Value {
    match &parameter.kind {
        Kind::Number { range, .. } => {
            let [low, high] = parameter.row.bar.unwrap_or(*range).map(|end| end as f32);
            Value::Number(number(random, low, high).into())
        }
        Kind::Color { .. } => Value::Color(color(random)),
        Kind::Triple { range: [low, high] } => Value::Triple([0; 3].map(|_| range(random, *low, high.min(5.0)))),
        Kind::Choice(choices) => Value::Choice(choices[random.below(choices.len())].name),
        Kind::Toggle => Value::Toggle(random.below(2) == 0),
        _ => present.clone(),
    }
}

/// A document of any values.
pub fn random_document(random: &mut Random) -> Document {
    let models = [
        ModelSource::Sphere,
        ModelSource::Plane,
        ModelSource::Shaderball,
        ModelSource::Teapot,
    ];
    let lights = [
        EnvironmentSource::Studio,
        EnvironmentSource::Sky,
        EnvironmentSource::Furnace,
    ];
    let mut material = PRESETS[random.below(PRESETS.len())].clone();
    // No built-in model has textures; with one switch more these would be other documents, some of which have a path that
    // parts by rounding.
    for parameter in PARAMETERS
        .iter()
        // Switches that do nothing without a texture.
        .filter(|parameter| {
            let is_of_layer = ["coat.", "thin_film.", "fuzz."]
                .iter()
                .any(|group| parameter.key.starts_with(group));
            !(is_of_layer && parameter.key.ends_with("_texture"))
        })
    {
        if random.below(4) == 0 {
            let value = value(random, parameter, &parameter.get(&material));
            // Soft ranges lie within what is taken.
            parameter.set(&mut material, value).expect("in range");
        }
    }
    let mut document = of_material(models[random.below(models.len())].clone(), material);
    document.ground = random.below(2) == 0;
    document.lighting.ground.kind = GroundKind::ALL[random.below(3)];
    document.lighting.ground.reflection = [0.0, 0.5][random.below(2)];
    document.lighting.environment = lights[random.below(lights.len())].clone();
    document.lighting.strength = [0.0, 1.0, 1.0, 3.0][random.below(4)];
    document.render.strategy = Strategy::ALL[random.below(3)];
    document.render.seed = random.below(1000) as u32;
    document.render.bounces = 1 + random.below(6) as u32;
    if random.below(4) == 0 {
        document.render.firefly_clamp = Some(range(random, 0.01, 2.0));
    }
    if random.below(3) == 0 {
        document.camera.aperture = 0.1;
    }
    if random.below(3) == 0 {
        let made = [AreaLight::default, AreaLight::spot, AreaLight::sun][random.below(3)];
        document.lighting.area_lights.push(made());
    }
    if random.below(4) == 0 {
        document.view.denoise = Denoise::High;
    }
    document
}
