//! `glossmith check`: proof on the user's own machine.

use std::{cell::RefCell, path::PathBuf, sync::atomic::AtomicBool};

use anyhow::bail;
use clap::Args;

use super::{answer::Answer, parse::check_writable};
use crate::{
    console::{message, output},
    document::parameter::nearest,
    render::{EngineChoice, EngineInfo, EngineKind},
    store::replace::save_atomically,
    study::check::{Check, CheckOptions, GroupSummary, run as run_checks, summaries},
    study::hard::{self, HardOptions, HardRow},
};

/// Arguments of `glossmith check`.
#[derive(Debug, Args)]
pub struct CheckArguments {
    /// The engine to check.
    #[arg(long, default_value = "auto", value_name = "auto|gpu|cpu")]
    engine: EngineChoice,
    /// Every lobe at every roughness and angle, with more samples.
    #[arg(long)]
    thorough: bool,
    /// List every check, not only those that fail.
    #[arg(long)]
    verbose: bool,
    #[command(flatten)]
    answer: Answer,
    /// Run the hard cases instead: places where naive code breaks, each with its verdict.
    #[arg(long)]
    hard: bool,
    /// Only hard cases whose names contain this.
    #[arg(long, value_name = "NAME", default_value = "", requires = "hard", value_parser = part_of_name)]
    only: String,
    /// Write the hard cases as a table in Markdown, on this engine and on the CPU.
    #[arg(long, value_name = "FILE.md", requires = "hard")]
    markdown: Option<PathBuf>,
}

/// Text that is in the name of a hard case.
fn part_of_name(text: &str) -> Result<String, String> {
    let names = || hard::catalogue().map(|case| case.name);
    if names().any(|name| name.contains(text)) {
        return Ok(text.to_owned());
    }
    let parts = names().flat_map(|name| name.split('-').chain([name]).map(move |part| (part, name)));
    Err(match nearest(text, parts) {
        Some(near) => format!("in no name of a hard case; did you mean {near}?"),
        None => format!(
            "in no name of a hard case; there are {}",
            crate::named::joined(names(), ", ")
        ),
    })
}

/// Runs the checks and prints a table.
///
/// # Errors
/// Where a check fails, the engine does, or the file can't be written.
pub fn run(arguments: &CheckArguments) -> anyhow::Result<()> {
    arguments.answer.check_writable()?;
    arguments.markdown.iter().try_for_each(|path| check_writable(path))?;
    if arguments.hard {
        return run_hard(arguments);
    }
    let options = CheckOptions {
        engine: arguments.engine,
        thorough: arguments.thorough,
    };
    let never = AtomicBool::new(false);
    let shown = RefCell::new(String::new());
    let progress = |group: &str, _| {
        if shown.replace(group.to_owned()) != group {
            message!("checking {group} …");
        }
    };
    let checks = run_checks(options, &never, progress)?.unwrap_or_default();
    if arguments.answer.has_words() {
        print_table(&checks, arguments.verbose);
    }
    conclude(arguments, &checks)
}

/// Writes the checks where that is wanted, and fails where one failed.
fn conclude(arguments: &CheckArguments, checks: &[Check]) -> anyhow::Result<()> {
    let failed = checks.iter().filter(|check| !check.passed).count();
    arguments.answer.write(&serde_json::json!({
        "version": env!("CARGO_PKG_VERSION"),
        "passed": failed == 0,
        "checks": checks,
    }))?;
    if failed > 0 {
        bail!(
            "{failed} of {} checks failed on this machine; please report them with the answer of --json",
            checks.len()
        );
    }
    Ok(())
}

/// Runs the hard cases and prints a line each.
fn run_hard(arguments: &CheckArguments) -> anyhow::Result<()> {
    let run_on = |engine| {
        let options = HardOptions {
            engine,
            thorough: arguments.thorough,
            only: arguments.only.clone(),
        };
        hard::run(&options, |name| message!("{name} …"))
    };
    let (engine, rows) = run_on(arguments.engine)?;
    if arguments.answer.has_words() {
        print_hard(&engine, &rows, arguments.verbose);
    }
    let checks: Vec<Check> = rows.iter().map(|row| row.check.clone()).collect();
    if let Some(path) = &arguments.markdown {
        let mut engines = vec![(engine, rows)];
        if engines[0].0.kind != EngineKind::Cpu {
            engines.push(run_on(EngineChoice::Cpu)?);
        }
        save_atomically(path, hard::markdown(&engines).as_bytes())?;
    }
    conclude(arguments, &checks)
}

/// A line a case, and more of those that fail (or of every one).
fn print_hard(engine: &EngineInfo, rows: &[HardRow], verbose: bool) {
    output!("{engine}\n{:8} {:34} {:>7}  verdict", "group", "case", "seconds");
    for row in rows {
        let HardRow {
            case, check, seconds, ..
        } = row;
        let verdict = if check.passed { "ok" } else { "FAILED" };
        let [value, limit] = check.texts();
        output!(
            "{:8} {:34} {seconds:>7.2}  {verdict}: {} {value}, limit {limit}; naive: {}",
            case.group,
            case.name,
            check.measure,
            case.naive
        );
        if verbose || !check.passed {
            output!("         {}; {}; {}", case.danger, case.made, case.must);
        }
    }
}

/// A line a group, and a line for each check that failed (or every one).
fn print_table(checks: &[Check], verbose: bool) {
    output!("{:12} {:>7} {:>7}  worst", "group", "passed", "failed");
    for of_group in summaries(checks) {
        let GroupSummary {
            group,
            passed,
            failed,
            worst,
        } = of_group;
        output!("{group:12} {passed:>7} {failed:>7}  {worst}");
    }
    for check in checks.iter().filter(|check| verbose || !check.passed) {
        let verdict = if check.passed { "  ok  " } else { "FAILED" };
        output!("{verdict} {}: {check}", check.group);
    }
}
