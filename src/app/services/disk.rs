//! Reading and writing small files beside the window, one after the other: what was saved last is what a file holds.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::Builder;

use crate::panics::caught;

/// What a job is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    Open,
    List,
    Write,
}

type Job<T> = Box<dyn FnOnce() -> T + Send>;
/// The outcome of a job, or what its panic said.
type Done<T> = (Task, Result<T, String>);

/// The thread, and its orders.
pub struct Disk<T> {
    ctx: egui::Context,
    jobs: Sender<(Task, Job<T>)>,
    sender: Sender<Done<T>>,
    done: Receiver<Done<T>>,
    pending: Vec<Task>,
}

impl<T: Send + 'static> Disk<T> {
    /// Starts the thread.
    pub fn new(ctx: egui::Context) -> std::io::Result<Self> {
        let (jobs, to_do) = channel::<(Task, Job<T>)>();
        let (sender, done) = channel();
        let (of_thread, repaint) = (sender.clone(), ctx.clone());
        Builder::new().name("files".to_owned()).spawn(move || {
            for (task, job) in to_do {
                // Nobody listens where the window was closed meanwhile.
                let _ = of_thread.send((task, caught(job)));
                repaint.request_repaint();
            }
        })?;
        Ok(Self {
            ctx,
            jobs,
            sender,
            done,
            pending: Vec::new(),
        })
    }

    /// Has something done after what was ordered before.
    pub fn order(&mut self, task: Task, job: impl FnOnce() -> T + Send + 'static) {
        self.pending.push(task);
        // The thread ends with this.
        let _ = self.jobs.send((task, Box::new(job)));
    }

    /// Has something done that takes long, on a thread of its own.
    pub fn beside(&mut self, task: Task, job: impl FnOnce() -> T + Send + 'static) {
        self.pending.push(task);
        let (sender, ctx) = (self.sender.clone(), self.ctx.clone());
        let body = move || {
            let _ = sender.send((task, caught(job)));
            ctx.request_repaint();
        };
        if let Err(error) = Builder::new().name("beside".to_owned()).spawn(body) {
            let _ = self.sender.send((task, Err(format!("cannot start a thread: {error}"))));
        }
    }

    /// Whether something that was asked for has not been read yet.
    pub fn is_reading(&self) -> bool {
        self.pending.iter().any(|task| *task != Task::Write)
    }

    /// Whether something is still to be written.
    pub fn is_writing(&self) -> bool {
        self.pending.contains(&Task::Write)
    }

    /// What was done since this was last called.
    pub fn take_done(&mut self) -> Vec<Done<T>> {
        let done: Vec<Done<T>> = self.done.try_iter().collect();
        for (task, _) in &done {
            if let Some(place) = self.pending.iter().position(|pending| pending == task) {
                self.pending.swap_remove(place);
            }
        }
        done
    }
}
