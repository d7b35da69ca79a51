//! Documents to begin with, one for each thing that the program promises.

use super::preset::material_by_name;
use crate::{
    document::{AreaLight, CameraSettings, Document, GroundKind, GroundSettings, MaterialSettings},
    scene::{ModelSource, environment::EnvironmentSource},
};

/// A document to begin with.
#[derive(Clone, Copy, Debug)]
pub struct Example {
    /// What it is called.
    pub label: &'static str,
    /// What is to be seen.
    pub help: &'static str,
    /// The title of the panel that shows more.
    pub panel: &'static str,
    pub document: fn() -> Document,
}

/// All of them; the editor and *New* begin with the first.
pub const EXAMPLES: [Example; 5] = [
    Example {
        label: "Still life",
        help: "A glazed teapot, a bowl, a ball and a bead in the studio: a place to try materials.",
        panel: "Presets",
        document: still_life,
    },
    Example {
        label: "Accuracy in time",
        help: "Brushed steel, rendered until the error is 1 %: Convergence shows what that takes, and what more would.",
        panel: "Convergence",
        document: accuracy,
    },
    Example {
        label: "A hard case: clear glass",
        help: "A ball of glass on the ground under a small light: the light behind it comes only through it. Precision over the \
               viewport shows where numbers are not to be trusted.",
        panel: "Inspector",
        document: clear_glass,
    },
    Example {
        label: "Effects and their cost",
        help: "Lacquer, glass, a metal that shines and a lens out of focus: Effects lists what is simulated and why, and \
               measures what each costs.",
        panel: "Effects",
        document: effects,
    },
    Example {
        label: "Many materials",
        help: "The shader ball in two materials under coloured lights: choose, hide and exchange them in Scene.",
        panel: "Scene",
        document: many_materials,
    },
];

fn preset(name: &str) -> MaterialSettings {
    material_by_name(name).cloned().unwrap_or_default()
}

fn light(yaw_deg: f64, pitch_deg: f64, strength: f32, color: [f32; 3]) -> AreaLight {
    AreaLight {
        yaw_deg,
        pitch_deg,
        strength,
        color,
        ..AreaLight::default()
    }
}

/// The document that the editor and *New* begin with.
pub fn still_life() -> Document {
    let yaw_deg = 18.0;
    let mut document = Document {
        model: ModelSource::StillLife,
        ground: true,
        materials: ["celadon-glaze", "copper", "gold", "candy-red"].map(preset).into(),
        camera: CameraSettings {
            yaw_deg,
            pitch_deg: 17.0,
            fov_deg: 24.0,
            ..CameraSettings::default()
        },
        ..Document::default()
    };
    // A floor that bends up into a wall has no horizon, and no edge in sight.
    document.lighting.ground = GroundSettings {
        kind: GroundKind::Cyclorama,
        yaw_deg,
        ..GroundSettings::default()
    };
    document.lighting.ground_color = [0.36, 0.32, 0.285];
    document
}

fn accuracy() -> Document {
    let mut document = Document {
        ground: true,
        materials: vec![preset("brushed-steel")],
        ..Document::default()
    };
    document.render.noise = Some(0.01);
    document.render.samples = 65_536;
    document
}

fn clear_glass() -> Document {
    let mut document = Document {
        model: ModelSource::Sphere,
        ground: true,
        materials: vec![preset("glass")],
        ..Document::default()
    };
    document.camera.pitch_deg = 28.0;
    document.lighting.strength = 0.15;
    document.lighting.area_lights = vec![AreaLight {
        width: 0.4,
        height: 0.4,
        ..light(-60.0, 50.0, 90.0, [1.0, 0.95, 0.85])
    }];
    document
}

fn effects() -> Document {
    let shining = MaterialSettings {
        emission_color: [1.0, 0.35, 0.1],
        emission_strength: 0.6,
        ..preset("frosted-glass")
    };
    let mut document = Document {
        model: ModelSource::Shaderball,
        ground: true,
        materials: vec![preset("car-paint-red"), shining],
        ..Document::default()
    };
    document.camera.aperture = 0.06;
    document.lighting.environment = EnvironmentSource::Sky;
    document
}

fn many_materials() -> Document {
    let mut document = Document {
        model: ModelSource::Shaderball,
        ground: true,
        materials: vec![preset("pearl"), preset("copper")],
        ..Document::default()
    };
    document.lighting.strength = 0.4;
    document.lighting.area_lights = vec![
        light(-60.0, 30.0, 8.0, [1.0, 0.6, 0.35]),
        light(70.0, 35.0, 8.0, [0.4, 0.6, 1.0]),
    ];
    document
}
