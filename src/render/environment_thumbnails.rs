//! Small pictures of environments, made beside the window and kept on disk.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::background::Background;
use super::picture_cache;
use crate::scene::environment::{Environment, EnvironmentError, EnvironmentSource, load, thumbnail};

/// Columns and rows of a thumbnail.
pub const SIZE: [u32; 2] = [256, 128];
/// Version of the thumbnails: raise it when the same environment is drawn differently.
const VERSION: u32 = 2;

/// An environment whose picture is wanted.
#[derive(Clone)]
pub struct Wanted {
    /// Where it comes from.
    pub source: EnvironmentSource,
    /// The environment where it has been loaded already: a large file is then not read twice.
    pub loaded: Option<Arc<Environment>>,
}

/// A picture: opaque red, green, blue and alpha of 8 bits, [`SIZE`] pixels from the top; `None` where the environment
/// can't be loaded.
pub type EnvironmentThumbnail = Option<Arc<Vec<u8>>>;
/// Thumbnails by what they show.
pub type EnvironmentThumbnails = Arc<HashMap<EnvironmentSource, EnvironmentThumbnail>>;
/// Makes the thumbnails of the latest request, in its order; each answer holds those made so far.
pub type EnvironmentThumbnailWorker = Background<Vec<Wanted>, EnvironmentThumbnails>;

/// Starts the worker; `folder` keeps the pictures from one start to the next. Nothing is made while `hold` is set: the
/// viewport goes first.
///
/// # Errors
/// If no thread can be started.
pub fn spawn_environment_thumbnails(
    folder: Option<PathBuf>,
    hold: Arc<AtomicBool>,
    repaint: impl Fn() + Send + 'static,
) -> io::Result<EnvironmentThumbnailWorker> {
    let mut made: HashMap<EnvironmentSource, (u64, EnvironmentThumbnail)> = HashMap::new();
    Background::spawn("environments", repaint, move |queue: Vec<Wanted>, desk| {
        for wanted in queue {
            if !desk.may_go_on(&hold) {
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
            // Reported where the environment is chosen.
            let picture = picture.unwrap_or_else(|error| {
                log::debug!("no small picture: {error}");
                None
            });
            made.insert(wanted.source, (key, picture.map(Arc::new)));
            let pictures = made
                .iter()
                .map(|(source, (_, picture))| (source.clone(), picture.clone()));
            desk.publish(Arc::new(pictures.collect()));
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

/// Changes with what a file holds, as far as its size and date tell.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn wanted(source: EnvironmentSource) -> Wanted {
        Wanted { source, loaded: None }
    }

    #[test]
    fn thumbnails_are_made_kept_and_missing_where_a_file_is() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let cache = folder.path().join("new");
        let missing = EnvironmentSource::File(folder.path().join("gone.hdr"));
        let worker = spawn_environment_thumbnails(Some(cache.clone()), Arc::default(), || {}).expect("a thread");
        worker.ask(vec![wanted(missing.clone()), wanted(EnvironmentSource::Furnace)]);
        let made = worker.wait_for(|made| made.len() >= 2);
        assert_eq!(made[&missing], None);
        let white = made[&EnvironmentSource::Furnace].clone().expect("it is computed");
        assert_eq!(white.len(), 4 * (SIZE[0] * SIZE[1]) as usize);
        assert!(
            white.chunks(4).all(|pixel| pixel == &white[..4]),
            "the same from everywhere"
        );
        // A marked file shows that the second start reads it.
        let marked = vec![77; white.len()];
        let path = cache.join(format!("{:016x}.png", key(&EnvironmentSource::Furnace)));
        picture_cache::write(&path, SIZE, &marked).expect("written");
        let again = spawn_environment_thumbnails(Some(cache), Arc::default(), || {}).expect("a thread");
        again.ask(vec![wanted(EnvironmentSource::Furnace)]);
        let kept = again.wait_for(|made| !made.is_empty())[&EnvironmentSource::Furnace]
            .clone()
            .expect("kept");
        assert_eq!(*kept, marked);
    }
}
