//! The map of numerical trouble, made in the background.

use std::{io, sync::Arc};

use super::{background::Background, seen_map::fitted};
use crate::cpu::precision::precision;
use crate::job::{Job, precision::PrecisionMap};

/// Longest side of the map in pixels.
const SIDE_MAX_PX: u32 = 320;

/// Makes maps of jobs; the latest job wins.
pub type PrecisionMaps = Background<Arc<Job>, Arc<PrecisionMap>>;

/// Starts the thread that makes maps; `repaint` is called when one is finished.
pub fn spawn(repaint: impl Fn() + Send + 'static) -> io::Result<PrecisionMaps> {
    Background::spawn("precision", repaint, |job: Arc<Job>, responder| {
        if let Some(map) = precision(&job, fitted(job.settings.image_size, SIDE_MAX_PX), || {
            responder.is_superseded()
        }) {
            responder.publish(Arc::new(map));
        }
    })
}
