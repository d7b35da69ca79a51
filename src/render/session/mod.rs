//! A document being rendered.

mod films;
mod recovery;

use std::{sync::Arc, time::Duration, time::Instant};

use super::{
    convergence::{Convergence, Measurement, Pacing, Work, fewest_samples, mean_samples},
    engine::{Engine, EngineChoice, EngineInfo, choice, gpu},
    error::SessionError,
    frame::FilmId,
    memory,
    progress::{Progress, StopReason},
    workshop::Workshop,
};
use crate::{
    analysis::halves::Distance,
    compile::{self, Assets, Compiler, Reloaded},
    document::{Denoise, Document, RenderSettings, change::Change},
    gpu::{GpuAdapter, GpuDevice, GpuError, Moment, Traversal},
    job::Job,
    job::effect::{Decision, EffectId},
    job::film::Extras,
    scene::texture::UserTextureFile,
};

/// A session: a document, its assets, and the engine that renders it.
pub struct Session {
    engine: Engine,
    info: EngineInfo,
    assets: Assets,
    compiler: Compiler,
    document: Option<Arc<Document>>,
    job: Option<Arc<Job>>,
    film: FilmId,
    convergence: Convergence,
    render_time: Duration,
    /// Part of it in the engine's steps.
    step_time: Duration,
    /// Engine time in seconds of the CPU fallback, before the GPU took over.
    fallback_seconds: f64,
    /// Background compilation of kernels; `None` if the session waits for them.
    workshop: Option<Workshop>,
    /// True if the GPU cannot take over from the CPU fallback.
    keeps_fallback: bool,
    /// True if the engine failed at this render, which stays as it is.
    is_stuck: bool,
    /// The denoised image's error: a noise target applies to the displayed image.
    pub denoised: Option<Distance>,
    /// Reason to keep guides for any document.
    guides_wanted: Option<&'static str>,
    /// Guides per pixel of documents that are not denoised.
    pub guides: u32,
    /// Memory limit of a render in bytes; `None` is the free memory.
    pub memory_limit: Option<u64>,
    /// Number of GPU failures.
    losses: u32,
    /// When devices that replace a lost one are lost as well, and how many: for tests.
    losing: Option<(Moment, u32)>,
}

impl Session {
    /// Opens an engine.
    ///
    /// # Errors
    ///
    /// [`GpuError`] if a GPU was requested and none works; `auto` and `cpu` always work.
    pub fn open(choice: EngineChoice) -> Result<Self, SessionError> {
        Self::open_with(choice, Assets::default())
    }

    /// The same with assets that may be shared with other sessions.
    pub fn open_with(choice: EngineChoice, assets: Assets) -> Result<Self, SessionError> {
        Ok(Self::around(choice::open(choice)?, assets))
    }

    /// Opens an adapter for a kind of traversal.
    pub fn on_adapter(adapter: &GpuAdapter, traversal: Traversal) -> Result<Self, SessionError> {
        let opened = gpu(adapter.open(traversal)?, choice::CHOSEN_BY_YOU.to_owned())?;
        Ok(Self::around(opened, Assets::default()))
    }

    fn around((engine, info): (Engine, EngineInfo), assets: Assets) -> Self {
        Self {
            engine,
            info,
            assets,
            compiler: Compiler::default(),
            document: None,
            job: None,
            film: FilmId::another(),
            convergence: Convergence::default(),
            render_time: Duration::ZERO,
            step_time: Duration::ZERO,
            fallback_seconds: 0.0,
            workshop: None,
            keeps_fallback: false,
            is_stuck: false,
            denoised: None,
            guides_wanted: None,
            guides: 2,
            memory_limit: memory::limit(),
            losses: 0,
            losing: None,
        }
    }

