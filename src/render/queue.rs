//! Queue of renders in the background, one after the other, with their own thread and session.

use std::{io, path::Path, path::PathBuf, sync::Arc, sync::Mutex, thread::Thread, time::Duration, time::Instant};

use super::{
    engine::EngineChoice,
    output,
    session::Session,
    step_denoiser::StepDenoiser,
    to_end::{step_to_end, submit},
    turntable,
    turntable::Turntable,
};
use crate::{compile::Assets, document::Document, panics::caught, panics::lock, store::replace::check_saving};

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

/// Progress of a task.
#[derive(Clone, Debug, PartialEq)]
pub enum TaskState {
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
pub struct QueuedTask {
    /// Unique id.
    pub id: u64,
    /// Name: its file's, with a number if taken.
    pub name: String,
    /// Whether it waits, renders, or how it ended.
    pub state: TaskState,
    /// When it was added, or began to render.
    pub since: Instant,
}

impl QueuedTask {
    /// Whether it is finished, failed or cancelled.
    pub fn is_over(&self) -> bool {
        !matches!(self.state, TaskState::Waiting | TaskState::Rendering(_))
    }
}

/// The queue and its thread. Dropping it cancels all tasks.
pub struct Queue {
    book: Arc<Mutex<Book>>,
    thread: Thread,
}

#[derive(Default)]
struct Book {
    /// Those that wait with what they are to do.
    entries: Vec<(QueuedTask, Option<Order>)>,
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

type Order = (Task, EngineChoice);

impl Book {
    /// The next task, if there is one and it may begin.
    fn next(&mut self) -> Option<(u64, Order)> {
        let mut waiting = self.entries.iter_mut().filter(|_| !self.is_paused);
        let (entry, order) = waiting.find(|(_, order)| order.is_some())?;
        (entry.state, entry.since) = (TaskState::Rendering(0.0), Instant::now());
        self.is_cancelled = false;
        Some((entry.id, order.take()?))
    }

    fn set(&mut self, id: u64, state: TaskState) {
        if let Some((entry, _)) = self.entries.iter_mut().find(|(entry, _)| entry.id == id) {
            entry.state = state;
        }
    }

    fn end(&mut self, id: u64, ended: Result<String, String>) {
        let state = match ended.clone() {
            Ok(words) if self.is_cancelled => TaskState::Cancelled(words),
            Ok(words) => TaskState::Done(words),
            Err(why) => TaskState::Failed(why),
        };
        self.set(id, state);
        self.news.push(ended);
    }
}

/// Waits for what `take` takes of the book; `None` when it is time to go.
fn wait<R>(book: &Mutex<Book>, mut take: impl FnMut(&mut Book) -> Option<R>) -> Option<R> {
    loop {
        let mut now = lock(book);
        if now.quits {
            return None;
        }
        if let Some(taken) = take(&mut now) {
            return Some(taken);
        }
        drop(now);
        std::thread::park();
    }
}

/// Reports a task's progress, and waits while paused. Returns false if it is cancelled.
fn report(book: &Mutex<Book>, id: u64, share: f64) -> bool {
    lock(book).set(id, TaskState::Rendering(share));
    if lock(book).gives_way {
        std::thread::sleep(GIVES_WAY);
    }
    let goes_on = |book: &mut Book| (book.is_cancelled || !book.is_paused).then_some(!book.is_cancelled);
    wait(book, goes_on).unwrap_or(false)
}

impl Queue {
    /// An empty queue; models and environments are shared. `repaint` is called when there is something new to show.
    pub fn new(assets: Assets, repaint: impl Fn() + Send + 'static) -> io::Result<Self> {
        let book = Arc::new(Mutex::<Book>::default());
        let of_thread = book.clone();
        let thread = std::thread::Builder::new().name("queue".to_owned()).spawn(move || {
            super::priority::lower_thread_priority();
            let mut kept: Option<(EngineChoice, Session)> = None;
            while let Some((id, (task, engine))) = wait(&of_thread, Book::next) {
                repaint();
                let mut on_progress = |share: f64| {
                    let continues = report(&of_thread, id, share);
                    repaint();
                    continues
                };
                // A session that panicked is not used again.
                let session = kept.take().filter(|(choice, _)| *choice == engine);
                let rendered = caught(|| {
                    let session = match session {
                        Some((_, session)) => session,
                        None => Session::open_with(engine, assets.clone())?,
                    };
                    let (_, session) = kept.insert((engine, session));
                    render(session, engine, &task, &mut on_progress)
                });
                let ended = match rendered {
                    Ok(ended) => ended.map_err(crate::in_words),
                    Err(why) => {
                        kept = None;
                        Err(format!("an internal error: {why}"))
                    }
                };
                let mut book = lock(&of_thread);
                book.end(id, ended);
                if book.entries.iter().all(|(entry, _)| entry.is_over()) {
                    // An engine's memory is the viewport's again.
                    kept = None;
                }
                drop(book);
                repaint();
            }
        })?;
        let thread = thread.thread().clone();
        Ok(Self { book, thread })
    }

