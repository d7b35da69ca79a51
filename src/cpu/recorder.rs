//! Events along a path, for a list of them. The path tracer is generic over a [`Recorder`]; rendering uses [`Unrecorded`],
//! which is compiled away.

use serde::Serialize;

use crate::optics::layer::Layer;

/// A receiver of a path's events, in order.
pub trait Recorder: Default {
    /// Whether events are kept.
    const KEEPS: bool;
    /// Records an event. The closure is only called if events are kept, because making one costs time.
    fn record(&mut self, event: impl FnOnce() -> Event);
    /// Amends the last [`Event::Light`]: that much of this radiance arrives.
    fn light_arrives(&mut self, _visible: f32, _radiance: [f32; 3]) {}
}

/// Discards all events.
#[derive(Clone, Copy, Default)]
pub struct Unrecorded;

impl Recorder for Unrecorded {
    const KEEPS: bool = false;
    fn record(&mut self, _: impl FnOnce() -> Event) {}
}

impl Recorder for Vec<Event> {
    const KEEPS: bool = true;
    fn record(&mut self, event: impl FnOnce() -> Event) {
        let event = event();
        // The light of a shadow ray is added once the path has gone on: it belongs to the direction that was sampled.
        let is_of_light =
            |event: &Event| matches!(event, Event::Light { .. } | Event::LightHit { .. } | Event::Hit { .. });
        let place = match (&event, self.iter().rposition(is_of_light)) {
            (Event::Contribution { .. }, Some(last)) if matches!(self[last], Event::Light { .. }) => last + 1,
            _ => self.len(),
        };
        self.insert(place, event);
    }

    fn light_arrives(&mut self, arrived: f32, light: [f32; 3]) {
        let mut lights = self.iter_mut().rev();
        if let Some(Event::Light { visible, radiance, .. }) = lights.find(|event| matches!(event, Event::Light { .. }))
        {
            (*visible, *radiance) = (arrived, light);
        }
    }
}

/// Purpose of a random number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Purpose {
    /// Position in the pixel.
    Pixel,
    /// Position on the lens.
    Lens,
    /// Opacity test: whether a surface with holes stops the ray.
    Opacity,
    /// Direction sampled from a lobe.
    Lobe,
    /// Choice of the layer that is sampled.
    Layer,
    /// Direction below the specular lobe.
    Below,
    /// Direction to a light.
    Light,
    Roulette,
    /// Whether the shadow catcher mirrors the ray.
    Catcher,
    /// Direction of a blurred background.
    Blur,
    /// Unused second number of a pair; not recorded.
    Unused,
}

/// Source of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LightSource {
    /// The environment light, at infinity.
    Environment,
    /// A surface that emits.
    Surface,
    /// The background that the camera sees behind the scene.
    Background,
}

/// Why a path ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// The ray left the scene.
    #[serde(rename = "left")]
    Escaped,
    /// The bounce limit was reached.
    Bounces,
    /// The sampled direction carries no light, or NaN.
    Absorbed,
    Roulette,
}

/// Sampling probability of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LayerChance {
    /// Layer of the material.
    pub layer: Layer,
    /// In [0, 1].
    pub probability: f32,
}

/// One event of a path. Lengths and positions are in the geometry's units, colours are linear RGB. All numbers are the
/// engine's own f32 values.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum Event {
    /// A random number was drawn.
    Number {
        /// Dimension: index of the pair.
        dimension: u32,
        /// Index in the pair: 0 or 1.
        half: u32,
        /// In [0, 1).
        value: f32,
        /// Purpose of the number.
        purpose: Purpose,
    },
    /// The ray left the camera.
    Camera {
        /// Origin on the lens.
        origin: [f32; 3],
        /// Unit vector.
        direction: [f32; 3],
    },
    /// A ray passed a surface with holes.
    Passed {
        /// Material slot of the surface.
        slot: u32,
        /// Distance from the ray's origin or the last passed surface.
        distance: f32,
        /// Opacity there, in [0, 1].
        opacity: f32,
    },
    /// A surface stopped the ray.
    Hit {
        /// Number of bounces before.
        bounce: u32,
        /// Triangle index, in the order of the hierarchy's leaves.
        triangle: u32,
        /// Material slot of the surface.
        slot: u32,
        /// Distance from the ray's origin.
        distance: f32,
        /// Position of the hit, in the geometry's units.
        position: [f32; 3],
        /// Geometric normal, on the ray's side.
        normal: [f32; 3],
        /// Unit shading normal, on the ray's side.
        shading_normal: [f32; 3],
        /// True for a hit on the triangle's back.
        is_inside: bool,
    },
    /// The camera ray hit the shadow catcher, which shows the background times the light that arrives, or mirrors.
    #[serde(rename = "caught")]
    CatcherHit {
        /// Whether it mirrors the ray.
        is_mirrored: bool,
        /// Radiance of the background; 1 if transparent, from which the light is subtracted.
        background: [f32; 3],
        /// Radiance of a white diffuse plane there without occluders.
        light: [f32; 3],
        /// Throughput from here on.
        throughput: [f32; 3],
    },
    /// The medium absorbed light.
    Absorption {
        /// Distance inside the medium.
        distance: f32,
        /// Transmittance per channel.
        kept: [f32; 3],
    },
    /// The path hit light by BSDF sampling.
    #[serde(rename = "found")]
    LightHit {
        /// Source of the light.
        source: LightSource,
        /// Radiance of the light.
        radiance: [f32; 3],
        /// Density of BSDF sampling per steradian; 0 if it does not compete.
        lobe_density: f32,
        /// Density of light sampling per steradian; 0 if it could not draw the direction.
        light_density: f32,
        /// MIS weight of BSDF sampling, in [0, 1].
        weight: f32,
    },
    /// A direction to a light was sampled.
    Light {
        source: LightSource,
        /// Unit vector.
        direction: [f32; 3],
        /// Density of the direction, per steradian.
        density: f32,
        /// Value of the material, cosine included, without the MIS weight.
        value: [f32; 3],
        /// MIS weight of light sampling per channel, in [0, 1]; 0 where the value is 0.
        weight: [f32; 3],
        /// Visibility in [0, 1]: 0 in shadow, 1 if no shadow ray was needed.
        visible: f32,
        /// Radiance of the light; 0 if none would arrive.
        radiance: [f32; 3],
    },
    /// The path continues in a direction sampled from the material.
    Scattered {
        layer: Layer,
        /// Probability of each layer. If the specular lobe passes on what it does not reflect: its mean.
        probabilities: Vec<LayerChance>,
        /// Unit vector.
        direction: [f32; 3],
        /// Factor of the throughput.
        factor: [f32; 3],
        /// Density of the direction in that layer times the layer's probability, per steradian; 0 if not needed.
        density: f32,
        /// Whether the layer counts as a mirror for MIS.
        is_mirror: bool,
        /// Throughput after it.
        throughput: [f32; 3],
    },
    /// Russian roulette was played.
    Roulette {
        /// Survival probability.
        survival: f32,
        /// The random number: the path survives below `survival`.
        number: f32,
    },
    /// Light was added to the sample.
    Contribution {
        /// Source of the light.
        source: LightSource,
        /// Number of reflections and refractions.
        reflections: u32,
        /// The contribution before the firefly clamp.
        found: [f32; 3],
        /// The contribution after the firefly clamp.
        added: [f32; 3],
    },
    Ended {
        why: End,
    },
}
