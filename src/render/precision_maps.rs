//! The map of numerical trouble, made in the background.

use std::io;
use std::sync::Arc;

use super::background::Background;
use crate::cpu::precision::precision;
use crate::job::Job;
use crate::job::precision::PrecisionMap;

/// Longest side of the map in pixels.
const SIDE_MAX_PX: u32 = 320;

/// Makes maps of jobs; the latest job wins.
pub type PrecisionMaps = Background<Arc<Job>, Arc<PrecisionMap>>;

/// Starts the thread that makes maps; `repaint` is called when one is finished.
pub fn spawn(repaint: impl Fn() + Send + 'static) -> io::Result<PrecisionMaps> {
    Background::spawn("precision", repaint, |job: Arc<Job>, responder| {
        if let Some(map) = precision(&job, map_size(job.settings.image_size), || responder.is_superseded()) {
            responder.publish(Arc::new(map));
        }
    })
}

/// Size of the map: the image's aspect within [`SIDE_MAX_PX`].
fn map_size([width, height]: [u32; 2]) -> [u32; 2] {
    let longest = width.max(height).max(1);
    let kept = SIDE_MAX_PX.min(longest);
    [width, height].map(|side| (side * kept).div_ceil(longest).max(1))
}
