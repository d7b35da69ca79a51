//! A session on a thread of its own, so that the window never waits.
//!
//! The window submits documents, the latest wins; the worker publishes snapshots, the latest wins. What the two say to
//! each other goes through two short locks. Work is cut into steps of [`STEP`], after each of which orders are read.

mod denoising;
mod stage;
mod thread;

use std::io;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::assets::Assets;
use super::convergence::Measurement;
use super::engine::{EngineChoice, EngineInfo};
use super::output::{Layers, Rendered};
use super::priority::lower_thread_priority;
use super::progress::Progress;
use super::session::Session;
use super::shown::{Facts, Scale, Shown};
use crate::analysis::halves::Distance;
use crate::document::Document;
use crate::gpu::Moment;
use crate::job::Job;
use crate::job::film::Image;
use crate::scene::environment::{Environment, EnvironmentSource};
use crate::scene::{Loading, Model, ModelOptions, ModelSource};

/// Longest that the worker does not look at its orders while rendering; and before the first picture, which is not to
/// wait for the samples that come after it.
const STEP: Duration = Duration::from_millis(20);
const FIRST_STEP: Duration = Duration::from_millis(6);
/// How long dropping a worker waits for its thread to end.
const FAREWELL: Duration = Duration::from_secs(2);

/// Renders on a thread of its own.
pub struct Worker {
    shared: Arc<Shared>,
    assets: Assets,
    /// Models and environments that were asked for and whose events have not been taken.
    opening: AtomicUsize,
    thread: Option<JoinHandle<()>>,
}

/// Whether more edits are about to follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// More changes follow at once, as while something is dragged: rendered at a resolution that keeps up, and at the
    /// full one once nothing has come for 150 ms.
    Moving,
    /// No further change is expected for now.
    Still,
}

/// What the worker is doing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Activity {
    /// Opening the adapter and compiling what every picture needs.
    #[default]
    Starting,
    /// Reading a file or computing a built-in.
    Loading(String),
    /// Building the hierarchy over the triangles, and what the engine wants to have made ready.
    Preparing,
    /// Rendering.
    Rendering,
    /// Everything asked for has been rendered.
    Done,
    /// Told to wait.
    Paused,
    /// There is nothing to render, as the document could not be.
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

/// A picture to show.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green, blue and alpha as the screen takes them, premultiplied in gamma space; row by row from the top.
    pub rgba: Vec<u8>,
    /// The linear picture that it shows.
    pub image: Arc<Image>,
    /// The mean of the samples: another one where the picture was denoised.
    pub samples: Arc<Image>,
    /// Differs from one picture to the next.
    pub serial: u64,
    /// The submission that it belongs to, see [`Worker::submit`].
    pub revision: u64,
    /// By how much width and height are smaller than asked for; 1 is the full resolution.
    pub reduction: u32,
    /// Samples a pixel in it.
    pub samples_per_pixel: u32,
    /// What `rgba` is a map of, with its colours' meaning where they stand for numbers; `None` for the picture itself.
    pub map: Option<(Shown, Option<Scale>)>,
    /// Per-pixel quantities, while the inspector is open.
    pub facts: Option<Arc<Facts>>,
    /// What it shows, with the size at the full resolution.
    pub document: Arc<Document>,
}

impl Picture {
    /// Whether its noise was taken out.
    pub fn is_denoised(&self) -> bool {
        !Arc::ptr_eq(&self.image, &self.samples)
    }

    /// As it is written to files.
    pub fn rendered(&self) -> Rendered<'_> {
        Rendered {
            denoised: self.is_denoised().then_some(&*self.image),
            ..Rendered::from(&*self.samples)
        }
    }
}

/// What is being rendered.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The document as submitted.
    pub document: Arc<Document>,
    /// What it compiled to.
    pub job: Arc<Job>,
    /// Its model.
    pub model: Arc<Model>,
}

