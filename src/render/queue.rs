//! Queue of renders in the background, one after the other, with their own thread and session.

use std::io;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use super::engine::EngineChoice;
use super::error::SessionError;
use super::mailbox::{IDLE, Mailbox};
use super::output::{self, OutputError, Rendered};
use super::session::Session;
use super::step_denoiser::StepDenoiser;
use super::to_end::{step_to_end, submit};
use super::turntable::{self, Turntable, TurntableError};
use crate::compile::Assets;
use crate::document::Document;
use crate::panics::caught;
use crate::store::FileError;
use crate::store::replace::check_saving;

/// Pause of a render while something moves in the window.
const GIVES_WAY: Duration = Duration::from_millis(50);

#[derive(Clone, Debug, PartialEq)]
pub enum Task {
    /// A document as an image of its own size.
    Picture {
        /// Document, rendered at its own size.
        document: Box<Document>,
        /// File of the image.
        path: PathBuf,
    },
    /// A document turned once.
    Turntable(Box<Turntable>),
}

/// State of a task.
#[derive(Clone, Debug, PartialEq)]
pub enum State {
    /// Others are before it.
    Waiting,
    /// The share of it that is done, in [0, 1].
    Rendering(f64),
    /// Finished, with a summary.
    Done(String),
    /// Failed, with the reason.
    Failed(String),
    /// Cancelled by the user, with a summary of its output.
    Cancelled(String),
}

/// A task as it is listed.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Unique id.
    pub id: u64,
    /// Name: its file's, with a number if taken.
    pub name: String,
    /// Whether it waits, renders, or how it ended.
    pub state: State,
}

impl Entry {
    /// Whether it is finished, failed or cancelled.
    pub fn is_over(&self) -> bool {
        !matches!(self.state, State::Waiting | State::Rendering(_))
    }
}

/// The queue and its thread. Dropping it cancels all tasks.
pub struct Queue {
    book: Arc<Mailbox<Book>>,
}

#[derive(Default)]
struct Book {
    entries: Vec<Entry>,
    tasks: Vec<(u64, Task, EngineChoice)>,
    /// Ends of tasks not yet reported.
    news: Vec<Result<String, String>>,
    last_id: u64,
    /// The task under way is to end.
    is_cancelled: bool,
    is_paused: bool,
    /// Something moves in the window.
    gives_way: bool,
    quits: bool,
}

