//! Calibration: the fastest engine and traversal on this machine.
//!
//! Measured in interleaved trials on a small image of the default document while the process is idle, and stored per
//! adapter, driver and version. Without a hardware GPU the candidates are the CPU engine and software Vulkan; on adapters
//! with ray queries, those and our own traversal. If rates of real renders contradict the result, it is measured again.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::ray_queries::RayQueries;
use super::{Engine, EngineInfo, Precision, cpu, gpu};
use crate::compile::{Assets, Compiler};
use crate::document::Document;
use crate::gpu::{AdapterKind, GpuAdapter, Traversal};
use crate::job::Job;
use crate::render::quiet::{self, Quiet};

/// Side of the measured image, in pixels.
const SIZE: u32 = 96;
/// Number of interleaved trials and length of each: three candidates take less than a second with pauses. Warming cached
/// kernels takes about another second.
const TURNS: usize = 5;
const DURATION: Duration = Duration::from_millis(40);
/// Quiet time needed before a trial, and the polling interval.
const REST: Duration = Duration::from_millis(50);
const GLANCE: Duration = Duration::from_millis(20);
/// Factor by which software Vulkan must be slower than the CPU engine on the same image to trigger another measurement.
const DOUBT: f64 = 1.1;
/// Machines that are remembered: an adapter each, with one driver.
const REMEMBERED: usize = 8;

/// Candidates of the measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
enum Candidate {
    /// The CPU engine.
    Processor,
    /// The GPU's, for rays that go this way.
    Gpu(Traversal),
}

impl Candidate {
    const OWN: Self = Self::Gpu(Traversal::Own);
    const QUERIES: Self = Self::Gpu(Traversal::RayQueries);

    /// All candidates for an adapter.
    fn with(adapter: &GpuAdapter) -> Vec<Self> {
        let mut all = vec![Self::OWN];
        if adapter.is_software() {
            all.insert(0, Self::Processor);
        }
        if adapter.has_ray_queries() {
            all.push(Self::QUERIES);
        }
        all
    }

    /// Its name; `is_software` if the CPU engine is among the candidates.
    fn name(self, is_software: bool) -> &'static str {
        match (self, is_software) {
            (Self::Processor, _) => "the CPU engine",
            (Self::OWN, true) => "software Vulkan",
            (Self::QUERIES, true) => "software Vulkan with ray queries",
            (Self::OWN, false) => "our own traversal",
            (Self::QUERIES, false) => "traversal by ray queries",
        }
    }
}

/// Opens the faster engine. If that is unknown and the caller must not wait, opens the CPU engine and measures for the next
/// start: compiling a kernel takes software Vulkan seconds.
pub(super) fn fastest_without_hardware(may_wait: bool) -> (Engine, EngineInfo) {
    let Ok(adapter) = GpuAdapter::find(AdapterKind::Software) else {
        return cpu("there is no Vulkan driver".to_owned());
    };
    let failed = || cpu("software Vulkan does not run the renderer".to_owned());
    let verdict = match remembered(&adapter) {
        Some(verdict) => verdict,
        // A caller that waits does nothing else.
        None if may_wait => match measured_and_remembered(&adapter, &Quiet::new()) {
            Some(verdict) => verdict,
            None => return failed(),
        },
        None => {
            measure_when_quiet(AdapterKind::Software);
            let reason = "no hardware GPU; software Vulkan is measured once nothing renders, for the next start";
            return cpu(reason.to_owned());
        }
    };
    let verdict = verdict.of(|candidate| match RayQueries::chosen() {
        RayQueries::Auto => true,
        RayQueries::On => candidate != Candidate::OWN || !adapter.has_ray_queries(),
        RayQueries::Off => candidate != Candidate::QUERIES,
    });
    let reason = format!("no hardware GPU; {}", verdict.reason());
    match verdict.fastest() {
        Candidate::Processor => cpu(reason),
        Candidate::Gpu(traversal) => {
            let opened = adapter.open(traversal).and_then(|device| gpu(device, reason));
            opened.unwrap_or_else(|_| failed())
        }
    }
}

