//! Threads beside the window, each started when it is first needed.

use std::io;

use crate::render::background::Background;

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
