//! Threads beside the window, each started when it is first needed.

use std::io;

use crate::render::background::{Background, Responder};

/// What a thread calls when there is something new to show.
pub type Repaint = Box<dyn Fn() + Send>;

/// The thread, started if it is not there yet. `None` if the system gives none, which the log says.
pub fn started<'a, Q, A>(
    thread: &'a mut Option<Background<Q, A>>,
    ctx: &egui::Context,
    spawn: impl FnOnce(Repaint) -> io::Result<Background<Q, A>>,
) -> Option<&'a Background<Q, A>> {
    if thread.is_none() {
        let ctx = ctx.clone();
        match spawn(Box::new(move || ctx.request_repaint())) {
            Ok(spawned) => *thread = Some(spawned),
            Err(error) => log::error!("cannot start a thread: {error}"),
        }
    }
    thread.as_ref()
}

/// A thread that is asked once for each query.
pub struct Beside<Q, A> {
    thread: Option<Background<Q, A>>,
    asked: Option<Q>,
}

impl<Q, A> Default for Beside<Q, A> {
    fn default() -> Self {
        let (thread, asked) = (None, None);
        Self { thread, asked }
    }
}

impl<Q: Clone + PartialEq + Send + 'static, A: Clone + Send + 'static> Beside<Q, A> {
    /// Asks, unless that was asked last, and returns the latest answer.
    pub fn ask(
        &mut self,
        ctx: &egui::Context,
        name: &str,
        query: Q,
        work: impl FnMut(Q, &Responder<'_, A>) + Send + 'static,
    ) -> Option<A> {
        let thread = started(&mut self.thread, ctx, |repaint| Background::spawn(name, repaint, work))?;
        if self.asked.as_ref() != Some(&query) {
            thread.ask(query.clone());
            self.asked = Some(query);
        }
        thread.latest()
    }

    pub fn latest(&self) -> Option<A> {
        self.thread.as_ref()?.latest()
    }
}