/// Traversal on an adapter, with its reason: ray queries if chosen or measured to be faster. If that is unknown and the
/// caller must not wait, measures for the next start. Software Vulkan is measured together with the CPU engine.
pub(super) fn traversal(adapter: &GpuAdapter, may_wait: bool) -> (Traversal, String) {
    let said = |traversal, what: &str| (traversal, what.to_owned());
    match (RayQueries::chosen(), adapter.has_ray_queries()) {
        (RayQueries::On, true) => return said(Traversal::RayQueries, "with ray queries, chosen by you"),
        (RayQueries::On, false) => return said(Traversal::Own, "without ray queries, which the adapter does not have"),
        (RayQueries::Off, true) => return said(Traversal::Own, "without ray queries, chosen by you"),
        (_, false) => return said(Traversal::Own, ""),
        (RayQueries::Auto, true) => {}
    }
    let verdict = match remembered(adapter) {
        Some(verdict) => Some(verdict),
        None if adapter.is_software() => return said(Traversal::Own, "its ray queries have not been measured"),
        None if may_wait => measured_and_remembered(adapter, &Quiet::new()),
        None => {
            measure_when_quiet(AdapterKind::Hardware);
            let what = "its ray queries are measured once nothing renders, for the next start";
            return said(Traversal::Own, what);
        }
    };
    let Some(verdict) = verdict.map(|verdict| verdict.of(|candidate| candidate != Candidate::Processor)) else {
        return said(Traversal::Own, "its ray queries could not be measured");
    };
    match verdict.fastest() {
        Candidate::Gpu(traversal) => (traversal, verdict.reason()),
        Candidate::Processor => (Traversal::Own, verdict.reason()),
    }
}

/// Compares the rates of software Vulkan and the CPU engine on a render, in samples per second. If the CPU engine is faster,
/// the stored measurement is invalid and is repeated.
pub(in crate::render) fn compare_rates(software: f64, cpu: f64) {
    if is_doubtful(software, cpu) && measure_when_quiet(AdapterKind::Software) {
        log::info!(
            "software Vulkan renders {:.1} × as fast as the CPU here: it is measured again",
            software / cpu
        );
    }
}

fn is_doubtful(software: f64, cpu: f64) -> bool {
    software > 0.0 && cpu > DOUBT * software
}

/// Key of a measurement.
fn machine(adapter: &GpuAdapter) -> String {
    format!(
        "{} | {} | {} threads | {} | in a quiet time",
        adapter.info.name,
        adapter.driver(),
        rayon::current_num_threads(),
        env!("CARGO_PKG_VERSION")
    )
}

/// Measures on a background thread. Returns false if that is in progress or was done since the start.
fn measure_when_quiet(kind: AdapterKind) -> bool {
    static IS_MEASURED: AtomicBool = AtomicBool::new(false);
    if IS_MEASURED.swap(true, Ordering::Relaxed) {
        return false;
    }
    let work = move || {
        crate::render::priority::lower_thread_priority();
        let adapter = GpuAdapter::find(kind).ok()?;
        let verdict = measured_and_remembered(&adapter, quiet::common())?;
        log::info!("{}: {}", adapter.info.name, verdict.reason());
        Some(())
    };
    // Without a thread the next start tries again.
    let spawned = std::thread::Builder::new().name("calibration".to_owned()).spawn(work);
    spawned.is_ok()
}

/// A measurement.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
struct Verdict {
    /// Adapter, driver, threads, version.
    machine: String,
    /// Working candidates, each with its rate relative to the first.
    ratios: Vec<(Candidate, f64)>,
}

impl Verdict {
    /// The measurement of some candidates.
    fn of(mut self, is_wanted: impl Fn(Candidate) -> bool) -> Self {
        self.ratios.retain(|(candidate, _)| is_wanted(*candidate));
        self
    }

    /// Whether it can be relied on.
    fn is_sound(&self) -> bool {
        let is_positive = |(_, ratio): &(Candidate, f64)| ratio.is_finite() && *ratio > 0.0;
        !self.ratios.is_empty() && self.ratios.iter().all(is_positive)
    }

    /// The candidates and their ratios, the fastest first; the earlier one of two that are as fast.
    fn ranked(&self) -> Vec<(Candidate, f64)> {
        let mut ranked = self.ratios.clone();
        ranked.sort_by(|(_, a), (_, b)| b.total_cmp(a));
        ranked
    }

    fn fastest(&self) -> Candidate {
        self.ranked()
            .first()
            .map_or(Candidate::OWN, |(candidate, _)| *candidate)
    }

    fn reason(&self) -> String {
        let is_software = self
            .ratios
            .iter()
            .any(|(candidate, _)| *candidate == Candidate::Processor);
        let ranked = self.ranked();
        let [(winner, most), others @ ..] = &ranked[..] else {
            return "nothing was measured".to_owned();
        };
        let winner = winner.name(is_software);
        if others.is_empty() {
            return format!("{winner}, as nothing else works here");
        }
        let beside = |(other, ratio): &(Candidate, f64)| {
            format!("{:.1} × as fast here as {}", most / ratio, other.name(is_software))
        };
        let beside: Vec<_> = others.iter().map(beside).collect();
        format!("{winner} was measured {}", beside.join(" and "))
    }
}

/// An engine that is measured, warm: its kernel has been compiled.
struct Contestant {
    candidate: Candidate,
    engine: Engine,
    /// Threads for the CPU engine, as software Vulkan has its own, of the same priority.
    threads: Option<rayon::ThreadPool>,
}

