//! Light, camera, view and render settings.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::{AreaLight, GroundSettings, LightMix, Reference, switches::EffectSwitches, switches::Switch};
use crate::{
    job::{LightPaths, Strategy, effect::EffectId},
    named::{named, with_defaults},
    optics::random::Sequence,
    optics::tone::{Grade, ToneCurve},
    scene::camera::{PixelFilter, Projection},
    scene::environment::{EnvironmentEncoding, EnvironmentSource},
};

with_defaults! {
    /// Where the light comes from.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(default)]
    pub struct Lighting {
        pub environment: EnvironmentSource,
        /// What the numbers of an image for screens stand for, where the map is one.
        pub environment_encoding: EnvironmentEncoding,
        /// Turn of the map about +Y, anticlockwise seen from above, degrees.
        pub rotation_deg: f32,
        /// Factor on its radiance, at least 0.
        pub strength: f32 = 1.0,
        /// What the camera sees beside the model.
        pub background: Background,
        /// How far the environment is blurred where the camera sees it: the angle around each direction over which it is
        /// averaged, degrees. Light and reflections stay sharp.
        pub background_blur_deg: f32,
        /// Albedo of the ground, linear RGB in [0, 1].
        pub ground_color: [f32; 3] = [0.3; 3],
        /// What else the ground is.
        pub ground: GroundSettings,
        /// Lights beside it, at most 64.
        pub area_lights: Vec<AreaLight>,
        /// Whether the light of each group is summed apart.
        #[serde(skip_serializing_if = "std::ops::Not::not")]
        pub light_groups: bool,
        /// What the groups' light is multiplied by after rendering; a group that is not named keeps its light.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        pub light_mix: Vec<LightMix>,
    }
}

impl Lighting {
    /// The area lights that are not muted: first those that the camera sees.
    pub fn shining(&self) -> impl Iterator<Item = &AreaLight> {
        let of = |is_hidden: bool| {
            let lights = self.area_lights.iter();
            lights.filter(move |light| !light.is_muted && light.is_hidden == is_hidden)
        };
        of(false).chain(of(true))
    }
}

/// What the camera sees where no surface is. Reflections always show the environment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Background {
    #[default]
    Environment,
    /// Nothing: opacity 0.
    Transparent,
    /// A linear RGB colour, not touched by the environment's strength.
    Color([f32; 3]),
}

with_defaults! {
    /// Where the scene is seen from. Yaw 0, pitch 0 looks along −Z from a place on the +Z side of the target; the yaw goes
    /// towards +X, the pitch towards +Y, which is up.
    #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(default)]
    pub struct CameraSettings {
        /// What is looked at; `None`: the centre of the model.
        pub target: Option<[f64; 3]>,
        /// Azimuth of the camera around the target, degrees.
        pub yaw_deg: f64 = 25.0,
        /// Height of the camera above the target's horizon, degrees in [−90, 90].
        pub pitch_deg: f64 = 20.0,
        /// Distance from the target, scene units; `None`: so far that the model fills the image.
        pub distance: Option<f64>,
        /// The camera's place; replaces yaw, pitch and distance.
        pub position: Option<[f64; 3]>,
        /// Vertical field of view, degrees; of an orthographic camera what it would see of its target.
        pub fov_deg: f64 = 30.0,
        #[serde(skip_serializing_if = "is_perspective")]
        pub projection: Projection,
        /// Turn of the camera about the line to its target, clockwise as its holder sees it, degrees.
        pub roll_deg: f64,
        /// Radius of the lens, bounding radii of the model; 0: a pinhole, everything is sharp.
        pub aperture: f64,
        /// Distance along the viewing direction of what is sharp, scene units; `None`: that of the target.
        pub focus_distance: Option<f64>,
    }
}

fn is_perspective(projection: &Projection) -> bool {
    *projection == Projection::Perspective
}

/// A camera to come back to.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Bookmark {
    /// What the user calls it.
    pub name: String,
    /// Where the scene is seen from.
    pub camera: CameraSettings,
}

