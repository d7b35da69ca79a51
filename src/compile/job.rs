//! Documents compiled to jobs.

use std::sync::Arc;

use super::{assets::Assets, error::AssetError, materials::compile_textured};
use crate::{
    document::{
        AreaLight, Background, CameraSettings, Document, GroupName, MaterialSettings, RenderSettings, Shine,
        effect::{Facts, Switch, plan, without_what_is_off},
        light_groups::emission_group,
    },
    import::light_profile,
    job::{BackgroundKind, Catcher, Job, Settings, Strategy, effect::EffectId, light_sums::ENVIRONMENT_GROUP},
    optics::{
        material::{HAS_PROFILE, LIGHT_GROUP_SHIFT, Material},
        table::append_table,
        vector::Vec3,
    },
    scene::{
        AreaFrame, Geometry,
        camera::{Camera, Projection, framing_distance, orbit_direction},
        catcher::{CatcherLight, NearLight, catcher_table},
        environment::Environment,
        light::{LightChoice, Lights, Sampled},
        light_profile::LightProfile,
        medium::medium_at,
        texture::{Textures, UserTextureFile},
    },
};

/// How far from its target parallel rays start at least, bounding radii of the model, and how far behind the camera.
const PARALLEL_REACH: f64 = 4.0;
const PARALLEL_MIN: f64 = 0.01;

/// Materials and their tables.
type Compiled = (Arc<Vec<Material<f32>>>, Arc<Vec<f32>>);

/// Key of materials and tables: settings, textures, and what lights are.
type MaterialsKey = (Vec<MaterialSettings>, Same<Textures>, Emission);

/// Something that is equal to itself alone.
#[derive(Debug)]
struct Same<T>(Arc<T>);

impl<T> PartialEq for Same<T> {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// What was made last of a key, made anew for another one.
fn remembered<K: PartialEq, V: Clone>(last: &mut Option<(K, V)>, key: K, make: impl FnOnce(&K) -> V) -> V {
    if let Some((_, made)) = last.as_ref().filter(|(of, _)| *of == key) {
        return made.clone();
    }
    let made = make(&key);
    *last = Some((key, made.clone()));
    made
}

/// What lights are, by the slots of their materials.
#[derive(Debug, PartialEq)]
struct Emission {
    shines: Vec<(usize, Shine)>,
    /// The light group of each slot; none where they are not summed apart.
    groups: Vec<u32>,
    /// Slots of lights whose profiles could be read.
    profiles: Vec<(usize, AreaFrame, Arc<LightProfile>)>,
}

impl Emission {
    /// Of a document whose area lights begin at a slot.
    fn of(document: &Document, model_slots: usize, first_light: usize) -> Self {
        let shines: Vec<_> = (first_light..)
            .zip(document.lighting.shining().map(AreaLight::shine))
            .collect();
        let profile = |(slot, shine): &(usize, Shine)| {
            let (file, frame) = shine.profile()?;
            Some((*slot, frame, light_profile::remembered(file.path())?))
        };
        Self {
            groups: slot_groups(document, model_slots),
            profiles: shines.iter().filter_map(profile).collect(),
            shines,
        }
    }

