//! What the model stands on, as it is edited.

use serde::{Deserialize, Serialize};

use super::{Document, MaterialSettings};
use crate::named::{named, with_defaults};
use crate::scene::ground::{Cyclorama, Ground};

/// The least albedo of a shadow catcher, whose light is known by what it reflects.
const CATCHER_ALBEDO_MIN: f32 = 0.001;

with_defaults! {
    /// What the ground is, where there is one. Its colour stands beside it. Lengths are in bounding radii of the model.
    #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(default)]
    pub struct GroundSettings {
        pub kind: GroundKind,
        /// How much of a varnish lies on it, in [0, 1]: its reflection is that of glass, times this.
        pub reflection: f32,
        /// Roughness of the reflection, in [0, 1].
        pub roughness: f32 = 0.2,
        /// Azimuth of the cyclorama's open side as a camera's, degrees.
        pub yaw_deg: f64,
        /// From the model's centre to the cyclorama's wall, above 0.
        pub wall_distance: f64 = 4.0,
        /// Radius of the cyclorama's bend, above 0; no more than the wall's distance is used.
        pub bend_radius: f64 = 2.0,
    }
}

named! {
    /// What a ground is.
    #[derive(Default)]
    GroundKind {
        #[default]
        Plane = 0, "plane", "Plane", "A matt plane, or a shiny one.";
        ShadowCatcher = 1, "shadow-catcher", "Shadow catcher", "A plane of which only shadows and reflections are seen: the background goes on below them, and a transparent one gets them as alpha.";
        Cyclorama = 2, "cyclorama", "Cyclorama", "A floor that bends up into a wall, as in a photographer's studio.";
    }
}

impl Document {
    /// The surface that the model stands on.
    pub fn ground_shape(&self) -> Ground {
        let settings = &self.lighting.ground;
        match settings.kind {
            _ if !self.ground => Ground::None,
            GroundKind::Plane | GroundKind::ShadowCatcher => Ground::Plane,
            GroundKind::Cyclorama => Ground::Cyclorama(Cyclorama {
                yaw_deg: settings.yaw_deg,
                distance: settings.wall_distance,
                radius: settings.bend_radius,
            }),
        }
    }

    /// Whether only shadows and reflections are seen of the ground.
    pub fn catches_shadows(&self) -> bool {
        self.ground && self.lighting.ground.kind == GroundKind::ShadowCatcher
    }

    pub fn ground_material(&self) -> MaterialSettings {
        let settings = &self.lighting.ground;
        let mut material = MaterialSettings::diffuse("ground", self.lighting.ground_color);
        if self.catches_shadows() {
            material.base_color = material.base_color.map(|albedo| albedo.max(CATCHER_ALBEDO_MIN));
        } else {
            material.specular_weight = settings.reflection;
            material.roughness = settings.roughness;
        }
        material
    }

    /// What a shadow catcher reflects with; `None` where it does not.
    pub fn catcher_reflection(&self) -> Option<MaterialSettings> {
        let settings = &self.lighting.ground;
        (self.catches_shadows() && settings.reflection > 0.0).then(|| MaterialSettings {
            metalness: 1.0,
            specular_weight: 1.0,
            roughness: settings.roughness,
            ..MaterialSettings::diffuse("ground's reflection", [1.0; 3])
        })
    }
}
