//! `glossmith evaluate`: values, densities and albedos of a material as numbers.

mod directions;

use std::{io::Write as _, path::PathBuf, str::FromStr as _};

use anyhow::bail;
use clap::Args;

use self::directions::{Pairs, unit_direction};
use super::{answer::Answer, answer::file_names, names, parse, scene};
use crate::{
    console::message,
    document::{ImportLobe, MaterialSettings, parameter::assign},
    named::named,
    render::{EngineChoice, Precision},
    store::replace::save_by,
    study::evaluate::{Albedo, BATCHES, Evaluation, Evaluator},
};

/// Steps of a grid without a number.
const GRID: &str = "9";
/// The most steps of a grid: some three million pairs.
const GRID_MAX: i64 = 90;
/// Samples of an albedo.
const COUNT_MAX: i64 = 1 << 24;

named! {
    /// The side of the surface that the viewer is on.
    Side {
        Above, "above", "Above", "Outside.";
        Below, "below", "Below", "Inside the solid.";
    }
}

/// Arguments of `glossmith evaluate`.
#[derive(Debug, Args)]
pub struct EvaluateArguments {
    /// The material: the name of a shipped one, or a file (.json, or one of another program, such as .mtlx).
    #[arg(long, value_name = "FILE|NAME", value_parser = parse::name_of_file(String::from_str))]
    material: String,
    #[command(flatten)]
    asked: Asked,
    /// .csv: the columns of --directions or --grid with r,g,b,density; or cos_theta_o,R_r,R_g,R_b,T_r,T_g,T_b,se_R,se_T.
    #[arg(long, value_name = "FILE.csv")]
    output: PathBuf,
    /// Samples of each albedo, in 16 independent batches that give its standard error.
    #[arg(long, default_value_t = 1 << 18, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(i64::from(BATCHES)..=COUNT_MAX))]
    count: u32,
    /// Changes the random numbers of --albedo.
    #[arg(long, default_value_t = 0, value_name = "N", allow_negative_numbers = true)]
    seed: u32,
    /// The side of the surface from which angles and cosines count: outside, or inside a solid.
    #[arg(long, default_value = "above", value_name = "above|below", value_parser = names::choice::<Side>)]
    side: Side,
    /// The lobe of another program's material: geometric, its roughness matched to the look of the file's, or ggx.
    #[arg(long, default_value = "geometric", value_name = "geometric|ggx", value_parser = names::choice::<ImportLobe>)]
    import_lobe: ImportLobe,
    /// Set a parameter of the material, such as specular.roughness=0.2. May be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse::assignment)]
    assignments: Vec<String>,
    /// The engine whose functions answer.
    #[arg(long, default_value = "auto", value_name = "auto|gpu|cpu")]
    engine: EngineChoice,
    /// The precision of the arithmetic; f64 on the CPU alone.
    #[arg(long, default_value = "f32", value_name = "f32|f64")]
    precision: Precision,
    #[command(flatten)]
    answer: Answer,
}

/// What is asked, one of three.
impl EvaluateArguments {
    /// The sign of heights above the side that is asked for.
    fn up(&self) -> f64 {
        if self.side == Side::Above { 1.0 } else { -1.0 }
    }
}

#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
struct Asked {
    /// Pairs of directions: a table with the columns theta_o, phi_o, theta_i, phi_i in degrees. Theta counts from the
    /// normal z, phi from the tangent x; `_o` is to the viewer, `_i` to the light. Other columns are kept.
    #[arg(long, value_name = "FILE.csv")]
    directions: Option<PathBuf>,
    /// A grid: N views from the normal to the horizon, each with N × 2N lights above the surface, and as many below one
    /// that transmits [default: 9].
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = GRID, value_parser = clap::value_parser!(u32).range(1..=GRID_MAX))]
    grid: Option<u32>,
    /// Directional albedos, reflected and transmitted, at these cosines of the view.
    #[arg(long, value_name = "COS[,COS…]", value_delimiter = ',', value_parser = parse::number_in(1e-3..=1.0), allow_negative_numbers = true)]
    albedo: Vec<f64>,
}

