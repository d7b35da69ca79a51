//! Thumbnails of materials and environments, made in the background and cached on disk.

use std::{
    collections::HashMap,
    hash::{DefaultHasher, Hash as _, Hasher as _},
    path::{Path, PathBuf},
    sync::{Arc, atomic::AtomicBool},
    time::Duration,
};

use image::RgbaImage;

use super::{
    EngineChoice, Session, SessionError,
    background::Responder,
    display::display,
    looks::{ball, denoise_if_possible},
    step_denoiser::StepDenoiser,
};
use crate::{
    document::{Document, MaterialSettings},
    import::environment::load,
    scene::ModelSource,
    scene::environment::{Environment, EnvironmentSource, thumbnail},
    store::{picture::png_bytes, picture::png_image, preset::material_text, replace::save_atomically},
};

/// Columns and rows of a material's thumbnail.
const SIDE: u32 = 192;
/// Columns and rows of an environment's.
const ENVIRONMENT_SIZE: [u32; 2] = [256, 128];
/// Samples per pixel: the noise is invisible at this size, and removed if denoised.
const SAMPLES: u32 = 24;
/// Render time between two checks for a newer request.
const STEP: Duration = Duration::from_millis(30);
/// Cache version: increase if thumbnails of the same thing change.
const VERSION: u32 = 5;

/// What a thumbnail is made of.
#[derive(Clone, Debug, PartialEq)]
pub enum Subject {
    Material(Box<MaterialSettings>),
    Environment(EnvironmentSource),
}

/// The thumbnails that are wanted, in their order, each with what it is to be called.
pub struct Wanted {
    pub subjects: Vec<(String, Subject)>,
    /// An environment that is loaded already: a large file is not read twice.
    pub loaded: Option<(EnvironmentSource, Arc<Environment>)>,
}

/// Alpha is not premultiplied; `None` if none can be made.
pub type Thumbnail = Option<Arc<RgbaImage>>;
/// Those made so far, by what they are called.
pub type Thumbnails = Arc<HashMap<String, Thumbnail>>;

/// Cache key, equal for materials of equal appearance.
pub fn key(material: &MaterialSettings) -> u64 {
    let nameless = MaterialSettings {
        name: String::new(),
        ..material.clone()
    };
    hash(material_text(Path::new(""), &nameless))
}

fn hash(of: impl std::hash::Hash) -> u64 {
    let mut hasher = DefaultHasher::new();
    (VERSION, env!("CARGO_PKG_VERSION"), of).hash(&mut hasher);
    hasher.finish()
}

impl Subject {
    /// Folder in the cache, and key: an environment's changes with its file's size and date.
    fn place(&self) -> (&'static str, u64) {
        match self {
            Self::Material(material) => ("thumbnails", key(material)),
            Self::Environment(source) => {
                let metadata = match source {
                    EnvironmentSource::File(path) => std::fs::metadata(path).ok(),
                    _ => None,
                };
                let state = metadata.map(|metadata| (metadata.len(), metadata.modified().ok()));
                ("environments", hash((source, state)))
            }
        }
    }
}

/// The work that makes what was wanted last; `cache`, created if needed, keeps thumbnails between starts. It pauses while
/// `hold` is set, for the viewport.
#[expect(clippy::map_entry, reason = "a picture that fails is not entered")]
pub fn makes(
    cache: Option<PathBuf>,
    hold: Arc<AtomicBool>,
) -> impl FnMut(Wanted, &Responder<'_, Thumbnails>) + Send + 'static {
    let mut studio: Option<Studio> = None;
    let mut made: HashMap<u64, Thumbnail> = HashMap::new();
    move |wanted, responder| {
        let mut found = HashMap::new();
        for (name, subject) in &wanted.subjects {
            let (folder, key) = subject.place();
            if !made.contains_key(&key) {
                let file = cache
                    .as_ref()
                    .map(|cache| cache.join(folder).join(format!("{key:016x}.png")));
                let mut picture = file.as_deref().and_then(read);
                if picture.is_none() {
                    if !responder.wait_while_held(&hold) {
                        return;
                    }
                    picture = match subject {
                        Subject::Material(material) => match rendered(&mut studio, material, &hold, responder) {
                            Ok(None) => return,
                            rendered => rendered.map_err(crate::in_words),
                        },
                        Subject::Environment(source) => match &wanted.loaded {
                            Some((of, environment)) if of == source => Ok(small(environment)),
                            _ => load(source)
                                .map(|environment| small(&environment))
                                .map_err(crate::in_words),
                        },
                    }
                    // Reported when it is used.
                    .unwrap_or_else(|error| {
                        log::debug!("no thumbnail of {name}: {error}");
                        None
                    });
                    if let (Some(file), Some(picture)) = (file, &picture)
                        && let Err(error) = write(&file, picture)
                    {
                        // The next start makes it again.
                        log::debug!("{error}");
                    }
                }
                made.insert(key, picture.map(Arc::new));
            }
            found.insert(name.clone(), made.get(&key).cloned().flatten());
            responder.publish(Arc::new(found.clone()));
        }
    }
}

fn read(path: &Path) -> Option<RgbaImage> {
    png_image(&std::fs::read(path).ok()?).ok()
}

fn write(path: &Path, picture: &RgbaImage) -> Result<(), String> {
    let bytes = png_bytes(picture.dimensions().into(), picture, None)?;
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    save_atomically(path, &bytes).map_err(crate::in_words)
}

fn small(environment: &Environment) -> Option<RgbaImage> {
    let [width, height] = ENVIRONMENT_SIZE;
    RgbaImage::from_raw(width, height, thumbnail(environment, width, height).concat())
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
fn rendered(
    studio: &mut Option<Studio>,
    material: &MaterialSettings,
    hold: &AtomicBool,
    responder: &Responder<'_, Thumbnails>,
) -> Result<Option<RgbaImage>, SessionError> {
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
    let image = match step_denoiser.finish(session)? {
        Some(denoised) => denoised.image,
        None => Arc::new(session.image()?),
    };
    Ok(RgbaImage::from_raw(SIDE, SIDE, display(&image, &document.view)))
}
