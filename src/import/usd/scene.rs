//! The scene of a stage: a walk through its prims, with instances, cameras and lights, in metres and with Y up.

use std::{f64::consts::PI, path::Path, rc::Rc};

use glam::{DMat4, DQuat, DVec3};
use openusd::{
    schemas::geom::{Imageable, Xformable},
    sdf::{Specifier, Value},
    usd::{Attribute, Prim, SchemaBase, SchemaKind, Stage, TimeCode},
};

use super::{
    DEPTH_MAX, Known, deep, kind,
    material::Slots,
    mesh::{COLORS, bound, read_mesh, read_shape},
    opened,
    shape::shape,
    text_of,
};
use crate::{
    assembly::{Assembly, camera_at, light_at},
    files::Files,
    model_error::ModelError,
    scene::{
        LightKind, Model, ModelCamera, ModelLens, ModelLight, ModelOptions,
        report::{Fate, ImportReport},
    },
};

/// More prims than this are not shown: a small file could repeat any number.
const PRIMS_MAX: usize = 1 << 20;
/// Most words on what composition left out.
const ERRORS_MAX: usize = 16;
/// A right angle of a light's cone, radians.
const HALF_SPACE: [f64; 2] = [1.55; 2];

/// Loads the contents of a USD file.
pub fn load(path: &Path, files: Files, bytes: Vec<u8>, options: &ModelOptions) -> Result<Model, ModelError> {
    let read = || {
        let files = Rc::new(files);
        let opened = opened(path, bytes, files.clone());
        let (stage, read) = opened.map_err(|reason| ModelError::invalid(path, reason))?;
        Walk::new(&stage, &files, options).model(path, &read)
    };
    deep(read).unwrap_or_else(|| Err(ModelError::invalid(path, "its parts contradict each other")))
}

/// A prim as one with a place.
struct Placed<'a>(&'a Prim);

impl SchemaBase for Placed<'_> {
    const KIND: SchemaKind = SchemaKind::ConcreteTyped;

    fn prim(&self) -> &Prim {
        self.0
    }
}

impl Imageable for Placed<'_> {}
impl Xformable for Placed<'_> {}

/// A mesh, or a shape, at a place.
struct Shown {
    prim: Prim,
    /// The kind of a shape.
    shape: Option<String>,
    world_from_mesh: DMat4,
    /// The prim whose instances are one object.
    object: usize,
}

struct Walk<'a> {
    stage: &'a Stage,
    files: &'a Files,
    options: &'a ModelOptions,
    time: TimeCode,
    world_from_stage: DMat4,
    shown: Vec<Shown>,
    cameras: Vec<ModelCamera>,
    lights: Vec<ModelLight>,
    prims: usize,
    report: ImportReport,
}

/// A value at a time, as it is without one.
pub fn value_at(attribute: &Attribute, time: TimeCode) -> Option<Value> {
    attribute.get_at::<Value>(time).ok().flatten()
}

impl<'a> Walk<'a> {
    fn new(stage: &'a Stage, files: &'a Files, options: &'a ModelOptions) -> Self {
        let metadata = |name: &str| stage.stage_metadata(name).ok().flatten();
        let metres = metadata("metersPerUnit").and_then(|value| value.cast::<f64>().ok());
        let metres = metres.filter(|metres| *metres > 0.0).unwrap_or(0.01);
        let up = metadata("upAxis").and_then(|value| value.cast::<String>().ok());
        let turn = match up.as_deref() {
            Some("Z") => DMat4::from_rotation_x(-PI / 2.0),
            _ => DMat4::IDENTITY,
        };
        let time = match (options.time_s, stage.has_authored_time_code_range()) {
            (Some(time_s), _) => {
                TimeCode::new(stage.start_time_code() + f64::from(time_s) * stage.time_codes_per_second())
            }
            (None, true) => TimeCode::new(stage.start_time_code()),
            (None, false) => TimeCode::EARLIEST,
        };
        Self {
            stage,
            files,
            options,
            time,
            world_from_stage: turn * DMat4::from_scale(DVec3::splat(metres)),
            shown: Vec::new(),
            cameras: Vec::new(),
            lights: Vec::new(),
            prims: 0,
            report: ImportReport::default(),
        }
    }

