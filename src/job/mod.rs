//! Input and output of an engine: the job (a document compiled to numbers, with its feature plan), the film, tiles and their
//! schedule, and other requests.

/// Structures of plain words, which the GPU reads byte for byte.
#[macro_export]
macro_rules! plain {
    ($($(#[$doc:meta])* struct $name:ident { $($(#[$of_field:meta])* $field:ident: $type:ty,)* })*) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
            #[repr(C)]
            pub struct $name {
                $($(#[$of_field])* pub $field: $type,)*
            }

            impl $name {
                /// Names and types of the members: the shaders' structure is made of them.
                pub const MEMBERS: &[(&str, &str)] = &[$((stringify!($field), stringify!($type))),*];
            }
        )*
    };
}
pub use crate::plain;

pub mod effect;
pub mod features;
pub mod film;
pub mod guides;
pub mod light_sums;
pub mod plan;
pub mod precision;
pub mod probe;
pub mod scatter;
pub mod tiles;

use std::sync::Arc;

use crate::{
    named::named,
    optics::{material::Material, random::Sequence},
    scene::{
        Geometry,
        camera::Camera,
        environment::{Distribution, Environment},
        light::{LightChoice, Lights},
        texture::Textures,
    },
};

use plan::Plan;

/// A render job: everything that an image depends on. Cheap to clone.
#[derive(Clone, Debug)]
pub struct Job {
    /// Geometry of the model and its surroundings, in units of its bounding radius.
    pub geometry: Arc<Geometry>,
    pub environment: Arc<Environment>,
    pub lights: Arc<Lights>,
    /// Materials by slot: the model's, the ground's, the area lights', the shadow catcher's reflection.
    pub materials: Arc<Vec<Material<f32>>>,
    /// Textures of the materials.
    pub textures: Arc<Textures>,
    /// Custom curves, albedo tables, the shadow catcher's table (`optics::table`).
    pub tables: Arc<Vec<f32>>,
    /// Camera, light and sampling.
    pub settings: Settings,
    /// Plan of the simulated effects.
    pub plan: Plan,
}

impl Job {
    /// Distribution of light sampling over the environment.
    pub fn distribution(&self) -> &Distribution {
        self.environment.distribution(self.settings.strategy == Strategy::Light)
    }

    /// Whether another job draws directions to the environment's light with the same.
    pub fn has_distribution_of(&self, other: &Self) -> bool {
        std::ptr::eq(self.distribution(), other.distribution())
    }
}

/// The numbers of a job that are cheap to change.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Width and height in pixels.
    pub image_size: [u32; 2],
    /// Camera in the geometry's units.
    pub camera: Camera<f64>,
    /// Slot of the medium around the camera; `None` if irrelevant.
    pub camera_medium: Option<u32>,
    /// Slot from which on the camera does not see surfaces: those of hidden area lights; [`u32::MAX`] without any.
    pub first_hidden_slot: u32,
    /// Background of camera rays that miss.
    pub background: BackgroundKind,
    /// The shadow catcher, if any.
    pub catcher: Option<Catcher>,
    /// Cosine and sine of the environment's rotation about +Y.
    pub environment_rotation: [f64; 2],
    /// Factor of the environment's radiance.
    pub environment_strength: f64,
    /// Whether coarse triangles are rounded according to their normals.
    pub rounds_surfaces: bool,
    /// Split of light samples between environment and emitters.
    pub light_choice: LightChoice,
    /// Reflections a path may have.
    pub bounces: u32,
    /// Throughput limit of Russian roulette for paths with few rough bounces; 1 without refraction.
    pub roulette_floor: f64,
    /// Light that was reflected less often does not count.
    pub least_reflections: u32,
    /// Light groups whose light is also summed apart, see [`light_sums`]; 0: none.
    pub light_groups: u32,
    /// First-hit guides per pixel, where any are kept: 2, of the even and the odd samples, or 1 where nothing is denoised.
    pub guides: u32,
    /// Largest radiance of indirect contributions; infinite for no limit.
    pub firefly_clamp: f64,
    pub sequence: Sequence,
    pub strategy: Strategy,
    /// Changes all random numbers.
    pub seed: u32,
    /// The number of each pixel's first sample.
    pub first_sample: u32,
}

named! {
    /// Light strategy; all three converge to the same image.
    #[derive(Default)]
    Strategy {
        Lobe = 0, "lobe", "Lobe", "Sample the material's lobe and see what light it meets.";
        Light = 1, "light", "Light", "Sample the light and see how the material reflects it.";
        #[default]
        Mis = 2, "mis", "Both (MIS)", "Sample both, each weighed by its density (Veach 1997).";
    }
}

named! {
    /// Part of the light in the image; direct and indirect light add up to all.
    #[derive(Default)]
    LightPaths {
        #[default]
        All, "all", "All light", "The image as it is.";
        Direct, "direct", "Direct light", "What shines, and light that was reflected once: straight from a light or the environment.";
        Indirect, "indirect", "Indirect light", "Light that was reflected twice or more: between the surfaces of the scene.";
    }
}

impl LightPaths {
    /// Range of reflections that count: at least and at most; paths may have `bounces` bounces.
    pub fn reflections(self, bounces: u32) -> [u32; 2] {
        match self {
            Self::All => [0, bounces],
            Self::Direct => [0, bounces.min(1)],
            Self::Indirect => [2, bounces],
        }
    }
}

/// A ground of which the camera sees only shadows and reflections.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Catcher {
    pub slot: u32,
    /// The slot whose specular lobe it reflects with.
    pub reflection_slot: u32,
    /// Start of its table among the job's ([`catcher_table`](crate::scene::catcher::catcher_table)).
    pub table: u32,
}

/// Background of camera rays that miss.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BackgroundKind {
    /// The environment map, unblurred.
    Environment,
    /// The environment, averaged around each direction; the sine of the largest angle.
    Blurred(f64),
    /// Nothing: alpha 0.
    Transparent,
    /// A linear colour.
    Color([f32; 3]),
}
