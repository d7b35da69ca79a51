//! The map of numerical trouble, made in the background.

use std::sync::Arc;

use super::{background::Responder, seen_map::fitted};
use crate::{cpu::precision::precision, job::Job, job::precision::PrecisionMap};

/// Longest side of the map in pixels.
const SIDE_MAX_PX: u32 = 320;

/// Answers with the map of a job.
pub fn answer(job: Arc<Job>, responder: &Responder<'_, Arc<PrecisionMap>>) {
    let size = fitted(job.settings.image_size, SIDE_MAX_PX);
    if let Some(map) = precision(&job, size, || responder.is_superseded()) {
        responder.publish(Arc::new(map));
    }
}