    fn model(mut self, path: &Path, read: &Known) -> Result<Model, ModelError> {
        let (stage, loading) = (self.stage, &self.files.import.loading);
        for name in stage.root_prims().unwrap_or_default() {
            self.walk(&stage.prim(format!("/{name}")), self.world_from_stage, 0);
            loading.check()?;
        }
        for error in stage.composition_errors().iter().take(ERRORS_MAX) {
            self.report.note(Fate::Missing, format!("a part ({error})"), "");
        }
        let mut slots = Slots::new(self.files, read, self.options);
        // The parts of a prim's instances are those of one prim, and shapes that look the same share a mesh.
        let key = |shown: &Shown| match &shown.shape {
            Some(shape) => {
                let color = value_at(&shown.prim.attribute(COLORS), self.time);
                format!("{shape} {:?} {color:?}", bound(&shown.prim))
            }
            None => {
                let shared = shown.prim.prim_in_prototype().ok().flatten();
                shared.as_ref().unwrap_or(&shown.prim).path().to_string()
            }
        };
        let mut assembly = Assembly::new(path, loading, self.shown.iter().map(key));
        for shown in &self.shown {
            let name = shown.prim.path().name().unwrap_or_default();
            let read = || match &shown.shape {
                Some(shape) => read_shape(&shown.prim, shape, self.time, &mut slots, &mut self.report),
                None => read_mesh(&shown.prim, self.time, &mut slots, &mut self.report, loading),
            };
            assembly.place(key(shown), (shown.object, name), shown.world_from_mesh, read)?;
        }
        let mut model = assembly.finish(&mut self.report);
        (model.slots, model.textures) = slots.finish();
        let duration = (stage.end_time_code() - stage.start_time_code()).max(0.0) / stage.time_codes_per_second();
        if stage.has_authored_time_code_range() && duration.is_finite() {
            model.duration_s = duration as f32;
        }
        Ok(Model {
            cameras: self.cameras,
            lights: self.lights,
            report: self.report,
            ..model
        })
    }

    fn value<T: openusd::sdf::FromValueCast>(&self, prim: &Prim, name: &str) -> Option<T> {
        value_at(&prim.attribute(name), self.time)?.cast().ok()
    }

    fn number(&self, prim: &Prim, name: &str, default: f64) -> f64 {
        let found = self.value(prim, name).filter(|x: &f64| x.is_finite());
        found.unwrap_or(default)
    }

    /// Takes a prim that is defined and active, and those below it.
    fn walk(&mut self, prim: &Prim, world_from_parent: DMat4, depth: usize) {
        let is_defined = prim.specifier().ok().flatten() == Some(Specifier::Def);
        if is_defined && prim.is_active().unwrap_or(false) {
            self.walk_any(prim, world_from_parent, depth);
        }
    }

    fn walk_any(&mut self, prim: &Prim, world_from_parent: DMat4, depth: usize) {
        let name = prim.path().name().unwrap_or_default().to_owned();
        self.prims += 1;
        if depth > DEPTH_MAX || self.prims > PRIMS_MAX {
            return self.report.note(Fate::Ignored, "prims, too many or too deep", "");
        }
        let token = |name: &str| text_of(&prim.attribute(name)).unwrap_or_default();
        let is_invisible = self.value::<String>(prim, "visibility").as_deref() == Some("invisible");
        if is_invisible || ["proxy", "guide"].contains(&&*token("purpose")) {
            return self.report.note(Fate::Used, "hidden prims, not shown", &name);
        }
        let placed = Placed(prim);
        let from_parent = match placed.resets_xform_stack() {
            Ok(true) => self.world_from_stage,
            _ => world_from_parent,
        };
        let local = placed.local_to_parent_transform(self.time);
        // The crate's vectors are rows.
        let world = from_parent * local.map_or(DMat4::IDENTITY, |local| DMat4::from_cols_array(&local.0));
        let (shape, mesh_from_unit) = shape(prim, self.time).unzip();
        match &*kind(prim) {
            kind if kind == "Mesh" || shape.is_some() => self.shown.push(Shown {
                prim: prim.clone(),
                shape,
                world_from_mesh: world * mesh_from_unit.unwrap_or_default(),
                object: self.prims,
            }),
            "PointInstancer" => return self.instances(prim, world, depth),
            "Camera" => {
                let camera = camera_at(&name, world, self.lens(prim));
                self.cameras.extend(camera);
            }
            "Skeleton" => self
                .report
                .note(Fate::Ignored, "skeletons: what they bend is at rest", &name),
            "GeomSubset" | "Material" | "Shader" | "NodeGraph" => return,
            light if light.ends_with("Light") => self.light(prim, light, &name, world),
            "" | "Xform" | "Scope" | "SkelRoot" => {}
            other => self
                .report
                .note(Fate::Ignored, format!("a prim of type {other}"), &name),
        }
        for child in prim.children().unwrap_or_default() {
            self.walk(&child, world, depth + 1);
        }
    }

