//! `glossmith merge`: films of the same picture, joined.

use std::path::PathBuf;

use anyhow::bail;
use clap::Args;

use super::answer::Answer;
use super::parse;
use crate::render::output::{self, Format, Rendered};
use crate::render::sums::KeptFilm;

/// Arguments of `glossmith merge`.
#[derive(Debug, Args)]
pub struct MergeArguments {
    /// Films of the same picture: .exr files of `glossmith render --keep-sums`, of different samples.
    #[arg(required = true, value_name = "FILM.exr")]
    films: Vec<PathBuf>,
    /// Picture to write: .exr (with the sums, to be merged again), .png or .hdr. May be repeated.
    #[arg(long = "output", required = true, value_name = "FILE", value_parser = parse::picture)]
    outputs: Vec<PathBuf>,
    #[command(flatten)]
    answer: Answer,
}

/// Joins the films in the order of their samples, so that the result does not depend on the order of the names.
///
/// # Errors
/// One line that names the file, what is wrong and what to do.
pub fn run(arguments: &MergeArguments) -> anyhow::Result<()> {
    for path in &arguments.outputs {
        parse::check_writable(path)?;
    }
    arguments.answer.check_writable()?;
    let mut films = Vec::new();
    for path in &arguments.films {
        films.push((path, KeptFilm::read(path)?));
    }
    films.sort_by_key(|(_, film)| film.samples.clone());
    let mut films = films.into_iter();
    let Some((first, mut whole)) = films.next() else {
        bail!("give the films to join");
    };
    for (path, film) in films {
        whole.add(&film, path, first)?;
    }
    eprintln!(
        "{} samples a pixel of {} films",
        whole.sample_count(),
        arguments.films.len()
    );
    let image = whole.film.image();
    for path in &arguments.outputs {
        match output::format_of(path)? {
            Format::Exr => whole.write(path)?,
            Format::Png | Format::Hdr => output::write(path, Rendered::from(&image), &whole.document)?,
        }
        eprintln!("wrote {}", path.display());
    }
    arguments.answer.write(&serde_json::json!({
        "version": env!("CARGO_PKG_VERSION"),
        "films": arguments.films,
        "samples": whole.samples,
        "samples_per_pixel": whole.sample_count(),
        "files": arguments.outputs,
    }))
}