    /// Changes the book and wakes the thread.
    fn change(&self, change: impl FnOnce(&mut Book)) {
        change(&mut lock(&self.book));
        self.thread.unpark();
    }

    /// Appends a task, to be rendered by an engine.
    pub fn add(&self, task: Task, engine: EngineChoice) {
        self.change(|book| {
            book.last_id += 1;
            let entry = QueuedTask {
                since: Instant::now(),
                id: book.last_id,
                name: free_name(&book.entries, &task.name()),
                state: TaskState::Waiting,
            };
            book.entries.push((entry, Some((task, engine))));
        });
    }

    /// All tasks, in order.
    pub fn entries(&self) -> Vec<QueuedTask> {
        lock(&self.book)
            .entries
            .iter()
            .map(|(entry, _)| entry.clone())
            .collect()
    }

    /// Results of tasks that ended since the last call: summaries or errors.
    pub fn take_news(&self) -> Vec<Result<String, String>> {
        std::mem::take(&mut lock(&self.book).news)
    }

    /// Whether tasks are waiting or under way.
    pub fn is_busy(&self) -> bool {
        lock(&self.book).entries.iter().any(|(entry, _)| !entry.is_over())
    }

    /// Cancels a task, or removes it from the list once it has ended.
    pub fn remove(&self, id: u64) {
        let is_rendering = |entry: &QueuedTask| entry.id == id && matches!(entry.state, TaskState::Rendering(_));
        self.change(|book| {
            if book.entries.iter().any(|(entry, _)| is_rendering(entry)) {
                book.is_cancelled = true;
            } else {
                book.entries.retain(|(entry, _)| entry.id != id);
            }
        });
    }

    /// Removes ended tasks.
    pub fn remove_over(&self) {
        self.change(|book| book.entries.retain(|(entry, _)| !entry.is_over()));
    }

    /// Moves a waiting task to the front.
    pub fn put_first(&self, id: u64) {
        self.change(|book| {
            let waiting = |entry: &(QueuedTask, Option<Order>)| entry.1.is_some();
            let first = book.entries.iter().position(waiting);
            let from = book.entries.iter().position(|entry| entry.0.id == id && waiting(entry));
            if let (Some(first), Some(from)) = (first, from) {
                book.entries[first..=from].rotate_right(1);
            }
        });
    }

    /// Pauses or resumes rendering.
    pub fn pause(&self, is_paused: bool) {
        self.change(|book| book.is_paused = is_paused);
    }

    /// Whether it was stopped.
    pub fn is_paused(&self) -> bool {
        lock(&self.book).is_paused
    }

    /// Yields most of the time to the window, or stops yielding.
    pub fn give_way(&self, gives_way: bool) {
        self.change(|book| book.gives_way = gives_way);
    }
}

impl Drop for Queue {
    fn drop(&mut self) {
        self.change(|book| book.quits = true);
    }
}

impl Task {
    /// Name of its output.
    fn name(&self) -> String {
        let path = match self {
            Self::Picture { path, .. } => Some(path),
            Self::Turntable(table) => table.video.as_ref().or(table.folder.as_ref()),
        };
        path.and_then(|path| path.file_name())
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned()
    }
}

/// A unique name: with a number if taken.
fn free_name(entries: &[(QueuedTask, Option<Order>)], name: &str) -> String {
    let numbered = (2..).map(|number| format!("{name} ({number})"));
    let mut names = std::iter::once(name.to_owned()).chain(numbered);
    names
        .find(|name| entries.iter().all(|(entry, _)| entry.name != *name))
        .unwrap_or_default()
}

/// Renders a task and returns its summary.
fn render(
    session: &mut Session,
    engine: EngineChoice,
    task: &Task,
    on_progress: &mut dyn FnMut(f64) -> bool,
) -> anyhow::Result<String> {
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
) -> anyhow::Result<String> {
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
    let denoised = ended.denoised.as_ref().map(|denoised| denoised.image.as_ref());
    session.write_image(path, denoised, document)?;
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
