//! Without a hardware GPU: is software Vulkan or our own processor engine faster on this machine?
//!
//! Measured on a small picture of the default document while nothing else is at work, the engines by turns, and
//! remembered for this driver and version. Where pictures render at rates that say otherwise, it is measured again.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::assets::Assets;
use super::compile::Compiler;
use super::engine::{Engine, EngineInfo, Precision, cpu, gpu};
use super::quiet::{self, Quiet};
use crate::document::Document;
use crate::gpu::{AdapterKind, GpuDevice};
use crate::job::Job;

/// Side of the picture that is measured on, in pixels.
const SIZE: u32 = 96;
/// How often the engines are measured in turns, and how long each time.
const TURNS: usize = 7;
const DURATION: Duration = Duration::from_millis(60);
/// How long it must have been quiet before a turn, and how often is looked.
const REST: Duration = Duration::from_millis(200);
const GLANCE: Duration = Duration::from_millis(20);
/// By how much software Vulkan must be slower than the processor on the same picture for another measurement.
const DOUBT: f64 = 1.1;

/// Opens whichever engine is faster. Where that is to be measured and the caller must not wait, the processor's is opened:
/// compiling a kernel to measure takes software Vulkan some ten seconds, and what is found counts the next time.
pub(super) fn fastest_without_hardware(may_wait: bool) -> (Engine, EngineInfo) {
    let device = match GpuDevice::open(AdapterKind::Software) {
        Ok(device) => device,
        Err(_) => return cpu("there is no Vulkan driver".to_owned()),
    };
    let machine = machine(&device);
    let remembered = read_verdict(&machine);
    if let Some(verdict) = remembered.as_ref().filter(|verdict| verdict.ratio >= 1.0) {
        return cpu(verdict.reason());
    }
    let Ok(mut software) = gpu(device, String::new()) else {
        return cpu("software Vulkan does not run the renderer".to_owned());
    };
    let verdict = match remembered {
        Some(verdict) => verdict,
        // Who waits does nothing else.
        None if may_wait => match measured(&mut software.0, machine, &Quiet::new()) {
            Some(verdict) => verdict,
            None => return cpu("software Vulkan does not run the renderer".to_owned()),
        },
        None => {
            measure_when_quiet();
            let reason = "no hardware GPU; software Vulkan is measured once nothing renders, for the next start";
            return cpu(reason.to_owned());
        }
    };
    if verdict.ratio >= 1.0 {
        return cpu(verdict.reason());
    }
    software.1.reason = verdict.reason();
    software
}

/// Takes note of how fast software Vulkan renders a picture beside the processor, both in samples a second: where the
/// processor is faster, what was measured does not hold, and is measured again.
pub(super) fn compare_rates(software: f64, processor: f64) {
    if is_doubtful(software, processor) && measure_when_quiet() {
        log::info!(
            "software Vulkan renders {:.1} × as fast as the processor here: it is measured again",
            software / processor
        );
    }
}

fn is_doubtful(software: f64, processor: f64) -> bool {
    software > 0.0 && processor > DOUBT * software
}

/// What the measurement holds for.
fn machine(device: &GpuDevice) -> String {
    format!(
        "{} | {} | {} threads | {} | in a quiet time",
        device.info.name,
        device.driver(),
        rayon::current_num_threads(),
        env!("CARGO_PKG_VERSION")
    )
}

/// Measures on a thread of its own; false where that is under way, or was done since the start.
fn measure_when_quiet() -> bool {
    static IS_MEASURED: AtomicBool = AtomicBool::new(false);
    if IS_MEASURED.swap(true, Ordering::Relaxed) {
        return false;
    }
    let work = || {
        super::priority::lower_thread_priority();
        let device = GpuDevice::open(AdapterKind::Software).ok()?;
        let machine = machine(&device);
        let mut software = gpu(device, String::new()).ok()?;
        let verdict = measured(&mut software.0, machine, quiet::common())?;
        log::info!("{}", verdict.reason());
        Some(())
    };
    // Without a thread the next start tries again.
    let spawned = std::thread::Builder::new().name("calibration".to_owned()).spawn(work);
    spawned.is_ok()
}

/// What was measured.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
struct Verdict {
    /// Adapter, driver, threads, version.
    machine: String,
    /// Samples a second of the processor engine over those of software Vulkan.
    ratio: f64,
}

impl Verdict {
    fn reason(&self) -> String {
        let (winner, loser, ratio) = if self.ratio >= 1.0 {
            ("the processor engine", "software Vulkan", self.ratio)
        } else {
            ("software Vulkan", "the processor engine", 1.0 / self.ratio)
        };
        format!("no hardware GPU; {winner} was measured {ratio:.1} × as fast here as {loser}")
    }
}