    /// The same without waiting for kernel compilation: until the kernel is ready, the CPU engine renders,
    /// and its samples count.
    pub fn open_fluid(choice: EngineChoice, assets: Assets) -> Result<Self, SessionError> {
        let mut session = Self::around(choice::open(choice)?, assets);
        match std::mem::take(&mut session.engine) {
            Engine::Gpu(engine) => session.workshop = Some(Workshop::new(*engine)),
            cpu => session.engine = cpu,
        }
        Ok(session)
    }

    /// True while the CPU engine renders because the GPU's kernel is being compiled.
    pub fn is_fallback(&self) -> bool {
        self.workshop.is_some() && !self.keeps_fallback && matches!(self.engine, Engine::Cpu(_))
    }

    /// Switches to the GPU if its kernel is ready. After an error the CPU engine continues.
    fn change_over(&mut self) -> Result<(), SessionError> {
        let (true, Some(job), Some(workshop)) = (self.is_fallback(), &self.job, &mut self.workshop) else {
            return Ok(());
        };
        let finished = workshop.finished(job).inspect_err(|_| self.keeps_fallback = true)?;
        let Some(mut engine) = finished else { return Ok(()) };
        self.fallback_seconds += self.engine_seconds();
        self.step_time = Duration::ZERO;
        if let Engine::Cpu(fallback) = std::mem::take(&mut self.engine) {
            let (film, schedule) = fallback.hand_over();
            engine.take_over(film, schedule);
        }
        self.engine = Engine::Gpu(Box::new(engine));
        Ok(())
    }

    /// The GPU's device, if it renders now.
    pub fn device(&self) -> Option<&GpuDevice> {
        self.engine.device()
    }

    /// The engine in use, and why it was chosen.
    pub fn engine(&self) -> &EngineInfo {
        &self.info
    }

    /// Keeps guides from the next submission on, also without denoising, because layers may be requested. `why` is the
    /// plan's reason.
    pub fn keep_guides(&mut self, why: &'static str) {
        self.guides_wanted = Some(why);
    }

    /// Models and environments, loaded and kept.
    pub fn assets(&self) -> &Assets {
        &self.assets
    }

    /// Users' texture maps of a document's materials, each with its error, if any.
    pub fn user_texture_files(&self, document: &Document) -> Result<Vec<UserTextureFile>, SessionError> {
        Ok(compile::user_texture_files(document, &self.assets)?)
    }

    /// Discards the render: the next submission starts over even with the same document.
    pub fn reset(&mut self) {
        self.document = None;
    }

    /// Reloads the files of a document. The next submission starts over.
    ///
    /// # Errors
    ///
    /// A model or environment that cannot be loaded; the current render then continues.
    pub fn reload(&mut self, document: &Document) -> Result<Reloaded, SessionError> {
        let lighting = &document.lighting;
        let (environment, encoding) = (&lighting.environment, lighting.environment_encoding);
        let reloaded = self
            .assets
            .reload(&document.model, &document.import, environment, encoding)?;
        self.reset();
        Ok(reloaded)
    }

    /// The numbers being rendered.
    pub fn job(&self) -> Option<&Arc<Job>> {
        self.job.as_ref()
    }

    /// Submits a document: loads its assets and starts over, unless only display settings changed. After an error the old
    /// document continues.
    pub fn submit(&mut self, document: &Document) -> Result<Change, SessionError> {
        self.submit_shared(&Arc::new(document.clone()))
    }

    /// The same without a copy of the document.
    pub fn submit_shared(&mut self, document: &Arc<Document>) -> Result<Change, SessionError> {
        let change = match &self.document {
            Some(old) => Change::between(old, document),
            None => Change::everything(),
        };
        if change.restarts() || change.target {
            let mut job = self.compiler.compile(document, &self.assets)?;
            if let Some(why) = self.guides_wanted {
                job.plan = job.plan.with(EffectId::Guides, Decision::on(why));
            }
            if !job.plan.has(EffectId::Denoising) {
                job.settings.guides = self.guides;
            }
            let job = Arc::new(job);
            // With only another goal, the engine continues with the same kernel. But a film without guides cannot get them
            // later.
            let guides = |job: &Arc<Job>| Extras::of(job).guides;
            if change.restarts() || guides(&job) > self.job.as_ref().map_or(0, guides) {
                self.check_memory(&job)?;
                self.start(job.clone())?;
            }
            self.job = Some(job);
        }
        self.document = Some(document.clone());
        self.is_stuck = false;
        if change.target {
            // The current goals were those of another target.
            self.convergence.goals.clear();
        }
        Ok(change)
    }

