//! `glossmith fit`: a material that looks like another lobe or like a measured one.

use std::{path::Path, path::PathBuf, sync::Arc};

use clap::Args;

use super::{
    answer::{Answer, file_names},
    lobe::{check_ending, write_view},
    lobe_spec::lobe_model,
    names,
    parse::check_writable,
};
use crate::{
    analysis::fit::Merl,
    console::{message, output},
    document::MaterialSettings,
    matching::{Candidate, LookMatch, Target, comparison, match_look},
    optics::lobe::{Lobe, model::LobeModel},
    optics::vector::Vec3,
    plot::lobe_view::LobeView,
    store::save_material,
};

/// View angles where none is given.
const VIEW_ANGLE_DEG: f64 = 0.0;
const VIEW_ANGLE_MEASURED_DEG: f64 = 30.0;

/// Arguments of `glossmith fit`.
#[derive(Debug, Args)]
pub struct FitArguments {
    /// What to come close to: a lobe and its roughness in [0, 1], for the microfacet lobes the square root of α as
    /// everywhere (or alpha=A itself); or a measured material of the MERL BRDF database.
    #[arg(long, value_name = "ggx:0.1|ggx:alpha=0.01|FILE.binary", value_parser = parse_target)]
    target: TargetArgument,
    /// Angle between the view and the normal at which the two are compared, 0 to 85 [default: 0 for a lobe, 30 for a
    /// measured material, whose data are weakest where the view hides the light].
    #[arg(long, value_name = "DEG")]
    view_angle: Option<f64>,
    /// The lobe to fit. For the geometric one the curve is fitted too.
    #[arg(long, default_value = "geometric", value_name = "NAME", value_parser = names::choice::<Lobe>)]
    lobe: Lobe,
    /// The material to write.
    #[arg(long, value_name = "MATERIAL.json")]
    output: PathBuf,
    /// Also write target and fits, before and after, in the plane of incidence.
    #[arg(long, value_name = "FILE.png|FILE.svg|FILE.csv")]
    plot: Option<PathBuf>,
    #[command(flatten)]
    answer: Answer,
}

/// A target as it is named.
#[derive(Clone, Debug)]
enum TargetArgument {
    Lobe(Box<LobeModel>),
    File(PathBuf),
}

/// A file where the text looks like one, else a lobe.
fn parse_target(text: &str) -> Result<TargetArgument, String> {
    let path = Path::new(text);
    if path.extension().is_some_and(|ending| ending == "binary") || path.is_file() {
        return Ok(TargetArgument::File(path.to_owned()));
    }
    lobe_model(text).map(|model| TargetArgument::Lobe(Box::new(model)))
}

/// Fits and writes the material.
///
/// # Errors
/// What is wrong with the target or the file.
pub fn run(arguments: &FitArguments) -> anyhow::Result<()> {
    if let Some(path) = &arguments.plot {
        check_ending(path)?;
        check_writable(path)?;
    }
    check_writable(&arguments.output)?;
    arguments.answer.check_writable()?;
    let (target, view_angle_deg) = match &arguments.target {
        TargetArgument::Lobe(model) => (Target::Lobe((**model).clone()), VIEW_ANGLE_DEG),
        TargetArgument::File(path) => {
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let merl = Arc::new(Merl::load(path)?);
            (Target::Measured { name, merl }, VIEW_ANGLE_MEASURED_DEG)
        }
    };
    let found = match_look(&target, arguments.lobe, arguments.view_angle.unwrap_or(view_angle_deg))?;
    if arguments.answer.has_words() {
        print_match(&found);
    }
    let mut material = MaterialSettings {
        name: format!("Like {}", found.target),
        ..MaterialSettings::default()
    };
    found.apply(&mut material);
    save_material(&arguments.output, &material)?;
    message!("wrote {}", arguments.output.display());
    if let Some(path) = &arguments.plot {
        write_view(path, &LobeView::Lines(comparison(&target, &found)?))?;
    }
    arguments.answer.write(&json(&found, arguments))
}

/// What was found, as a value.
fn json(found: &LookMatch, arguments: &FitArguments) -> serde_json::Value {
    let candidate = |candidate: &Candidate| {
        serde_json::json!({
            "lobe": candidate.model.name,
            "roughness": candidate.model.roughness,
            "total_variation": candidate.total_variation,
        })
    };
    let files = [Some(&arguments.output), arguments.plot.as_ref()];
    serde_json::json!({
        "version": env!("CARGO_PKG_VERSION"),
        "target": found.target,
        "view_angle_deg": found.view_angle_deg,
        "before": candidate(&found.before),
        "nearest": candidate(&found.nearest),
        "after": candidate(&found.after),
        "curve": found.curve.as_ref().map(|curve| curve.points()),
        "base_color": found.colors.as_ref().map(|colors| colors.base.to_f64()),
        "specular_color": found.colors.as_ref().map(|colors| colors.highlight.to_f64()),
        "files": file_names(files.into_iter().flatten()),
    })
}

/// The residuals and what was found, a line each.
fn print_match(found: &LookMatch) {
    output!("target   {}, view angle {}°", found.target, found.view_angle_deg);
    let line = |word: &str, candidate: &Candidate| {
        output!(
            "{word:<8} TV {:.4}  {}",
            candidate.total_variation,
            candidate.model.name
        );
    };
    line("before", &found.before);
    line("nearest", &found.nearest);
    line("after", &found.after);
    output!("R        {}", found.after.model.roughness);
    if let Some(curve) = &found.curve {
        let points = curve.points().iter().map(|[xi, distance]| format!("{xi}:{distance}"));
        output!("curve    {}", crate::named::joined(points, ","));
    }
    if let Some(colors) = &found.colors {
        let text = |color: Vec3<f64>| color.to_f64().map(|x| format!("{x:.4}")).join(",");
        output!("base     {}", text(colors.base));
        output!("specular {}", text(colors.highlight));
    }
}
