//! Thumbnails of environments, made in the background and cached on disk.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::background::Background;
use super::picture_cache;
use crate::import::environment::{EnvironmentError, load};
use crate::scene::environment::{Environment, EnvironmentSource, thumbnail};

/// Columns and rows of a thumbnail.
pub const SIZE: [u32; 2] = [256, 128];
/// Version of the thumbnails: raise it when the same environment is drawn differently.
const VERSION: u32 = 2;

/// A requested thumbnail.
#[derive(Clone)]
pub struct Wanted {
    /// Source of the environment.
    pub source: EnvironmentSource,
    /// The environment, if loaded already: avoids reading a large file twice.
    pub loaded: Option<Arc<Environment>>,
}

/// A thumbnail: opaque RGBA, 8 bits each, [`SIZE`] pixels, rows from the top; `None` if the environment cannot be loaded.
pub type EnvironmentThumbnail = Option<Arc<Vec<u8>>>;
pub type EnvironmentThumbnails = Arc<HashMap<EnvironmentSource, EnvironmentThumbnail>>;
/// Background worker for the latest request, in its order; each answer has all thumbnails made so far.
pub type EnvironmentThumbnailWorker = Background<Vec<Wanted>, EnvironmentThumbnails>;

/// Starts the worker; `folder` caches thumbnails between starts. It pauses while `hold` is set, for the viewport.
pub fn spawn_environment_thumbnails(
    folder: Option<PathBuf>,
    hold: Arc<AtomicBool>,
    repaint: impl Fn() + Send + 'static,
) -> io::Result<EnvironmentThumbnailWorker> {
    let mut made: HashMap<EnvironmentSource, (u64, EnvironmentThumbnail)> = HashMap::new();
    Background::spawn("environments", repaint, move |queue: Vec<Wanted>, responder| {
        for wanted in queue {
            if !responder.wait_while_held(&hold) {
                return;
            }
            let key = key(&wanted.source);
            if made.get(&wanted.source).is_some_and(|(of, _)| *of == key) {
                continue;
            }
            let picture = match &folder {
                Some(folder) => {
                    let path = folder.join(format!("{key:016x}.png"));
                    picture_cache::kept_or_made(&path, SIZE, || make(&wanted))
                }
                None => make(&wanted),
            };
            // The error is reported when the environment is selected.
            let picture = picture.unwrap_or_else(|error| {
                log::debug!("no thumbnail: {error}");
                None
            });
            made.insert(wanted.source, (key, picture.map(Arc::new)));
            let pictures = made
                .iter()
                .map(|(source, (_, picture))| (source.clone(), picture.clone()));
            responder.publish(Arc::new(pictures.collect()));
        }
    })
}

fn make(wanted: &Wanted) -> Result<Option<Vec<u8>>, EnvironmentError> {
    let pixels = |environment: &Environment| Some(thumbnail(environment, SIZE[0], SIZE[1]).concat());
    Ok(match &wanted.loaded {
        Some(environment) => pixels(environment),
        None => pixels(&load(&wanted.source)?),
    })
}

/// Cache key: changes with a file's size and date.
fn key(source: &EnvironmentSource) -> u64 {
    let mut hasher = DefaultHasher::new();
    (VERSION, env!("CARGO_PKG_VERSION"), source).hash(&mut hasher);
    if let EnvironmentSource::File(path) = source
        && let Ok(metadata) = std::fs::metadata(path)
    {
        (metadata.len(), metadata.modified().ok()).hash(&mut hasher);
    }
    hasher.finish()
}