/// Errors of a task.
#[derive(Debug, thiserror::Error)]
enum TaskError {
    #[error(transparent)]
    Session(#[from] SessionError),
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Output(#[from] OutputError),
    #[error(transparent)]
    Turntable(#[from] TurntableError),
}

impl Mailbox<Book> {
    /// The next task, once there is one; `None` when it is time to go.
    fn next(&self) -> Option<(u64, Task, EngineChoice)> {
        self.wait(|book| {
            if book.quits {
                return ControlFlow::Break(None);
            }
            if book.is_paused || book.tasks.is_empty() {
                return ControlFlow::Continue(IDLE);
            }
            let next = book.tasks.remove(0);
            book.is_cancelled = false;
            book.set(next.0, State::Rendering(0.0));
            ControlFlow::Break(Some(next))
        })
    }

    /// Reports a task's progress, and waits while paused. Returns false if it is cancelled.
    fn report(&self, id: u64, share: f64) -> bool {
        let mut has_rested = false;
        self.wait(|book| {
            book.set(id, State::Rendering(share));
            let is_over = book.is_cancelled || book.quits;
            if book.gives_way && !std::mem::replace(&mut has_rested, true) {
                return ControlFlow::Continue(GIVES_WAY);
            }
            if book.is_paused && !is_over {
                return ControlFlow::Continue(IDLE);
            }
            ControlFlow::Break(!is_over)
        })
    }

    fn end(&self, id: u64, ended: Result<String, String>) {
        let mut book = self.look();
        let state = match &ended {
            Ok(words) if book.is_cancelled => State::Cancelled(words.clone()),
            Ok(words) => State::Done(words.clone()),
            Err(why) => State::Failed(why.clone()),
        };
        book.set(id, state);
        book.news.push(ended);
    }
}

impl Book {
    fn set(&mut self, id: u64, state: State) {
        if let Some(entry) = self.entries.iter_mut().find(|entry| entry.id == id) {
            entry.state = state;
        }
    }
}

impl Queue {
    /// An empty queue; models and environments are shared. `repaint` is called when there is something new to show.
    pub fn new(assets: Assets, repaint: impl Fn() + Send + 'static) -> io::Result<Self> {
        let book = Arc::new(Mailbox::<Book>::default());
        let of_thread = book.clone();
        std::thread::Builder::new().name("queue".to_owned()).spawn(move || {
            super::priority::lower_thread_priority();
            let mut session: Option<(EngineChoice, Session)> = None;
            while let Some((id, task, engine)) = of_thread.next() {
                repaint();
                let mut on_progress = |share: f64| {
                    let continues = of_thread.report(id, share);
                    repaint();
                    continues
                };
                let rendered = caught(|| {
                    let session = opened(&mut session, engine, &assets)?;
                    render(session, engine, &task, &mut on_progress)
                });
                let ended = match rendered {
                    Ok(Ok(words)) => Ok(words),
                    Ok(Err(error)) => Err(error.to_string()),
                    Err(why) => {
                        // A session that panicked is not used again.
                        session = None;
                        Err(format!("an internal error: {why}"))
                    }
                };
                of_thread.end(id, ended);
                if of_thread.look().tasks.is_empty() {
                    // An engine's memory is the viewport's again.
                    session = None;
                }
                repaint();
            }
        })?;
        Ok(Self { book })
    }

    /// Appends a task, to be rendered by an engine.
    pub fn add(&self, task: Task, engine: EngineChoice) {
        self.book.change(|book| {
            book.last_id += 1;
            let (id, name) = (book.last_id, free_name(&book.entries, &task.name()));
            book.entries.push(Entry {
                id,
                name,
                state: State::Waiting,
            });
            book.tasks.push((id, task, engine));
        });
    }

    /// All tasks, in order.
    pub fn entries(&self) -> Vec<Entry> {
        self.book.look().entries.clone()
    }

    /// Results of tasks that ended since the last call: summaries or errors.
    pub fn take_news(&self) -> Vec<Result<String, String>> {
        std::mem::take(&mut self.book.look().news)
    }

    /// Whether tasks are waiting or under way.
    pub fn is_busy(&self) -> bool {
        self.book.look().entries.iter().any(|entry| !entry.is_over())
    }

    /// Cancels a task, or removes it from the list once it has ended.
    pub fn remove(&self, id: u64) {
        let is_rendering = |entry: &Entry| entry.id == id && matches!(entry.state, State::Rendering(_));
        self.book.change(|book| {
            if book.entries.iter().any(is_rendering) {
                book.is_cancelled = true;
            } else {
                book.entries.retain(|entry| entry.id != id);
                book.tasks.retain(|(of, ..)| *of != id);
            }
        });
    }

    /// Removes ended tasks.
    pub fn remove_over(&self) {
        self.book.look().entries.retain(|entry| !entry.is_over());
    }

    /// Moves a waiting task to the front.
    pub fn put_first(&self, id: u64) {
        let mut book = self.book.look();
        if let Some(from) = book.tasks.iter().position(|(of, ..)| *of == id) {
            book.tasks[..=from].rotate_right(1);
        }
        let is_waiting = |entry: &Entry| entry.state == State::Waiting;
        let first = book.entries.iter().position(is_waiting);
        let from = book
            .entries
            .iter()
            .position(|entry| entry.id == id && is_waiting(entry));
        if let (Some(first), Some(from)) = (first, from) {
            book.entries[first..=from].rotate_right(1);
        }
    }

    /// Pauses or resumes rendering.
    pub fn pause(&self, is_paused: bool) {
        self.book.change(|book| book.is_paused = is_paused);
    }

    /// Whether it was stopped.
    pub fn is_paused(&self) -> bool {
        self.book.look().is_paused
    }

    /// Yields most of the time to the window, or stops yielding.
    pub fn give_way(&self, gives_way: bool) {
        self.book.look().gives_way = gives_way;
    }
}

impl Drop for Queue {
    fn drop(&mut self) {
        self.book.change(|book| book.quits = true);
    }
}

impl Task {
    /// Name of its output.
    fn name(&self) -> String {
        let path = match self {
            Self::Picture { path, .. } => Some(path),
            Self::Turntable(table) => table.video.as_ref().or(table.folder.as_ref()),
        };
        let name = path.and_then(|path| path.file_name()).unwrap_or_default();
        name.to_string_lossy().into_owned()
    }
}

/// A unique name: with a number if taken.
fn free_name(entries: &[Entry], name: &str) -> String {
    let numbered = (2..).map(|number| format!("{name} ({number})"));
    let mut names = std::iter::once(name.to_owned()).chain(numbered);
    let is_free = |name: &String| entries.iter().all(|entry| entry.name != *name);
    names.find(is_free).unwrap_or_default()
}

/// The session for an engine: the one that is there, unless it has another.
fn opened<'a>(
    session: &'a mut Option<(EngineChoice, Session)>,
    engine: EngineChoice,
    assets: &Assets,
) -> Result<&'a mut Session, SessionError> {
    if session.as_ref().is_none_or(|(choice, _)| *choice != engine) {
        *session = None;
    }
    Ok(match session {
        Some((_, session)) => session,
        None => &mut session.insert((engine, Session::open_with(engine, assets.clone())?)).1,
    })
}

/// Renders a task and returns its summary.
fn render(
    session: &mut Session,
    engine: EngineChoice,
    task: &Task,
    on_progress: &mut dyn FnMut(f64) -> bool,
) -> Result<String, TaskError> {
    match task {
        Task::Picture { document, path } => picture(session, engine, document, path, on_progress),
        Task::Turntable(table) => {
            let outcome = turntable::render(session, engine, table, &mut |progress| {
                on_progress((f64::from(progress.done) + progress.share) / f64::from(table.frames.max(1)))
            })?;
            Ok(summary(table, outcome.frames))
        }
    }
}

fn picture(
    session: &mut Session,
    engine: EngineChoice,
    document: &Document,
    path: &Path,
    on_progress: &mut dyn FnMut(f64) -> bool,
) -> Result<String, TaskError> {
    output::format_of(path)?;
    check_saving(path)?;
    submit(session, engine, document)?;
    let limit_s = document.render.time_s;
    let mut step_denoiser = StepDenoiser::new(document);
    let ended = step_to_end(session, engine, document, &mut step_denoiser, &mut |progress| {
        on_progress(progress.share_done(limit_s))
    })?;
    if !ended.progress.is_done {
        return Ok(format!("{} cancelled: nothing was written", path.display()));
    }
    let (image, lights) = (session.image()?, session.light_layers()?);
    let rendered = Rendered {
        lights: &lights,
        denoised: ended.denoised.as_ref().map(|denoised| denoised.image.as_ref()),
        ..Rendered::from(&image)
    };
    output::write(path, rendered, document)?;
    let [samples, seconds] = [ended.progress.mean_samples, ended.progress.render_seconds];
    let path = path.display();
    Ok(format!(
        "rendered {path}: {samples:.0} samples per pixel in {seconds:.1} s"
    ))
}

/// The outcome of a turntable, by the number of frames rendered.
fn summary(table: &Turntable, frames: u32) -> String {
    let is_whole = frames >= table.frames;
    let all = match is_whole {
        true => format!("turntable: {frames} frames"),
        false => format!("turntable cancelled: {frames} of {} frames", table.frames),
    };
    let folder = table.folder.as_ref().map(|folder| folder.display().to_string());
    let video = table.video.as_ref().filter(|_| is_whole);
    let places: Vec<String> = folder
        .into_iter()
        .chain(video.map(|video| video.display().to_string()))
        .collect();
    match places[..] {
        [] => all,
        _ => format!("{all} in {}", places.join(" and ")),
    }
}
