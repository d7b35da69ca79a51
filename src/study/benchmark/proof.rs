//! The checks and the hard cases, as far as the time allows.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, mpsc};
use std::time::Duration;

use super::report::{EngineReport, Proof};
use super::{Done, Place, Run, StepTime};
use crate::study::StudyError;
use crate::study::check::{self, CheckOptions};
use crate::study::hard::{HardError, Stage, catalogue};

/// Names in the report.
const CHECK: &str = "check";
const HARD: &str = "hard cases";

/// Runs the hard cases, then the checks.
pub(super) fn proofs(run: &mut Run<'_, '_>, place: &Place, report: &mut EngineReport, slot: StepTime) -> Done {
    run.report(&format!("{}, hard cases", report.name()))?;
    let proof = until(slot.left().div_f64(2.0), |stop| hard_cases(place, stop))?;
    report.proofs.push(proof);
    run.report(&format!("{}, check", report.name()))?;
    let begun = slot.left();
    let found = until(begun, |stop| {
        let options = CheckOptions {
            engine: place.choice(),
            thorough: false,
        };
        Ok(check::run(options, stop, |_, _| {})?)
    })?;
    match found {
        Some(checks) => {
            let (passed, failed): (Vec<_>, Vec<_>) = checks.iter().partition(|check| check.passed);
            report.proofs.push(Proof {
                what: CHECK.to_owned(),
                passed: passed.len(),
                failed: failed.iter().map(|check| check.name.clone()).collect(),
                not_run: 0,
            });
        }
        None => {
            let seconds = begun.as_secs_f64();
            let why = format!(
                "not finished in {seconds:.0} s: run glossmith check --engine {}",
                report.engine
            );
            report.leave_out(CHECK, "", why);
        }
    }
    Ok(())
}

/// The result of work that is stopped by a flag after some time.
fn until<A>(time: Duration, work: impl FnOnce(&Arc<AtomicBool>) -> Result<A, StudyError>) -> Result<A, StudyError> {
    let stop = Arc::new(AtomicBool::new(false));
    std::thread::scope(|scope| {
        let (done, ended) = mpsc::channel::<()>();
        let of_clock = stop.clone();
        scope.spawn(move || {
            // The sender is dropped at the end of the work.
            if ended.recv_timeout(time) == Err(mpsc::RecvTimeoutError::Timeout) {
                of_clock.store(true, Ordering::Relaxed);
            }
        });
        let outcome = work(&stop);
        drop(done);
        outcome
    })
}

fn hard_cases(place: &Place, stop: &Arc<AtomicBool>) -> Result<Proof, StudyError> {
    let mut proof = Proof {
        what: HARD.to_owned(),
        passed: 0,
        failed: Vec::new(),
        not_run: catalogue().count(),
    };
    let mut stage = match Stage::open(place.choice(), false) {
        Ok(stage) => stage.until(stop.clone()),
        Err(error) => {
            proof.failed.push(error.to_string());
            return Ok(proof);
        }
    };
    for case in catalogue() {
        match case.run(&mut stage) {
            Ok(row) if row.check.passed => proof.passed += 1,
            Ok(row) => proof.failed.push(row.check.to_string()),
            Err(HardError::Stopped) => break,
            Err(error) => proof.failed.push(format!("{}: {error}", case.name)),
        }
        proof.not_run -= 1;
    }
    Ok(proof)
}
