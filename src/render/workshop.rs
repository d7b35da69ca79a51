//! Kernels made ready beside the picture: while one is compiled for the scene's plan, the processor draws.
//!
//! Each kernel has an engine and a device of its own, since software Vulkan compiles at the first dispatch, which would
//! hold up every other dispatch of the device.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

use super::engine::Engine;
use crate::gpu::{AdapterKind, GpuDevice, GpuEngine, GpuError};
use crate::job::Job;
use crate::job::plan::Specialisation;

/// Kernels that are kept besides the one in use.
const KEPT: usize = 3;

/// An engine being made ready on a thread of its own.
struct Preparation {
    specialisation: Specialisation,
    begun: Instant,
    engine: Receiver<Result<GpuEngine, GpuError>>,
}

/// See the module.
pub(super) struct Workshop {
    kind: AdapterKind,
    /// An engine that is open and has no kernel yet.
    blank: Option<GpuEngine>,
    /// Those that are ready, the one used last at the end.
    ready: Vec<GpuEngine>,
    in_work: Option<Preparation>,
    /// How long the last kernel took.
    compile_time: Option<Duration>,
}

impl Workshop {
    /// Around an engine that has just been opened.
    pub(super) fn new(blank: GpuEngine) -> Self {
        let is_software = blank.device().is_software();
        Self {
            kind: if is_software {
                AdapterKind::Software
            } else {
                AdapterKind::Hardware
            },
            blank: Some(blank),
            ready: Vec::new(),
            in_work: None,
            compile_time: None,
        }
    }

    /// How long the kernel took that was compiled last.
    pub(super) fn compile_seconds(&self) -> Option<f64> {
        self.compile_time.as_ref().map(Duration::as_secs_f64)
    }

    /// The engine to begin a job with: the GPU's where a kernel is ready, else the processor's, until [`Self::finished`]
    /// gives one.
    pub(super) fn engine_for(&mut self, job: &Arc<Job>, current: Engine) -> Engine {
        if let Engine::Gpu(engine) = current {
            self.ready.push(*engine);
        }
        let wanted = job.plan.specialisation();
        if let Some(place) = self.ready.iter().position(|engine| engine.has_kernel(&wanted)) {
            return Engine::Gpu(Box::new(self.ready.remove(place)));
        }
        if self.ready.len() > KEPT {
            self.ready.remove(0);
        }
        self.ready.iter_mut().for_each(GpuEngine::rest);
        self.begin(job);
        Engine::Cpu(Box::default())
    }

    /// Begins to compile where nothing else is being compiled.
    fn begin(&mut self, job: &Arc<Job>) {
        if self.in_work.is_some() {
            return;
        }
        let (sender, engine) = channel();
        let (blank, kind) = (self.blank.take(), self.kind);
        let prepared = job.clone();
        let work = move || {
            let prepare = || {
                let mut engine = match blank {
                    Some(engine) => engine,
                    None => GpuEngine::new(GpuDevice::open(kind)?)?,
                };
                engine.prepare(prepared)?;
                Ok(engine)
            };
            // Nobody waits any more where the session is gone.
            let _ = sender.send(prepare());
        };
        if std::thread::Builder::new()
            .name("kernel".to_owned())
            .spawn(work)
            .is_ok()
        {
            self.in_work = Some(Preparation {
                specialisation: job.plan.specialisation(),
                begun: Instant::now(),
                engine,
            });
        }
    }

    /// The engine whose kernel is for this job, once it is ready.
    ///
    /// # Errors
    /// What the driver said to the kernel.
    pub(super) fn finished(&mut self, job: &Arc<Job>) -> Result<Option<GpuEngine>, GpuError> {
        let Some(preparation) = &self.in_work else {
            self.begin(job);
            return Ok(None);
        };
        let outcome = match preparation.engine.try_recv() {
            Err(TryRecvError::Empty) => return Ok(None),
            Err(TryRecvError::Disconnected) => {
                Err(GpuError::Lost("the thread that compiled a kernel stopped".to_owned()))
            }
            Ok(outcome) => outcome,
        };
        let is_wanted = preparation.specialisation == job.plan.specialisation();
        self.compile_time = Some(preparation.begun.elapsed());
        self.in_work = None;
        let engine = outcome?;
        if is_wanted {
            return Ok(Some(engine));
        }
        self.ready.push(engine);
        self.begin(job);
        Ok(None)
    }
}