    /// Puts it on the compiled materials.
    fn finish(&self, materials: &mut [Material<f32>], tables: &mut Vec<f32>) {
        for (slot, shine) in &self.shines {
            shine.finish(&mut materials[*slot]);
        }
        for (material, group) in materials.iter_mut().zip(&self.groups) {
            material.flags |= group << LIGHT_GROUP_SHIFT;
        }
        for (slot, frame, profile) in &self.profiles {
            materials[*slot].flags |= HAS_PROFILE;
            materials[*slot].lobe_table = append_table(tables, &profile.table(frame));
        }
    }
}

/// Key of the emitters' table: geometry, and the emission of each slot.
type LightsKey = (Same<Geometry>, Vec<f32>);

/// Start of a shadow catcher's table, and all tables with it at the end.
type WithCatcher = (u32, Arc<Vec<f32>>);

/// Key of a shadow catcher's table, with the tables before it.
#[derive(Debug, PartialEq)]
struct CatcherKey {
    environment: Same<Environment>,
    rotation_deg: f32,
    strength: f32,
    area_lights: Vec<NearLight>,
    height: f64,
    reflection: f32,
    tables: Same<Vec<f32>>,
}

/// Textures of a document with the materials of the model's slots.
fn textures_of(document: &Document, slots: &[MaterialSettings], assets: &Assets) -> Result<Arc<Textures>, AssetError> {
    let own: Vec<_> = slots.iter().map(|slot| slot.user_textures.clone()).collect();
    assets.textures(&document.model, &document.import, &own)
}

/// Users' texture maps of a document's materials, readable or not.
pub fn user_texture_files(document: &Document, assets: &Assets) -> Result<Vec<UserTextureFile>, AssetError> {
    let document = &*without_what_is_off(document);
    let model = assets.model(&document.model, &document.import)?;
    let slots = slot_materials(document, model.slots.len());
    Ok(textures_of(document, &slots[..model.slots.len()], assets)?
        .user_textures
        .clone())
}

/// Compiles documents; remembers the last materials and lights, whose tables take milliseconds.
#[derive(Debug, Default)]
pub struct Compiler {
    catcher: Option<(CatcherKey, WithCatcher)>,
    materials: Option<(MaterialsKey, Compiled)>,
    lights: Option<(LightsKey, Arc<Lights>)>,
}

impl Compiler {
    pub fn compile(&mut self, document: &Document, assets: &Assets) -> Result<Job, AssetError> {
        let document = &*without_what_is_off(document);
        let (source, options) = (&document.model, &document.import);
        let model = assets.model(source, options)?;
        let shapes = document.lighting.shining().map(AreaLight::shape).collect();
        let geometry = assets.geometry(
            source,
            options,
            document.ground_shape(),
            shapes,
            document.hidden_objects.clone(),
        )?;
        let lighting = &document.lighting;
        let environment = assets.environment(&lighting.environment, lighting.environment_encoding)?;
        let mut slots = slot_materials(document, model.slots.len());
        let textures = textures_of(document, &slots[..model.slots.len()], assets)?;
        slots.extend(document.catcher_reflection());
        let first_light = model.slots.len() + usize::from(document.ground);
        let emission = Emission::of(document, model.slots.len(), first_light);
        let (materials, tables) = self.materials(&slots, &textures, emission);
        let (catcher, tables) = if document.catches_shadows() {
            let (table, tables) = self.with_catcher(document, &geometry, &environment, tables);
            let catcher = Catcher {
                slot: model.slots.len() as u32,
                reflection_slot: slots.len() as u32 - 1,
                table,
            };
            (Some(catcher), tables)
        } else {
            (None, tables)
        };
        let lights = self.lights(&geometry, &materials);
        let environment_strength = f64::from(document.lighting.strength);
        let switches = document.render.effects;
        let sampled = Sampled {
            environment: switches.get(EffectId::LightSampling) != Switch::Off,
            emitters: switches.get(EffectId::EmitterSampling) != Switch::Off,
            alone: document.render.strategy == Strategy::Light,
        };
        let [least_reflections, bounces] = document.render.light_paths.reflections(document.render.bounces);
        let camera = camera(&document.camera, &document.render, &geometry);
        let settings = Settings {
            image_size: [document.render.width, document.render.height],
            camera_medium: medium_at(&geometry, &materials, Vec3::from_f64(camera.origin.to_f64())),
            camera,
            first_hidden_slot: first_hidden_slot(document, first_light),
            background: match document.lighting.background {
                Background::Environment => match f64::from(document.lighting.background_blur_deg).to_radians().sin() {
                    sine if sine > 0.0 => BackgroundKind::Blurred(sine),
                    _ => BackgroundKind::Environment,
                },
                Background::Transparent => BackgroundKind::Transparent,
                Background::Color(color) => BackgroundKind::Color(color),
            },
            catcher,
            environment_rotation: cosine_and_sine(document.lighting.rotation_deg),
            environment_strength,
            rounds_surfaces: geometry.is_coarse && switches.get(EffectId::ShadowTerminator) != Switch::Off,
            light_choice: LightChoice::new(&environment, environment_strength, &lights, sampled),
            bounces,
            roulette_floor: roulette_floor(&materials),
            least_reflections,
            light_groups: document.light_groups().len() as u32,
            guides: 2,
            firefly_clamp: document.render.firefly_clamp.map_or(f64::INFINITY, f64::from),
            sequence: document.render.sequence,
            strategy: document.render.strategy,
            seed: document.render.seed,
            first_sample: document.render.first_sample,
        };
        let plan = plan(&Facts {
            document,
            slots: &slots,
            materials: &materials,
            geometry: &geometry,
            environment: &environment,
            settings: &settings,
        });
        Ok(Job {
            geometry,
            environment,
            lights,
            materials,
            textures,
            tables,
            settings,
            plan,
        })
    }

