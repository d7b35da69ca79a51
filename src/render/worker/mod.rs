//! A session on a thread of its own, so that the window never waits.
//!
//! The window submits documents and the worker publishes snapshots; the latest of each wins. They communicate through two
//! short locks. Work is cut into steps of [`STEP`], and commands are read after each.

mod denoising;
mod picture;
mod stage;
mod thread;

use std::io;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

pub use picture::Picture;

use super::convergence::Measurement;
use super::engine::{EngineChoice, EngineInfo};
use super::mailbox::Mailbox;
use super::output::Layers;
use super::priority::lower_thread_priority;
use super::progress::Progress;
use super::session::Session;
use super::shown::Shown;
use crate::analysis::halves::Distance;
use crate::compile::Assets;
use crate::document::Document;
use crate::gpu::Moment;
use crate::job::Job;
use crate::panics::lock;
use crate::scene::environment::{Environment, EnvironmentSource};
use crate::scene::{Loading, Model, ModelOptions, ModelSource};

/// Longest rendering step between two reads of the commands; and the step before the first image, which must not wait for
/// later samples.
const STEP: Duration = Duration::from_millis(20);
const FIRST_STEP: Duration = Duration::from_millis(6);
/// Time for which dropping a worker waits for its thread.
const SHUTDOWN_TIMEOUT: Duration = Duration::from_secs(2);

/// Renders on a thread of its own.
pub struct Worker {
    shared: Arc<Shared>,
    assets: Assets,
    /// Requested models and environments whose events have not been taken.
    opening: AtomicUsize,
    thread: Option<JoinHandle<()>>,
}

/// Whether more edits are expected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// More changes follow at once, as during a drag. Rendered at a reduced resolution, and in full after 150 ms without a
    /// change.
    Moving,
    /// No further change is expected for now.
    Still,
}

/// Activity of the worker.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Activity {
    /// Opening the adapter and compiling the common kernels.
    #[default]
    Starting,
    /// Reading a file or computing a built-in.
    Loading(String),
    /// Building the hierarchy and the engine's resources.
    Preparing,
    /// Samples are being rendered.
    Rendering,
    /// Rendering has reached its goal.
    Done,
    /// Paused by the user.
    Paused,
    /// Nothing to render, because the document failed.
    Idle,
}

impl std::fmt::Display for Activity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Starting => f.write_str("starting the engine"),
            Self::Loading(what) => write!(f, "loading {what}"),
            Self::Preparing => f.write_str("preparing"),
            Self::Rendering => f.write_str("rendering"),
            Self::Done => f.write_str("done"),
            Self::Paused => f.write_str("paused"),
            Self::Idle => f.write_str("nothing to render"),
        }
    }
}

/// The scene being rendered.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The document as submitted.
    pub document: Arc<Document>,
    /// The compiled job.
    pub job: Arc<Job>,
    /// The source model.
    pub model: Arc<Model>,
}

/// The state of the worker at some moment.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// The latest image.
    pub picture: Option<Arc<Picture>>,
    /// The scene being rendered.
    pub scene: Option<Arc<Scene>>,
    /// Progress of the render.
    pub progress: Progress,
    /// Error measurements of the render, oldest first.
    pub history: Arc<Vec<Measurement>>,
    /// Speed in pixel samples per second.
    pub samples_per_second: f64,
    /// Divisor of width and height of the render in progress.
    pub reduction: u32,
    /// Activity of the worker.
    pub activity: Activity,
    /// The engine; `None` while it is being opened.
    pub engine: Option<EngineInfo>,
    /// Estimated error of the denoised image.
    pub denoised: Option<Distance>,
    /// Time from the latest submission to its first image.
    pub first_picture: Option<Duration>,
    /// Progress of loading.
    pub loading: Loading,
}

/// Severity of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// For the record.
    Info,
    /// Something was fixed or left out.
    Warning,
    /// Something was not done.
    Error,
}

