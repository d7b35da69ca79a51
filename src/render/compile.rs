//! Documents compiled to jobs.

use std::sync::Arc;

use super::assets::Assets;
use super::session::SessionError;
use crate::document::job::{BackgroundKind, Job, Settings};
use crate::document::plan::Plan;
use crate::document::{AreaLight, Background, CameraSettings, Document, MaterialSettings, RenderSettings, compile};
use crate::optics::material::Material;
use crate::optics::vector::Vec3;
use crate::scene::Geometry;
use crate::scene::camera::{Camera, orbit_direction};
use crate::scene::light::{LightChoice, Lights};

/// How much room a framed model is given.
const FRAME_MARGIN: f64 = 1.05;

/// Materials and their tables.
type Compiled = (Arc<Vec<Material<f32>>>, Arc<Vec<f32>>);

/// What the table of emitting triangles depends on: geometry, and the emission of each slot.
type LightsKey = (Arc<Geometry>, Vec<Vec3<f32>>);

/// Compiles documents; remembers the last materials and lights, whose tables take milliseconds.
#[derive(Debug, Default)]
pub(super) struct Compiler {
    materials: Option<(Vec<MaterialSettings>, Compiled)>,
    lights: Option<(LightsKey, Arc<Lights>)>,
}

impl Compiler {
    pub(super) fn compile(&mut self, document: &Document, assets: &mut Assets) -> Result<Job, SessionError> {
        let model = assets.model(&document.model)?;
        let shapes = document.lighting.area_lights.iter().map(AreaLight::shape).collect();
        let geometry = assets.geometry(&document.model, document.ground, shapes)?;
        let environment = assets.environment(&document.lighting.environment)?;
        let (materials, tables) = self.materials(slot_materials(document, model.slots.len()));
        let lights = self.lights(&geometry, &materials);
        let environment_strength = f64::from(document.lighting.strength);
        let rotation_rad = f64::from(document.lighting.rotation_deg).to_radians();
        let settings = Settings {
            image_size: [document.render.width, document.render.height],
            camera: camera(&document.camera, &document.render, &geometry),
            background: match document.lighting.background {
                Background::Environment => BackgroundKind::Environment,
                Background::Transparent => BackgroundKind::Transparent,
                Background::Color(color) => BackgroundKind::Color(color),
            },
            environment_rotation: [rotation_rad.cos(), rotation_rad.sin()],
            environment_strength,
            light_choice: LightChoice::new(&environment, environment_strength, &lights),
            bounces: document.render.bounces,
            firefly_clamp: document.render.firefly_clamp.map_or(f64::INFINITY, f64::from),
            sequence: document.render.sequence,
            strategy: document.render.strategy,
            seed: document.render.seed,
        };
        let plan = Plan {
            firefly_clamp: settings.firefly_clamp.is_finite(),
            ..Plan::new(&materials, &settings.light_choice, settings.camera.lens_radius)
        };
        Ok(Job {
            geometry,
            environment,
            lights,
            materials,
            tables,
            settings,
            plan,
        })
    }

    fn materials(&mut self, wanted: Vec<MaterialSettings>) -> Compiled {
        if let Some((_, compiled)) = self.materials.as_ref().filter(|(of, _)| *of == wanted) {
            return compiled.clone();
        }
        let (materials, tables) = compile(&wanted);
        let compiled = (Arc::new(materials), Arc::new(tables));
        self.materials = Some((wanted, compiled.clone()));
        compiled
    }

    fn lights(&mut self, geometry: &Arc<Geometry>, materials: &[Material<f32>]) -> Arc<Lights> {
        let emissions: Vec<_> = materials.iter().map(|material| material.emission).collect();
        let is_known = |(of, emitted): &LightsKey| Arc::ptr_eq(of, geometry) && *emitted == emissions;
        if let Some((_, lights)) = self.lights.as_ref().filter(|(key, _)| is_known(key)) {
            return lights.clone();
        }
        let lights = Arc::new(Lights::new(geometry, materials));
        self.lights = Some(((geometry.clone(), emissions), lights.clone()));
        lights
    }
}

/// One material a slot, the last one repeated where the document has too few, the ground's where there is one, and those
/// of the area lights.
fn slot_materials(document: &Document, slots: usize) -> Vec<MaterialSettings> {
    let last = document.materials.last().cloned().unwrap_or_default();
    let mut materials = document.materials.clone();
    materials.resize(slots, last);
    if document.ground {
        materials.push(MaterialSettings::diffuse("ground", document.lighting.ground_color));
    }
    materials.extend(document.lighting.area_lights.iter().map(AreaLight::material));
    materials
}

/// The camera in the geometry's units.
fn camera(settings: &CameraSettings, render: &RenderSettings, geometry: &Geometry) -> Camera<f64> {
    let aspect = f64::from(render.width) / f64::from(render.height.max(1));
    let units = |place: [f64; 3]| geometry.units_from_world(place.into());
    let target = settings.target.map_or(glam::DVec3::ZERO, units);
    let position = settings.position.map(units).unwrap_or_else(|| {
        let distance = match settings.distance {
            Some(distance) => distance / geometry.world_units_per_unit,
            None => framing_distance(settings.fov_deg, aspect),
        };
        target + distance * orbit_direction(settings.yaw_deg, settings.pitch_deg)
    });
    Camera::look_at(
        position.to_array(),
        target.to_array(),
        settings.fov_deg,
        aspect,
        render.filter,
    )
}

/// The distance at which the bounding sphere, of radius 1, just fits the picture's shorter side.
fn framing_distance(fov_deg: f64, aspect: f64) -> f64 {
    let half_height = (0.5 * fov_deg.to_radians()).tan();
    let half = (half_height * aspect.min(1.0)).atan();
    FRAME_MARGIN / half.sin()
}
