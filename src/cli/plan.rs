//! `glossmith plan`: which effects a scene calls for, and why.

use anyhow::Context;
use clap::Args;

use super::{answer::Answer, scene::SceneArguments};
use crate::{
    console::output,
    job::effect::{Decision, EffectId},
    job::plan::Plan,
};

/// Arguments of `glossmith plan`: those of `glossmith render` that describe the scene.
#[derive(Debug, Args)]
pub struct PlanArguments {
    #[command(flatten)]
    scene: SceneArguments,
    #[command(flatten)]
    answer: Answer,
}

/// Prints the plan as a table.
///
/// # Errors
/// One line that names the file, what is wrong and what to do.
pub fn run(arguments: &PlanArguments) -> anyhow::Result<()> {
    arguments.answer.check_writable()?;
    let (session, _) = arguments.scene.on_cpu()?;
    let job = session.job().context("the scene has no plan")?;
    if arguments.answer.has_words() {
        print(&job.plan);
    }
    arguments.answer.write(&json(&job.plan))
}

fn print(plan: &Plan) {
    let width = plan.table().map(|(effect, _)| effect.name().len()).max().unwrap_or(0);
    for (effect, decision) in plan.table() {
        let word = if decision.is_on { "on" } else { "off" };
        output!("{:width$}  {word:3}  {}", effect.name(), decision.reason);
    }
    output!("{} of {} features active", plan.effects().len(), plan.table().count());
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
