//! Documents with some of everything, in range: for the tests of plans, and for the benchmark that takes more of them.

use glossmith::document::{AreaLight, Document, Kind, MaterialSettings, PARAMETERS, PRESETS, Strategy, Value};
use glossmith::scene::ModelSource;
use glossmith::scene::environment::EnvironmentSource;

/// Small enough that many are rendered.
pub fn small(mut document: Document) -> Document {
    (document.render.width, document.render.height) = (24, 24);
    document.render.samples = 4;
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

/// Makes documents out of random bits.
pub struct Documents<B>(pub B);

impl<B: FnMut() -> u64> Documents<B> {
    fn below(&mut self, count: usize) -> usize {
        ((self.0)() % count as u64) as usize
    }

    fn range(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * ((self.0)() >> 40) as f32 / (1u64 << 24) as f32
    }

    fn value(&mut self, kind: &Kind, present: &Value) -> Value {
        match kind {
            Kind::Number {
                soft_range: [low, high],
                ..
            } => Value::Number(self.range(*low, *high)),
            Kind::Color => Value::Color([0; 3].map(|_| self.range(0.0, 1.0))),
            Kind::Triple { range: [low, high] } => Value::Triple([0; 3].map(|_| self.range(*low, high.min(5.0)))),
            Kind::Choice(choices) => Value::Choice(choices[self.below(choices.len())].name),
            Kind::Toggle => Value::Toggle(self.below(2) == 0),
            Kind::Curve => present.clone(),
        }
    }

    /// The next one.
    pub fn draw(&mut self) -> Document {
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
        let mut material = PRESETS[self.below(PRESETS.len())].clone();
        for parameter in PARAMETERS.iter() {
            if self.below(4) == 0 {
                let value = self.value(&parameter.kind, &parameter.get(&material));
                // Soft ranges lie within what is taken.
                parameter.set(&mut material, value).expect("in range");
            }
        }
        let mut document = of_material(models[self.below(models.len())].clone(), material);
        document.ground = self.below(2) == 0;
        document.lighting.environment = lights[self.below(lights.len())].clone();
        document.lighting.strength = [0.0, 1.0, 1.0, 3.0][self.below(4)];
        document.render.strategy = Strategy::ALL[self.below(3)];
        document.render.seed = self.below(1000) as u32;
        document.render.bounces = 1 + self.below(6) as u32;
        if self.below(3) == 0 {
            document.camera.aperture = 0.1;
        }
        if self.below(3) == 0 {
            document.lighting.area_lights.push(AreaLight::default());
        }
        document
    }
}
