//! Samples and rays per second of each scene, with our own traversal and, where there are any, with ray queries.

use std::time::Instant;

use super::{Case, Done, Run, TestedEngine, opened, report::EngineReport, turns};
use crate::{gpu::Traversal, render::Session, study::StudyError, study::UNLIMITED};

/// Steps with their units, of which more is better.
const RATES: [(&str, &str); 3] = [
    ("samples", "M samples/s"),
    ("rays", "M rays/s"),
    ("ray queries", "M rays/s"),
];

/// Measures the rates of all scenes.
pub fn rates(run: &mut Run<'_, '_>, place: &TestedEngine, report: &mut EngineReport, end: Instant) -> Done {
    let mut sessions = vec![(0, opened(place, Traversal::Own)?)];
    match place {
        Some(adapter) if adapter.has_ray_queries() => sessions.push((2, opened(place, Traversal::RayQueries)?)),
        Some(_) => report.leave_out("ray queries", "", "the adapter has none"),
        None => {}
    }
    let mut found = vec![[const { Vec::new() }; 3]; run.cases.len()];
    for (turn, number) in turns(end, run.extent.turns, found.len()) {
        let (case, rates) = (&run.cases[number], &mut found[number]);
        for (first, session) in &mut sessions {
            match measured(session, case, turn, run.extent.turn) {
                // The first turn compiles kernels and fills caches.
                Ok(_) if turn == 0 => {}
                Ok([_, rays]) if *first == 2 => rates[2].push(rays),
                Ok([samples, rays]) => {
                    rates[0].push(samples);
                    rates[1].push(rays);
                }
                Err(error) => report.leave_out(RATES[*first].0, &case.name, error.to_string()),
            }
        }
        let what = format!("{}, {}, turn {turn}", report.name(), case.name);
        run.report(&what)?;
    }
    for (case, rates) in std::iter::zip(&run.cases, &found) {
        for ((step, unit), rates) in std::iter::zip(RATES, rates) {
            if step == "samples" || !rates.is_empty() {
                report.add(step, &case.name, (unit, true), rates);
            }
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
    let counts = |session: &mut Session| -> Result<[f64; 2], StudyError> {
        let film = session.film()?;
        Ok([film.samples() as f64, film.total_rays() as f64])
    };
    let before = counts(session)?;
    let begun = Instant::now();
    session.step(time)?;
    let seconds = begun.elapsed().as_secs_f64();
    let after = counts(session)?;
    Ok([0, 1].map(|i| (after[i] - before[i]) / seconds / 1e6))
}
