//! A session on a thread of its own, so that the window never waits.
//!
//! The window sends orders and the worker publishes snapshots; the latest submission and snapshot win. Work is cut into steps
//! of 20 ms, and orders are executed after each.

mod denoising;
mod picture;
mod stage;
mod thread;

use std::{
    io,
    path::PathBuf,
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering::Relaxed},
        mpsc::{Receiver, Sender, channel},
    },
    thread::JoinHandle,
    time::{Duration, Instant},
};

pub use picture::Picture;
use thread::State;

use super::{
    convergence::Measurement,
    engine::{EngineChoice, EngineInfo},
    output::Layers,
    priority::lower_thread_priority,
    progress::Progress,
    session::Session,
    shown::Shown,
};
use crate::{
    analysis::halves::Distance,
    compile::Assets,
    document::Document,
    gpu::Moment,
    job::Job,
    panics::lock,
    scene::{
        Loading, Model, ModelOptions, ModelSource,
        environment::{Environment, EnvironmentSource},
    },
};

/// Time for which dropping a worker waits for its thread.
const SHUTDOWN_TIMEOUT: Duration = Duration::from_secs(2);

/// Renders on a thread of its own.
pub struct Worker {
    orders: Sender<Order>,
    shared: Arc<Shared>,
    assets: Assets,
    /// Requested models and environments whose events have not been taken.
    opening: AtomicUsize,
    last_revision: AtomicU64,
    thread: JoinHandle<()>,
}

/// What the thread is to do before its next step.
type Order = Box<dyn FnOnce(&mut State<'_>) + Send>;

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

/// The layers of an image, the progress of the render at that moment, and the divisor of width and height.
pub type LayersMade = (Box<Layers>, Progress, u32);

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
    snapshot: Mutex<Arc<Snapshot>>,
    events: Mutex<Vec<Event>>,
    /// The thread is to end.
    is_over: AtomicBool,
}

impl Worker {
    /// Starts the thread, which opens the engine and calls `repaint` when there is something new to show.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn spawn(choice: EngineChoice, repaint: impl Fn() + Send + 'static) -> io::Result<Self> {
        Self::spawn_with(choice, Assets::default(), repaint)
    }

    /// The loaded models and environments, to be shared.
    pub fn assets(&self) -> &Assets {
        &self.assets
    }

    /// The same with assets that may be shared with other workers and sessions.
    pub fn spawn_with(choice: EngineChoice, assets: Assets, repaint: impl Fn() + Send + 'static) -> io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let (orders, received) = channel();
        let (of_thread, its_assets, to_itself) = (shared.clone(), assets.clone(), orders.clone());
        let thread = std::thread::Builder::new().name("render".to_owned()).spawn(move || {
            lower_thread_priority();
            let mut state = State::new(&of_thread, &repaint, its_assets, to_itself);
            state.open(choice);
            while state.run_once(&received) {}
        })?;
        Ok(Self {
            orders,
            shared,
            assets,
            opening: AtomicUsize::new(0),
            last_revision: AtomicU64::new(0),
            thread,
        })
    }

    /// Submits a document to render instead of the last one. Returns its revision, which its images carry.
    pub fn submit(&self, document: &Document, pace: Pace) -> u64 {
        let revision = self.last_revision.fetch_add(1, Relaxed) + 1;
        let submission = Submission {
            document: Arc::new(document.clone()),
            pace,
            revision,
            at: Instant::now(),
        };
        self.order(|state| state.submitted = Some(submission));
        revision
    }

    /// Pauses or resumes rendering. Submissions are still shown with their first sample while paused.
    pub fn pause(&self, is_paused: bool) {
        self.order(move |state| state.is_paused = is_paused);
    }

    /// Loads a model in the background; an [`Event`] reports the result.
    pub fn open_model(&self, source: ModelSource, options: ModelOptions) {
        self.opening.fetch_add(1, Relaxed);
        self.order(|state| state.load_model(source, options));
    }

    /// Loads an environment in the background; an [`Event`] reports the result.
    pub fn open_environment(&self, source: EnvironmentSource) {
        self.opening.fetch_add(1, Relaxed);
        self.order(|state| state.load_environment(source));
    }

    /// Makes the layers of the document submitted last, as soon as it has samples at full resolution, or where another one
    /// replaces it before. The channel closes without them where nothing can be rendered.
    pub fn make_layers(&self) -> Receiver<LayersMade> {
        let (sender, made) = channel();
        let revision = self.last_revision.load(Relaxed);
        self.order(move |state| state.requested_layers.push((revision, sender)));
        made
    }

    /// Carries later orders out once a channel is closed, or after 2 s.
    pub fn wait_for(&self, done: Receiver<()>) {
        self.order(move |_| {
            let _ = done.recv_timeout(SHUTDOWN_TIMEOUT);
        });
    }

    /// Reads the scene's files again; an [`Event`] reports the result. If they cannot be read, the current render continues.
    pub fn reload(&self) {
        self.opening.fetch_add(1, Relaxed);
        self.order(|state| state.reload());
    }

    /// Restarts the render.
    pub fn restart(&self) {
        self.order(|state| state.start_over());
    }

    /// Injects losses of the GPU's device, as by a driver's reset: at `moment`, and `times` in all. No effect on the CPU
    /// engine. For tests.
    pub fn lose_device(&self, moment: Moment, times: u32) {
        self.order(move |state| {
            state
                .session
                .iter_mut()
                .for_each(|session| session.lose_when(moment, times))
        });
    }

    /// Makes the GPU refuse buffers above a size in bytes, as a small adapter does. For tests.
    pub fn limit_buffers(&self, bytes: u64) {
        self.order(move |state| {
            let device = state.session.as_ref().and_then(Session::device);
            device.into_iter().for_each(|device| device.limit_buffers(bytes));
        });
    }

    /// Switches to another engine.
    pub fn use_engine(&self, choice: EngineChoice) {
        self.order(move |state| {
            state.open(choice);
            state.restart();
        });
    }

    /// Shows the image, or a map of its error or samples; the render continues.
    pub fn show(&self, shown: Shown) {
        self.order(move |state| {
            state.shown = shown;
            state.republish();
        });
    }

    /// Turns per-pixel quantities ([`Picture::facts`]) on or off.
    pub fn set_inspected(&self, is_inspected: bool) {
        self.order(move |state| {
            state.is_inspected = is_inspected;
            state.republish();
        });
    }

    /// Progress of loading for the window.
    pub fn loading(&self) -> &Loading {
        self.assets.loading()
    }

    fn order(&self, order: impl FnOnce(&mut State<'_>) + Send + 'static) {
        // The thread lasts as long as this.
        let _ = self.orders.send(Box::new(order));
    }

    /// The latest snapshot.
    pub fn snapshot(&self) -> Arc<Snapshot> {
        lock(&self.shared.snapshot).clone()
    }

    /// The events since the last call.
    pub fn take_events(&self) -> Vec<Event> {
        let events = std::mem::take(&mut *lock(&self.shared.events));
        self.opening.fetch_sub(
            events
                .iter()
                .filter(|event| {
                    matches!(
                        event,
                        Event::ModelOpened(..)
                            | Event::EnvironmentOpened(..)
                            | Event::OpenFailed(..)
                            | Event::Reloaded(..)
                    )
                })
                .count(),
            Relaxed,
        );
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
        self.shared.is_over.store(true, Relaxed);
        self.order(|_| ());
        let begun = Instant::now();
        while !self.thread.is_finished() && begun.elapsed() < SHUTDOWN_TIMEOUT {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}
