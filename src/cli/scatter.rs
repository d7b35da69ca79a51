//! `glossmith scatter`: samples of a lobe as numbers or as an image.

use std::{io::Write as _, path::Path, path::PathBuf};

use anyhow::bail;
use clap::{Args, builder::PathBufValueParser, builder::TypedValueParser};

use crate::{
    console::message,
    import::endings::ending,
    job::scatter::ScatterRequest,
    optics::curve::Curve,
    optics::lobe::{Horizon, Lobe, model::LobeModel},
    plot::{ScatterPlot, plot_file},
    render::EngineChoice,
    store::replace::{save_atomically, save_by},
};

use super::{answer::Answer, answer::file_names, names::choice, parse::check_writable, parse::number_in};

/// Samples that fit in memory on any machine of today.
const COUNT_MAX: i64 = 100_000_000;
/// Relative indices of refraction: into and out of anything there is.
const IOR: std::ops::RangeInclusive<f64> = 0.2..=5.0;

/// Arguments of `glossmith scatter`.
#[derive(Debug, Args)]
pub struct ScatterArguments {
    /// The lobe.
    #[arg(long, value_name = "NAME", value_parser = choice::<Lobe>)]
    lobe: Lobe,
    /// The geometric lobe's curve D(ξ).
    #[arg(long, default_value = "smooth", value_name = "NAME", value_parser = named_curve)]
    curve: Curve,
    /// Roughness in [0, 1].
    #[arg(long, default_value = "0.3", value_name = "R", value_parser = number_in(0.0..=1.0), allow_negative_numbers = true)]
    roughness: f64,
    /// What happens to samples below the surface.
    #[arg(long, default_value = "mirror", value_name = "mirror|absorb|none", value_parser = choice::<Horizon>)]
    horizon: Horizon,
    /// Angle between the view and the normal, 0 to 90.
    #[arg(long, default_value = "45", value_name = "DEG", value_parser = number_in(0.0..=90.0), allow_negative_numbers = true)]
    view_angle: f64,
    /// Refracts instead of reflecting: index of refraction behind the surface over that before it. Refracted samples
    /// have z < 0; beyond the critical angle lobes without facets reflect.
    #[arg(long, value_name = "X", value_parser = number_in(IOR), allow_negative_numbers = true)]
    ior: Option<f64>,
    /// Samples to draw; absorbed ones count.
    #[arg(long, default_value_t = 10_000, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=COUNT_MAX))]
    count: u32,
    /// Changes all random numbers.
    #[arg(long, default_value_t = 0, value_name = "N", allow_negative_numbers = true)]
    seed: u32,
    /// The engine whose function draws.
    #[arg(long, default_value = "auto", value_name = "auto|gpu|cpu")]
    engine: EngineChoice,
    /// .csv: columns x,y,z,density, a row a sample; .png: the samples seen from the lobe's middle.
    #[arg(long, value_name = "FILE.csv|FILE.png", value_parser = output())]
    output: PathBuf,
    #[command(flatten)]
    answer: Answer,
}

/// Draws and writes the samples.
///
/// # Errors
/// An argument out of range, a GPU that fails, a file that can't be written.
pub fn run(arguments: &ScatterArguments) -> anyhow::Result<()> {
    check_writable(&arguments.output)?;
    arguments.answer.check_writable()?;
    let request = ScatterRequest {
        model: LobeModel {
            horizon: arguments.horizon,
            eta: arguments.ior.unwrap_or(0.0),
            ..LobeModel::new(arguments.lobe, arguments.roughness, arguments.curve)
        },
        view_angle_deg: arguments.view_angle as f32,
        count: arguments.count,
        seed: arguments.seed,
    };
    let cloud = crate::render::Prober::open(arguments.engine)?.scatter(&request)?;
    if cloud.absorbed > 0 {
        message!(
            "{} of {} samples were absorbed at the horizon",
            cloud.absorbed,
            request.count
        );
    }
    if is_picture(&arguments.output)? {
        let plot = ScatterPlot {
            request: &request,
            cloud: &cloud,
        };
        save_atomically(&arguments.output, &plot_file(&arguments.output, &plot)?)?;
    } else {
        save_by(&arguments.output, |file| {
            writeln!(file, "x,y,z,density")?;
            cloud
                .samples
                .iter()
                .try_for_each(|[x, y, z, density]| writeln!(file, "{x},{y},{z},{density}"))
        })?;
    }
    message!("wrote {}", arguments.output.display());
    arguments.answer.write(&serde_json::json!({
        "version": env!("CARGO_PKG_VERSION"),
        "lobe": arguments.lobe.name(),
        "curve": arguments.curve.name(),
        "roughness": arguments.roughness,
        "view_angle_deg": arguments.view_angle,
        "samples": request.count,
        "absorbed": cloud.absorbed,
        "files": file_names([&arguments.output]),
    }))
}

/// Whether a file takes a picture of the samples, not their numbers.
fn is_picture(path: &Path) -> anyhow::Result<bool> {
    match ending(path).as_str() {
        "csv" => Ok(false),
        "png" => Ok(true),
        _ => bail!(
            "{}: samples are written as .csv or .png; give the file one of these endings",
            path.display()
        ),
    }
}

/// A custom curve's points have no place on the command line.
fn named_curve(text: &str) -> Result<Curve, String> {
    match choice::<Curve>(text)? {
        curve if curve.has_table() => {
            Err("it has no points here; draw it in the editor, or choose a named curve".to_owned())
        }
        named => Ok(named),
    }
}

/// The name of the file; its ending is one of those that are written.
fn output() -> impl TypedValueParser<Value = PathBuf> {
    let checked = |path: PathBuf| is_picture(&path).map(|_| path).map_err(|error| error.to_string());
    PathBufValueParser::new().try_map(checked)
}