/// The state of the worker at some moment.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// The latest picture.
    pub picture: Option<Arc<Picture>>,
    /// What it shows.
    pub scene: Option<Arc<Scene>>,
    /// How far it has come.
    pub progress: Progress,
    /// The errors seen so far in it, oldest first.
    pub history: Arc<Vec<Measurement>>,
    /// Pixel samples a second.
    pub samples_per_second: f64,
    /// By how much the picture in progress is smaller than asked for.
    pub reduction: u32,
    /// What the worker is doing.
    pub activity: Activity,
    /// What renders; `None` while it is being opened.
    pub engine: Option<EngineInfo>,
    /// The error of the denoised picture.
    pub denoised: Option<Distance>,
    /// From the latest submission to its first picture.
    pub first_picture: Option<Duration>,
    /// What is being done while something is loaded or made ready.
    pub loading: Loading,
}

/// How bad a message is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// For the record.
    Info,
    /// Something was mended or left out.
    Warning,
    /// Something was not done.
    Error,
}

/// What the worker has to tell.
#[derive(Clone, Debug)]
pub enum Event {
    /// Words for the user.
    Message(Level, String),
    /// A model that was asked for by [`Worker::open_model`]; the document has not been touched.
    ModelOpened(ModelSource, ModelOptions, Arc<Model>),
    /// An environment that was asked for by [`Worker::open_environment`].
    EnvironmentOpened(EnvironmentSource, Arc<Environment>),
    /// What was asked for by [`Worker::reload`]: the model as it was, where it is known, and as it is; nothing where
    /// nothing is rendered.
    Reloaded(Option<Arc<Model>>, Option<Arc<Model>>),
    /// A file that could not be opened, and why.
    OpenFailed(PathBuf, Level, String),
    /// What was asked for is not wanted any more.
    Cancelled,
    /// What was asked for by [`Worker::make_layers`], for this file.
    LayersMade(PathBuf, Box<Layers>),
}

/// Faults of the GPU's device that tests inject.
#[derive(Clone, Copy, Debug)]
enum Mishap {
    /// It is lost at this moment, this many times in all.
    Lost(Moment, u32),
    /// Buffers larger than this many bytes are refused.
    Limited(u64),
}

impl Mishap {
    fn befall(self, session: &mut Session) {
        match self {
            Self::Lost(moment, times) => session.lose_when(moment, times),
            Self::Limited(bytes) => session
                .device()
                .into_iter()
                .for_each(|device| device.limit_buffers(bytes)),
        }
    }
}

/// What the window wants.
#[derive(Debug, Default)]
struct Orders {
    submission: Option<Submission>,
    models: Vec<(ModelSource, ModelOptions)>,
    environments: Vec<EnvironmentSource>,
    layers: Vec<PathBuf>,
    engine: Option<EngineChoice>,
    shown: Option<Shown>,
    looks_closer: Option<bool>,
    reloads: u32,
    restart: bool,
    mishaps: Vec<Mishap>,
    quit: bool,
}

