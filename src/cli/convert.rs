//! `glossmith convert`: materials to and from other programs' formats, with what was lost on the way.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use clap::Args;

use super::{answer::Destination, answer::write_json, names, parse::check_writable};
use crate::{
    console::message,
    document::ImportLobe,
    named::joined,
    plot::{PictureSheet, plot_file},
    render::looks::compared,
    scene::path_text::path_text,
    store::{
        exchange::{self, FORMATS, ReadOptions, Registered, Subject, report::Report},
        preset,
        replace::save_atomically,
    },
};

/// Arguments of `glossmith convert`.
#[derive(Debug, Args)]
#[command(after_help = formats_help(), override_usage = "glossmith convert [OPTIONS] <IN>... <OUT>")]
pub struct ConvertArguments {
    /// What to convert, then where to: materials, projects or models, or names of shipped materials; then a file, or a
    /// folder with --to.
    #[arg(required = true, num_args = 2.., value_name = "IN... OUT")]
    paths: Vec<PathBuf>,
    /// The format to write, where OUT is a folder or its ending says too little.
    #[arg(long, value_name = "FORMAT", value_parser = format)]
    to: Option<&'static Registered>,
    /// The one material of several to convert, by its name or its number from 1.
    #[arg(long, value_name = "NAME|N")]
    material: Option<String>,
    /// The lobe of materials that know only GGX: geometric, its roughness matched to the look of GGX, or ggx.
    #[arg(long, default_value = "geometric", value_name = "geometric|ggx", value_parser = names::choice::<ImportLobe>)]
    import_lobe: ImportLobe,
    /// Read what a file shows, although it has the exact parameters too.
    #[arg(long)]
    without_exact: bool,
    /// Write what was exact, approximated and dropped, as JSON; - is standard output. Beside a file go images of a ball with
    /// each material, with what the file shows, and of their difference.
    #[arg(long = "json", alias = "report", value_name = "FILE|-")]
    report: Option<Destination>,
}

/// The formats, for the help.
fn formats_help() -> String {
    let line = |format: &Registered| {
        let ways = if format.is_read() { "in, out" } else { "out" };
        format!(
            "  {:<16} {:<12} {ways:<8} {}",
            format.name,
            joined(format.extensions.iter().map(|ending| format!(".{ending}")), " "),
            format.help
        )
    };
    format!("Formats:\n{}", joined(FORMATS.iter().map(line), "\n"))
}

fn format(text: &str) -> Result<&'static Registered, String> {
    let known = || joined(FORMATS.iter().map(|format| format.name), ", ");
    exchange::by_name(text).ok_or_else(|| format!("expected one of {}", known()))
}

/// Converts and reports what was lost.
///
/// # Errors
/// One line that names the file, what is wrong and what to do. Of many files those that can be are converted.
pub fn run(arguments: &ConvertArguments) -> anyhow::Result<()> {
    let Some((output, inputs)) = arguments.paths.split_last() else {
        bail!("give what to convert and where to");
    };
    let is_folder = inputs.len() > 1 || output.is_dir();
    if is_folder && arguments.to.is_none() {
        bail!(
            "{}: several files go to a folder; say by --to in which format",
            output.display()
        );
    }
    if is_folder {
        std::fs::create_dir_all(output)
            .with_context(|| format!("{}: the folder cannot be made; give another", output.display()))?;
    }
    let targets = targets(inputs, output, arguments.to.filter(|_| is_folder))?;
    targets.iter().try_for_each(|target| check_writable(target))?;
    arguments.report.iter().try_for_each(Destination::check_writable)?;
    let (mut reports, mut failed) = (Vec::new(), 0);
    for (input, target) in inputs.iter().zip(&targets) {
        match convert(input, target, arguments) {
            Ok(report) => {
                message!("{report}");
                reports.push(report);
            }
            Err(error) if inputs.len() == 1 => return Err(error),
            Err(error) => {
                message!("{error:#}");
                failed += 1;
            }
        }
    }
    if let Some(destination) = &arguments.report {
        write_json(destination, &reports)?;
    }
    if failed > 0 {
        bail!("{failed} of {} files could not be converted", inputs.len());
    }
    Ok(())
}

/// Where each input goes: no two to the same file.
fn targets(inputs: &[PathBuf], output: &Path, to: Option<&Registered>) -> anyhow::Result<Vec<PathBuf>> {
    let Some(format) = to else {
        return Ok(vec![output.to_owned()]);
    };
    let mut targets: Vec<PathBuf> = Vec::new();
    for input in inputs {
        let stem = input.file_stem().unwrap_or_default();
        let target = output.join(stem).with_extension(format.extensions[0]);
        if targets.contains(&target) {
            bail!(
                "{}: {} would be written twice; convert files of the same name into different folders",
                input.display(),
                target.display()
            );
        }
        targets.push(target);
    }
    Ok(targets)
}

fn convert(input: &Path, output: &Path, arguments: &ConvertArguments) -> anyhow::Result<Report> {
    let format = match arguments.to {
        Some(format) => format,
        None => exchange::by_ending(output)?,
    };
    let options = ReadOptions {
        lobe: arguments.import_lobe,
        is_plain: arguments.without_exact,
        ..ReadOptions::default()
    };
    let name = path_text(input);
    let mut subject = match preset::material_by_name(&name) {
        Some(material) => Subject::of(material.clone()),
        None if input.extension().is_none() => Subject::of(preset::find(&name)?.value),
        None => exchange::read(input, options)?,
    };
    if let Some(wanted) = &arguments.material {
        subject = chosen(subject, wanted).with_context(|| format!("{name}: --material {wanted}"))?;
    }
    let mut prepared = exchange::prepare(&subject, &name, output, format)?;
    if let Some(Destination::File(path)) = &arguments.report {
        compare(&mut prepared.report, path)?;
    }
    prepared.save()?;
    Ok(prepared.report)
}

/// Renders a ball of each material and of what the file shows, into an image beside the report.
fn compare(report: &mut Report, path: &Path) -> anyhow::Result<()> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let of_file = report.output.file_stem().unwrap_or_default().to_string_lossy();
    for (index, material) in report.materials.iter_mut().enumerate() {
        let Some(looks) = &material.looks else { continue };
        let compared = compared(looks)?;
        material.difference = Some(compared.difference);
        let names = [material.material.as_str(), "as the file shows it", "difference"];
        let sheet = PictureSheet {
            title: format!("{}, {of_file}", material.material),
            pictures: names.map(str::to_owned).into_iter().zip(compared.pictures).collect(),
        };
        let number = if index == 0 {
            String::new()
        } else {
            format!("-{}", index + 1)
        };
        let picture = path.with_file_name(format!("{stem}-{of_file}{number}.png"));
        save_atomically(&picture, &plot_file(&picture, &sheet)?)?;
        message!("wrote {}", picture.display());
    }
    Ok(())
}

/// The subject with one of its materials alone.
fn chosen(subject: Subject, wanted: &str) -> anyhow::Result<Subject> {
    let names: Vec<&str> = subject
        .materials
        .iter()
        .map(|material| material.name.as_str())
        .collect();
    let by_number = wanted.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
    let by_name = names.iter().position(|name| *name == wanted);
    let index = by_name.or(by_number.filter(|index| *index < names.len()));
    let index = index.with_context(|| format!("there is no such material; there are {}", names.join(", ")))?;
    Ok(Subject {
        materials: vec![subject.materials[index].clone()],
        document: None,
        losses: subject.losses.get(index).cloned().into_iter().collect(),
    })
}
