//! `glossmith batch`: all combinations of lists, as images in a folder; what is done already stays.

mod file;
mod inputs;
mod maker;
mod row;
mod sheet;
mod template;

use std::{ops::RangeInclusive, path::PathBuf};

use anyhow::{Context, bail};
use clap::Args;

use self::{file::BatchFile, file::Picture, maker::Maker, row::Row, row::Status};
use super::{PartialFailure, answer::Destination, answer::Lines, parse};
use crate::{console::message, render::EngineChoice, store::replace::save_atomically};

/// Arguments of `glossmith batch`.
#[derive(Debug, Args)]
pub struct BatchArguments {
    /// The lists, in TOML: models, materials, environments, cameras, settings; docs/tutorials/automate.md shows one.
    #[arg(value_name = "FILE.toml")]
    file: PathBuf,
    /// The folder for the images, in place of the file's.
    #[arg(long, value_name = "FOLDER")]
    folder: Option<PathBuf>,
    /// Only these images, by their numbers from 1.
    #[arg(long, value_name = "N|FROM-TO", value_parser = numbers)]
    pictures: Option<RangeInclusive<usize>>,
    /// Only these frames of each turn, by their numbers from 1.
    #[arg(long, value_name = "N|FROM-TO", value_parser = numbers)]
    frame_range: Option<RangeInclusive<usize>>,
    /// Render a part of each image's samples only, to be joined by --merge: the number of the first.
    #[arg(long, value_name = "N", requires = "samples_to")]
    samples_from: Option<u32>,
    /// The number after the part's last sample. Other numbers draw other random numbers.
    #[arg(long, value_name = "N")]
    samples_to: Option<u32>,
    /// The same by parts of equal size: part K of N.
    #[arg(long, value_name = "K/N", value_parser = slice, conflicts_with_all = ["samples_from", "samples_to"])]
    slice: Option<[u32; 2]>,
    /// Join the parts that are in the folder to images, and render nothing; write the contact sheets.
    #[arg(long, conflicts_with_all = ["samples_from", "samples_to", "slice"])]
    merge: bool,
    /// Render nothing: write an Open Job Description template (jobtemplate-2023-09), by which render farms run the batch.
    #[arg(long, value_name = "OUT.yaml")]
    job_template: Option<PathBuf>,
    /// Tasks of the template for each image, each with an equal part of its samples.
    #[arg(long, value_name = "N", default_value_t = 1, requires = "job_template", value_parser = clap::value_parser!(u32).range(1..=9999))]
    slices: u32,
    /// Where a line of JSON goes for each image; - is standard output.
    #[arg(long, value_name = "FILE|-", default_value = "-")]
    json: Destination,
    /// The engine: a hardware GPU if there is one, else the CPU; the GPU; the CPU.
    #[arg(long, default_value = "auto", value_name = "auto|gpu|cpu")]
    engine: EngineChoice,
}

/// `3` or `3-7`, from 1.
fn numbers(text: &str) -> Result<RangeInclusive<usize>, String> {
    let (from, to) = text.split_once('-').unwrap_or((text, text));
    let number = |text: &str| text.trim().parse::<usize>().ok().filter(|number| *number > 0);
    match (number(from), number(to)) {
        (Some(from), Some(to)) if from <= to => Ok(from..=to),
        _ => Err("give a number from 1, or two such as 3-7".to_owned()),
    }
}

/// `2/5`: the second of five.
fn slice(text: &str) -> Result<[u32; 2], String> {
    let is_one = |[part, of]: &[u32; 2]| (1..=*of).contains(part);
    let expected = || "give the number of the part and how many there are, such as 2/5".to_owned();
    parse::pair(text, &['/']).filter(is_one).ok_or_else(expected)
}

impl BatchArguments {
    fn is_of_parts(&self) -> bool {
        self.slice.is_some() || self.samples_to.is_some()
    }

    /// The first sample of a part and the one after its last, of an image with this many samples.
    fn part(&self, samples: u32) -> Option<[u32; 2]> {
        let from = self.samples_from.unwrap_or(0);
        match self.slice {
            Some([part, of]) => {
                let bound = |part: u32| (u64::from(samples) * u64::from(part) / u64::from(of)) as u32;
                Some([bound(part - 1), bound(part)])
            }
            None => self.samples_to.map(|to| [from, to]),
        }
    }
}

