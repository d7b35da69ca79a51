//! `glossmith check`: proof on the user's own machine.

use std::path::PathBuf;

use anyhow::{Context, bail};
use clap::Args;

use crate::render::EngineChoice;
use crate::render::check::{Check, CheckOptions, GroupSummary, run as run_checks, summaries};

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
    /// Write all checks as JSON.
    #[arg(long, value_name = "FILE.json")]
    output: Option<PathBuf>,
}

/// Runs the checks and prints a table.
///
/// # Errors
/// Where a check fails, the engine does, or the file can't be written.
pub fn run(arguments: &CheckArguments) -> anyhow::Result<()> {
    let options = CheckOptions {
        engine: arguments.engine,
        thorough: arguments.thorough,
    };
    let checks = run_checks(options, |group| eprintln!("checking {group} …"))?;
    print_table(&checks, arguments.verbose);
    if let Some(path) = &arguments.output {
        let text = serde_json::to_string_pretty(&serde_json::json!({
            "version": env!("CARGO_PKG_VERSION"),
            "passed": checks.iter().all(|check| check.passed),
            "checks": checks,
        }))?;
        std::fs::write(path, text + "\n").with_context(|| format!("{}: could not be written", path.display()))?;
    }
    let failed = checks.iter().filter(|check| !check.passed).count();
    if failed > 0 {
        bail!(
            "{failed} of {} checks failed on this machine; please report them with the JSON of --output",
            checks.len()
        );
    }
    Ok(())
}

/// A line a group, and a line for each check that failed (or every one).
fn print_table(checks: &[Check], verbose: bool) {
    println!("{:12} {:>7} {:>7}  worst", "group", "passed", "failed");
    for of_group in summaries(checks) {
        let GroupSummary {
            group,
            passed,
            failed,
            worst,
        } = of_group;
        println!("{group:12} {passed:>7} {failed:>7}  {worst}");
    }
    for check in checks.iter().filter(|check| verbose || !check.passed) {
        let verdict = if check.passed { "  ok  " } else { "FAILED" };
        println!("{verdict} {}: {check}", check.group);
    }
}
