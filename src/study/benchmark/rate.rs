//! Samples and rays per second of each scene, and ray queries against our own traversal.

use std::time::Instant;

use super::report::EngineReport;
use super::{Case, Done, Place, Run, turns};
use crate::gpu::Traversal;
use crate::render::Session;
use crate::study::{StudyError, UNLIMITED};

/// Units of the rows; more is better.
const SAMPLES: (&str, bool) = ("M samples/s", true);
const RAYS: (&str, bool) = ("M rays/s", true);
/// Scenes of the comparison of traversals: the first ones.
const TRAVERSED: usize = 2;

/// Rates of a case in each turn, in millions per second.
#[derive(Default)]
struct Rates {
    samples: Vec<f64>,
    rays: Vec<f64>,
}

/// Measures the rates of all scenes.
pub(super) fn rates(run: &mut Run<'_, '_>, place: &Place, report: &mut EngineReport, end: Instant) -> Done {
    let mut session = place.open()?;
    let mut found: Vec<Rates> = run.cases.iter().map(|_| Rates::default()).collect();
    for (turn, number) in turns(end, run.extent.turns, found.len()) {
        let (case, rates) = (&run.cases[number], &mut found[number]);
        // The first turn compiles kernels and fills caches.
        match measured(&mut session, case, turn, run.extent.turn) {
            Ok([samples, rays]) if turn > 0 => {
                rates.samples.push(samples);
                rates.rays.push(rays);
            }
            Ok(_) => {}
            Err(error) => report.leave_out("samples", &case.name, error.to_string()),
        }
        let what = format!("{}, {}, turn {turn}", report.name(), case.name);
        run.report(&what)?;
    }
    for (case, rates) in std::iter::zip(&run.cases, &found) {
        report.add("samples", &case.name, SAMPLES, &rates.samples);
        if !rates.rays.is_empty() {
            report.add("rays", &case.name, RAYS, &rates.rays);
        }
    }
    Ok(())
}

/// Samples and rays in millions per second of a turn.
fn measured(
    session: &mut Session,
    case: &Case,
    turn: usize,
    time: std::time::Duration,
) -> Result<[f64; 2], StudyError> {
    let mut document = case.document.clone();
    (document.render.samples, document.render.seed) = (UNLIMITED, turn as u32);
    session.submit(&document)?;
    // Warms: uploads, caches, the size of dispatches.
    session.step(time.div_f64(4.0))?;
    let mut counts = || -> Result<[f64; 2], StudyError> {
        let film = session.film()?;
        Ok([film.samples() as f64, film.total_rays() as f64])
    };
    let before = counts()?;
    let begun = Instant::now();
    session.step(time)?;
    let seconds = begun.elapsed().as_secs_f64();
    let film = session.film()?;
    let after = [film.samples() as f64, film.total_rays() as f64];
    Ok([0, 1].map(|i| (after[i] - before[i]) / seconds / 1e6))
}

/// Measures ray queries and our own traversal in turn.
pub(super) fn ray_queries(run: &mut Run<'_, '_>, place: &Place, report: &mut EngineReport, end: Instant) -> Done {
    let Place::Adapter(adapter) = place else {
        return Ok(());
    };
    if !adapter.has_ray_queries() {
        report.leave_out("ray queries", "", "the adapter has none");
        return Ok(());
    }
    let variants = [("off", Traversal::Own), ("on", Traversal::RayQueries)];
    let mut sessions = Vec::new();
    for (_, traversal) in variants {
        sessions.push(Session::on_adapter(adapter, traversal)?);
    }
    let count = run.cases.len().min(TRAVERSED);
    let mut found = vec![[const { Vec::new() }; 2]; count];
    for (turn, number) in turns(end, run.extent.turns, count) {
        for (session, rates) in sessions.iter_mut().zip(&mut found[number]) {
            let [_, rays] = measured(session, &run.cases[number], turn, run.extent.turn)?;
            if turn > 0 {
                rates.push(rays);
            }
            run.report(&format!("{}, ray queries, turn {turn}", report.name()))?;
        }
    }
    for (case, of_case) in std::iter::zip(&run.cases, &found) {
        for ((name, _), rates) in std::iter::zip(variants, of_case) {
            report.add("ray queries", &format!("{name}: {}", case.name), RAYS, rates);
        }
    }
    Ok(())
}