    /// Refuses a job that does not fit into memory, so that the old one continues.
    fn check_memory(&self, job: &Job) -> Result<(), SessionError> {
        // A film uses memory from its first sample on, and is freed when another starts.
        let is_in_use = self.engine.schedule().pixel_samples() > 0;
        let old = self.job.as_deref().filter(|_| is_in_use);
        let held = old.map_or(0, |old| memory::Needs::of(old, &self.info).bytes());
        let allowed = self.memory_limit.unwrap_or_else(|| memory::free(held));
        memory::check(job, &self.info, allowed).map_err(SessionError::TooLarge)
    }

    /// Restarts the engine with a job; after an error it continues with the old one.
    fn start(&mut self, job: Arc<Job>) -> Result<(), GpuError> {
        match &mut self.workshop {
            Some(workshop) => workshop.begin(&job, &mut self.engine)?,
            None => self.engine.submit(job)?,
        }
        self.keeps_fallback = false;
        self.begin_film();
        Ok(())
    }

    fn begin_film(&mut self) {
        self.film = FilmId::another();
        (self.denoised, self.is_stuck) = (None, false);
        self.convergence = Convergence::default();
        (self.render_time, self.step_time, self.fallback_seconds) = (Duration::ZERO, Duration::ZERO, 0.0);
    }

    /// Renders for about `budget`. After an engine error the render is done as it is, until the next submission.
    ///
    /// # Errors
    ///
    /// If the GPU fails; [`Session::recover`] continues.
    pub fn step(&mut self, budget: Duration) -> Result<Progress, SessionError> {
        self.change_over()?;
        let outcome = self.render(budget);
        self.is_stuck = outcome.is_err();
        outcome
    }

    fn render(&mut self, budget: Duration) -> Result<Progress, SessionError> {
        let before = self.render_time;
        let begun = Instant::now();
        while !self.progress().is_done {
            self.plan()?;
            let mut left = budget.saturating_sub(begun.elapsed());
            if let Some(limit) = self.time_limit() {
                left = left.min(limit.saturating_sub(self.render_time));
            }
            let step_begun = Instant::now();
            self.engine.step(left, &self.convergence.goals)?;
            self.step_time += step_begun.elapsed();
            self.render_time = before + begun.elapsed();
            if self.engine.schedule().is_at_goal() || self.progress().is_done {
                self.measure()?;
            }
            self.render_time = before + begun.elapsed();
            if begun.elapsed() >= budget || self.awaits_denoised() {
                break;
            }
        }
        Ok(self.progress())
    }

    /// Sets new goals if the current ones have been reached or dropped.
    fn plan(&mut self) -> Result<(), SessionError> {
        let Some(document) = &self.document else { return Ok(()) };
        let goals = &self.convergence.goals;
        let is_in_force = goals.len() == self.engine.schedule().grid().tiles();
        if is_in_force && !self.engine.schedule().is_at_goal() {
            return Ok(());
        }
        let begun = Instant::now();
        // Where rounds decide nothing about the image, their length may go by the clock.
        let is_watched = document.render.noise.is_none() && !document.render.is_adaptive();
        let by_clock = is_watched || matches!(self.engine, Engine::Gpu(_));
        let pacing = Pacing {
            engine_seconds: by_clock.then(|| self.engine_seconds()),
            is_denoised: self.shows_nearer(),
        };
        let schedule = self.engine.schedule().clone();
        let film = document.render.is_adaptive().then(|| self.engine.film()).transpose()?;
        self.convergence.next_round(film, &schedule, &document.render, pacing);
        self.convergence.took(Work::Planning, begun.elapsed().as_secs_f64());
        Ok(())
    }

