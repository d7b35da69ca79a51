//! What becomes of a picture when the GPU's device is lost.

use super::Session;
use crate::gpu::{AdapterKind, GpuAdapter, GpuEngine, GpuError, Moment};
use crate::job::film::Film;
use crate::job::tiles::Schedule;
use crate::render::engine::{Engine, cpu};
use crate::render::workshop::Workshop;

/// How often a lost device is reopened: one that is lost yet again is taken to be broken.
const REPLACEMENTS: u32 = 3;

impl Session {
    /// Goes on after a failure of the GPU, and says how: on a device opened anew where it was lost, thrice at most; else on
    /// the processor. What the GPU had handed over of the picture counts.
    pub fn recover(&mut self, error: &GpuError) -> String {
        let kept = match std::mem::replace(&mut self.engine, Engine::Cpu(Box::default())) {
            Engine::Gpu(engine) => engine.hand_over(),
            Engine::Cpu(engine) => Some(engine.hand_over()),
        };
        let why = match error {
            GpuError::Lost(why) => format!("the GPU stopped working: {why}"),
            other => other.to_string(),
        };
        let mut cause = error.clone();
        loop {
            self.losses += 1;
            let how = self.go_on_after(&cause);
            let Some(job) = self.job.clone() else {
                return format!("{why}; {how}");
            };
            let render_time = self.render_time;
            match self.start(job) {
                Ok(()) => {
                    self.render_time = render_time;
                    self.take_back(kept);
                    return format!("{why}; {how}");
                }
                Err(again) => cause = again,
            }
        }
    }

    /// Opens another engine; what it does next, in words.
    fn go_on_after(&mut self, cause: &GpuError) -> String {
        let may_go_on = cause.is_lost() && self.losses <= REPLACEMENTS;
        let kind = if self.info.is_software {
            AdapterKind::Software
        } else {
            AdapterKind::Hardware
        };
        let is_fluid = self.workshop.take().is_some();
        let traversal = self.info.traversal;
        let opened = may_go_on.then(|| GpuAdapter::find(kind)?.open(traversal).and_then(GpuEngine::new));
        match opened {
            Some(Ok(engine)) if is_fluid => self.workshop = Some(Workshop::new(engine)),
            Some(Ok(engine)) => self.engine = Engine::Gpu(Box::new(engine)),
            _ => {
                (self.engine, self.info) = cpu(format!("the GPU failed: {cause}"));
                return "going on with the processor".to_owned();
            }
        }
        if let Some((moment, times @ 1..)) = self.losing {
            self.lose_when(moment, times);
        }
        format!(
            "going on with the GPU opened anew ({} of {REPLACEMENTS} times)",
            self.losses
        )
    }

    /// Gives the engine what there was of the picture, where it is of the same one.
    fn take_back(&mut self, kept: Option<(Film, Schedule)>) {
        let Some((film, schedule)) = kept else { return };
        // None was rendered yet where the job is the first.
        if schedule.grid() != self.engine.schedule().grid() {
            return;
        }
        match &mut self.engine {
            Engine::Cpu(engine) => engine.take_over(film, schedule),
            Engine::Gpu(engine) => engine.take_over(film, schedule),
        }
    }

    /// Takes the GPU's device away at a moment to come, and so many times in all those that replace it: for tests.
    pub fn lose_when(&mut self, moment: Moment, times: u32) {
        self.losing = Some((moment, times - 1));
        let device = self.device().or_else(|| self.workshop.as_ref()?.blank_device());
        if let Some(device) = device {
            device.lose_when(moment);
        }
    }
}
