//! What an engine is handed, and what it hands back: the job (a document compiled to numbers, with the plan that says
//! which effects it calls for), the film, tiles and their schedule, and what else is asked of an engine.

pub mod effect;
pub mod features;
pub mod film;
pub mod guides;
pub mod plan;
pub mod precision;
pub mod probe;
pub mod sampling;
pub mod scatter;
pub mod tiles;

use std::sync::Arc;

use crate::optics::material::Material;
use crate::optics::random::Sequence;
use crate::scene::Geometry;
use crate::scene::camera::Camera;
use crate::scene::environment::{Distribution, Environment};
use crate::scene::light::{LightChoice, Lights};
use crate::scene::texture::Textures;

use crate::named::named;
use plan::Plan;

/// Everything that a picture depends on. Cheap to clone.
#[derive(Clone, Debug)]
pub struct Job {
    /// What rays meet.
    pub geometry: Arc<Geometry>,
    /// What they see far away.
    pub environment: Arc<Environment>,
    /// What of the geometry emits.
    pub lights: Arc<Lights>,
    /// The materials by slot: the model's, the ground's, the area lights', what a shadow catcher reflects with.
    pub materials: Arc<Vec<Material<f32>>>,
    /// What the materials look up.
    pub textures: Arc<Textures>,
    /// Custom curves, albedo tables, the shadow catcher's table (`optics::table`).
    pub tables: Arc<Vec<f32>>,
    /// Camera, light and sampling.
    pub settings: Settings,
    /// Which effects are simulated.
    pub plan: Plan,
}

impl Job {
    /// What directions to the environment's light are drawn with.
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
    /// In the geometry's units.
    pub camera: Camera<f64>,
    /// The slot of the solid around the camera; `None` where nothing depends on it.
    pub camera_medium: Option<u32>,
    /// What the camera sees where it meets nothing.
    pub background: BackgroundKind,
    /// The ground, where only shadows and reflections are seen of it.
    pub catcher: Option<Catcher>,
    /// Cosine and sine of the environment's rotation about +Y.
    pub environment_rotation: [f64; 2],
    /// Factor of the environment's radiance.
    pub environment_strength: f64,
    /// Coarse triangles are taken as the round surfaces that their normals tell of.
    pub rounds_surfaces: bool,
    /// How one light sample is shared out.
    pub light_choice: LightChoice,
    /// Reflections a path may have.
    pub bounces: u32,
    /// Paths of few bounces at what is no mirror or clear glass play Russian roulette below this throughput alone; 1 where
    /// nothing is refracted.
    pub roulette_floor: f64,
    /// Light that was reflected less often does not count.
    pub least_reflections: u32,
    /// The largest radiance that light keeps that was reflected twice or more; infinite where all is kept.
    pub firefly_clamp: f64,
    /// Random numbers.
    pub sequence: Sequence,
    /// How light is found.
    pub strategy: Strategy,
    /// Changes all random numbers.
    pub seed: u32,
    /// The number of each pixel's first sample.
    pub first_sample: u32,
}

named! {
    /// How light is found. All three converge to the same picture.
    #[derive(Default)]
    Strategy {
        Lobe = 0, "lobe", "Lobe", "Sample the material's lobe and see what light it meets.";
        Light = 1, "light", "Light", "Sample the light and see how the material reflects it.";
        #[default]
        Mis = 2, "mis", "Both (MIS)", "Sample both, each weighed by its density (Veach 1997).";
    }
}

named! {
    /// Which light the picture shows. Direct and indirect light together are all of it.
    #[derive(Default)]
    LightPaths {
        #[default]
        All, "all", "All light", "The picture as it is.";
        Direct, "direct", "Direct light", "What shines, and light that was reflected once: straight from a light or the environment.";
        Indirect, "indirect", "Indirect light", "Light that was reflected twice or more: between the surfaces of the scene.";
    }
}

impl LightPaths {
    /// How often light is reflected that counts: at least and, where paths may have so many bounces, at most.
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
    /// Its material slot.
    pub slot: u32,
    /// The slot whose specular lobe it reflects with.
    pub reflection_slot: u32,
    /// Where its table begins among the job's ([`catcher_table`](crate::scene::catcher::catcher_table)).
    pub table: u32,
}

/// What the camera sees where it meets nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BackgroundKind {
    /// The environment.
    Environment,
    /// The environment, averaged around each direction; the sine of the largest angle.
    Blurred(f64),
    /// Nothing: alpha 0.
    Transparent,
    /// A linear colour.
    Color([f32; 3]),
}