/// A report of the worker to the window.
#[derive(Clone, Debug)]
pub enum Event {
    /// A message for the user.
    Message(Level, String),
    /// A model requested by [`Worker::open_model`]; the document is unchanged.
    ModelOpened(ModelSource, ModelOptions, Arc<Model>),
    /// An environment requested by [`Worker::open_environment`].
    EnvironmentOpened(EnvironmentSource, Arc<Environment>),
    /// The result of [`Worker::reload`]: the model before, if known, and after; both `None` if nothing is rendered.
    Reloaded(Option<Arc<Model>>, Option<Arc<Model>>),
    /// A file that failed to open, with the reason.
    OpenFailed(PathBuf, Level, String),
    /// A request was cancelled.
    Cancelled,
    /// The result of [`Worker::make_layers`] for a file, with the progress of the render at that moment.
    LayersMade(PathBuf, Box<Layers>, Progress),
}

/// A fault of the GPU's device, injected by tests.
#[derive(Clone, Copy, Debug)]
enum InjectedFault {
    /// The device is lost at a moment, a number of times in all.
    Lost(Moment, u32),
    /// Buffers larger than this many bytes are refused.
    Limited(u64),
}

impl InjectedFault {
    fn inject(self, session: &mut Session) {
        match self {
            Self::Lost(moment, times) => session.lose_when(moment, times),
            Self::Limited(bytes) => session
                .device()
                .into_iter()
                .for_each(|device| device.limit_buffers(bytes)),
        }
    }
}

/// Pending commands of the window.
#[derive(Debug, Default)]
struct Commands {
    submission: Option<Submission>,
    models: Vec<(ModelSource, ModelOptions)>,
    environments: Vec<EnvironmentSource>,
    layers: Vec<PathBuf>,
    engine: Option<EngineChoice>,
    shown: Option<Shown>,
    is_inspected: Option<bool>,
    reloads: u32,
    restart: bool,
    faults: Vec<InjectedFault>,
    quit: bool,
}

impl Commands {
    fn is_empty_beside_submission(&self) -> bool {
        self.models.is_empty()
            && self.environments.is_empty()
            && self.layers.is_empty()
            && self.engine.is_none()
            && self.shown.is_none()
            && self.is_inspected.is_none()
            && self.reloads == 0
            && !self.restart
            && self.faults.is_empty()
            && !self.quit
    }
}

#[derive(Clone, Debug)]
struct Submission {
    document: Arc<Document>,
    pace: Pace,
    revision: u64,
    at: Instant,
}

#[derive(Default)]
struct Shared {
    commands: Mailbox<CommandQueue>,
    snapshot: Mutex<Arc<Snapshot>>,
    events: Mutex<Vec<Event>>,
}

#[derive(Default)]
struct CommandQueue {
    commands: Commands,
    is_paused: bool,
    last_revision: u64,
}

