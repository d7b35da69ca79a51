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
///
/// # Errors
///
/// If no thread can be started.
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

/// Renderer of thumbnails.
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

#[cfg(test)]
mod tests {
    use std::sync::atomic::Ordering;

    use super::*;
    use crate::store::material_by_name;

    fn mean(pixels: &[u8]) -> [f64; 3] {
        [0, 1, 2].map(|channel| {
            // The centre of the image: the sphere.
            let middle = (72..120).flat_map(|y| (72..120).map(move |x| 4 * (y * SIDE as usize + x) + channel));
            middle.map(|at| f64::from(pixels[at])).sum::<f64>() / 2304.0
        })
    }

    #[test]
    fn thumbnails_show_their_materials_and_are_kept() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let cache = folder.path().join("new");
        let [gold, rubber] = ["gold", "rubber"].map(|name| material_by_name(name).expect("shipped").clone());
        let worker = spawn_thumbnails(cache.clone(), Arc::default(), || {}).expect("a thread");
        worker.ask(vec![gold.clone(), rubber.clone()]);
        let made = worker.wait_for(|made| made.len() >= 2);
        let (yellow, dark) = (mean(&made[&key(&gold)]), mean(&made[&key(&rubber)]));
        assert!(yellow[0] > 1.2 * yellow[2], "gold is yellow: {yellow:?}");
        assert!(dark[0] < 0.6 * yellow[0], "rubber is dark: {dark:?}");
        assert_eq!(std::fs::read_dir(&cache).expect("made").count(), 2);
        // A marked file shows that the second start reads it.
        let marked = vec![77; 4 * (SIDE * SIDE) as usize];
        let path = cache.join(format!("{:016x}.png", key(&gold)));
        picture_cache::write(&path, [SIDE; 2], &marked).expect("written");
        let again = spawn_thumbnails(cache, Arc::default(), || {}).expect("a thread");
        again.ask(vec![gold.clone()]);
        assert_eq!(*again.wait_for(|made| !made.is_empty())[&key(&gold)], marked);
    }

    #[test]
    fn nothing_is_made_while_it_is_held() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let hold = Arc::new(AtomicBool::new(true));
        let worker = spawn_thumbnails(folder.path().to_owned(), hold.clone(), || {}).expect("a thread");
        worker.ask(vec![material_by_name("gold").expect("shipped").clone()]);
        std::thread::sleep(Duration::from_millis(300));
        assert!(worker.latest().is_none(), "held");
        hold.store(false, Ordering::Relaxed);
        worker.wait_for(|made| !made.is_empty());
    }

    #[test]
    fn the_key_follows_the_look_and_not_the_name() {
        let gold = material_by_name("gold").expect("shipped").clone();
        let mut other = gold.clone();
        other.name = "Or".to_owned();
        assert_eq!(key(&gold), key(&other));
        other.roughness += 0.01;
        assert_ne!(key(&gold), key(&other));
    }
}
