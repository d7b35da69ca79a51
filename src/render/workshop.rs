//! Background compilation of kernels: while one is compiled for the scene's plan, the CPU engine renders.
//!
//! Each kernel has an engine and a device of its own, because software Vulkan compiles at the first dispatch, which would
//! block all other dispatches of the device.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

use super::engine::Engine;
use crate::gpu::{AdapterKind, GpuAdapter, GpuDevice, GpuEngine, GpuError, Traversal};
use crate::job::Job;
use crate::job::plan::Specialisation;

/// Kernels that are kept besides the one in use.
const KEPT: usize = 3;

/// An engine being prepared on a thread of its own.
struct Preparation {
    specialisation: Specialisation,
    begun: Instant,
    engine: Receiver<Result<GpuEngine, GpuError>>,
}

/// See the module.
pub(super) struct Workshop {
    kind: AdapterKind,
    traversal: Traversal,
    /// An engine that is open and has no kernel yet.
    blank: Option<GpuEngine>,
    /// Ready engines, the most recently used last.
    ready: Vec<GpuEngine>,
    in_work: Option<Preparation>,
    /// Compile time of the latest kernel.
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
            traversal: blank.device().traversal,
            blank: Some(blank),
            ready: Vec::new(),
            in_work: None,
            compile_time: None,
        }
    }

    /// The device of the engine that has no kernel yet.
    pub(super) fn blank_device(&self) -> Option<&GpuDevice> {
        self.blank.as_ref().map(GpuEngine::device)
    }

    /// Compile time of the latest kernel, in seconds.
    pub(super) fn compile_seconds(&self) -> Option<f64> {
        self.compile_time.as_ref().map(Duration::as_secs_f64)
    }

    /// Starts a job on the GPU if its kernel is ready, else on the CPU until [`Self::finished`] returns one. After an error
    /// the current engine continues.
    pub(super) fn begin(&mut self, job: &Arc<Job>, current: &mut Engine) -> Result<(), GpuError> {
        if let Engine::Gpu(engine) = current
            && engine.has_kernel(job)
        {
            return engine.submit(job.clone());
        }
        let next = match self.ready.iter().position(|engine| engine.has_kernel(job)) {
            Some(place) => {
                self.ready[place].submit(job.clone())?;
                Engine::Gpu(Box::new(self.ready.remove(place)))
            }
            None => {
                self.compile(job);
                let mut engine = Engine::Cpu(Box::default());
                engine.submit(job.clone())?;
                engine
            }
        };
        if let Engine::Gpu(engine) = std::mem::replace(current, next) {
            self.ready.push(*engine);
        }
        if self.ready.len() > KEPT {
            self.ready.remove(0);
        }
        self.ready.iter_mut().for_each(GpuEngine::rest);
        Ok(())
    }

    /// Compiles a job's kernel, unless another is being compiled.
    fn compile(&mut self, job: &Arc<Job>) {
        if self.in_work.is_some() {
            return;
        }
        let (sender, engine) = channel();
        let (blank, kind, traversal) = (self.blank.take(), self.kind, self.traversal);
        let prepared = job.clone();
        let work = move || {
            let prepare = || {
                let mut engine = match blank {
                    Some(engine) => engine,
                    None => GpuEngine::new(GpuAdapter::find(kind)?.open(traversal)?)?,
                };
                engine.prepare(prepared)?;
                Ok(engine)
            };
            // The session may be gone.
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

    /// The engine with this job, once its kernel is ready.
    pub(super) fn finished(&mut self, job: &Arc<Job>) -> Result<Option<GpuEngine>, GpuError> {
        let Some(preparation) = &self.in_work else {
            self.compile(job);
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
        let mut engine = match outcome {
            // Another job's error: this job is tried separately.
            Err(error) if !is_wanted && !error.is_lost() => {
                log::warn!("{error}");
                self.compile(job);
                return Ok(None);
            }
            outcome => outcome?,
        };
        if !is_wanted {
            engine.rest();
            self.ready.push(engine);
            self.compile(job);
            return Ok(None);
        }
        let taken = engine.submit(job.clone());
        if taken.is_err() {
            self.ready.push(engine);
            return taken.map(|()| None);
        }
        Ok(Some(engine))
    }
}
