//! `glossmith scatter`: samples of a lobe as numbers or as a picture.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use clap::Args;

use crate::analysis::scatter::{ScatterCloud, ScatterRequest};
use crate::optics::curve::Curve;
use crate::optics::lobe::{Horizon, Lobe};
use crate::render::EngineChoice;

use super::names::{curve, horizon, lobe};

/// Arguments of `glossmith scatter`.
#[derive(Debug, Args)]
pub struct ScatterArguments {
    /// The lobe.
    #[arg(long, value_name = "NAME", value_parser = lobe)]
    lobe: Lobe,
    /// The geometric lobe's curve D(ξ).
    #[arg(long, default_value = "smooth", value_name = "NAME", value_parser = curve)]
    curve: Curve,
    /// Roughness in [0, 1].
    #[arg(long, default_value_t = 0.3, value_name = "R")]
    roughness: f32,
    /// What happens to samples below the surface.
    #[arg(long, default_value = "mirror", value_name = "mirror|absorb|none", value_parser = horizon)]
    horizon: Horizon,
    /// Angle between the view and the normal, 0 to 90.
    #[arg(long, default_value_t = 45.0, value_name = "DEG")]
    view_angle: f32,
    /// Samples to draw; absorbed ones count.
    #[arg(long, default_value_t = 10_000, value_name = "N")]
    count: u32,
    /// Changes all random numbers.
    #[arg(long, default_value_t = 0, value_name = "N")]
    seed: u32,
    /// The engine whose function draws.
    #[arg(long, default_value = "auto", value_name = "auto|gpu|cpu")]
    engine: EngineChoice,
    /// .csv: columns x,y,z,density, a row a sample; .png: the samples seen from the mirror direction.
    #[arg(long, value_name = "FILE.csv|FILE.png")]
    output: PathBuf,
}

/// Draws and writes the samples.
///
/// # Errors
/// An argument out of range, a GPU that fails, a file that can't be written.
pub fn run(arguments: &ScatterArguments) -> anyhow::Result<()> {
    if !(0.0..=1.0).contains(&arguments.roughness) {
        bail!("--roughness is {}; it must lie between 0 and 1", arguments.roughness);
    }
    if !(0.0..=90.0).contains(&arguments.view_angle) {
        bail!("--view-angle is {}; it must lie between 0 and 90", arguments.view_angle);
    }
    if arguments.curve == Curve::Custom {
        bail!("--curve custom has no points here; draw it in the editor, or choose a named curve");
    }
    let ending = arguments
        .output
        .extension()
        .and_then(|ending| ending.to_str())
        .unwrap_or_default();
    if !matches!(ending, "csv" | "png") {
        bail!(
            "{}: samples are written as .csv or .png; give the file one of these endings",
            arguments.output.display()
        );
    }
    let request = ScatterRequest {
        lobe: arguments.lobe,
        curve: arguments.curve,
        horizon: arguments.horizon,
        roughness: arguments.roughness,
        anisotropy: 0.0,
        table: Vec::new(),
        view_angle_deg: arguments.view_angle,
        count: arguments.count,
        seed: arguments.seed,
    };
    let cloud = crate::render::scatter(arguments.engine, &request)?;
    if cloud.absorbed > 0 {
        eprintln!(
            "{} of {} samples were absorbed at the horizon",
            cloud.absorbed, request.count
        );
    }
    match ending {
        "csv" => write_csv(&arguments.output, &cloud)?,
        _ => crate::analysis::plot::scatter_png(&arguments.output, &request, &cloud)?,
    }
    eprintln!("wrote {}", arguments.output.display());
    Ok(())
}

fn write_csv(path: &Path, cloud: &ScatterCloud) -> anyhow::Result<()> {
    let mut text = String::from("x,y,z,density\n");
    for [x, y, z, density] in &cloud.samples {
        writeln!(text, "{x},{y},{z},{density}")?;
    }
    std::fs::write(path, text).with_context(|| format!("{}: could not be written", path.display()))
}