    /// Prototypes at the places of a `PointInstancer`.
    fn instances(&mut self, prim: &Prim, world: DMat4, depth: usize) {
        let value = |name: &str| value_at(&prim.attribute(name), self.time);
        let numbers = |name: &str| match value(name) {
            Some(Value::IntVec(numbers)) => numbers,
            _ => Vec::new(),
        };
        let vectors = |name: &str| {
            value(name)
                .and_then(|value| value.get::<Vec<[f32; 3]>>())
                .unwrap_or_default()
        };
        let (indices, positions, scales) = (numbers("protoIndices"), vectors("positions"), vectors("scales"));
        let turns: Vec<DQuat> = match value("orientations") {
            Some(Value::QuathVec(turns)) => {
                let turn = |q: &openusd::gf::Quath| [q.x, q.y, q.z, q.w].map(|x| x.to_f32().into());
                turns.iter().map(|q| DQuat::from_array(turn(q))).collect()
            }
            Some(Value::QuatfVec(turns)) => {
                let turn = |q: &openusd::gf::Quatf| [q.x, q.y, q.z, q.w].map(f64::from);
                turns.iter().map(|q| DQuat::from_array(turn(q))).collect()
            }
            _ => Vec::new(),
        };
        let prototypes = prim.relationship("prototypes").targets().unwrap_or_default();
        let vector = |list: &[[f32; 3]], i: usize| list.get(i).map(|v| DVec3::from_array(v.map(f64::from)));
        for (i, index) in indices.iter().enumerate() {
            let Some(prototype) = prototypes.get(*index as usize) else {
                self.report.note(Fate::Missing, "a prototype of instances", "");
                continue;
            };
            let turn = turns.get(i).copied().filter(|turn| turn.length_squared() > 0.0);
            let place = DMat4::from_scale_rotation_translation(
                vector(&scales, i).unwrap_or(DVec3::ONE),
                turn.unwrap_or_default().normalize(),
                vector(&positions, i).unwrap_or_default(),
            );
            self.walk_any(&self.stage.prim(prototype.clone()), world * place, depth + 1);
        }
        self.report.count(Fate::Used, "instances", "", indices.len());
    }

    fn lens(&self, prim: &Prim) -> ModelLens {
        let aperture = self.number(prim, "verticalAperture", 15.2908);
        match text_of(&prim.attribute("projection")).as_deref() {
            // Tenths of a unit.
            Some("orthographic") => ModelLens::Orthographic(aperture / 10.0 * self.metres()),
            _ => ModelLens::Perspective(
                2.0 * (aperture / 2.0)
                    .atan2(self.number(prim, "focalLength", 50.0))
                    .to_degrees(),
            ),
        }
    }

    fn metres(&self) -> f64 {
        self.world_from_stage.x_axis.length()
    }

    /// Lights as points and spots of their intensity, candela, and suns of their irradiance.
    fn light(&mut self, prim: &Prim, light: &str, name: &str, world: DMat4) {
        let number = |name: &str, default| self.number(prim, &format!("inputs:{name}"), default);
        let is_normalized = self.value::<bool>(prim, "inputs:normalize") == Some(true);
        // Lengths across the surface, metres.
        let scale = world.transform_vector3(DVec3::X).length();
        let radius = number("radius", 0.5) * scale;
        let cone = self.value::<f64>(prim, "inputs:shaping:cone:angle");
        let cone = cone.map(|outer_deg| {
            let outer = outer_deg.clamp(0.0, 89.0).to_radians();
            [
                outer * (1.0 - number("shaping:cone:softness", 0.0).clamp(0.0, 1.0)),
                outer,
            ]
        });
        // The area that is seen of it from before it, and all of it.
        let (kind, seen, whole) = match light {
            "DistantLight" => {
                let half = (number("angle", 0.53) / 2.0).clamp(0.0, 90.0).to_radians();
                let solid_angle = PI * half.sin().powi(2);
                (LightKind::Directional, solid_angle, solid_angle)
            }
            "SphereLight" => {
                let disc = PI * radius * radius;
                (cone.map_or(LightKind::Point, LightKind::Spot), disc, 4.0 * disc)
            }
            "DiskLight" => {
                let disc = PI * radius * radius;
                (LightKind::Spot(cone.unwrap_or(HALF_SPACE)), disc, disc)
            }
            "RectLight" => {
                let area = number("width", 1.0) * number("height", 1.0) * scale * scale;
                (LightKind::Spot(cone.unwrap_or(HALF_SPACE)), area, area)
            }
            _ => return self.report.note(Fate::Ignored, format!("a {light}"), name),
        };
        if whole <= 0.0 {
            return self.report.note(Fate::Ignored, "a light without a size", name);
        }
        let strength = number("intensity", 1.0) * number("exposure", 0.0).exp2();
        let strength = strength * if is_normalized { seen / whole } else { seen };
        let color = self.value::<[f64; 3]>(prim, "inputs:color").unwrap_or([1.0; 3]);
        if light == "RectLight" || light == "DiskLight" {
            self.report
                .note(Fate::Approximated, "an area of light, as a spot", name);
        }
        let shining = (color.map(|x| x as f32), strength as f32);
        self.lights.extend(light_at((name, kind), world, DVec3::NEG_Z, shining));
    }
}
