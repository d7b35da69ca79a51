//! `glossmith merge`: films of the same image, joined.

use std::path::PathBuf;

use anyhow::bail;
use clap::Args;

use super::{
    answer::{Answer, file_names},
    names, parse,
    render::{add_denoised, check_takes, rendered, report_written, write_pictures},
};
use crate::{
    console::message,
    document::Denoise,
    render::{denoise::Denoised, denoise::Denoiser, output::Layers, output::Rendered, sums::KeptFilm},
};

/// Arguments of `glossmith merge`.
#[derive(Debug, Args)]
pub struct MergeArguments {
    /// Films of the same image: .exr files of `glossmith render --keep-sums`, of different samples.
    #[arg(required = true, value_name = "FILM.exr")]
    films: Vec<PathBuf>,
    /// Image to write: .exr (with the sums, to be merged again), .png or .hdr. May be repeated.
    #[arg(long = "output", required = true, value_name = "FILE", value_parser = parse::picture())]
    outputs: Vec<PathBuf>,
    /// Write albedo, normal, depth, number of samples and variance as layers into .exr images.
    #[arg(long)]
    aovs: bool,
    /// Denoise the merged image.
    #[arg(long, default_value = "off", value_name = "off|fast|high|auto", value_parser = names::choice::<Denoise>)]
    denoise: Denoise,
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
    if arguments.aovs {
        check_takes("--aovs", &arguments.outputs)?;
    }
    let mut whole = joined(&arguments.films)?;
    whole.document.view.denoise = arguments.denoise;
    let samples = whole.film.samples() as f64 / whole.film.pixel_count().max(1) as f64;
    let (film, lights) = (whole.mixed(), whole.light_layers());
    let image = film.image();
    let layers = match arguments.aovs {
        true => Some(Layers::of(&film, whole.features()?)),
        false => None,
    };
    let denoised = denoised(&whole)?;
    let rendered = rendered(&image, denoised.as_ref(), &lights);
    let rendered = Rendered {
        layers: layers.as_ref(),
        sums: Some(&whole),
        ..rendered
    };
    write_pictures(&arguments.outputs, rendered, &whole.document)?;
    message!("{samples:.0} samples per pixel of {} films", arguments.films.len());
    report_written(&arguments.outputs);
    let mut answer = serde_json::json!({
        "version": env!("CARGO_PKG_VERSION"),
        "films": arguments.films,
        "samples": whole.samples,
        "samples_per_pixel": whole.sample_count(),
        "mean_samples_per_pixel": samples,
        "files": file_names(&arguments.outputs),
    });
    add_denoised(&mut answer, &whole.document, denoised.as_ref());
    arguments.answer.write(&answer)
}

/// The films as one.
pub fn joined(paths: &[PathBuf]) -> anyhow::Result<KeptFilm> {
    let mut films = Vec::new();
    for path in paths {
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
    Ok(whole)
}

/// The image of a film without its noise, where its document asks for that.
///
/// # Errors
/// Where the denoiser is not there or fails, or the film lacks what it is guided by.
pub fn denoised(film: &KeptFilm) -> anyhow::Result<Option<Denoised>> {
    let how = film.document.view.denoise;
    if how == Denoise::Off {
        return Ok(None);
    }
    let noisy = film.noisy()?;
    Ok(Some(Denoiser::open()?.denoise(&noisy, how)?))
}
