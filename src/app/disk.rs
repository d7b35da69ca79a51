//! Reading and writing small files beside the window, one after the other: what was saved last is what a file holds.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};

use super::library::Listed;
use super::snapshots::PinsListed;
use crate::document::Document;
use crate::render::worker::Level;
use crate::store::FileError;
use crate::store::file::Opened;

/// What came of a job.
pub(super) enum Done {
    /// A file was read.
    Read(PathBuf, Result<Opened, FileError>),
    /// The document was written, such as it was then.
    SavedProject(PathBuf, Box<Document>, Result<(), FileError>),
    /// The user's materials were listed.
    Listed(Result<Listed, FileError>),
    /// The user's materials were changed.
    ChangedLibrary(Result<Listed, FileError>),
    /// The pinned states were listed.
    ListedPins(Result<PinsListed, FileError>),
    /// The pinned states were changed.
    ChangedPins(Result<PinsListed, FileError>),
    /// Something else was written; what to say about it.
    Wrote(Result<String, String>),
}

type Job = Box<dyn FnOnce() -> Done + Send>;

/// The thread, and what it was told to do.
pub(super) struct Disk {
    ctx: egui::Context,
    jobs: Sender<Job>,
    sender: Sender<Done>,
    done: Receiver<Done>,
    reads: usize,
    writes: usize,
}

impl Disk {
    /// Starts the thread.
    ///
    /// # Errors
    /// If the system gives none.
    pub(super) fn new(ctx: egui::Context) -> std::io::Result<Self> {
        let (jobs, to_do) = channel::<Job>();
        let (sender, done) = channel();
        let (of_thread, repaint) = (sender.clone(), ctx.clone());
        std::thread::Builder::new().name("files".to_owned()).spawn(move || {
            for job in to_do {
                // Nobody listens where the window was closed meanwhile.
                let _ = of_thread.send(job());
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

    /// Reads a file.
    pub(super) fn read(&mut self, job: impl FnOnce() -> Done + Send + 'static) {
        self.reads += 1;
        self.order(job);
    }

    /// Writes a file.
    pub(super) fn write(&mut self, job: impl FnOnce() -> Done + Send + 'static) {
        self.writes += 1;
        self.order(job);
    }

    /// Writes something that takes long, on a thread of its own.
    pub(super) fn write_beside(&mut self, work: impl FnOnce() -> Result<String, String> + Send + 'static) {
        self.writes += 1;
        let (sender, ctx) = (self.sender.clone(), self.ctx.clone());
        let body = move || {
            // Nobody listens where the window was closed meanwhile.
            let _ = sender.send(Done::Wrote(work()));
            ctx.request_repaint();
        };
        if let Err(error) = std::thread::Builder::new().name("save".to_owned()).spawn(body) {
            let why = format!("the system gives no thread to save on: {error}");
            // This end listens.
            let _ = self.sender.send(Done::Wrote(Err(why)));
        }
    }

    fn order(&self, job: impl FnOnce() -> Done + Send + 'static) {
        // The thread ends with this.
        let _ = self.jobs.send(Box::new(job));
    }

    /// Whether a file that was asked for has not been read yet.
    pub(super) fn is_reading(&self) -> bool {
        self.reads > 0
    }

    /// Whether something is still to be written.
    pub(super) fn is_writing(&self) -> bool {
        self.writes > 0
    }

    /// What was done since this was last called.
    pub(super) fn take_done(&mut self) -> Vec<Done> {
        let done: Vec<Done> = self.done.try_iter().collect();
        for done in &done {
            match done {
                Done::Read(..) | Done::Listed(_) | Done::ListedPins(_) => self.reads = self.reads.saturating_sub(1),
                Done::SavedProject(..) | Done::ChangedLibrary(_) | Done::ChangedPins(_) | Done::Wrote(_) => {
                    self.writes = self.writes.saturating_sub(1)
                }
            }
        }
        done
    }
}

/// How a result is said.
pub(super) fn words(result: Result<String, String>) -> (Level, String) {
    match result {
        Ok(text) => (Level::Info, text),
        Err(text) => (Level::Error, text),
    }
}