    /// Measures the error if there are new samples since the last measurement.
    fn measure(&mut self) -> Result<(), SessionError> {
        if !self.convergence.is_stale(self.engine.schedule()) {
            return Ok(());
        }
        let begun = Instant::now();
        let seconds = self.engine_seconds();
        let schedule = self.engine.schedule().clone();
        let settings = self.settings();
        self.convergence
            .measure(self.engine.film()?, &schedule, &settings, seconds);
        self.convergence.took(Work::Measuring, begun.elapsed().as_secs_f64());
        Ok(())
    }

    /// The engine's own time.
    fn engine_seconds(&self) -> f64 {
        self.fallback_seconds + self.engine.gpu_seconds().unwrap_or(self.step_time.as_secs_f64())
    }

    /// Progress of the render.
    pub fn progress(&self) -> Progress {
        let schedule = self.engine.schedule();
        let settings = self.settings();
        let engine_seconds = self.engine_seconds();
        let mut progress = Progress {
            samples_per_pixel: schedule.samples_per_pixel(),
            samples_wanted: settings.samples,
            mean_samples: mean_samples(schedule, None),
            samples_per_second: schedule.pixel_samples() as f64 / engine_seconds.max(1e-9),
            render_seconds: self.render_time.as_secs_f64(),
            engine_seconds,
            measure_seconds: self.convergence.total_seconds,
            is_fallback: self.is_fallback(),
            kernel_seconds: self.workshop.as_ref().and_then(|workshop| workshop.compile_seconds),
            noise: self.convergence.noise(),
            cut_share: self.convergence.cut_share,
            noise_wanted: settings.noise,
            denoised: self.denoised,
            targets_denoised: self.shows_nearer(),
            ..Progress::default()
        };
        // With pausing tiles, one may be complete while others lack samples of the round.
        let is_even = !settings.is_adaptive() || self.is_between_rounds();
        let has_all = progress.samples_per_pixel >= progress.samples_wanted && is_even;
        let has_least = || fewest_samples(schedule, &settings) >= settings.least_samples();
        progress.stopped_by = if progress.is_converged() && has_least() {
            Some(StopReason::Noise)
        } else if has_all && has_least() {
            Some(StopReason::Samples)
        } else if self.time_limit().is_some_and(|limit| self.render_time >= limit) {
            Some(StopReason::Time)
        } else {
            None
        };
        progress.is_done = self.job.is_none() || self.is_stuck || progress.stopped_by.is_some();
        progress
    }

    /// The errors seen so far, oldest first.
    pub fn history(&self) -> &[Measurement] {
        &self.convergence.history
    }

    fn settings(&self) -> RenderSettings {
        self.document
            .as_ref()
            .map(|document| document.render)
            .unwrap_or_default()
    }

    fn time_limit(&self) -> Option<Duration> {
        Some(Duration::from_secs_f64(self.settings().time_s?.clamp(0.0, 1e9)))
    }

    /// True if every tile has the samples of its round; on the CPU their number does not depend on time.
    pub fn is_between_rounds(&self) -> bool {
        self.engine.schedule().is_at_goal()
    }

    /// True if rendering waits for the denoised image's error.
    fn awaits_denoised(&self) -> bool {
        self.settings().noise.is_some() && self.shows_nearer() && self.is_between_rounds()
    }

    /// Whether the display blends samples and denoised image by error (`auto`).
    fn shows_nearer(&self) -> bool {
        let document = self.document.as_ref();
        document.is_some_and(|document| document.view.denoise == Denoise::Auto)
    }

    fn world_units_per_unit(&self) -> f64 {
        self.job.as_ref().map_or(1.0, |job| job.geometry.world_units_per_unit)
    }
}
