//! Disk cache of converged reference renders, by scene.

use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use serde::{Deserialize, Serialize};

use super::{Machine, StudyError, UNLIMITED};
use crate::analysis::halves::Halves;
use crate::document::Document;
use crate::job::film::Image;
use crate::render::{Precision, Session};
use crate::scene::ModelSource;
use crate::scene::environment::EnvironmentSource;
use crate::store::replace::save_atomically;
use crate::study::technique::converged;

/// Cache format: increase if the format or the renders change within a version of the program.
const FORMAT: u32 = 1;
const ENDING: &str = "reference";
/// Default disk space of the cache, in bytes.
const LIMIT_BYTES: u64 = 512 << 20;
/// Names the folder instead of the user's own.
const FOLDER_VARIABLE: &str = "GLOSSMITH_CACHE";
/// Numbers of a pixel on disk: colour with opacity, and the two halves' luminances.
const PIXEL_NUMBERS: usize = 6;
/// Changes the random numbers of a reference: no technique's own are these.
const SEED: u32 = 0x5eed_0f0f;
/// Render time between two checks for a stop.
const STEP: Duration = Duration::from_millis(100);

/// A reference render of the requested precision.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// The mean image, linear.
    pub image: Image,
    /// Halves of its samples.
    pub halves: Halves,
    /// Estimated relative error.
    pub noise: f64,
    /// Render time in seconds.
    pub seconds: f64,
    /// Whether it came from the disk.
    pub is_kept: bool,
}

/// Requested precision of references.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Relative error to reach.
    pub noise: f64,
    /// Time limit in seconds.
    pub seconds: f64,
}

/// Folder of references; `None` for no cache.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceCache {
    folder: Option<PathBuf>,
    limit_bytes: u64,
}

impl ReferenceCache {
    /// Keeps nothing.
    pub fn none() -> Self {
        Self {
            folder: None,
            limit_bytes: 0,
        }
    }

    /// A cache in a folder, created if needed.
    pub fn at(folder: PathBuf) -> Self {
        Self {
            folder: Some(folder),
            limit_bytes: LIMIT_BYTES,
        }
    }

    /// A cache in the folder of `GLOSSMITH_CACHE`, else in the user's cache folder.
    pub fn of_user() -> Self {
        let named = std::env::var_os(FOLDER_VARIABLE).filter(|name| !name.is_empty());
        let of_system = || {
            Some(
                directories::ProjectDirs::from("", "", "glossmith")?
                    .cache_dir()
                    .to_owned(),
            )
        };
        match named.map(PathBuf::from).or_else(of_system) {
            Some(folder) => Self::at(folder.join("references")),
            None => Self::none(),
        }
    }

    /// The same with other disk space, bytes.
    pub fn with_limit(self, limit_bytes: u64) -> Self {
        Self { limit_bytes, ..self }
    }

    /// What a document converges to: kept, if it is exact enough or had the time that this one would have, else rendered by the session and kept. `on_progress` is
    /// asked now and then, with the share of the time that has gone by.
    ///
    /// # Errors
    /// What the session can't render, and [`StudyError::Stopped`]. A cache that can't be written is no error.
    pub fn reference(
        &self,
        session: &mut Session,
        document: &Document,
        precision: Precision,
        effort: Effort,
        on_progress: &mut dyn FnMut(f64) -> Result<(), StudyError>,
    ) -> Result<Reference, StudyError> {
        let key = Key::of(document, &Machine::of(session.engine()), precision);
        let path = self.folder.as_ref().map(|folder| folder.join(key.file_name()));
        if let Some(kept) = path.as_deref().and_then(|path| read(path, &key))
            && (kept.noise <= effort.noise || kept.seconds >= effort.seconds)
        {
            return Ok(kept);
        }
        let reference = render(session, document, precision, effort, on_progress)?;
        if let (Some(path), Some(folder)) = (&path, &self.folder) {
            match write(path, &key, &reference) {
                Ok(()) => shrink(folder, self.limit_bytes),
                Err(error) => log::debug!("a reference could not be kept: {error}"),
            }
        }
        Ok(reference)
    }
}

/// Cache key: everything that a reference depends on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Key {
    format: u32,
    version: String,
    engine: String,
    precision: String,
    document: serde_json::Value,
    /// Sizes and times of the files that the document names.
    files: Vec<Option<(u64, SystemTime)>>,
}

impl Key {
    fn of(document: &Document, machine: &Machine, precision: Precision) -> Self {
        let canonical = converged(document);
        let model = match &document.model {
            ModelSource::File(path) => Some(path),
            _ => None,
        };
        let environment = match &document.lighting.environment {
            EnvironmentSource::File(path) => Some(path),
            _ => None,
        };
        let stamp = |path: &Path| {
            let metadata = std::fs::metadata(path).ok()?;
            Some((metadata.len(), metadata.modified().ok()?))
        };
        Self {
            format: FORMAT,
            version: machine.version.to_owned(),
            engine: machine.engine.to_owned(),
            precision: format!("{precision:?}"),
            // A document is plain data: this does not fail.
            document: serde_json::to_value(&canonical).unwrap_or_default(),
            files: [model, environment]
                .into_iter()
                .flatten()
                .map(PathBuf::as_path)
                .chain(document.pictures())
                .map(stamp)
                .collect(),
        }
    }

