//! Test bench of the cases: an engine for renders and single functions, and a folder for files.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::time::Duration;
use std::{fs, io};

use crate::document::effect::EffectSwitches;
use crate::document::{Document, PixelFilter};
use crate::gpu::GpuError;
use crate::import::environment;
use crate::job::film::{Film, Image};
use crate::optics::random::Sequence;
use crate::render::output::{self, OutputError, Rendered};
use crate::render::{EngineChoice, EngineInfo, Session, SessionError};
use crate::scene::ModelSource;
use crate::scene::environment::{Environment, EnvironmentSource};
use crate::study::probe::Prober;

/// Time between two checks for a stop.
pub(super) const SLICE: Duration = Duration::from_millis(100);

/// Why a case can't be run.
#[derive(Debug, thiserror::Error)]
pub enum HardError {
    /// Error of the engine or its input.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// An image for a case could not be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A file or folder for a case could not be written.
    #[error("{}: cannot be written: {source}; make room in the system's temporary folder", path.display())]
    Folder { path: PathBuf, source: io::Error },
    /// The run was stopped.
    #[error("stopped")]
    Stopped,
}

impl From<GpuError> for HardError {
    fn from(error: GpuError) -> Self {
        Self::Session(error.into())
    }
}

/// An engine, and a folder that goes with it.
pub struct Stage {
    /// More samples and rays.
    pub thorough: bool,
    /// Single functions of the engine.
    pub prober: Prober,
    /// The engine's choice, for clouds of samples.
    pub choice: EngineChoice,
    session: Session,
    folder: Folder,
    /// The last rendered image.
    picture: Option<Image>,
    stop: Arc<AtomicBool>,
}

impl Stage {
    /// Opens an engine. If that is the CPU engine, single functions run on the CPU, too.
    pub fn open(choice: EngineChoice, thorough: bool) -> Result<Self, HardError> {
        let session = Session::open(choice)?;
        let choice = session.engine().kind.into();
        Ok(Self {
            thorough,
            prober: Prober::open(choice)?,
            choice,
            session,
            folder: Folder::new()?,
            picture: None,
            stop: Arc::default(),
        })
    }

    /// The same stage, whose cases end as soon as `stop` is set.
    #[must_use]
    pub fn until(self, stop: Arc<AtomicBool>) -> Self {
        Self { stop, ..self }
    }

    /// Checks for a stop; call it within long work.
    pub fn check_stop(&self) -> Result<(), HardError> {
        match self.stop.load(Ordering::Relaxed) {
            true => Err(HardError::Stopped),
            false => Ok(()),
        }
    }

    /// The stop flag, for other threads.
    pub(super) fn stop(&self) -> &AtomicBool {
        &self.stop
    }

    /// Takes the last rendered image.
    pub fn take_picture(&mut self) -> Option<Image> {
        self.picture.take()
    }

    /// The engine that runs the cases.
    pub fn engine(&self) -> &EngineInfo {
        self.session.engine()
    }

    /// The session, for details beyond the film.
    pub fn session(&mut self) -> &mut Session {
        &mut self.session
    }

    /// Renders a document to its end.
    pub fn film(&mut self, document: &Document) -> Result<Film, HardError> {
        let mut document = document.clone();
        if self.choice == EngineChoice::Gpu {
            // One kernel for all renders: compiling one each would take longer than rendering.
            document.render.effects = EffectSwitches::all_on();
        }
        self.check_stop()?;
        self.session.reset();
        self.session.submit(&document)?;
        while !self.session.step(SLICE)?.is_done {
            self.check_stop()?;
        }
        let film = self.session.film()?.clone();
        self.picture = Some(film.image());
        Ok(film)
    }

    /// Path of a case's file.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.0.join(name)
    }

    /// Writes a file for a case.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<PathBuf, HardError> {
        let path = self.path(name);
        match fs::write(&path, bytes) {
            Ok(()) => Ok(path),
            Err(source) => Err(HardError::Folder { path, source }),
        }
    }

    /// A latitude-longitude map of linear radiances, written as .exr in f32 and to be read again.
    pub fn environment(
        &self,
        name: &str,
        [width, height]: [u32; 2],
        radiance: impl Fn(u32, u32) -> [f32; 3],
    ) -> Result<EnvironmentSource, HardError> {
        let pixels = (0..width * height).map(|i| {
            let [red, green, blue] = radiance(i % width, i / width);
            [red, green, blue, 1.0]
        });
        let image = Image {
            width,
            height,
            pixels: pixels.collect(),
        };
        let path = self.path(name);
        output::write(&path, Rendered::from(&image), &Document::default())?;
        Ok(EnvironmentSource::File(path))
    }

    /// The map of a source, loaded as the engines load it.
    pub fn load_environment(&self, source: &EnvironmentSource) -> Result<Environment, HardError> {
        Ok(environment::load(source).map_err(|error| SessionError::Asset(error.into()))?)
    }
}

/// A small document with honest variances: box filter, independent samples.
pub fn document(model: ModelSource, light: EnvironmentSource, side: u32, samples: u32) -> Document {
    let mut document = Document {
        model,
        ..Document::default()
    };
    document.lighting.environment = light;
    (document.render.width, document.render.height) = (side, side);
    document.render.samples = samples;
    document.render.filter = PixelFilter::Box;
    document.render.sequence = Sequence::Independent;
    document
}

/// A folder that is removed with this value.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Result<Self, HardError> {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("glossmith-hard-{}-{number}", std::process::id()));
        match fs::create_dir_all(&path) {
            Ok(()) => Ok(Self(path)),
            Err(source) => Err(HardError::Folder { path, source }),
        }
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // Leftovers in the temporary folder are harmless.
        let _ = fs::remove_dir_all(&self.0);
    }
}
