//! The account of one path: everything that made one sample of one pixel, in words and as JSON.
//!
//! The path is traced by the CPU engine's own integrator with a recorder attached: there is no second integrator.

use serde::Serialize;

use crate::{
    compile::slot_materials,
    cpu::{integrator::is_sound, oracle::PathTracer, recorder::Event, recorder::LightSource},
    document::Document,
    document::Strategy,
    job::Job,
    optics::random::Sequence,
    scene::Geometry,
    scene::Model,
};

mod words;

/// Everything that made one sample of one pixel. Lengths and places are in the model's units; colours are linear RGB.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PathAccount {
    /// Column and row from the top left.
    pub pixel: [u32; 2],
    /// Width and height of the image, in pixels.
    pub image_size: [u32; 2],
    /// Number of the sample in its pixel, from 0.
    pub sample: u32,
    /// Seed of the render.
    pub seed: u32,
    pub sequence: Sequence,
    pub strategy: Strategy,
    /// Bounces that a path may have.
    pub bounces: u32,
    /// Names of the slots, for the events' `slot`.
    pub surfaces: Vec<String>,
    /// Events in order.
    pub events: Vec<Event>,
    /// Radiance of the sample: to the bit the sum of the contributions in their order.
    pub radiance: [f32; 3],
    /// Coverage in [0, 1]: 0 if the path saw only transparent background.
    pub alpha: f32,
    /// Number of rays traced.
    pub rays: u32,
    /// Luminance that limiting fireflies took.
    pub clamped: f32,
    /// True if the radiance is not finite or is negative: such samples are dropped.
    pub is_dropped: bool,
}

/// The account of one sample of a pixel, for a job compiled from a document with this model.
pub fn explain(document: &Document, model: &Model, job: &Job, pixel: [u32; 2], sample: u32) -> PathAccount {
    let mut events = Vec::new();
    let path = PathTracer::new(job).record(pixel, sample, &mut events);
    events.iter_mut().for_each(|event| to_model_units(event, &job.geometry));
    let settings = &job.settings;
    PathAccount {
        pixel,
        image_size: settings.image_size,
        sample,
        seed: settings.seed,
        sequence: settings.sequence,
        strategy: settings.strategy,
        bounces: settings.bounces,
        surfaces: surfaces(document, model),
        events,
        radiance: path.radiance.to_f32(),
        alpha: path.alpha,
        rays: path.rays,
        clamped: path.clamped,
        is_dropped: !is_sound(path.radiance),
    }
}

impl PathAccount {
    /// Contributions to the sample, in order.
    pub fn contributions(&self) -> impl Iterator<Item = (LightSource, [f32; 3])> + '_ {
        self.events.iter().filter_map(|event| match event {
            Event::Contribution { source, added, .. } => Some((*source, *added)),
            _ => None,
        })
    }

    /// The sum of the contributions in their order.
    pub fn sum(&self) -> [f32; 3] {
        let mut sum = [0.0; 3];
        for (_, added) in self.contributions() {
            for (sum, added) in sum.iter_mut().zip(added) {
                *sum += added;
            }
        }
        sum
    }
}

/// Names of a job's slots: the model's, then the ground and the area lights.
fn surfaces(document: &Document, model: &Model) -> Vec<String> {
    let materials = slot_materials(document, model.slots.len());
    let lights = (1..).zip(&document.lighting.area_lights);
    let shining: Vec<u32> = lights
        .filter(|(_, light)| !light.is_muted)
        .map(|(number, _)| number)
        .collect();
    let name = |(slot, material): (usize, &crate::document::MaterialSettings)| match model.slots.get(slot) {
        Some(of_model) => format!("slot {slot} ({}), material {}", of_model.name, material.name),
        None if slot + shining.len() < materials.len() => "the ground".to_owned(),
        None => format!("area light {}", shining[slot + shining.len() - materials.len()]),
    };
    materials.iter().enumerate().map(name).collect()
}

/// Converts lengths and positions from the geometry's units to the model's.
fn to_model_units(event: &mut Event, geometry: &Geometry) {
    let place = |place: &mut [f32; 3]| {
        let center = geometry.center_world.to_array();
        *place = [0, 1, 2].map(|i| (center[i] + geometry.world_units_per_unit * f64::from(place[i])) as f32);
    };
    let length = |length: &mut f32| *length = (geometry.world_units_per_unit * f64::from(*length)) as f32;
    match event {
        Event::Camera { origin, .. } => place(origin),
        Event::Passed { distance, .. } | Event::Absorption { distance, .. } => length(distance),
        Event::Hit { distance, position, .. } => {
            length(distance);
            place(position);
        }
        _ => {}
    }
}