/// Measures, and remembers it; `None` where one of the engines fails.
fn measured(software: &mut Engine, machine: String, quiet: &Quiet) -> Option<Verdict> {
    let mut document = Document::default();
    (document.render.width, document.render.height) = (SIZE, SIZE);
    let job = Arc::new(Compiler::default().compile(&document, &Assets::default()).ok()?);
    let (mut processor, _) = cpu(String::new());
    // On threads of its own, as software Vulkan has its own, of the same priority.
    let threads = rayon::ThreadPoolBuilder::new().build().ok()?;
    threads.install(|| warm(&mut processor, &job))?;
    warm(software, &job)?;
    let own = || threads.install(|| samples_per_second(&mut processor, &job));
    let ratio = ratio_by_turns(quiet, own, || samples_per_second(software, &job))?;
    let verdict = Verdict { machine, ratio };
    write_verdict(&verdict);
    Some(verdict)
}

/// The middle one of the ratios of two rates, which are measured by turns, each of them first in every other turn. Turns
/// wait until it has been quiet for a while, and those that work fell into do not count.
fn ratio_by_turns(
    quiet: &Quiet,
    mut own: impl FnMut() -> Option<f64>,
    mut other: impl FnMut() -> Option<f64>,
) -> Option<f64> {
    let mut ratios = Vec::new();
    while ratios.len() < TURNS {
        let span = rested(quiet);
        let ratio = if ratios.len() % 2 == 0 {
            let own = own()?;
            own / other()?
        } else {
            let other = other()?;
            own()? / other
        };
        if quiet.span() == Some(span) {
            ratios.push(ratio);
        }
    }
    ratios.sort_by(f64::total_cmp);
    Some(ratios[TURNS / 2])
}

/// Waits until it has been quiet for a while; the number of the quiet time.
fn rested(quiet: &Quiet) -> u64 {
    let mut since: Option<(u64, Instant)> = None;
    loop {
        match (quiet.span(), since) {
            (Some(span), Some((known, at))) if span == known => {
                if at.elapsed() >= REST {
                    return span;
                }
            }
            (Some(span), _) => since = Some((span, Instant::now())),
            (None, _) => since = None,
        }
        std::thread::sleep(GLANCE);
    }
}

/// Renders a sample of every pixel: the first one compiles.
fn warm(engine: &mut Engine, job: &Arc<Job>) -> Option<()> {
    engine.submit(job.clone()).ok()?;
    let tiles = engine.schedule().grid().tiles();
    let goals = vec![1; tiles];
    engine.step(Duration::from_secs(60), &goals, Precision::Single).ok()
}

fn samples_per_second(engine: &mut Engine, job: &Arc<Job>) -> Option<f64> {
    engine.submit(job.clone()).ok()?;
    let tiles = engine.schedule().grid().tiles();
    let begun = Instant::now();
    engine.step(DURATION, &vec![u32::MAX; tiles], Precision::Single).ok()?;
    let samples = engine.film().ok()?.samples();
    Some(samples as f64 / begun.elapsed().as_secs_f64())
}

fn verdict_path() -> Option<PathBuf> {
    Some(
        directories::ProjectDirs::from("", "", "glossmith")?
            .cache_dir()
            .join("engine.json"),
    )
}

fn read_verdict(machine: &str) -> Option<Verdict> {
    let text = std::fs::read(verdict_path()?).ok()?;
    let verdict: Verdict = serde_json::from_slice(&text).ok()?;
    (verdict.machine == machine && verdict.ratio.is_finite() && verdict.ratio > 0.0).then_some(verdict)
}

/// A cache: where it can't be written, the next start measures again.
fn write_verdict(verdict: &Verdict) {
    let write = || {
        let path = verdict_path()?;
        std::fs::create_dir_all(path.parent()?).ok()?;
        std::fs::write(path, serde_json::to_vec(verdict).ok()?).ok()
    };
    if write().is_none() {
        log::debug!("the engine's measurement could not be cached");
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// The processor's engine does twice what the other one does, but a quarter while the window renders on its cores.
    #[test]
    fn what_is_measured_beside_other_work_does_not_count() {
        let quiet = Quiet::new();
        let turn = Cell::new(0);
        let order = std::cell::RefCell::new(String::new());
        let own = || {
            order.borrow_mut().push('o');
            // Somebody renders during more than half of the turns.
            let is_disturbed = turn.get() < TURNS + 2;
            turn.set(turn.get() + 1);
            let _work = is_disturbed.then(|| quiet.work());
            Some(if is_disturbed { 0.5 } else { 2.0 })
        };
        let other = || {
            order.borrow_mut().push('s');
            Some(1.0)
        };
        assert_eq!(ratio_by_turns(&quiet, own, other), Some(2.0));
        assert!(
            order.borrow().ends_with("ossoossoossoos"),
            "by turns: {}",
            order.borrow()
        );
    }

    #[test]
    fn a_rate_far_below_the_processors_is_doubted() {
        assert!(is_doubtful(1.0e6, 2.0e6));
        assert!(!is_doubtful(1.0e6, 1.05e6) && !is_doubtful(2.0e6, 1.0e6));
        assert!(!is_doubtful(0.0, 1.0e6), "nothing is known of it");
    }
}
