//! `glossmith check`: proof on the user's own machine.

use std::path::PathBuf;

use anyhow::{Context, bail};
use clap::Args;

use crate::render::EngineChoice;
use crate::render::check::{Check, CheckOptions, run as run_checks};

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
    let mut groups: Vec<&str> = checks.iter().map(|check| check.group).collect();
    groups.dedup();
    println!("{:12} {:>7} {:>7}  worst", "group", "passed", "failed");
    for group in groups {
        let of_group: Vec<&Check> = checks.iter().filter(|check| check.group == group).collect();
        let passed = of_group.iter().filter(|check| check.passed).count();
        // The smallest p, else the largest share of the limit.
        let badness = |check: &Check| {
            if check.measure == "p" {
                -check.value
            } else {
                check.value
            }
        };
        let worst = of_group.iter().max_by(|a, b| badness(a).total_cmp(&badness(b)));
        let worst = worst.map(|check| line(check)).unwrap_or_default();
        println!("{group:12} {passed:>7} {:>7}  {worst}", of_group.len() - passed);
    }
    for check in checks.iter().filter(|check| verbose || !check.passed) {
        println!(
            "{} {}: {}",
            if check.passed { "  ok  " } else { "FAILED" },
            check.group,
            line(check)
        );
    }
}

fn line(check: &Check) -> String {
    let comparison = if check.measure == "p" { "above" } else { "at most" };
    format!(
        "{}: {} {:.3e}, {comparison} {:.1e}",
        check.name, check.measure, check.value, check.limit
    )
}
