//! The worker's thread: executes orders, steps the session, publishes images.

mod publish;

use std::{
    path::PathBuf,
    sync::{Arc, atomic::Ordering::Relaxed, mpsc::Receiver, mpsc::Sender},
    time::Duration,
    time::Instant,
};

use super::{
    Activity, Event, LayersMade, Level, Order, Scene, Shared, Snapshot, Submission,
    denoising::Denoising,
    stage::{Stage, pixels},
};
use crate::{
    compile::Assets,
    document::{Change, Document, ViewSettings},
    gpu::GpuError,
    job::plan::Specialisation,
    panics::caught,
    panics::lock,
    render::{
        engine::EngineChoice, engine::EngineKind, error::SessionError, frame::Frame, output::Layers, session::Session,
        shown::Shown,
    },
    scene::{ModelOptions, ModelSource, environment::EnvironmentEncoding, environment::EnvironmentSource},
};

/// Longest rendering step between two reads of the orders; and the step before the first image, which must not wait for
/// later samples.
const STEP: Duration = Duration::from_millis(20);
const FIRST_STEP: Duration = Duration::from_millis(6);
/// Shortest and longest time between two images of a render, and between two progress reports: without a GPU the window
/// redraws for either, which costs the renderer time.
const PUBLISH_INTERVAL: [Duration; 2] = [Duration::from_millis(100), Duration::from_millis(500)];
/// The interval is this share of the render's age.
const PUBLISH_SHARE: f64 = 0.1;
/// Publishing takes at most one part in this many of the time.
const PUBLISH_COST: u32 = 12;
/// Weight of the latest measurement in the running mean of the speed.
const SPEED_WEIGHT: f64 = 0.1;

pub struct State<'a> {
    shared: &'a Shared,
    repaint: &'a dyn Fn(),
    assets: Assets,
    /// Who waits for layers, with the revision that they are to be of.
    pub requested_layers: Vec<(u64, Sender<LayersMade>)>,
    pub session: Option<Session>,
    snapshot: Snapshot,
    /// The latest submission, while the one before it must still be shown.
    pub submitted: Option<Submission>,
    stage: Option<Stage>,
    pub is_paused: bool,
    /// Mean speed in pixel samples per second, to choose resolutions; 0 before the first measurement.
    samples_per_second: f64,
    published_at: Instant,
    published_samples: u32,
    publish_cost: Duration,
    reported_at: Instant,
    /// The image or a map of it.
    pub shown: Shown,
    /// True while the inspector needs per-pixel quantities.
    pub is_inspected: bool,
    denoising: Denoising,
    /// The latest frame shown of the submission.
    frame: Option<Frame>,
}

/// A session for the window, which keeps guides: denoising and layers may be requested for samples already rendered.
fn for_window(mut session: Session) -> Session {
    session.keep_guides("the window keeps them: denoising may be switched on and layers saved at any time");
    session
}

impl<'a> State<'a> {
    pub fn new(shared: &'a Shared, repaint: &'a dyn Fn(), assets: Assets, to_itself: Sender<Order>) -> Self {
        Self {
            shared,
            repaint,
            requested_layers: Vec::new(),
            session: None,
            snapshot: Snapshot {
                loading: assets.loading().clone(),
                ..Snapshot::default()
            },
            assets,
            submitted: None,
            stage: None,
            is_paused: false,
            samples_per_second: 0.0,
            published_at: Instant::now(),
            published_samples: 0,
            publish_cost: Duration::ZERO,
            reported_at: Instant::now(),
            shown: Shown::default(),
            is_inspected: false,
            denoising: Denoising::spawn(move || {
                // Wakes the thread, which may be gone.
                let _ = to_itself.send(Box::new(|_| ()));
            }),
            frame: None,
        }
    }
}