    fn file_name(&self) -> String {
        let mut hasher = DefaultHasher::new();
        serde_json::to_string(self).unwrap_or_default().hash(&mut hasher);
        format!("{:016x}.{ENDING}", hasher.finish())
    }
}

/// Header of a file, one line of JSON; the pixels follow as little-endian f32.
#[derive(Serialize, Deserialize)]
struct Header {
    key: Key,
    width: u32,
    height: u32,
    noise: f64,
    seconds: f64,
}

fn write(path: &Path, key: &Key, reference: &Reference) -> Result<(), Box<dyn std::error::Error>> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let header = Header {
        key: key.clone(),
        width: reference.image.width,
        height: reference.image.height,
        noise: reference.noise,
        seconds: reference.seconds,
    };
    let mut bytes = serde_json::to_vec(&header)?;
    bytes.push(b'\n');
    let halves = std::iter::zip(&reference.halves.even, &reference.halves.odd);
    for (color, (even, odd)) in std::iter::zip(&reference.image.pixels, halves) {
        let numbers = color.iter().copied().chain([*even as f32, *odd as f32]);
        numbers.for_each(|x| bytes.extend(x.to_le_bytes()));
    }
    Ok(save_atomically(path, &bytes)?)
}

/// Reads a reference; `None` if there is none with this key.
fn read(path: &Path, key: &Key) -> Option<Reference> {
    let bytes = std::fs::read(path).ok()?;
    let end = bytes.iter().position(|byte| *byte == b'\n')?;
    let header: Header = serde_json::from_slice(&bytes[..end]).ok()?;
    let pixels = header.width as usize * header.height as usize;
    let body = &bytes[end + 1..];
    if header.key != *key || body.len() != pixels * PIXEL_NUMBERS * 4 || !header.noise.is_finite() {
        return None;
    }
    let number = |bytes: &[u8; 4]| f32::from_le_bytes(*bytes);
    let numbers: Vec<f32> = body.as_chunks::<4>().0.iter().map(number).collect();
    let numbers = numbers.as_chunks::<PIXEL_NUMBERS>().0;
    // Used last is thrown away last.
    let file = std::fs::File::options().append(true).open(path);
    if let Err(error) = file.and_then(|file| file.set_modified(SystemTime::now())) {
        log::debug!("{}: {error}", path.display());
    }
    Some(Reference {
        image: Image {
            width: header.width,
            height: header.height,
            pixels: numbers.iter().map(|[r, g, b, a, _, _]| [*r, *g, *b, *a]).collect(),
        },
        halves: Halves {
            even: numbers.iter().map(|of_pixel| f64::from(of_pixel[4])).collect(),
            odd: numbers.iter().map(|of_pixel| f64::from(of_pixel[5])).collect(),
        },
        noise: header.noise,
        seconds: header.seconds,
        is_kept: true,
    })
}

/// Throws the references away that were used the longest time ago, until the rest fits.
fn shrink(folder: &Path, limit_bytes: u64) {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let of_entry = |entry: std::fs::DirEntry| {
        let metadata = entry.metadata().ok()?;
        let is_reference = entry.path().extension().is_some_and(|ending| ending == ENDING);
        is_reference.then_some((metadata.modified().ok()?, metadata.len(), entry.path()))
    };
    let mut kept: Vec<_> = entries.filter_map(of_entry).collect();
    kept.sort();
    let mut total: u64 = kept.iter().map(|(_, bytes, _)| bytes).sum();
    for (_, bytes, path) in kept {
        if total <= limit_bytes {
            return;
        }
        match std::fs::remove_file(&path) {
            Ok(()) => total -= bytes,
            Err(error) => log::debug!("{}: {error}", path.display()),
        }
    }
}

fn render(
    session: &mut Session,
    document: &Document,
    precision: Precision,
    effort: Effort,
    on_progress: &mut dyn FnMut(f64) -> Result<(), StudyError>,
) -> Result<Reference, StudyError> {
    let mut document = converged(document);
    document.render.seed = SEED;
    document.render.samples = UNLIMITED;
    document.render.noise = Some(effort.noise);
    document.render.time_s = Some(effort.seconds);
    document.render.adaptive = Some(false);
    session.set_precision(precision);
    session.submit(&document)?;
    loop {
        let progress = session.step(STEP)?;
        on_progress((progress.render_seconds / effort.seconds).min(1.0))?;
        // Both halves of every pixel need some samples.
        if progress.is_done && progress.mean_samples >= 4.0 {
            break;
        }
        if progress.is_done {
            document.render.time_s = Some(2.0 * progress.render_seconds.max(effort.seconds));
            session.submit(&document)?;
        }
    }
    let progress = session.progress();
    let noise = progress.noise.map_or(f64::INFINITY, |noise| noise.relative);
    let film = session.film()?;
    let halves = Halves::of(film);
    let is_lit = halves.mean_luminance() > 1e-9;
    let reference = Reference {
        image: film.image(),
        halves,
        noise,
        seconds: progress.render_seconds,
        is_kept: false,
    };
    session.set_precision(Precision::Single);
    if is_lit { Ok(reference) } else { Err(StudyError::Black) }
}
