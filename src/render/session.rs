//! A document being rendered.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::assets::Assets;
use super::compile::Compiler;
use super::engine::{Engine, EngineChoice, EngineInfo, cpu};
use super::output::Layers;
use crate::analysis::film::{Film, Image};
use crate::document::Document;
use crate::document::change::Change;
use crate::document::job::Job;
use crate::gpu::GpuError;
use crate::scene::ModelError;
use crate::scene::environment::EnvironmentError;

/// Samples of a pixel over which albedo, normal and depth are averaged.
const FEATURE_SAMPLES: u32 = 32;

/// What a session can't do.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The model can't be had.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The environment can't be had.
    #[error(transparent)]
    Environment(#[from] EnvironmentError),
    /// The GPU can't be used.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// How far a render has come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Completed samples a pixel.
    pub samples_per_pixel: u32,
    /// Samples a pixel to reach.
    pub samples_wanted: u32,
    /// The engine's own time on this picture, seconds.
    pub render_seconds: f64,
    /// All that was asked for has been done.
    pub is_done: bool,
}

impl Progress {
    /// Pixel samples a second, over the whole render.
    pub fn samples_per_second(&self, pixels: u64) -> f64 {
        f64::from(self.samples_per_pixel) * pixels as f64 / self.render_seconds.max(1e-9)
    }
}

/// A document, what it needs, and the engine that renders it.
pub struct Session {
    engine: Engine,
    info: EngineInfo,
    assets: Assets,
    compiler: Compiler,
    document: Option<Document>,
    job: Option<Arc<Job>>,
    render_time: Duration,
}

impl Session {
    /// Opens an engine.
    ///
    /// # Errors
    /// [`GpuError`] where a GPU was asked for and there is none that works; `auto` and `cpu` always work.
    pub fn open(choice: EngineChoice) -> Result<Self, SessionError> {
        Self::open_with(choice, Assets::default())
    }

    /// The same with models and environments that it may share with other sessions.
    ///
    /// # Errors
    /// As [`Session::open`].
    pub fn open_with(choice: EngineChoice, assets: Assets) -> Result<Self, SessionError> {
        let (engine, info) = Engine::open(choice)?;
        Ok(Self {
            engine,
            info,
            assets,
            compiler: Compiler::default(),
            document: None,
            job: None,
            render_time: Duration::ZERO,
        })
    }

    /// What renders.
    pub fn engine(&self) -> &EngineInfo {
        &self.info
    }

    /// Models and environments, loaded and kept.
    pub fn assets(&self) -> &Assets {
        &self.assets
    }

    /// Forgets what was rendered, so that the next submission starts over even with the same document.
    pub fn forget(&mut self) {
        self.document = None;
    }

    /// Forgets files, too, so that they are read again.
    pub fn reload(&mut self) {
        self.assets.reload();
        self.forget();
    }

    /// The numbers being rendered.
    pub fn job(&self) -> Option<&Arc<Job>> {
        self.job.as_ref()
    }

    /// Takes a document to render: loads what it names and starts over, unless nothing changed but how the picture is
    /// shown. After an error the old document goes on.
    ///
    /// # Errors
    /// A model or environment that can't be loaded, or what the GPU can't hold.
    pub fn submit(&mut self, document: &Document) -> Result<Change, SessionError> {
        let change = match &self.document {
            Some(old) => Change::between(old, document),
            None => Change::everything(),
        };
        if change.restarts() {
            let job = Arc::new(self.compiler.compile(document, &self.assets)?);
            self.engine.submit(job.clone())?;
            self.job = Some(job);
            self.render_time = Duration::ZERO;
        }
        self.document = Some(document.clone());
        Ok(change)
    }

    /// Renders for about `budget`.
    ///
    /// # Errors
    /// If the GPU fails; [`Session::fall_back_to_cpu`] goes on without it.
    pub fn step(&mut self, budget: Duration) -> Result<Progress, SessionError> {
        let progress = self.progress();
        if progress.is_done {
            return Ok(progress);
        }
        let left = self.time_limit().map(|limit| limit.saturating_sub(self.render_time));
        let begun = Instant::now();
        self.engine
            .step(left.map_or(budget, |left| budget.min(left)), progress.samples_wanted)?;
        self.render_time += begun.elapsed();
        Ok(self.progress())
    }

    /// How far the render has come.
    pub fn progress(&self) -> Progress {
        let samples_per_pixel = self.engine.samples_per_pixel();
        let samples_wanted = self.document.as_ref().map_or(0, |document| document.render.samples);
        let is_late = self.time_limit().is_some_and(|limit| self.render_time >= limit);
        Progress {
            samples_per_pixel,
            samples_wanted,
            render_seconds: self.render_time.as_secs_f64(),
            is_done: self.job.is_none() || samples_per_pixel >= samples_wanted || is_late,
        }
    }

    fn time_limit(&self) -> Option<Duration> {
        let seconds = self.document.as_ref()?.render.time_s?;
        Some(Duration::from_secs_f64(seconds.clamp(0.0, 1e9)))
    }

    /// The sums of what has been rendered.
    ///
    /// # Errors
    /// If the GPU fails.
    pub fn film(&mut self) -> Result<&Film, SessionError> {
        Ok(self.engine.film()?)
    }

    /// The mean picture, linear.
    ///
    /// # Errors
    /// If the GPU fails.
    pub fn image(&mut self) -> Result<Image, SessionError> {
        Ok(self.film()?.image())
    }

    /// The mean picture with what is known beside it about each pixel.
    ///
    /// # Errors
    /// If the GPU fails.
    pub fn layers(&mut self) -> Result<Layers, SessionError> {
        let features = self.engine.features(FEATURE_SAMPLES)?.unwrap_or_default();
        let film = self.engine.film()?;
        Ok(Layers {
            image: film.image(),
            features,
            samples: film.statistics.iter().map(|statistics| statistics[1] as f32).collect(),
            variance: film
                .variance_of_mean()
                .into_iter()
                .map(|variance| variance as f32)
                .collect(),
        })
    }

    /// Goes on with the processor after the GPU failed, with the same document from its start.
    pub fn fall_back_to_cpu(&mut self, why: &str) {
        (self.engine, self.info) = cpu(format!("the GPU failed: {why}"));
        if let Some(job) = &self.job
            && self.engine.submit(job.clone()).is_ok()
        {
            self.render_time = Duration::ZERO;
        }
    }
}