/// Evaluates and writes the numbers.
///
/// # Errors
/// A material or directions that can't be read, a GPU that fails, a file that can't be written.
pub fn run(arguments: &EvaluateArguments) -> anyhow::Result<()> {
    parse::check_writable(&arguments.output)?;
    arguments.answer.check_writable()?;
    if arguments.engine == EngineChoice::Gpu && arguments.precision == Precision::Double {
        bail!("--precision f64: the GPU computes in f32; choose --engine cpu");
    }
    let material = material(arguments)?;
    let evaluator = Evaluator::open(&material, arguments.engine, arguments.precision)?;
    let rows = if arguments.asked.albedo.is_empty() {
        write_values(arguments, &evaluator)?
    } else {
        write_albedos(arguments, &evaluator)?
    };
    message!("wrote {}", arguments.output.display());
    arguments.answer.write(&serde_json::json!({
        "version": env!("CARGO_PKG_VERSION"),
        "material": material.name,
        "side": arguments.side.name(),
        "precision": arguments.precision,
        "rows": rows,
        "files": file_names([&arguments.output]),
    }))
}

fn material(arguments: &EvaluateArguments) -> anyhow::Result<MaterialSettings> {
    let mut material = scene::material(&arguments.material, arguments.import_lobe)?;
    for assignment in &arguments.assignments {
        assign(&mut material, assignment)?;
    }
    if material.user_textures.iter().next().is_some() {
        log::warn!("{}: its textures are left out", arguments.material);
    }
    Ok(material)
}

/// Writes value and density for each pair; returns the number of rows.
fn write_values(arguments: &EvaluateArguments, evaluator: &Evaluator) -> anyhow::Result<usize> {
    let pairs = match &arguments.asked.directions {
        Some(path) => Pairs::read(path)?,
        None => Pairs::grid(arguments.asked.grid.unwrap_or_default(), evaluator.transmits())?,
    };
    let up = arguments.up();
    let toward = |pair: &[[f64; 2]; 2]| pair.map(|angles_deg| unit_direction(angles_deg, up));
    let directions: Vec<_> = pairs.angles_deg.iter().map(toward).collect();
    let values = evaluator.evaluate(&directions)?;
    save_by(&arguments.output, |file| {
        writeln!(file, "{},r,g,b,density", pairs.header)?;
        for (
            row,
            Evaluation {
                value: [r, g, b],
                density,
            },
        ) in pairs.rows.iter().zip(&values)
        {
            writeln!(file, "{row},{r},{g},{b},{density}")?;
        }
        Ok(())
    })?;
    Ok(values.len())
}

/// Writes an albedo for each cosine; returns the number of rows.
fn write_albedos(arguments: &EvaluateArguments, evaluator: &Evaluator) -> anyhow::Result<usize> {
    let (cosines, up) = (&arguments.asked.albedo, arguments.up());
    let albedo = |cosine: &f64| evaluator.albedo(up * cosine, arguments.count, arguments.seed);
    let albedos: Vec<Albedo> = cosines.iter().map(albedo).collect::<Result<_, _>>()?;
    save_by(&arguments.output, |file| {
        writeln!(file, "cos_theta_o,R_r,R_g,R_b,T_r,T_g,T_b,se_R,se_T")?;
        for (cosine, albedo) in cosines.iter().zip(&albedos) {
            let [[a, b, c], [d, e, f]] = [albedo.reflected, albedo.transmitted];
            let [of_reflected, of_transmitted] = albedo.standard_errors;
            writeln!(file, "{cosine},{a},{b},{c},{d},{e},{f},{of_reflected},{of_transmitted}")?;
        }
        Ok(())
    })?;
    Ok(albedos.len())
}