impl Contestant {
    /// `None` if it does not work here.
    fn open(candidate: Candidate, adapter: &GpuAdapter, job: &Arc<Job>) -> Option<Self> {
        let (engine, threads) = match candidate {
            Candidate::Processor => {
                let threads = rayon::ThreadPoolBuilder::new().build().ok()?;
                (cpu(String::new()).0, Some(threads))
            }
            Candidate::Gpu(traversal) => {
                let device = adapter.open(traversal).ok()?;
                (gpu(device, String::new()).ok()?.0, None)
            }
        };
        let mut contestant = Self {
            candidate,
            engine,
            threads,
        };
        contestant.run(|engine| warm(engine, job))?;
        Some(contestant)
    }

    fn run<A: Send>(&mut self, work: impl FnOnce(&mut Engine) -> A + Send) -> A {
        let engine = &mut self.engine;
        match &self.threads {
            Some(threads) => threads.install(|| work(engine)),
            None => work(engine),
        }
    }
}

/// Measures and stores the result; `None` if the GPU does not render.
fn measured_and_remembered(adapter: &GpuAdapter, quiet: &Quiet) -> Option<Verdict> {
    let verdict = measured(adapter, quiet)?;
    let written = verdict_path().and_then(|path| write_verdict(&path, &verdict));
    // A cache: if it cannot be written, the next start measures again.
    if written.is_none() {
        log::debug!("the engines' measurement could not be cached");
    }
    Some(verdict)
}

fn measured(adapter: &GpuAdapter, quiet: &Quiet) -> Option<Verdict> {
    let mut document = Document::default();
    (document.render.width, document.render.height) = (SIZE, SIZE);
    let job = Arc::new(Compiler::default().compile(&document, &Assets::default()).ok()?);
    let mut contestants: Vec<_> = Candidate::with(adapter)
        .into_iter()
        .filter_map(|candidate| Contestant::open(candidate, adapter, &job))
        .collect();
    let candidates: Vec<_> = contestants.iter().map(|contestant| contestant.candidate).collect();
    if !candidates.contains(&Candidate::OWN) {
        return None;
    }
    let rate = |number: usize| contestants[number].run(|engine| samples_per_second(engine, &job));
    let ratios = ratios_by_turns(quiet, candidates.len(), rate)?;
    Some(Verdict {
        machine: machine(adapter),
        ratios: std::iter::zip(candidates, ratios).collect(),
    })
}