impl State<'_> {
    /// Waits for orders if there is nothing to do, executes them, and renders a step. Returns false to end the thread.
    pub fn run_once(&mut self, orders: &Receiver<Order>) -> bool {
        let first = orders.recv_timeout(self.longest_wait()).ok();
        for order in first.into_iter().chain(orders.try_iter()) {
            if self.shared.is_over.load(Relaxed) {
                return false;
            }
            order(self);
        }
        self.collect_denoised();
        let submitted = if self.keeps_stage() {
            None
        } else {
            self.submitted.take()
        };
        if let Some(submission) = submitted {
            self.make_layers(submission.revision);
            self.accept(submission);
        } else if self.stage.as_ref().is_some_and(Stage::is_settled) {
            self.settle();
        }
        if self.should_render() {
            self.guarded(Self::step);
        } else {
            self.report_idle();
        }
        self.make_layers(0);
        true
    }

    /// Reports a change of activity while there is nothing to render.
    fn report_idle(&mut self) {
        let activity = self.activity();
        let is_news = self.snapshot.activity != activity;
        let is_unseen = self.stage.as_ref().is_some_and(|stage| !stage.is_shown);
        if activity == Activity::Done && is_unseen && !self.denoising.is_pending() {
            // The time limit passed before the first sample.
            self.guarded(Self::publish_picture);
        }
        if is_news {
            self.report(activity);
        }
    }

    /// Whether layers are requested and there is not a sample to make them of.
    fn lacks_samples(&self) -> bool {
        let has_none = |session: &Session| session.progress().samples_per_pixel == 0;
        !self.requested_layers.is_empty() && self.session.as_ref().is_none_or(has_none)
    }

    /// Makes the requested layers once there are samples at full resolution; those of what the `next` revision replaces, of
    /// what there is.
    fn make_layers(&mut self, next: u64) {
        if self.lacks_samples() {
            if next == 0 && !self.should_render() && !self.denoising.is_pending() {
                self.requested_layers.clear();
            }
            return;
        }
        let Some(stage) = &self.stage else { return };
        let (reduction, revision) = (stage.reduction, stage.submission.revision);
        let is_full = reduction == 1 || stage.is_final;
        let is_due = |(asked, _): &mut (u64, _)| *asked < next || (is_full && *asked <= revision);
        let due: Vec<_> = self.requested_layers.extract_if(.., is_due).collect();
        for (_, made) in due {
            self.guarded(|state| {
                let frame = state.frame.clone().filter(Frame::is_denoised);
                let session = state.session()?;
                let denoised = frame
                    .filter(|frame| session.has_film_of(frame))
                    .map(|frame| frame.image);
                let layers = Layers {
                    denoised,
                    ..session.layers()?
                };
                // Nobody waits where the save was called off.
                let _ = made.send((Box::new(layers), session.progress(), reduction));
                Ok(())
            });
        }
    }

    fn session(&mut self) -> Result<&mut Session, SessionError> {
        let session = match self.session.take() {
            Some(session) => session,
            None => for_window(Session::open_with(EngineChoice::Cpu, self.assets.clone())?),
        };
        Ok(self.session.insert(session))
    }

    /// Opens an engine; if that fails, the CPU engine.
    pub fn open(&mut self, choice: EngineChoice) {
        self.session = None;
        self.snapshot.engine = None;
        self.report(Activity::Starting);
        let opened = caught(|| Session::open_fluid(choice, self.assets.clone()));
        match opened.and_then(|opened| opened.map_err(crate::in_words)) {
            Ok(session) => self.session = Some(for_window(session)),
            Err(why) => {
                self.message(Level::Error, format!("{why} (going on with the CPU)"));
                self.guarded(|state| state.session().map(|_| ()));
            }
        }
        self.report_engine();
    }

    fn report_engine(&mut self) {
        self.samples_per_second = 0.0;
        self.snapshot.engine = self.session.as_ref().map(|session| session.engine().clone());
        if let Some(engine) = self.snapshot.engine.clone() {
            self.message(Level::Info, format!("rendering with {engine}: {}", engine.reason));
        }
    }

    /// Runs work that may fail. A lost GPU is opened again. If that fails too, or the work panics, the CPU engine takes over
    /// with the same document. Other errors are reported and change nothing.
    fn guarded(&mut self, work: impl FnOnce(&mut Self) -> Result<(), SessionError>) -> bool {
        let why = match caught(|| work(self)) {
            Ok(Ok(())) => return true,
            Ok(Err(SessionError::Gpu(error))) if error.is_lost() => {
                self.recover(error);
                return false;
            }
            Ok(Err(error)) => {
                if error.is_cancelled() {
                    self.message(Level::Info, error.to_string());
                    self.event(Event::Cancelled);
                } else {
                    self.message(Level::Error, error.to_string());
                }
                return false;
            }
            Err(panic) => panic,
        };
        let engine = self.snapshot.engine.as_ref();
        let was_cpu = engine.is_some_and(|engine| engine.kind == EngineKind::Cpu);
        self.message(Level::Error, format!("the renderer failed: {why}"));
        self.session = None;
        if was_cpu {
            // A bug: the same document would trigger it again.
            self.stage = None;
            return false;
        }
        self.message(Level::Warning, "going on with the CPU".to_owned());
        let document = self.stage.as_ref().map(Stage::document);
        let submitted = self
            .session()
            .and_then(|session| document.map_or(Ok(()), |document| session.submit_shared(&document).map(|_| ())));
        if let Err(error) = submitted {
            self.session = None;
            self.message(Level::Error, error.to_string());
        }
        self.begin_film();
        self.report_engine();
        false
    }

    /// Recovers from a lost GPU device, with the stage's document.
    fn recover(&mut self, mut lost: GpuError) {
        while let Some(session) = &mut self.session {
            let how = session.recover(&lost);
            let stage = self.stage.as_ref().map(Stage::document);
            let outcome = stage.map(|document| session.submit_shared(&document));
            self.message(Level::Warning, how);
            match outcome {
                Some(Err(SessionError::Gpu(again))) if again.is_lost() => lost = again,
                Some(Err(error)) => {
                    self.message(Level::Error, error.to_string());
                    break;
                }
                _ => break,
            }
        }
        self.begin_film();
        self.report_engine();
    }

    /// Discards the render and begins it again.
    pub fn start_over(&mut self) {
        self.guarded(|state| {
            state.session()?.reset();
            Ok(())
        });
        self.restart();
    }

    /// Submits the stage's document again, as after a change of engine.
    pub fn restart(&mut self) {
        self.snapshot.scene = None;
        if let Some(stage) = self.stage.take() {
            self.accept(stage.submission);
        }
    }

    /// Starts or updates the render for a submission.
    fn accept(&mut self, submission: Submission) {
        if let Some(stage) = &mut self.stage {
            let change = Change::between(&stage.submission.document, &submission.document);
            if !change.restarts() {
                stage.submission = submission;
                self.guarded(|state| state.apply_change(change));
                return;
            }
        }
        self.snapshot.first_picture = None;
        let kernel = self.kernel();
        let stage = Stage::first(submission, self.samples_per_second);
        self.begin(stage.clone());
        if kernel.is_some() && self.kernel() != kernel {
            let cautious = Stage::cautious(stage.submission, self.samples_per_second);
            if cautious.reduction > stage.reduction {
                self.begin(cautious);
            }
        }
    }

    /// Specialisation of the kernel that renders or is being compiled.
    fn kernel(&self) -> Option<Specialisation> {
        Some(self.session.as_ref()?.job()?.plan.specialisation())
    }

    /// Applies a change that keeps the samples: another display or another goal.
    fn apply_change(&mut self, change: Change) -> Result<(), SessionError> {
        let Some(stage) = self.stage.clone() else { return Ok(()) };
        self.session()?.submit_shared(&stage.document())?;
        let view = &stage.submission.document.view;
        let mix = &stage.submission.document.lighting.light_mix;
        let shown = self.snapshot.picture.as_ref().map(|picture| &picture.document);
        let has_same_pixels = shown.is_some_and(|old| {
            let modes = |view: &ViewSettings| (view.denoise, view.denoise_when);
            modes(&old.view) == modes(view) && old.lighting.light_mix == *mix
        });
        self.update_scene()?;
        if !has_same_pixels && stage.is_shown {
            self.reset_denoised();
            self.frame = None;
            return self.publish_picture();
        }
        // If nothing is left to render, the image also belongs to the new submission.
        let is_done = self.session()?.progress().is_done;
        match self.frame.clone() {
            Some(frame) if stage.is_shown && (change.display || is_done) => self.publish(frame),
            _ => Ok(()),
        }
    }

    /// Proceeds from a reduced resolution to the next.
    fn settle(&mut self) {
        let Some(stage) = self.stage.as_ref().map(|stage| stage.next(self.samples_per_second)) else {
            return;
        };
        if !self.begin(stage)
            && let Some(small) = &mut self.stage
        {
            // It would fail again: the reduced image stays until the document changes.
            small.is_final = true;
        }
    }

    /// Submits a stage to the session. If that fails, the current render continues and the result is false.
    fn begin(&mut self, stage: Stage) -> bool {
        let document = stage.document();
        let engine = self.snapshot.engine.clone();
        let is_taken = self.guarded(|state| state.submit_stage(&document))
            // The GPU failed: try again with the CPU engine.
            || (self.snapshot.engine != engine && self.guarded(|state| state.submit_stage(&document)));
        if !is_taken {
            return false;
        }
        if !stage.is_shown {
            self.frame = None;
        }
        self.stage = Some(stage);
        self.begin_film();
        self.guarded(Self::update_scene);
        true
    }

    /// Starts over what is counted and made of a film.
    fn begin_film(&mut self) {
        self.reset_denoised();
        self.published_samples = 0;
        self.published_at = Instant::now();
    }

    fn submit_stage(&mut self, document: &Arc<Document>) -> Result<(), SessionError> {
        let known = self.snapshot.scene.as_ref().map(|scene| scene.document.clone());
        let is_new = |is_same: &dyn Fn(&Document) -> bool| !known.as_deref().is_some_and(is_same);
        if is_new(&|known| (&known.model, &known.import) == (&document.model, &document.import)) {
            self.begin_loading(document.model.to_string());
            self.session()?.assets().model(&document.model, &document.import)?;
            self.report(Activity::Preparing);
        }
        let environment = &document.lighting.environment;
        if is_new(&|known| known.lighting.environment == *environment) {
            self.begin_loading(environment.to_string());
            self.session()?
                .assets()
                .environment(environment, document.lighting.environment_encoding)?;
        }
        self.session()?.submit_shared(document)?;
        Ok(())
    }

    fn update_scene(&mut self) -> Result<(), SessionError> {
        let Some(document) = self.stage.as_ref().map(|stage| stage.submission.document.clone()) else {
            return Ok(());
        };
        let session = self.session()?;
        let model = session.assets().model(&document.model, &document.import)?;
        if let Some(job) = session.job().cloned() {
            self.snapshot.scene = Some(Arc::new(Scene { document, job, model }));
        }
        Ok(())
    }

    /// Renders a step, and publishes when that is due.
    fn step(&mut self) -> Result<(), SessionError> {
        let is_shown = self.stage.as_ref().is_none_or(|stage| stage.is_shown);
        let progress = self.session()?.step(if is_shown { STEP } else { FIRST_STEP })?;
        let Some(stage) = &self.stage else { return Ok(()) };
        self.snapshot.progress = progress;
        let history = self.session.as_ref().map(Session::history).unwrap_or_default();
        if self.snapshot.history.as_slice() != history {
            self.snapshot.history = Arc::new(history.to_vec());
        }
        self.snapshot.reduction = stage.reduction;
        if progress.samples_per_pixel > 0 {
            self.snapshot.samples_per_second = progress.samples_per_second;
            // Averaged, so that the resolution does not flicker during a drag.
            let weight = if self.samples_per_second > 0.0 {
                SPEED_WEIGHT
            } else {
                1.0
            };
            self.samples_per_second += weight * (self.snapshot.samples_per_second - self.samples_per_second);
        }
        let age = self.published_at.elapsed();
        let interval = Duration::from_secs_f64(PUBLISH_SHARE * progress.render_seconds)
            .clamp(PUBLISH_INTERVAL[0], PUBLISH_INTERVAL[1])
            .max(PUBLISH_COST * self.publish_cost);
        let is_due = if self.denoising.shows(&stage.submission.document, &progress) {
            let pixels = pixels(&stage.submission, stage.reduction);
            self.denoising.is_due(&progress, pixels, stage.is_shown)
        } else {
            let is_urgent = self.published_samples == 0 || progress.is_done;
            progress.samples_per_pixel > self.published_samples && (is_urgent || age >= interval)
        };
        if is_due {
            self.publish_picture()?;
        }
        if self.reported_at.elapsed() >= interval || self.snapshot.activity != Activity::Rendering {
            self.report(Activity::Rendering);
        }
        Ok(())
    }

    /// Publishes the snapshot.
    fn report(&mut self, activity: Activity) {
        self.snapshot.activity = activity;
        self.reported_at = Instant::now();
        *lock(&self.shared.snapshot) = Arc::new(self.snapshot.clone());
        (self.repaint)();
    }

    fn message(&self, level: Level, text: String) {
        self.event(Event::Message(level, text));
    }

    fn event(&self, event: Event) {
        lock(&self.shared.events).push(event);
        (self.repaint)();
    }

    /// Whether the stage must be shown before another submission is taken.
    fn keeps_stage(&self) -> bool {
        let is_in_work = self.should_render() || self.denoising.is_pending();
        let is_needed = |stage: &Stage| !stage.may_be_replaced() || self.lacks_samples();
        self.stage.as_ref().is_some_and(is_needed) && is_in_work
    }

    /// Time until there is something to do without an order.
    fn longest_wait(&self) -> Duration {
        let has_submission = self.submitted.is_some() && !self.keeps_stage();
        let has_news = self.activity() != self.snapshot.activity || self.denoising.has_outcome();
        if self.should_render() || has_submission || has_news {
            return Duration::ZERO;
        }
        self.stage.as_ref().map_or(Duration::MAX, Stage::wait_left)
    }

    /// Whether to render a step; while paused, only until the first image, and the first sample for requested layers.
    fn should_render(&self) -> bool {
        let (Some(stage), Some(session)) = (&self.stage, &self.session) else {
            return false;
        };
        let is_wanted = !self.is_paused || !stage.is_shown || self.lacks_samples();
        !session.progress().is_done && is_wanted && !self.yields_to_denoiser()
    }

    /// Whether the engine waits for the denoiser. On the same cores each would take as long as both, and the user waits for
    /// the denoised image.
    fn yields_to_denoiser(&self) -> bool {
        self.denoising.is_pending()
            && self
                .session
                .as_ref()
                .is_some_and(|session| session.engine().is_software || session.is_fallback())
    }

    /// The current activity.
    fn activity(&self) -> Activity {
        match &self.session {
            Some(_) if self.stage.is_none() => Activity::Idle,
            Some(_) if self.denoising.is_pending() => Activity::Rendering,
            Some(session) if session.progress().is_done => Activity::Done,
            Some(_) if self.is_paused => Activity::Paused,
            Some(_) => Activity::Rendering,
            None => Activity::Idle,
        }
    }

    pub fn load_model(&mut self, source: ModelSource, options: ModelOptions) {
        self.loaded(source.to_string(), |state| {
            let model = state.session()?.assets().model(&source, &options)?;
            Ok(Event::ModelOpened(source, options, model))
        });
    }

    pub fn load_environment(&mut self, source: EnvironmentSource) {
        self.loaded(source.to_string(), |state| {
            let environment = state
                .session()?
                .assets()
                .environment(&source, EnvironmentEncoding::default())?;
            for warning in &environment.warnings {
                state.message(Level::Warning, warning.clone());
            }
            Ok(Event::EnvironmentOpened(source, environment))
        });
    }

    /// Reads the scene's files again and restarts the render.
    pub fn reload(&mut self) {
        let Some(document) = self.stage.as_ref().map(|stage| stage.submission.document.clone()) else {
            return self.event(Event::Reloaded(None, None));
        };
        let mut is_read = false;
        self.loaded(document.model.to_string(), |state| {
            let reloaded = state.session()?.reload(&document)?;
            if let Some(summary) = reloaded.model.report.summary() {
                state.message(Level::Warning, summary);
            }
            is_read = true;
            Ok(Event::Reloaded(reloaded.before, Some(reloaded.model)))
        });
        if is_read {
            self.restart();
        }
    }

    /// Reports the start of loading and resets its cancellation.
    fn begin_loading(&mut self, what: String) {
        self.assets.loading().begin();
        self.report(Activity::Loading(what));
    }

    /// Reports the result of loading; a failure does not affect the current render.
    fn loaded(&mut self, what: String, work: impl FnOnce(&mut Self) -> Result<Event, SessionError>) {
        let path = PathBuf::from(&what);
        self.begin_loading(what);
        let event = match caught(|| work(self)) {
            Ok(Ok(event)) => event,
            Ok(Err(error)) if error.is_cancelled() => Event::OpenFailed(path, Level::Info, error.to_string()),
            Ok(Err(error)) => Event::OpenFailed(path, Level::Error, error.to_string()),
            Err(panic) => {
                let why = format!("{}: reading it failed: {panic}", path.display());
                Event::OpenFailed(path, Level::Error, why)
            }
        };
        self.event(event);
    }
}
