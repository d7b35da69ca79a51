//! Work beside the window, on a thread that starts with the first query.

use crate::render::background::{Background, Responder};

/// A thread for queries, the latest of which wins.
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

impl<Q: Send + 'static, A: Clone + Send + 'static> Beside<Q, A> {
    /// Asks, unless that was asked last, and returns the latest answer.
    pub fn ask(
        &mut self,
        ctx: &egui::Context,
        name: &str,
        query: Q,
        work: impl FnMut(Q, &Responder<'_, A>) + Send + 'static,
    ) -> Option<A>
    where
        Q: Clone + PartialEq,
    {
        if self.asked.as_ref() != Some(&query) {
            self.asked = Some(query.clone());
            self.ask_again(ctx, name, query, work);
        }
        self.latest()
    }

    /// Asks, whatever was asked before.
    pub fn ask_again(
        &mut self,
        ctx: &egui::Context,
        name: &str,
        query: Q,
        work: impl FnMut(Q, &Responder<'_, A>) + Send + 'static,
    ) {
        let thread = self.thread.get_or_insert_with(|| {
            let ctx = ctx.clone();
            Background::spawn(name, move || ctx.request_repaint(), work)
        });
        thread.ask(query);
    }

    pub fn latest(&self) -> Option<A> {
        self.thread.as_ref()?.latest()
    }

    /// Whether something asked for is still to come.
    pub fn is_busy(&self) -> bool {
        self.thread.as_ref().is_some_and(Background::is_busy)
    }

    /// Why there is no answer to the latest query, where its work failed.
    pub fn failure(&self) -> Option<String> {
        self.thread.as_ref()?.failure()
    }
}
