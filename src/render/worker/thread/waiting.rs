//! Scheduling: when the thread works, and what it waits for.

use std::ops::ControlFlow;
use std::time::Duration;

use super::State;
use crate::render::mailbox::IDLE;
use crate::render::session::Session;
use crate::render::worker::stage::Stage;
use crate::render::worker::{Activity, CommandQueue, Commands};

impl State<'_> {
    /// Takes the commands, after waiting for some if there is nothing to render. A submission stays pending while the one
    /// before it must still be shown.
    pub(super) fn await_commands(&mut self) -> (Commands, bool) {
        let shared = self.shared;
        shared.commands.wait(|queue| {
            let is_busy = self.should_render(queue.is_paused);
            let wait = self.longest_wait();
            let has_news = self.activity(queue.is_paused) != self.snapshot.activity || self.denoising.has_outcome();
            if !(is_busy || has_news || self.has_commands(queue) || wait.is_zero()) {
                return ControlFlow::Continue(wait);
            }
            let mut commands = std::mem::take(&mut queue.commands);
            if self.keeps_stage(queue.is_paused) {
                queue.commands.submission = commands.submission.take();
            }
            ControlFlow::Break((commands, queue.is_paused))
        })
    }

    /// Whether the stage must be shown before another submission is taken.
    fn keeps_stage(&self, is_paused: bool) -> bool {
        let is_unseen = |stage: &Stage| !stage.may_be_replaced(self.taken_at);
        let is_in_work = self.should_render(is_paused) || self.denoising.is_pending();
        self.stage.as_ref().is_some_and(is_unseen) && is_in_work
    }

    /// Whether there are commands to execute now.
    fn has_commands(&self, queue: &CommandQueue) -> bool {
        let has_submission = queue.commands.submission.is_some() && !self.keeps_stage(queue.is_paused);
        has_submission || !queue.commands.is_empty_beside_submission()
    }

    /// Time until the stage needs attention without commands.
    fn longest_wait(&self) -> Duration {
        let Some(stage) = &self.stage else { return IDLE };
        let until_stale = (!stage.may_be_replaced(self.taken_at)).then(|| stage.wait_left(self.taken_at));
        let ends = [stage.rest_left(), until_stale];
        ends.into_iter().flatten().min().unwrap_or(IDLE)
    }

    /// Whether to render a step; while paused, only until the first image.
    pub(super) fn should_render(&self, is_paused: bool) -> bool {
        let (Some(stage), Some(session)) = (&self.stage, &self.session) else {
            return false;
        };
        !session.progress().is_done && (!is_paused || !stage.is_shown) && !self.yields_to_denoiser()
    }

    /// Whether the engine waits for the denoiser. On the same cores each would take as long as both, and the user waits for
    /// the denoised image.
    fn yields_to_denoiser(&self) -> bool {
        let is_on_cores = |session: &Session| session.engine().is_software || session.is_fallback();
        self.denoising.is_pending() && self.session.as_ref().is_some_and(is_on_cores)
    }

    /// The current activity.
    pub(super) fn activity(&self, is_paused: bool) -> Activity {
        match (&self.stage, &self.session) {
            (Some(_), Some(_)) if self.denoising.is_pending() => Activity::Rendering,
            (Some(_), Some(session)) if session.progress().is_done => Activity::Done,
            (Some(_), Some(_)) if is_paused => Activity::Paused,
            (Some(_), Some(_)) => Activity::Rendering,
            _ => Activity::Idle,
        }
    }
}
