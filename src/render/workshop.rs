//! Background compilation of kernels: while one is compiled for the scene's plan, the CPU engine renders.
//!
//! Each kernel has an engine and a device of its own, because software Vulkan compiles at the first dispatch, which would
//! block all other dispatches of the device.

use std::{sync::Arc, thread::JoinHandle, time::Instant};

use super::engine::Engine;
use crate::gpu::{AdapterKind, GpuAdapter, GpuEngine, GpuError, Traversal};
use crate::job::{Job, plan::Specialisation};

/// Kernels that are kept besides the one in use.
const KEPT: usize = 3;

/// An engine being prepared on a thread of its own.
struct Preparation {
    specialisation: Specialisation,
    begun: Instant,
    engine: JoinHandle<Result<GpuEngine, GpuError>>,
}

/// See the module.
pub struct Workshop {
    kind: AdapterKind,
    traversal: Traversal,
    /// An engine that is open and has no kernel yet.
    pub blank: Option<GpuEngine>,
    /// Ready engines, the most recently used last.
    ready: Vec<GpuEngine>,
    in_work: Option<Preparation>,
    /// Compile time of the latest kernel.
    pub compile_seconds: Option<f64>,
}

impl Workshop {
    /// Around an engine that has just been opened.
    pub fn new(blank: GpuEngine) -> Self {
        let is_software = blank.device().is_software();
        Self {
            kind: AdapterKind::of(is_software),
            traversal: blank.device().traversal,
            blank: Some(blank),
            ready: Vec::new(),
            in_work: None,
            compile_seconds: None,
        }
    }

    /// Starts a job on the GPU if its kernel is ready, else on the CPU until [`Self::finished`] returns one. After an error
    /// the current engine continues.
    pub fn begin(&mut self, job: &Arc<Job>, current: &mut Engine) -> Result<(), GpuError> {
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
                let mut engine = Engine::default();
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
        let (blank, kind, traversal) = (self.blank.take(), self.kind, self.traversal);
        let prepared = job.clone();
        let prepare = move || {
            let mut engine = match blank {
                Some(engine) => engine,
                None => GpuEngine::new(GpuAdapter::find(kind)?.open(traversal)?)?,
            };
            engine.prepare(prepared)?;
            Ok(engine)
        };
        if let Ok(engine) = std::thread::Builder::new().name("kernel".to_owned()).spawn(prepare) {
            self.in_work = Some(Preparation {
                specialisation: job.plan.specialisation(),
                begun: Instant::now(),
                engine,
            });
        }
    }

    /// The engine with this job, once its kernel is ready.
    pub fn finished(&mut self, job: &Arc<Job>) -> Result<Option<GpuEngine>, GpuError> {
        let Some(preparation) = self.in_work.take_if(|preparation| preparation.engine.is_finished()) else {
            self.compile(job);
            return Ok(None);
        };
        let is_wanted = preparation.specialisation == job.plan.specialisation();
        self.compile_seconds = Some(preparation.begun.elapsed().as_secs_f64());
        let stopped = "the thread that compiled a kernel stopped";
        let outcome = preparation.engine.join();
        let outcome = outcome.unwrap_or_else(|_| Err(GpuError::Lost(stopped.to_owned())));
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
        if let Err(error) = engine.submit(job.clone()) {
            self.ready.push(engine);
            return Err(error);
        }
        Ok(Some(engine))
    }
}
