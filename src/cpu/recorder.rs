//! What happens along a path, told to whoever wants to list it. The path tracer is generic over a [`Recorder`]; the one
//! that renders with, [`Unrecorded`], is compiled away.

use serde::Serialize;

use crate::optics::layer::Layer;
use crate::optics::real::Scalar;

/// What is told of the events of a path, in their order.
pub trait Recorder {
    /// Whether anything is kept of the events.
    const KEEPS: bool;
    /// Takes an event. Making it may cost something: only who keeps it calls for it.
    fn record(&mut self, event: impl FnOnce() -> Event);
}

impl<R: Recorder> Recorder for &mut R {
    const KEEPS: bool = R::KEEPS;
    #[inline(always)]
    fn record(&mut self, event: impl FnOnce() -> Event) {
        (**self).record(event);
    }
}

/// Keeps nothing.
#[derive(Clone, Copy)]
pub struct Unrecorded;

impl Recorder for Unrecorded {
    const KEEPS: bool = false;
    #[inline(always)]
    fn record(&mut self, _: impl FnOnce() -> Event) {}
}

impl Recorder for Vec<Event> {
    const KEEPS: bool = true;
    fn record(&mut self, event: impl FnOnce() -> Event) {
        self.push(event());
    }
}

/// What a random number is drawn for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Purpose {
    /// The place in the pixel.
    Pixel,
    /// The place on the lens.
    Lens,
    /// Whether a surface with holes stops the ray.
    Opacity,
    /// The direction drawn from a lobe.
    Lobe,
    /// Which layer of the material the direction is drawn from.
    Layer,
    /// The direction of what the specular lobe passed on.
    Below,
    /// The direction to a light.
    Light,
    /// Russian roulette.
    Roulette,
    /// Whether a shadow catcher mirrors the ray.
    Catcher,
    /// The direction in which a blurred background is seen.
    Blur,
    /// Drawn beside another number and not used; not told.
    Unused,
}

/// Where light comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// The environment.
    Environment,
    /// A surface that emits.
    Surface,
    /// What the camera sees where it meets nothing.
    Background,
}

/// Why a path goes no further.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// The ray left the scene.
    #[serde(rename = "left")]
    Escaped,
    /// It has as many bounces as it may have.
    Bounces,
    /// Nothing was reflected into the direction drawn, or what was is not a number.
    Absorbed,
    /// Russian roulette.
    Roulette,
}

/// How likely a layer is to be sampled.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LayerChance {
    /// The layer.
    pub layer: Layer,
    /// In [0, 1].
    pub probability: f32,
}

/// One event of a path. Lengths and places are in the geometry's units; colours are linear RGB. All numbers are as the
/// engine had them, where it shades in f32.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum Event {
    /// A random number was drawn.
    Number {
        /// Which pair of the path's.
        dimension: u32,
        /// Which of the pair: 0 or 1.
        half: u32,
        /// In [0, 1).
        value: f32,
        /// What for.
        purpose: Purpose,
    },
    /// The ray left the camera.
    Camera {
        /// On the lens.
        origin: [f32; 3],
        /// Unit vector.
        direction: [f32; 3],
    },
    /// A ray went straight on through a surface with holes.
    Passed {
        /// The surface's slot.
        slot: u32,
        /// From where the ray started or last went through.
        distance: f32,
        /// Share of light that the surface stops there.
        opacity: f32,
    },
    /// A surface stopped the ray.
    Hit {
        /// Number of bounces before.
        bounce: u32,
        /// In the order of the hierarchy's leaves.
        triangle: u32,
        /// The surface's slot.
        slot: u32,
        /// From the ray's origin.
        distance: f32,
        /// Where.
        position: [f32; 3],
        /// Geometric normal, on the side of the ray.
        normal: [f32; 3],
        /// The normal that is shaded with.
        shading_normal: [f32; 3],
        /// True where the back of the triangle was met.
        is_inside: bool,
    },
    /// A shadow catcher shows the background, as far as light reaches it or what it mirrors does not hide it.
    #[serde(rename = "caught")]
    CatcherHit {
        /// Whether it mirrors the ray.
        is_mirrored: bool,
        /// What is seen of the background; 1 where it is transparent, and the path's light is taken from that.
        background: [f32; 3],
        /// The radiance of a white matt plane there, nothing in the way of the light.
        light: [f32; 3],
        /// What the light that arrives is multiplied by from here on.
        throughput: [f32; 3],
    },
    /// The interior took its part of the light.
    Absorption {
        /// The way inside.
        distance: f32,
        /// What it lets through.
        kept: [f32; 3],
    },
    /// The path itself met light.
    #[serde(rename = "found")]
    LightHit {
        /// What shines.
        source: Source,
        /// Its radiance.
        radiance: [f32; 3],
        /// The density with which the lobe drew the direction, per steradian; 0 where it competes with nothing.
        lobe_density: f32,
        /// The density with which light sampling would have drawn it; 0 where it could not.
        light_density: f32,
        /// The share of the lobe under multiple importance sampling.
        weight: f32,
    },
    /// A direction to a light was drawn.
    Light {
        /// What was drawn from.
        source: Source,
        /// Unit vector.
        direction: [f32; 3],
        /// Of the direction, per steradian.
        density: f32,
        /// What the material reflects or refracts from there, cosine included, without the weight.
        value: [f32; 3],
        /// The share of light sampling under multiple importance sampling, by colour; 0 where the value is.
        weight: [f32; 3],
        /// The share of the light that arrives: 0 in shadow. 1 where nothing needed to be looked at.
        visible: f32,
        /// What shines there; 0 where nothing would arrive.
        radiance: [f32; 3],
    },
    /// The path goes on in a direction drawn from the material.
    Scattered {
        /// Which layer was chosen.
        layer: Layer,
        /// How likely each layer was. Where the specular lobe passes on what it does not reflect, by its mean.
        probabilities: Vec<LayerChance>,
        /// Unit vector.
        direction: [f32; 3],
        /// What the throughput was multiplied by.
        factor: [f32; 3],
        /// Of the direction in that layer times the probability of the layer, per steradian; 0 where it is not asked for.
        density: f32,
        /// Whether the layer is weighed as a mirror.
        is_mirror: bool,
        /// After it.
        throughput: [f32; 3],
    },
    /// Russian roulette was played.
    Roulette {
        /// The probability of going on.
        survival: f32,
        /// The number drawn: the path goes on where it is below.
        number: f32,
    },
    /// Light was added to the sample.
    Contribution {
        /// Where it comes from.
        source: Source,
        /// How often it was reflected or refracted.
        reflections: u32,
        /// What the path brings of it.
        found: [f32; 3],
        /// What was added: less where fireflies are limited.
        added: [f32; 3],
    },
    /// The path went no further.
    Ended {
        /// Why.
        why: End,
    },
}

/// As f32: exact where the path is traced in it.
pub(super) fn single<S: Scalar>(value: S) -> f32 {
    value.to_f64() as f32
}