    fn materials(&mut self, wanted: &[MaterialSettings], textures: &Arc<Textures>, emission: Emission) -> Compiled {
        let key = (wanted.to_vec(), Same(textures.clone()), emission);
        remembered(&mut self.materials, key, |(wanted, textures, emission)| {
            let (mut materials, mut tables) = compile_textured(wanted, &textures.0.slots);
            emission.finish(&mut materials, &mut tables);
            (Arc::new(materials), Arc::new(tables))
        })
    }

    /// The tables with a shadow catcher's.
    fn with_catcher(
        &mut self,
        document: &Document,
        geometry: &Geometry,
        environment: &Arc<Environment>,
        tables: Arc<Vec<f32>>,
    ) -> WithCatcher {
        let lighting = &document.lighting;
        let key = CatcherKey {
            environment: Same(environment.clone()),
            rotation_deg: lighting.rotation_deg,
            strength: lighting.strength,
            area_lights: lighting.shining().map(AreaLight::seen_from_near).collect(),
            height: geometry.ground_height(),
            reflection: lighting.ground.reflection,
            tables: Same(tables),
        };
        remembered(&mut self.catcher, key, |key| {
            let light = CatcherLight {
                environment,
                rotation: cosine_and_sine(key.rotation_deg),
                strength: key.strength.into(),
                area_lights: &key.area_lights,
            };
            let mut joined = key.tables.0.to_vec();
            let first = append_table(&mut joined, &catcher_table(&light, key.height, key.reflection));
            (first, Arc::new(joined))
        })
    }

    fn lights(&mut self, geometry: &Arc<Geometry>, materials: &[Material<f32>]) -> Arc<Lights> {
        let emissions = materials.iter().map(|material| material.light_luminance).collect();
        let make = |_: &LightsKey| Arc::new(Lights::new(geometry, materials));
        remembered(&mut self.lights, (Same(geometry.clone()), emissions), make)
    }
}

/// Cosine and sine of an angle in degrees.
fn cosine_and_sine(angle_deg: f32) -> [f64; 2] {
    let (sine, cosine) = f64::from(angle_deg).to_radians().sin_cos();
    [cosine, sine]
}

/// One material per slot: the document's (the last one repeated if there are too few), the ground's if there is one, and
/// those of the area lights.
pub fn slot_materials(document: &Document, slots: usize) -> Vec<MaterialSettings> {
    let last = document.materials.last().cloned().unwrap_or_default();
    let mut materials = document.materials.clone();
    materials.resize(slots, last);
    if document.ground {
        materials.push(document.ground_material());
    }
    materials.extend(document.lighting.shining().map(AreaLight::material));
    materials
}

/// The number of each slot's light group, up to the area lights'; none without groups.
fn slot_groups(document: &Document, model_slots: usize) -> Vec<u32> {
    let names = document.light_groups();
    if names.is_empty() {
        return Vec::new();
    }
    let number = |name: GroupName| {
        let last = names.len() - 1;
        names.iter().position(|other| *other == name).unwrap_or(last) as u32
    };
    let mut groups = vec![number(emission_group()); model_slots];
    groups.resize(model_slots + usize::from(document.ground), ENVIRONMENT_GROUP);
    groups.extend(document.lighting.shining().map(|light| number(light.group_name())));
    groups
}

/// See [`Settings::first_hidden_slot`]; the slots of the area lights begin at `first_light`.
fn first_hidden_slot(document: &Document, first_light: usize) -> u32 {
    let first = document.lighting.shining().position(|light| light.is_hidden);
    first.map_or(u32::MAX, |first| (first_light + first) as u32)
}

/// See [`Settings::roulette_floor`]: an albedo behind clear glass is not gambled for.
fn roulette_floor(materials: &[Material<f32>]) -> f64 {
    let transmits = materials.iter().any(|material| material.least_metallic().transmits());
    if transmits { 1.0 / 16.0 } else { 1.0 }
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
    let pinhole = Camera::look_at(
        position.to_array(),
        target.to_array(),
        settings.fov_deg,
        aspect,
        render.filter,
    )
    .rolled(settings.roll_deg);
    let pinhole = match settings.projection {
        Projection::Perspective => pinhole,
        // In front of it is all of the model, wherever the target is.
        Projection::Orthographic => {
            let reach = PARALLEL_REACH + target.length();
            pinhole.orthographic((reach - pinhole.focus_distance).max(PARALLEL_MIN))
        }
    };
    let focus_distance = settings
        .focus_distance
        .map(|distance| distance / geometry.world_units_per_unit + pinhole.parallel_from);
    Camera {
        lens_radius: settings.aperture,
        focus_distance: focus_distance.unwrap_or(pinhole.focus_distance),
        ..pinhole
    }
}
