//! What is edited and saved, as plain values: what is rendered, its materials, light, camera, view and render settings;
//! their parameters as data; files; differences; history.

mod area_light;
pub mod change;
mod checked;
pub mod custom_curve;
pub mod effect;
mod ground;
pub mod group_name;
pub mod history;
pub mod import;
pub mod light_groups;
mod look_words;
pub mod material;
mod material_textures;
mod metal_colors;
pub mod of_model;
pub mod parameter;
mod profile_file;
pub mod range;
mod reference;
mod settings;
mod switches;
mod texture_json;
pub mod turntable;

use std::{collections::BTreeMap, path::Path, path::PathBuf};

use serde::{Deserialize, Serialize};

pub use area_light::{AreaLight, AreaLightShape, Shine};
pub use change::Change;
pub use checked::SettingError;
pub use custom_curve::CustomCurve;
pub use ground::{GroundKind, GroundSettings};
pub use group_name::GroupName;
pub use history::History;
pub use import::ImportLobe;
pub use light_groups::LightMix;
pub use material::{CoatLobe, Conductor, MaterialSettings, SPECULAR_COLOR_MAX, TextureUse};
pub use parameter::{
    Choice, Kind, LIGHT_PARAMETERS, PARAMETERS, Parameter, ParameterError, SETTINGS, Stage, TEXTURE_PARAMETERS, Value,
    assign, parameter, setting,
};
pub use profile_file::ProfileFile;
pub use reference::{Reference, ReferencePlace};
pub use settings::{
    Background, Bookmark, CameraSettings, Denoise, DenoiseWhen, Lighting, RenderSettings, ViewSettings,
};
pub use texture_json::{TextureError, texture_from_json, texture_to_json};

pub use crate::{job::LightPaths, job::Strategy, scene::camera::PixelFilter, scene::texture::UserTextures};

use crate::{named::with_defaults, scene::ModelOptions, scene::ModelSource};

with_defaults! {
    /// Everything that an image depends on, except for the contents of the files it names.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(default)]
    pub struct Document {
        pub model: ModelSource,
        /// What is shown of a file that holds more than one image.
        pub import: ModelOptions,
        /// The numbers of the objects of the model that are not shown, each once.
        pub hidden_objects: Vec<usize>,
        /// Names of objects of the model instead of the file's, by number; no image depends on them.
        pub object_names: BTreeMap<usize, String>,
        /// Whether the model stands on a ground.
        pub ground: bool,
        /// The materials in the order of the model's slots. A slot beyond the last takes the last one.
        pub materials: Vec<MaterialSettings> = vec![MaterialSettings::default()],
        /// Where the light comes from.
        pub lighting: Lighting,
        /// Where it is seen from.
        pub camera: CameraSettings,
        /// Metres of a scene unit: what lights' power is reckoned with; no image depends on it.
        pub unit_m: f64 = 1.0,
        /// Cameras to come back to; no image depends on them.
        pub bookmarks: Vec<Bookmark>,
        /// How radiance becomes an image.
        pub view: ViewSettings,
        /// How, and for how long, it is rendered.
        pub render: RenderSettings,
        /// What the file had that this version does not know: written back when saving.
        #[serde(skip)]
        pub extra: serde_json::Map<String, serde_json::Value>,
    }
}

impl Document {
    /// Whether every number lies where the renderer can work with it. Materials need no check: they are set through
    /// [`PARAMETERS`].
    pub fn check(&self) -> Result<(), SettingError> {
        checked::check(self)
    }

    /// The files that it names beside model and environment: its materials' textures, the view's table of colours and its
    /// reference, lights' profiles.
    pub fn pictures(&self) -> impl Iterator<Item = &Path> {
        let textures = self
            .materials
            .iter()
            .flat_map(|material| material.user_textures.files());
        let reference = self.view.reference.as_ref().map(|reference| &reference.file);
        let of_view = self.view.lut.as_ref().into_iter().chain(reference);
        let of_lights = self.lighting.area_lights.iter().filter_map(|light| light.profile);
        let named = textures.chain(of_view);
        named
            .map(PathBuf::as_path)
            .chain(of_lights.map(|profile| profile.path()))
    }

    /// The material that a slot shows.
    pub fn material(&self, slot: usize) -> MaterialSettings {
        let materials = &self.materials;
        materials.get(slot).or(materials.last()).cloned().unwrap_or_default()
    }

    /// The material of a slot, to be changed; slots before it keep what they show.
    pub fn material_mut(&mut self, slot: usize) -> &mut MaterialSettings {
        if self.materials.len() <= slot {
            let last = self.materials.last().cloned().unwrap_or_default();
            self.materials.resize(slot + 1, last);
        }
        &mut self.materials[slot]
    }
}