/// Renders, joins, or writes the template.
///
/// # Errors
/// One line that names the file, what is wrong and what to do; [`PartialFailure`] where some images are there and others
/// are not.
pub fn run(arguments: &BatchArguments) -> anyhow::Result<()> {
    let mut file = BatchFile::read(&arguments.file)?;
    if let Some(folder) = &arguments.folder {
        file.folder = folder.clone();
    }
    let all = file.pictures();
    if let Some(path) = &arguments.job_template {
        parse::check_writable(path)?;
        save_atomically(
            path,
            template::text(path, &file, all.len(), arguments.slices).as_bytes(),
        )?;
        message!(
            "wrote {}: {} images, {} tasks each",
            path.display(),
            all.len(),
            arguments.slices
        );
        return Ok(());
    }
    let chosen = chosen(&file, &all, arguments)?;
    let from = arguments.samples_from.unwrap_or(0);
    if let Some(to) = arguments.samples_to.filter(|to| *to <= from) {
        bail!("--samples-to {to} must be above --samples-from {from}");
    }
    std::fs::create_dir_all(&file.folder).with_context(|| {
        format!(
            "{}: the folder cannot be made; give another by --folder",
            file.folder.display()
        )
    })?;
    let mut lines = Lines::open(&arguments.json)?;
    let mut maker = Maker::open(&file, arguments)?;
    let mut failed = 0;
    for (number, picture) in &chosen {
        let row = maker.make(*number, picture);
        report(&row, &mut lines, all.len())?;
        failed += usize::from(row.status == Status::Failed);
    }
    // Where several programs render at once, none of them has all images.
    if !arguments.is_of_parts() && (chosen.len() == all.len() || arguments.merge) {
        sheet::write(&file, &all)?;
    }
    match failed {
        0 => Ok(()),
        _ if failed == chosen.len() => bail!("none of the {failed} images could be made; the lines above say why"),
        _ => Err(PartialFailure(format!(
            "{failed} of {} images could not be made; the lines above say why. Run it again for them alone",
            chosen.len()
        ))
        .into()),
    }
}

/// The images that are asked for, with their numbers.
fn chosen<'a>(
    file: &BatchFile,
    all: &'a [Picture],
    arguments: &BatchArguments,
) -> anyhow::Result<Vec<(usize, &'a Picture)>> {
    let within = |range: &Option<RangeInclusive<usize>>, option: &str, count: usize| match range {
        Some(range) if *range.end() > count => {
            bail!("{option} {}-{}: there are {count} only", range.start(), range.end())
        }
        _ => Ok(()),
    };
    within(&arguments.pictures, "--pictures", all.len())?;
    match (file.frames, &arguments.frame_range) {
        (None, Some(_)) => bail!(
            "--frame-range: nothing turns in {}; add frames = 36 to it, or choose by --pictures",
            file.path.display()
        ),
        (Some(frames), range) => within(range, "--frame-range", frames as usize)?,
        (None, None) => {}
    }
    let is_chosen = |(number, picture): &(usize, &Picture)| {
        let frame = picture.frame.map_or(1, |frame| frame as usize + 1);
        arguments.pictures.as_ref().is_none_or(|range| range.contains(number))
            && arguments
                .frame_range
                .as_ref()
                .is_none_or(|range| range.contains(&frame))
    };
    let chosen: Vec<_> = (1..).zip(all).filter(is_chosen).collect();
    if chosen.is_empty() {
        bail!("--pictures and --frame-range have no image in common; --pictures counts every frame");
    }
    Ok(chosen)
}

/// A line to the program that called, and one for people.
fn report(row: &Row, lines: &mut Lines, count: usize) -> anyhow::Result<()> {
    lines.write(row)?;
    let Row {
        number,
        picture,
        status,
        ..
    } = row;
    let outcome = row
        .error
        .clone()
        .unwrap_or_else(|| format!("{status:?}").to_lowercase());
    message!("{number} of {count}, {picture}: {outcome}");
    Ok(())
}