with_defaults! {
    /// How radiance becomes an image.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(default)]
    pub struct ViewSettings {
        pub tone_map: ToneCurve,
        /// Stops by which radiance is multiplied before it: 2^exposure.
        pub exposure_ev: f32,
        /// The exposure is added to one that brings the image's mean brightness to middle grey.
        pub auto_exposure: bool,
        /// The temperature of the light that appears white, in K.
        pub white_k: f32 = Grade::NEUTRAL_K,
        /// The power around middle grey by which radiance is steepened before the tone curve.
        pub contrast: f32 = 1.0,
        /// The distance from grey by which colours are multiplied before it.
        pub saturation: f32 = 1.0,
        /// How much darker the corners are: they keep 1/(1 + vignette)² of their light.
        #[serde(skip_serializing_if = "is_zero")]
        pub vignette: f32,
        /// The share of the light that is spread around where it falls, as in a lens.
        #[serde(skip_serializing_if = "is_zero")]
        pub glare: f32,
        /// A table of colours in a `.cube` file that the image goes through last, as codes of sRGB.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub lut: Option<PathBuf>,
        /// An image to work from, which the viewport shows.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub reference: Option<Reference>,
        /// Whether the image is denoised, and how.
        pub denoise: Denoise,
        /// When that is done in the window.
        pub denoise_when: DenoiseWhen,
    }
}

/// Whether an effect is off: documents without it stay as they were.
fn is_zero(value: &f32) -> bool {
    *value == 0.0
}

named! {
    /// How an image is denoised.
    #[derive(Default)]
    Denoise {
        #[default]
        Off = 0, "off", "Off", "The samples as they are.";
        Fast = 1, "fast", "Fast", "Denoises in about half the time.";
        High = 2, "high", "High quality", "Denoises at the best quality.";
        Auto = 3, "auto", "Automatic", "Blends the denoised and the raw image per tile to minimise the estimated error; converges to the raw image.";
    }
}

named! {
    /// When the window denoises an image.
    #[derive(Default)]
    DenoiseWhen {
        #[default]
        Rendering = 0, "rendering", "While rendering", "From the first sample on.";
        End = 1, "end", "At the end", "Once all has been rendered.";
    }
}

with_defaults! {
    /// How, and for how long, the image is rendered.
    #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(default)]
    pub struct RenderSettings {
        /// Columns of pixels.
        pub width: u32 = 512,
        /// Rows of pixels.
        pub height: u32 = 512,
        /// Samples per pixel after which rendering stops.
        pub samples: u32 = 256,
        /// The number of the first of them: a part of an image's samples is rendered where it is not 0.
        pub first_sample: u32,
        /// Seconds after which it stops earlier.
        pub time_s: Option<f64>,
        /// Relative error of the image (see [`crate::analysis::noise`]) at which it stops earlier; 0.01 is 1 %.
        pub noise: Option<f64>,
        /// Samples that each pixel has before the error is believed, so that small lights are not missed; at least 2.
        pub min_samples: u32 = 16,
        /// Whether samples go where the error is; `None`: only where a noise is to be reached. `samples` is then the most
        /// that a pixel gets.
        pub adaptive: Option<bool>,
        /// Longest path, 1 to 64 bounces.
        pub bounces: u32 = 64,
        /// The largest radiance that light keeps that was reflected twice or more; what is beyond is taken from the image,
        /// and reported. `None`: nothing is taken.
        pub firefly_clamp: Option<f32>,
        /// Which random numbers are drawn.
        pub sequence: Sequence,
        /// How light is found.
        pub strategy: Strategy,
        /// Which light the image shows.
        pub light_paths: LightPaths,
        /// Which of the possible images' noise: any number.
        pub seed: u32,
        /// How samples are spread over a pixel and its neighbours.
        pub filter: PixelFilter,
        /// The part of the image that is rendered: left, top, right, bottom as shares of width and height; `None`: all.
        pub region: Option<[f64; 4]>,
        /// What the user decides about effects, against the plan.
        pub effects: EffectSwitches,
    }
}

impl RenderSettings {
    /// The samples that every pixel gets where samples go where the error is or end with it.
    pub fn least_samples(&self) -> u32 {
        self.min_samples.min(self.samples)
    }

    /// Whether samples go where the error is.
    pub fn is_adaptive(&self) -> bool {
        let is_switched_off = self.effects.get(EffectId::AdaptiveSampling) == Switch::Off;
        !is_switched_off && self.adaptive.unwrap_or(self.noise.is_some())
    }
}
