//! Recovery of a render when the GPU's device is lost.

use super::Session;
use crate::{
    gpu::{AdapterKind, GpuAdapter, GpuEngine, GpuError, Moment},
    job::{film::Film, tiles::Schedule},
    render::engine::{Engine, cpu},
    render::workshop::Workshop,
};

/// Largest number of reopenings of a lost device; one that is lost again counts as broken.
const REPLACEMENTS: u32 = 3;

impl Session {
    /// Continues after a GPU failure and returns a message: on a reopened device after a loss, up to three times; else on
    /// the CPU. Samples already read from the GPU count.
    pub fn recover(&mut self, error: &GpuError) -> String {
        let kept = match std::mem::take(&mut self.engine) {
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
            let how = self.continue_after(&cause);
            let Some(job) = self.job.clone() else {
                return format!("{why}; {how}");
            };
            let render_time = self.render_time;
            match self.start(job) {
                Ok(()) => {
                    self.render_time = render_time;
                    self.restore_samples(kept);
                    return format!("{why}; {how}");
                }
                Err(again) => cause = again,
            }
        }
    }

    /// Opens another engine. Returns a message.
    fn continue_after(&mut self, cause: &GpuError) -> String {
        let may_reopen = cause.is_lost() && self.losses <= REPLACEMENTS;
        let kind = AdapterKind::of(self.info.is_software);
        let is_fluid = self.workshop.take().is_some();
        let traversal = self.info.traversal;
        let opened = may_reopen.then(|| GpuAdapter::find(kind)?.open(traversal).and_then(GpuEngine::new));
        match opened {
            Some(Ok(engine)) if is_fluid => self.workshop = Some(Workshop::new(engine)),
            Some(Ok(engine)) => self.engine = Engine::Gpu(Box::new(engine)),
            _ => {
                (self.engine, self.info) = cpu(format!("the GPU failed: {cause}"));
                return "going on with the CPU".to_owned();
            }
        }
        if let Some((moment, times @ 1..)) = self.losing {
            self.lose_when(moment, times);
        }
        format!(
            "going on with the GPU opened again ({} of {REPLACEMENTS} times)",
            self.losses
        )
    }

    /// Passes the samples so far to the engine, if they are of the same image.
    fn restore_samples(&mut self, kept: Option<(Film, Schedule)>) {
        let Some((film, schedule)) = kept else { return };
        // The first job has no samples yet.
        if schedule.grid() != self.engine.schedule().grid() {
            return;
        }
        match &mut self.engine {
            Engine::Cpu(engine) => engine.take_over(film, schedule),
            Engine::Gpu(engine) => engine.take_over(film, schedule),
        }
    }

    /// Injects losses of the GPU's device at a moment, and `times` in all. For tests.
    pub fn lose_when(&mut self, moment: Moment, times: u32) {
        self.losing = Some((moment, times - 1));
        let device = self
            .device()
            .or_else(|| self.workshop.as_ref()?.blank.as_ref().map(GpuEngine::device));
        if let Some(device) = device {
            device.lose_when(moment);
        }
    }
}
