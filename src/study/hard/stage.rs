//! What hard cases are run on.

use std::{
    fs,
    path::PathBuf,
    sync::Arc,
    sync::atomic::{AtomicBool, Ordering},
};

use tempfile::TempDir;

use crate::{
    document::{Document, effect::EffectSwitches},
    import::environment,
    job::film::{Film, Image},
    render::{EngineChoice, EngineInfo, Prober, Session, SessionError, output, output::Rendered},
    scene::environment::{Environment, EnvironmentSource},
    study::{StudyError, check::STEP},
};

/// An engine, and a folder that goes with it.
pub struct Stage {
    /// More samples and rays.
    pub thorough: bool,
    /// Single functions of the engine.
    pub prober: Prober,
    choice: EngineChoice,
    pub session: Session,
    folder: TempDir,
    /// The last rendered image.
    pub picture: Option<Image>,
    pub stop: Arc<AtomicBool>,
}

impl Stage {
    /// Opens an engine. If that is the CPU engine, single functions run on the CPU, too. Cases end as soon as `stop` is
    /// set.
    pub fn open(choice: EngineChoice, thorough: bool, stop: Arc<AtomicBool>) -> Result<Self, StudyError> {
        let session = Session::open(choice)?;
        let choice = session.engine().kind.into();
        let (prober, folder) = (Prober::open(choice)?, TempDir::new()?);
        Ok(Self {
            thorough,
            prober,
            choice,
            session,
            folder,
            picture: None,
            stop,
        })
    }

    pub fn check_stop(&self) -> Result<(), StudyError> {
        match self.stop.load(Ordering::Relaxed) {
            true => Err(StudyError::Stopped),
            false => Ok(()),
        }
    }

    pub fn engine(&self) -> &EngineInfo {
        self.session.engine()
    }

    /// Renders a document to its end.
    pub fn film(&mut self, document: &Document) -> Result<Film, StudyError> {
        let mut document = document.clone();
        if self.choice == EngineChoice::Gpu {
            // One kernel for all renders: compiling one each would take longer than rendering.
            document.render.effects = EffectSwitches::all_on();
        }
        self.check_stop()?;
        self.session.reset();
        self.session.submit(&document)?;
        while !self.session.step(STEP)?.is_done {
            self.check_stop()?;
        }
        let film = self.session.film()?.clone();
        self.picture = Some(film.image());
        Ok(film)
    }

    /// Writes a file for a case.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<PathBuf, StudyError> {
        let path = self.folder.path().join(name);
        fs::write(&path, bytes)?;
        Ok(path)
    }

    /// A latitude-longitude map of linear radiances, written as .exr in f32 and to be read again.
    pub fn environment(
        &self,
        name: &str,
        [width, height]: [u32; 2],
        radiance: impl Fn(u32, u32) -> [f32; 3],
    ) -> Result<EnvironmentSource, StudyError> {
        let pixels = (0..width * height).map(|i| {
            let [red, green, blue] = radiance(i % width, i / width);
            [red, green, blue, 1.0]
        });
        let image = Image {
            width,
            height,
            pixels: pixels.collect(),
        };
        let path = self.folder.path().join(name);
        output::write(&path, Rendered::from(&image), &Document::default())?;
        Ok(EnvironmentSource::File(path))
    }

    /// The map of a source, loaded as the engines load it.
    pub fn load_environment(&self, source: &EnvironmentSource) -> Result<Environment, StudyError> {
        Ok(environment::load(source).map_err(|error| SessionError::Asset(error.into()))?)
    }
}

/// How far the worst pixel is from what all pixels should be, relative to it, and how many samples were dropped.
pub fn worst_pixel(film: &Film, color: [f32; 3]) -> f64 {
    let off = |pixel: &[f32; 4]| [0, 1, 2].map(|i| f64::from((pixel[i] / color[i] - 1.0).abs()));
    film.image().pixels.iter().flat_map(off).fold(0.0, f64::max) + film.dropped() as f64
}

pub fn mean_luminance(film: &Film) -> f64 {
    film.luminance().iter().sum::<f64>() / film.pixel_count() as f64
}