/// Rates of `count` candidates relative to the first: medians of interleaved trials, every other one in reverse order.
/// Trials wait for a quiet period, and disturbed ones do not count.
fn ratios_by_turns(quiet: &Quiet, count: usize, mut rate: impl FnMut(usize) -> Option<f64>) -> Option<Vec<f64>> {
    let mut turns: Vec<Vec<f64>> = Vec::new();
    while turns.len() < TURNS {
        let span = rested(quiet);
        let mut order: Vec<usize> = (0..count).collect();
        if turns.len() % 2 == 1 {
            order.reverse();
        }
        let mut rates = vec![0.0; count];
        for number in order {
            rates[number] = rate(number)?;
        }
        if quiet.span() == Some(span) {
            turns.push(rates.iter().map(|rate| rate / rates[0]).collect());
        }
    }
    let middle = |number: usize| {
        let mut ratios: Vec<f64> = turns.iter().map(|ratios| ratios[number]).collect();
        ratios.sort_by(f64::total_cmp);
        ratios[TURNS / 2]
    };
    Some((0..count).map(middle).collect())
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

/// The stored measurement of an adapter.
fn remembered(adapter: &GpuAdapter) -> Option<Verdict> {
    read_verdict(&verdict_path()?, &machine(adapter))
}

/// The stored measurements, oldest first; empty if the file cannot be read.
fn read_verdicts(path: &Path) -> Vec<Verdict> {
    let text = std::fs::read(path).ok();
    text.and_then(|text| serde_json::from_slice(&text).ok())
        .unwrap_or_default()
}

fn read_verdict(path: &Path, machine: &str) -> Option<Verdict> {
    let verdicts = read_verdicts(path).into_iter();
    verdicts
        .filter(Verdict::is_sound)
        .find(|verdict| verdict.machine == machine)
}

/// Stores a measurement in place of the same machine's; `None` if the file cannot be written.
fn write_verdict(path: &Path, verdict: &Verdict) -> Option<()> {
    let mut verdicts = read_verdicts(path);
    verdicts.retain(|other| other.machine != verdict.machine);
    verdicts.push(verdict.clone());
    let kept = &verdicts[verdicts.len().saturating_sub(REMEMBERED)..];
    std::fs::create_dir_all(path.parent()?).ok()?;
    std::fs::write(path, serde_json::to_vec(kept).ok()?).ok()
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// The first candidate does twice what the second one does, but a quarter while the window renders on its cores.
    #[test]
    fn what_is_measured_beside_other_work_does_not_count() {
        let quiet = Quiet::new();
        let turn = Cell::new(0);
        let order = std::cell::RefCell::new(String::new());
        let rate = |number: usize| {
            order.borrow_mut().push(['a', 'b', 'c'][number]);
            if number > 0 {
                return Some(f64::from(number as u32));
            }
            // Somebody renders during more than half of the turns.
            let is_disturbed = turn.get() < TURNS + 2;
            turn.set(turn.get() + 1);
            let _work = is_disturbed.then(|| quiet.work());
            Some(if is_disturbed { 0.5 } else { 2.0 })
        };
        assert_eq!(ratios_by_turns(&quiet, 3, rate), Some(vec![1.0, 0.5, 1.0]));
        let by_turns = "abccbaabccbaabc";
        assert!(order.borrow().ends_with(by_turns), "by turns: {}", order.borrow());
    }

    #[test]
    fn a_rate_far_below_the_processors_is_doubted() {
        assert!(is_doubtful(1.0e6, 2.0e6));
        assert!(!is_doubtful(1.0e6, 1.05e6) && !is_doubtful(2.0e6, 1.0e6));
        assert!(!is_doubtful(0.0, 1.0e6), "nothing is known of it");
    }

    fn verdict(machine: &str, ratios: &[(Candidate, f64)]) -> Verdict {
        Verdict {
            machine: machine.to_owned(),
            ratios: ratios.to_vec(),
        }
    }

    #[test]
    fn the_fastest_is_taken_and_told_beside_the_others() {
        let software = verdict(
            "m",
            &[
                (Candidate::Processor, 1.0),
                (Candidate::OWN, 1.2),
                (Candidate::QUERIES, 0.6),
            ],
        );
        assert_eq!(software.fastest(), Candidate::OWN);
        assert_eq!(
            software.reason(),
            "software Vulkan was measured 1.2 × as fast here as the CPU engine and 2.0 × as fast here as software \
             Vulkan with ray queries"
        );
        let hardware = verdict("m", &[(Candidate::OWN, 1.0), (Candidate::QUERIES, 1.5)]);
        assert_eq!(hardware.fastest(), Candidate::QUERIES);
        assert_eq!(
            hardware.reason(),
            "traversal by ray queries was measured 1.5 × as fast here as our own traversal"
        );
        let alone = hardware.of(|candidate| candidate == Candidate::OWN);
        assert_eq!(alone.fastest(), Candidate::OWN);
        assert!(alone.reason().contains("nothing else works"), "{}", alone.reason());
    }

    #[test]
    fn verdicts_are_remembered_by_machine() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("cache/engine.json");
        assert_eq!(read_verdict(&path, "old driver"), None);
        let old = verdict("old driver", &[(Candidate::OWN, 1.0), (Candidate::QUERIES, 1.5)]);
        let new = verdict("new driver", &[(Candidate::OWN, 1.0), (Candidate::QUERIES, 0.5)]);
        for verdict in [&old, &new] {
            write_verdict(&path, verdict).expect("written");
        }
        assert_eq!(read_verdict(&path, "old driver"), Some(old));
        assert_eq!(read_verdict(&path, "new driver"), Some(new));
        assert_eq!(read_verdict(&path, "another adapter"), None);
        // Measured again, it counts in place of what was there; what can't be is not relied on.
        let again = verdict("new driver", &[(Candidate::OWN, 1.0), (Candidate::QUERIES, 0.0)]);
        write_verdict(&path, &again).expect("written");
        assert_eq!(read_verdict(&path, "new driver"), None);
        assert_eq!(read_verdicts(&path).len(), 2);
        for number in 0..20 {
            write_verdict(&path, &verdict(&number.to_string(), &[(Candidate::OWN, 1.0)])).expect("written");
        }
        assert_eq!(read_verdicts(&path).len(), REMEMBERED);
        std::fs::write(&path, "{").expect("written");
        assert_eq!(read_verdict(&path, "19"), None);
    }

    /// All that this machine has, on any Mesa.
    #[test]
    fn software_vulkan_is_measured_with_all_that_it_has() {
        let adapter =
            GpuAdapter::find(AdapterKind::Software).expect("a Vulkan driver: apt install mesa-vulkan-drivers");
        let begun = Instant::now();
        let found = measured(&adapter, &Quiet::new()).expect("it renders");
        println!("{} in {:.1} s", found.reason(), begun.elapsed().as_secs_f64());
        assert!(found.is_sound(), "{found:?}");
        let candidates: Vec<_> = found.ratios.iter().map(|(candidate, _)| *candidate).collect();
        assert_eq!(candidates, Candidate::with(&adapter));
        assert_eq!(candidates.contains(&Candidate::QUERIES), adapter.has_ray_queries());
    }
}
