//! Reading and writing small files beside the window, one after the other: what was saved last is what a file holds.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};

use crate::app::services::export::Ready;
use crate::app::services::library::Listed;
use crate::app::services::messages::Success;
use crate::app::services::snapshots::Pins;
use crate::document::Document;
use crate::panics::caught;
use crate::store::FileError;
use crate::store::exchange::ExchangeError;
use crate::store::library::Entry;
use crate::store::opened::Opened;

/// What came of a job.
pub enum Done {
    /// A file was read; and the files that it names and may not.
    Read(PathBuf, Result<Opened, ExchangeError>, Vec<PathBuf>),
    /// A file for another program is ready to be written.
    Prepared(Box<Result<Ready, String>>),
    /// A material as text for another program, and what to say about it.
    Copied(Result<(String, Success), String>),
    /// The document was written, such as it was then.
    SavedProject(PathBuf, Box<Document>, Result<(), FileError>),
    /// The user's materials were listed.
    Listed(Result<Listed<Vec<Entry>>, FileError>),
    /// The user's materials were changed.
    ChangedLibrary(Result<Listed<Vec<Entry>>, FileError>),
    /// The pinned states were listed.
    ListedPins(Result<Listed<Pins>, FileError>),
    /// The pinned states were changed.
    ChangedPins(Result<Listed<Pins>, FileError>),
    /// Something else was written; what to say about it.
    Wrote(Result<Success, String>),
    /// What was to be done panicked, and what the panic said.
    Broke(Task, String),
}

/// What a job is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    Open,
    List,
    Write,
}

type Job = Box<dyn FnOnce() -> Done + Send>;

/// The thread, and its orders.
pub struct Disk {
    ctx: egui::Context,
    jobs: Sender<(Task, Job)>,
    sender: Sender<Done>,
    done: Receiver<Done>,
    reads: usize,
    writes: usize,
}

impl Disk {
    /// Starts the thread.
    pub fn new(ctx: egui::Context) -> std::io::Result<Self> {
        let (jobs, to_do) = channel::<(Task, Job)>();
        let (sender, done) = channel();
        let (of_thread, repaint) = (sender.clone(), ctx.clone());
        std::thread::Builder::new().name("files".to_owned()).spawn(move || {
            for (task, job) in to_do {
                // Nobody listens where the window was closed meanwhile.
                let _ = of_thread.send(outcome(task, job));
                repaint.request_repaint();
            }
        })?;
        Ok(Self {
            ctx,
            jobs,
            sender,
            done,
            reads: 0,
            writes: 0,
        })
    }

    pub fn open(&mut self, job: impl FnOnce() -> Done + Send + 'static) {
        self.reads += 1;
        self.order(Task::Open, job);
    }

    pub fn list(&mut self, job: impl FnOnce() -> Done + Send + 'static) {
        self.reads += 1;
        self.order(Task::List, job);
    }

    pub fn write(&mut self, job: impl FnOnce() -> Done + Send + 'static) {
        self.writes += 1;
        self.order(Task::Write, job);
    }

    /// Writes something that takes long, on a thread of its own.
    pub fn write_beside(&mut self, work: impl FnOnce() -> Result<Success, String> + Send + 'static) {
        self.writes += 1;
        self.beside(Task::Write, || Done::Wrote(work()));
    }

    /// Makes something that takes long and is shown then, on a thread of its own.
    pub fn open_beside(&mut self, job: impl FnOnce() -> Done + Send + 'static) {
        self.reads += 1;
        self.beside(Task::List, job);
    }

    fn beside(&self, task: Task, job: impl FnOnce() -> Done + Send + 'static) {
        let (sender, ctx) = (self.sender.clone(), self.ctx.clone());
        let body = move || {
            // Nobody listens where the window was closed meanwhile.
            let _ = sender.send(outcome(task, job));
            ctx.request_repaint();
        };
        if let Err(error) = std::thread::Builder::new().name("beside".to_owned()).spawn(body) {
            let why = format!("cannot start a thread: {error}");
            // This end listens.
            let _ = self.sender.send(Done::Broke(task, why));
        }
    }

    fn order(&self, task: Task, job: impl FnOnce() -> Done + Send + 'static) {
        // The thread ends with this.
        let _ = self.jobs.send((task, Box::new(job)));
    }

    /// Whether a file that was asked for has not been read yet.
    pub fn is_reading(&self) -> bool {
        self.reads > 0
    }

    /// Whether something is still to be written.
    pub fn is_writing(&self) -> bool {
        self.writes > 0
    }

    /// What was done since this was last called.
    pub fn take_done(&mut self) -> Vec<Done> {
        let done: Vec<Done> = self.done.try_iter().collect();
        for done in &done {
            match done {
                Done::Read(..)
                | Done::Prepared(_)
                | Done::Copied(_)
                | Done::Listed(_)
                | Done::ListedPins(_)
                | Done::Broke(Task::Open | Task::List, _) => self.reads = self.reads.saturating_sub(1),
                Done::SavedProject(..)
                | Done::ChangedLibrary(_)
                | Done::ChangedPins(_)
                | Done::Wrote(_)
                | Done::Broke(Task::Write, _) => self.writes = self.writes.saturating_sub(1),
            }
        }
        done
    }
}

/// The outcome of a job, panics included: the thread goes on, so that no caller waits for ever.
fn outcome(task: Task, job: impl FnOnce() -> Done) -> Done {
    caught(job).unwrap_or_else(|why| Done::Broke(task, why))
}
