//! `glossmith plan`: which effects a scene calls for, and why.

use std::path::PathBuf;

use anyhow::Context;
use clap::Args;

use super::parse;
use super::scene::SceneArguments;
use crate::job::effect::{Decision, EffectId};
use crate::job::plan::Plan;
use crate::render::{EngineChoice, Session};

/// Arguments of `glossmith plan`: those of `glossmith render` that describe the scene.
#[derive(Debug, Args)]
pub struct PlanArguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// Write the table as JSON, too.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Prints the plan as a table.
///
/// # Errors
/// One line that names the file, what is wrong and what to do.
pub fn run(arguments: &PlanArguments) -> anyhow::Result<()> {
    if let Some(path) = &arguments.json {
        parse::check_writable(path)?;
    }
    let mut session = Session::open(EngineChoice::Cpu)?;
    let document = arguments.scene.document(&mut session)?;
    session.submit(&document)?;
    let job = session.job().context("the scene has no plan")?;
    print(&job.plan);
    if let Some(path) = &arguments.json {
        let text = serde_json::to_string_pretty(&json(&job.plan))?;
        std::fs::write(path, text + "\n")
            .with_context(|| format!("{}: the plan could not be written", path.display()))?;
    }
    Ok(())
}

fn print(plan: &Plan) {
    let width = plan.table().map(|(effect, _)| effect.name().len()).max().unwrap_or(0);
    for (effect, decision) in plan.table() {
        let word = if decision.is_on { "on" } else { "off" };
        println!("{:width$}  {word:3}  {}", effect.name(), decision.reason);
    }
    println!(
        "{} of {} effects are simulated; the kernel leaves out {}",
        plan.effects().len(),
        plan.table().count(),
        plan.left_out()
    );
}

fn json(plan: &Plan) -> serde_json::Value {
    let row = |(effect, decision): (EffectId, &Decision)| {
        serde_json::json!({
            "name": effect.name(),
            "on": decision.is_on,
            "reason": decision.reason,
            "constant": effect.constant().map(|constant| constant.name),
            "value": effect.constant().map(|_| decision.value),
        })
    };
    serde_json::json!({
        "version": env!("CARGO_PKG_VERSION"),
        "effects": plan.table().map(row).collect::<Vec<_>>(),
        "left_out": plan.left_out(),
    })
}
