//! Thumbnails of materials, rendered in the background and cached on disk.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use super::background::{Background, Responder};
use super::display::display;
use super::looks::{ball, denoise_if_possible};
use super::step_denoiser::StepDenoiser;
use super::{EngineChoice, Session, SessionError, picture_cache};
use crate::document::{Document, MaterialSettings};
use crate::scene::ModelSource;
use crate::store::preset::material_text;

/// Columns and rows of a thumbnail.
pub const SIDE: u32 = 192;
/// Samples per pixel: the noise is invisible at this size, and removed if denoised.
const SAMPLES: u32 = 24;
/// Render time between two checks for a newer request.
const STEP: Duration = Duration::from_millis(30);
/// Cache version: increase if thumbnails of the same material change.
const VERSION: u32 = 5;

/// A thumbnail: RGBA, 8 bits each, alpha not premultiplied; [`SIDE`] × [`SIDE`] pixels, rows from the top.
pub type Thumbnail = Arc<Vec<u8>>;
/// Thumbnails by [`key`].
pub type Thumbnails = Arc<HashMap<u64, Thumbnail>>;
/// Renders the thumbnails of the materials that it was asked for last, in their order; answers grow.
pub type ThumbnailWorker = Background<Vec<MaterialSettings>, Thumbnails>;

/// Cache key, equal for materials of equal appearance.
pub fn key(material: &MaterialSettings) -> u64 {
    let nameless = MaterialSettings {
        name: String::new(),
        ..material.clone()
    };
    let mut hasher = DefaultHasher::new();
    (
        VERSION,
        env!("CARGO_PKG_VERSION"),
        material_text(Path::new(""), &nameless),
    )
        .hash(&mut hasher);
    hasher.finish()
}

/// Starts the worker; `folder`, created if needed, caches thumbnails between starts. It pauses while `hold` is set, for the
/// viewport.
pub fn spawn_thumbnails(
    folder: PathBuf,
    hold: Arc<AtomicBool>,
    repaint: impl Fn() + Send + 'static,
) -> io::Result<ThumbnailWorker> {
    let mut studio: Option<Studio> = None;
    let mut made: HashMap<u64, Thumbnail> = HashMap::new();
    Background::spawn("thumbnails", repaint, move |materials, responder| {
        for material in materials {
            let key = key(&material);
            if made.contains_key(&key) {
                continue;
            }
            let path = folder.join(format!("{key:016x}.png"));
            let picture =
                picture_cache::kept_or_made(&path, [SIDE; 2], || make(&mut studio, &material, &hold, responder));
            match picture {
                Ok(Some(pixels)) => {
                    made.insert(key, Arc::new(pixels));
                    responder.publish(Arc::new(made.clone()));
                }
                Ok(None) => return,
                Err(error) => log::warn!("no thumbnail of {}: {error}", material.name),
            }
        }
    })
}

/// The document of a thumbnail.
fn document(material: &MaterialSettings) -> Document {
    let mut document = ball(material, SIDE, SAMPLES, denoise_if_possible());
    if material.emission_strength > 0.0 {
        // In the light of a studio nothing would be seen of its own.
        document.ground = true;
        document.lighting.strength = 0.05;
        document.camera.pitch_deg = 15.0;
    } else if material.transmission_weight > 0.0 {
        // Thick and thin, with edges behind which something is seen.
        document.model = ModelSource::default();
        document.camera.pitch_deg = 20.0;
    }
    document
}

struct Studio {
    session: Session,
    step_denoiser: StepDenoiser,
}

/// `None` if superseded.
fn make<A>(
    studio: &mut Option<Studio>,
    material: &MaterialSettings,
    hold: &AtomicBool,
    responder: &Responder<'_, Vec<MaterialSettings>, A>,
) -> Result<Option<Vec<u8>>, SessionError> {
    if !responder.wait_while_held(hold) {
        return Ok(None);
    }
    let document = document(material);
    let Studio { session, step_denoiser } = match studio {
        Some(studio) => studio,
        None => studio.insert(Studio {
            session: Session::open(EngineChoice::Cpu)?,
            step_denoiser: StepDenoiser::new(&document),
        }),
    };
    session.submit(&document)?;
    while !session.step(STEP)?.is_done {
        if !responder.wait_while_held(hold) {
            return Ok(None);
        }
    }
    let denoised = step_denoiser.finish(session)?;
    let image = match denoised {
        Some(denoised) => denoised.image,
        None => Arc::new(session.image()?),
    };
    Ok(Some(display(&image, &document.view)))
}