impl Orders {
    fn is_empty_beside_submission(&self) -> bool {
        self.models.is_empty()
            && self.environments.is_empty()
            && self.layers.is_empty()
            && self.engine.is_none()
            && self.shown.is_none()
            && self.looks_closer.is_none()
            && self.reloads == 0
            && !self.restart
            && self.mishaps.is_empty()
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
    orders: Mutex<OrderBook>,
    ordered: Condvar,
    snapshot: Mutex<Arc<Snapshot>>,
    events: Mutex<Vec<Event>>,
}

#[derive(Default)]
struct OrderBook {
    orders: Orders,
    is_paused: bool,
    last_revision: u64,
}

impl Shared {
    /// Wakes the thread. It holds the lock while it decides to wait, so that no wake-up is lost.
    fn wake(&self) {
        let _orders = lock(&self.orders);
        self.ordered.notify_one();
    }
}

/// What a panicking thread leaves behind a lock here is still whole: every write is a single assignment or push.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Worker {
    /// Starts the thread, which opens the engine; `repaint` is called when there is something new to show.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn spawn(choice: EngineChoice, repaint: impl Fn() + Send + 'static) -> io::Result<Self> {
        Self::spawn_with(choice, Assets::default(), repaint)
    }

    /// Starts another one that shares models and environments with this one.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn spawn_beside(&self, choice: EngineChoice, repaint: impl Fn() + Send + 'static) -> io::Result<Self> {
        Self::spawn_with(choice, self.assets.clone(), repaint)
    }

    /// The models and environments that it keeps, to be shared.
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

    /// Submits a document to render instead of the last one; returns its revision, which its pictures carry.
    pub fn submit(&self, document: &Document, pace: Pace) -> u64 {
        let mut book = lock(&self.shared.orders);
        book.last_revision += 1;
        let revision = book.last_revision;
        book.orders.submission = Some(Submission {
            document: Arc::new(document.clone()),
            pace,
            revision,
            at: Instant::now(),
        });
        self.shared.ordered.notify_one();
        revision
    }

    /// Stops rendering until told otherwise; submissions are still taken and shown at their first sample.
    pub fn pause(&self, is_paused: bool) {
        lock(&self.shared.orders).is_paused = is_paused;
        self.shared.ordered.notify_one();
    }

    /// Loads a model beside everything else; an [`Event`] tells how it went.
    pub fn open_model(&self, source: ModelSource, options: ModelOptions) {
        self.opening.fetch_add(1, Relaxed);
        self.order(|orders| orders.models.push((source, options)));
    }

    /// Loads an environment beside everything else; an [`Event`] tells how it went.
    pub fn open_environment(&self, source: EnvironmentSource) {
        self.opening.fetch_add(1, Relaxed);
        self.order(|orders| orders.environments.push(source));
    }

    /// Makes the picture's layers as soon as it has samples at its full resolution; an [`Event`] brings them, with the
    /// file that they are for.
    pub fn make_layers(&self, path: PathBuf) {
        self.order(|orders| orders.layers.push(path));
    }

    /// Reads the files of what is rendered again; an [`Event`] tells how it went. Where they cannot be read, what is
    /// rendered goes on.
    pub fn reload(&self) {
        self.opening.fetch_add(1, Relaxed);
        self.order(|orders| orders.reloads += 1);
    }

    /// Renders the picture from the start.
    pub fn restart(&self) {
        self.order(|orders| orders.restart = true);
    }

    /// Takes the GPU's device away at a moment to come, and so many times in all those that replace it, as a driver's reset
    /// does: for tests of what follows. Nothing on the processor.
    pub fn lose_device(&self, moment: Moment, times: u32) {
        self.order(|orders| orders.mishaps.push(Mishap::Lost(moment, times)));
    }

    /// Has the GPU refuse buffers above a size, as a small adapter does: for tests of what follows.
    pub fn limit_buffers(&self, bytes: u64) {
        self.order(|orders| orders.mishaps.push(Mishap::Limited(bytes)));
    }

    /// Goes on with another engine.
    pub fn use_engine(&self, choice: EngineChoice) {
        self.order(|orders| orders.engine = Some(choice));
    }

    /// Shows the picture or a map of its error or samples; what has been rendered stays.
    pub fn show(&self, shown: Shown) {
        self.order(|orders| orders.shown = Some(shown));
    }

    /// Has pictures tell what is known of each pixel, or no more.
    pub fn look_closer(&self, looks_closer: bool) {
        self.order(|orders| orders.looks_closer = Some(looks_closer));
    }

    /// Calls off what is being loaded or made ready; what is rendered goes on.
    pub fn cancel_loading(&self) {
        self.loading().cancel();
    }

    /// What is being loaded for the window.
    pub fn loading(&self) -> &Loading {
        self.assets.loading()
    }

    fn order(&self, change: impl FnOnce(&mut Orders)) {
        change(&mut lock(&self.shared.orders).orders);
        self.shared.ordered.notify_one();
    }

    /// The latest state.
    pub fn snapshot(&self) -> Arc<Snapshot> {
        lock(&self.shared.snapshot).clone()
    }

    /// What happened since this was last called.
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
    /// Asks the thread to end, and leaves it behind where that takes long, as when it is reading a large file.
    fn drop(&mut self) {
        self.order(|orders| orders.quit = true);
        let begun = Instant::now();
        while let Some(thread) = &self.thread
            && !thread.is_finished()
            && begun.elapsed() < FAREWELL
        {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}
