//! Map of the object and material slot at each pixel of the screen, made in the background: for outlines.

use std::sync::Arc;

use super::background::Responder;
use crate::{job::Job, optics::vector::Vec3, parallel, scene::NO_OBJECT};

/// Longest side of the map in pixels.
const SIDE_MAX_PX: u32 = 2048;
/// Marks background pixels.
pub const NOTHING: u32 = NO_OBJECT;
/// By how much the shapes of images of one view may differ.
const ASPECT_ROUNDING: f64 = 0.02;

/// Object and slot hit through each pixel's centre.
#[derive(Clone, Debug)]
pub struct SeenMap {
    pub job: Arc<Job>,
    pub width: u32,
    pub height: u32,
    /// Object and slot, or [`NOTHING`]; rows from the top.
    pub seen: Vec<[u32; 2]>,
}

/// Answers with the map of a job, of at most these columns and rows.
pub fn answer((job, size): (Arc<Job>, [u32; 2]), responder: &Responder<'_, Arc<SeenMap>>) {
    if let Some(map) = seen_map(&job, size, || responder.is_superseded()) {
        responder.publish(Arc::new(map));
    }
}

/// The map of a job in these columns and rows, at any size of its image; `None` if superseded.
pub fn seen_map(job: &Arc<Job>, [columns, rows]: [u32; 2], is_superseded: impl Fn() -> bool) -> Option<SeenMap> {
    let [width, height] = fitted([columns, rows], SIDE_MAX_PX);
    let geometry = &job.geometry;
    let seen = |_: [f64; 2], [origin, direction]: [Vec3<f32>; 2]| {
        let hit = geometry.intersect(origin.to_f32(), direction.to_f32(), f32::MAX);
        hit.map_or([NOTHING; 2], |hit| {
            let triangle = hit.triangle as usize;
            [geometry.object(triangle), geometry.slot(triangle)]
        })
    };
    Some(SeenMap {
        job: job.clone(),
        width,
        height,
        seen: job.settings.mapped([width, height], is_superseded, seen)?,
    })
}

/// An image's shape within a longest side.
pub fn fitted(size: [u32; 2], side_max: u32) -> [u32; 2] {
    let longest = size[0].max(size[1]).max(1);
    size.map(|side| (side * side_max.min(longest)).div_ceil(longest).max(1))
}

impl SeenMap {
    /// Whether it is what a job's camera sees, too: its image may have another size.
    pub fn is_of(&self, job: &Arc<Job>) -> bool {
        let is_seen_alike = || {
            let [own, other] = [&self.job, job].map(|job| (&job.settings.camera, job.settings.image_size));
            // Shapes differ by what rounding to whole pixels makes of them.
            let aspect = |[width, height]: [u32; 2]| f64::from(width) / f64::from(height.max(1));
            own.0 == other.0 && (aspect(own.1) / aspect(other.1) - 1.0).abs() < ASPECT_ROUNDING
        };
        Arc::ptr_eq(&self.job, job) || (Arc::ptr_eq(&self.job.geometry, &job.geometry) && is_seen_alike())
    }

    /// Pixels at the edges of the selection: those with neighbours of another kind.
    pub fn edges(&self, is_chosen: impl Fn([u32; 2]) -> bool + Sync) -> Vec<bool> {
        let (width, height) = (self.width as usize, self.height as usize);
        let chosen = parallel::map_each(&self.seen, |seen| is_chosen(*seen));
        let is_edge = |place: usize| {
            let (x, y) = (place % width, place / width);
            let at = |x: usize, y: usize| chosen[y * width + x];
            let is_inside = at(x, y);
            let beside = [
                x.checked_sub(1).map(|x| at(x, y)),
                (x + 1 < width).then(|| at(x + 1, y)),
                y.checked_sub(1).map(|y| at(x, y)),
                (y + 1 < height).then(|| at(x, y + 1)),
            ];
            beside.into_iter().flatten().any(|other| other != is_inside)
        };
        parallel::map(chosen.len(), is_edge)
    }
}