impl Worker {
    /// Starts the thread, which opens the engine and calls `repaint` when there is something new to show.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn spawn(choice: EngineChoice, repaint: impl Fn() + Send + 'static) -> io::Result<Self> {
        Self::spawn_with(choice, Assets::default(), repaint)
    }

    /// Starts another worker that shares models and environments with this one.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn spawn_beside(&self, choice: EngineChoice, repaint: impl Fn() + Send + 'static) -> io::Result<Self> {
        Self::spawn_with(choice, self.assets.clone(), repaint)
    }

    /// The loaded models and environments, to be shared.
    pub fn assets(&self) -> &Assets {
        &self.assets
    }

    fn spawn_with(choice: EngineChoice, assets: Assets, repaint: impl Fn() + Send + 'static) -> io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let (of_thread, its_assets) = (shared.clone(), assets.clone());
        let thread = std::thread::Builder::new().name("render".to_owned()).spawn(move || {
            lower_thread_priority();
            thread::run(&of_thread, choice, its_assets, &repaint);
        })?;
        Ok(Self {
            shared,
            assets,
            opening: AtomicUsize::new(0),
            thread: Some(thread),
        })
    }

    /// Submits a document to render instead of the last one. Returns its revision, which its images carry.
    pub fn submit(&self, document: &Document, pace: Pace) -> u64 {
        self.shared.commands.change(|queue| {
            queue.last_revision += 1;
            queue.commands.submission = Some(Submission {
                document: Arc::new(document.clone()),
                pace,
                revision: queue.last_revision,
                at: Instant::now(),
            });
            queue.last_revision
        })
    }

    /// Pauses or resumes rendering. Submissions are still shown with their first sample while paused.
    pub fn pause(&self, is_paused: bool) {
        self.shared.commands.change(|queue| queue.is_paused = is_paused);
    }

    /// Loads a model in the background; an [`Event`] reports the result.
    pub fn open_model(&self, source: ModelSource, options: ModelOptions) {
        self.opening.fetch_add(1, Relaxed);
        self.send(|commands| commands.models.push((source, options)));
    }

    /// Loads an environment in the background; an [`Event`] reports the result.
    pub fn open_environment(&self, source: EnvironmentSource) {
        self.opening.fetch_add(1, Relaxed);
        self.send(|commands| commands.environments.push(source));
    }

    /// Makes the image's layers as soon as it has samples at full resolution; an [`Event`] returns them with the file name.
    pub fn make_layers(&self, path: PathBuf) {
        self.send(|commands| commands.layers.push(path));
    }

    /// Reads the scene's files again; an [`Event`] reports the result. If they cannot be read, the current render continues.
    pub fn reload(&self) {
        self.opening.fetch_add(1, Relaxed);
        self.send(|commands| commands.reloads += 1);
    }

    /// Restarts the render.
    pub fn restart(&self) {
        self.send(|commands| commands.restart = true);
    }

    /// Injects losses of the GPU's device, as by a driver's reset: at `moment`, and `times` in all. No effect on the CPU
    /// engine. For tests.
    pub fn lose_device(&self, moment: Moment, times: u32) {
        self.send(|commands| commands.faults.push(InjectedFault::Lost(moment, times)));
    }

    /// Makes the GPU refuse buffers above a size in bytes, as a small adapter does. For tests.
    pub fn limit_buffers(&self, bytes: u64) {
        self.send(|commands| commands.faults.push(InjectedFault::Limited(bytes)));
    }

    /// Switches to another engine.
    pub fn use_engine(&self, choice: EngineChoice) {
        self.send(|commands| commands.engine = Some(choice));
    }

    /// Shows the image, or a map of its error or samples; the render continues.
    pub fn show(&self, shown: Shown) {
        self.send(|commands| commands.shown = Some(shown));
    }

    /// Turns per-pixel quantities ([`Picture::facts`]) on or off.
    pub fn set_inspected(&self, is_inspected: bool) {
        self.send(|commands| commands.is_inspected = Some(is_inspected));
    }

    /// Cancels loading; the current render continues.
    pub fn cancel_loading(&self) {
        self.loading().cancel();
    }

    /// Progress of loading for the window.
    pub fn loading(&self) -> &Loading {
        self.assets.loading()
    }

    fn send(&self, change: impl FnOnce(&mut Commands)) {
        self.shared.commands.change(|queue| change(&mut queue.commands));
    }

    /// The latest snapshot.
    pub fn snapshot(&self) -> Arc<Snapshot> {
        lock(&self.shared.snapshot).clone()
    }

    /// The events since the last call.
    pub fn take_events(&self) -> Vec<Event> {
        let events = std::mem::take(&mut *lock(&self.shared.events));
        let ends_opening = |event: &&Event| {
            matches!(
                event,
                Event::ModelOpened(..) | Event::EnvironmentOpened(..) | Event::OpenFailed(..) | Event::Reloaded(..)
            )
        };
        self.opening
            .fetch_sub(events.iter().filter(ends_opening).count(), Relaxed);
        events
    }

    /// Whether a requested model or environment is still pending.
    pub fn is_opening(&self) -> bool {
        self.opening.load(Relaxed) > 0
    }
}

impl Drop for Worker {
    /// Asks the thread to end. Leaves it behind if that takes longer than [`SHUTDOWN_TIMEOUT`], as while it reads a large
    /// file.
    fn drop(&mut self) {
        self.send(|commands| commands.quit = true);
        let begun = Instant::now();
        while let Some(thread) = &self.thread
            && !thread.is_finished()
            && begun.elapsed() < SHUTDOWN_TIMEOUT
        {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}
