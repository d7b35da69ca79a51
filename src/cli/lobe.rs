//! `glossmith lobe`: views of lobes as plots or numbers.

use std::path::{Path, PathBuf};

use anyhow::bail;
use clap::Args;

use super::{
    answer::{Answer, file_names},
    lobe_spec::lobe_model,
    names,
    parse::{check_writable, number_in},
    scene::material,
};
use crate::{
    console::message,
    document::ImportLobe,
    matching::lobe_of_material,
    optics::lobe::{Horizon, model::LobeModel},
    plot::lobe_view::{LobeView, ViewKind, lobe_view},
    plot::plot_file,
    store::replace::save_atomically,
};

/// Arguments of `glossmith lobe`.
#[derive(Debug, Args)]
pub struct LobeArguments {
    /// What is shown: a slice in the plane of incidence, the lobe in space, the density over the hemisphere, the albedo,
    /// the reciprocity error, the share of the samples below the horizon, the density of the geometric lobe's distance D.
    #[arg(long, value_name = "polar|3d|hemisphere|albedo|reciprocity|horizon|distance", value_parser = names::choice::<ViewKind>)]
    plot: ViewKind,
    /// A lobe, its roughness in [0, 1] (for the microfacet lobes the square root of α, or alpha=A itself; 0.3 without
    /// one) and the geometric lobe's curve, such as geometric:0.3/sqrt. May be repeated to compare.
    #[arg(long = "lobe", value_name = "NAME[:ROUGHNESS][/CURVE]", value_parser = lobe_model)]
    lobes: Vec<LobeModel>,
    /// The specular lobe of a material, its Fresnel factor left aside. May be repeated.
    #[arg(long = "material", value_name = "FILE|NAME")]
    materials: Vec<String>,
    /// What happens to samples below the surface, for the lobes of --lobe.
    #[arg(long, default_value = "mirror", value_name = "mirror|absorb|none", value_parser = names::choice::<Horizon>)]
    horizon: Horizon,
    /// Angles between view and normal, from 0 to below 90 [default: 45, or all where the plot is against the angle].
    #[arg(long, value_name = "DEG[,DEG…]", value_delimiter = ',', value_parser = number_in(0.0..=89.9))]
    view_angle: Vec<f64>,
    /// The plot, or its numbers.
    #[arg(long, value_name = "FILE.png|FILE.svg|FILE.csv")]
    output: PathBuf,
    #[command(flatten)]
    answer: Answer,
}

/// Computes and writes the view.
///
/// # Errors
/// A material that can't be read or is a mirror, a file that can't be written.
pub fn run(arguments: &LobeArguments) -> anyhow::Result<()> {
    check_ending(&arguments.output)?;
    check_writable(&arguments.output)?;
    arguments.answer.check_writable()?;
    let lobes = lobes(arguments)?;
    let angles_deg = if arguments.view_angle.is_empty() {
        arguments.plot.view_angles_deg()
    } else {
        arguments.view_angle.clone()
    };
    let view = lobe_view(arguments.plot, &lobes, &angles_deg);
    write_view(&arguments.output, &view)?;
    arguments.answer.write(&serde_json::json!({
        "version": env!("CARGO_PKG_VERSION"),
        "plot": arguments.plot.name(),
        "lobes": lobes.iter().map(|lobe| &lobe.name).collect::<Vec<_>>(),
        "view_angles_deg": angles_deg,
        "files": file_names([&arguments.output]),
    }))
}

/// Before the work, not after it.
pub fn check_ending(path: &Path) -> anyhow::Result<()> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    if !matches!(ending, "png" | "svg" | "csv") {
        bail!(
            "{}: plots are written as .png, .svg or .csv; give the file one of these endings",
            path.display()
        );
    }
    Ok(())
}

/// Writes a view in the format that the file's ending says.
pub fn write_view(path: &Path, view: &LobeView) -> anyhow::Result<()> {
    let contents = if path.extension().is_some_and(|ending| ending == "csv") {
        view.csv().into_bytes()
    } else {
        plot_file(path, view)?
    };
    save_atomically(path, &contents)?;
    message!("wrote {}", path.display());
    Ok(())
}

/// The lobes of both kinds of arguments.
fn lobes(arguments: &LobeArguments) -> anyhow::Result<Vec<LobeModel>> {
    let mut lobes = arguments.lobes.clone();
    for lobe in &mut lobes {
        lobe.horizon = arguments.horizon;
    }
    for name in &arguments.materials {
        let lobe = lobe_of_material(&material(name, ImportLobe::default())?);
        if !lobe.has_density() {
            bail!(
                "--material {name}: its roughness of {} is a mirror's, which has no density; choose a rougher one",
                lobe.roughness
            );
        }
        lobes.push(lobe);
    }
    if lobes.is_empty() {
        bail!("there is no lobe to show; give --lobe NAME or --material NAME");
    }
    if let Some(lobe) = lobes.iter().find(|lobe| !arguments.plot.shows(lobe.lobe)) {
        bail!(
            "{}: only the geometric lobe has a distance D; leave it out, or choose another --plot",
            lobe.name
        );
    }
    Ok(lobes)
}
