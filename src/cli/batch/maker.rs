//! The images of a batch: rendered whole or in parts, or joined of parts. A record beside each says of what it was made.

use std::path::PathBuf;

use anyhow::{Context, bail};

use super::{
    BatchArguments,
    file::{BatchFile, Picture, Scene},
    inputs::Inputs,
    row::{Row, Status},
    sheet,
};
use crate::{
    cli::merge::{denoised, joined},
    cli::render::{render_to_end, rendered},
    document::{Denoise, Document, turntable::turned},
    job::film::Image,
    render::{Session, output, output::Rendered, sums},
    store::replace::{remove_leftovers, save_atomically},
};

/// What makes the images of a batch.
pub struct Maker<'a> {
    file: &'a BatchFile,
    arguments: &'a BatchArguments,
    session: Session,
}

/// An image that is to be made.
struct Wanted<'a> {
    number: usize,
    picture: &'a Picture,
    document: Document,
    part: Option<[u32; 2]>,
    hash: String,
}

impl<'a> Maker<'a> {
    /// A session for images, or for a part of the samples of each; removes what a batch that was killed has left half
    /// written.
    pub fn open(file: &'a BatchFile, arguments: &'a BatchArguments) -> anyhow::Result<Self> {
        let mut session = Session::open(arguments.engine)?;
        if arguments.is_of_parts() {
            session.keep_guides("sums of the image are kept");
        }
        remove_leftovers(&file.folder);
        remove_leftovers(&file.folder.join(sheet::THUMBNAILS));
        Ok(Self {
            file,
            arguments,
            session,
        })
    }

    /// The document of an image, and the hash of what it is made of.
    fn wanted<'p>(&mut self, number: usize, picture: &'p Picture) -> anyhow::Result<Wanted<'p>> {
        let scene = Scene::parse(&picture.arguments)?.arguments;
        let mut document = scene.document(&mut self.session)?;
        let part = self.arguments.part(document.render.samples);
        if let Some(range) = part {
            put_part(&mut document, range)?;
        }
        let hash = self.hash(&document, picture, part)?;
        Ok(Wanted {
            number,
            picture,
            document,
            part,
            hash,
        })
    }

    fn hash(&mut self, document: &Document, picture: &Picture, part: Option<[u32; 2]>) -> anyhow::Result<String> {
        let model = self.session.assets().model(&document.model, &document.import)?;
        let mut inputs = Inputs::new();
        inputs.document(document, &model, &self.file.path)?;
        inputs.text(&format!("{:?}", (picture.frame, self.file.frames, self.file.turn)));
        // Which files of a whole image exist is seen from their names.
        inputs.text(&format!("{part:?}"));
        Ok(inputs.hash())
    }

    /// Renders an image or a part of it, or joins its parts, unless it is there.
    pub fn make(&mut self, number: usize, picture: &Picture) -> Row {
        let wanted = self.wanted(number, picture);
        let made = wanted.and_then(|wanted| match self.kept(&wanted) {
            Some(row) => Ok(row),
            None if self.arguments.merge => self.joined(&wanted),
            None => self.rendered(&wanted),
        });
        made.unwrap_or_else(|error| Row::failed(number, picture, &error))
    }

    /// The record of an image that is there already.
    fn kept(&self, wanted: &Wanted<'_>) -> Option<Row> {
        let row = Row::read(&self.record(wanted))?;
        let is_same = row.hash.as_ref() == Some(&wanted.hash);
        let files = self.files(wanted);
        let is_whole = || match &row.files_hash {
            Some(known) => hash_of(&files).is_ok_and(|hash| hash == *known),
            None => files.iter().all(|file| file.is_file()),
        };
        (is_same && is_whole()).then_some(Row {
            number: wanted.number,
            status: Status::Kept,
            files,
            ..row
        })
    }

    /// The file of an image or a part of it.
    fn path(&self, picture: &Picture, part: Option<[u32; 2]>, ending: &str) -> PathBuf {
        let part = part.map_or_else(String::new, |[from, to]| format!(".{from}-{to}"));
        self.file.folder.join(format!("{}{part}.{ending}", picture.name))
    }

    fn record(&self, wanted: &Wanted<'_>) -> PathBuf {
        self.path(wanted.picture, wanted.part, "json")
    }

    fn files(&self, wanted: &Wanted<'_>) -> Vec<PathBuf> {
        let path = |ending: &str| self.path(wanted.picture, wanted.part, ending);
        match wanted.part {
            Some(_) => vec![path("exr")],
            None => self.file.formats.iter().map(|ending| path(ending)).collect(),
        }
    }

    fn rendered(&mut self, wanted: &Wanted<'_>) -> anyhow::Result<Row> {
        let document = match (wanted.picture.frame, self.file.frames) {
            (Some(frame), Some(frames)) => {
                self.session.submit(&wanted.document)?;
                let center = self.session.job().map(|job| job.geometry.center_world.to_array());
                turned(
                    &wanted.document,
                    self.file.turn,
                    frame,
                    frames,
                    center.unwrap_or_default(),
                )
            }
            _ => wanted.document.clone(),
        };
        let (progress, denoised) = render_to_end(&mut self.session, self.arguments.engine, &document)?;
        let row = Row {
            samples: wanted.part,
            samples_per_pixel: Some(progress.samples_per_pixel),
            render_seconds: Some(progress.render_seconds),
            noise: progress.noise.map(|noise| noise.relative),
            ..self.row(wanted, Status::Rendered)
        };
        let (image, lights) = (self.session.image()?, self.session.light_layers()?);
        let rendered = rendered(&image, denoised.as_ref(), &lights);
        if wanted.part.is_some() {
            let sums = Some(&self.session.kept_film()?);
            output::write(&row.files[0], Rendered { sums, ..rendered }, &document)?;
        } else {
            self.write(&row.files, rendered, &document, wanted.picture)?;
        }
        self.finish(wanted, row)
    }

    fn row(&self, wanted: &Wanted<'_>, status: Status) -> Row {
        let hash = Some(wanted.hash.clone());
        Row {
            files: self.files(wanted),
            hash,
            ..Row::new(wanted.number, wanted.picture, status)
        }
    }

    /// The files of a whole image, each replaced at once.
    fn write(
        &self,
        files: &[PathBuf],
        rendered: Rendered<'_>,
        document: &Document,
        picture: &Picture,
    ) -> anyhow::Result<()> {
        for file in files {
            output::write(file, rendered, document)?;
        }
        let shown: &Image = rendered.denoised.unwrap_or(rendered.image);
        sheet::write_thumbnail(&self.file.folder, &picture.name, shown, &document.view)
    }

    /// Writes the record last: it marks the image complete.
    fn finish(&self, wanted: &Wanted<'_>, mut row: Row) -> anyhow::Result<Row> {
        row.files_hash = Some(hash_of(&row.files)?);
        let text = serde_json::to_string_pretty(&row)? + "\n";
        save_atomically(&self.record(wanted), text.as_bytes())?;
        Ok(row)
    }

    fn joined(&mut self, wanted: &Wanted<'_>) -> anyhow::Result<Row> {
        let samples = wanted.document.render.samples;
        let (mut done, mut seconds) = (0, 0.0);
        let mut paths = Vec::new();
        for (range, row) in self.parts(wanted)? {
            // Ignores slices that another split has left.
            if range[0] != done || range[1] > samples {
                continue;
            }
            paths.push(self.path(wanted.picture, Some(range), "exr"));
            done = range[1];
            seconds += row.render_seconds.unwrap_or_default();
        }
        if done < samples {
            bail!(
                "{}: samples {done} to {samples} of {} are missing or of other settings; render them by --slice or \
                 --samples-from and --samples-to, then join again",
                self.file.folder.display(),
                wanted.picture.name
            );
        }
        let mut whole = joined(&paths)?;
        whole.document.view.denoise = wanted.document.view.denoise;
        let denoised = denoised(&whole)?;
        let (image, lights) = (whole.mixed().image(), whole.light_layers());
        let rendered = rendered(&image, denoised.as_ref(), &lights);
        let row = Row {
            samples_per_pixel: Some(whole.sample_count()),
            render_seconds: Some(seconds),
            ..self.row(wanted, Status::Merged)
        };
        // The frame that was rendered, with the number of all samples.
        self.write(&row.files, rendered, &whole.document, wanted.picture)?;
        self.finish(wanted, row)
    }

    /// The parts of an image in the folder, in order; of those that begin alike the longest first.
    fn parts(&mut self, wanted: &Wanted<'_>) -> anyhow::Result<Vec<([u32; 2], Row)>> {
        let mut parts = Vec::new();
        let prefix = format!("{}.", wanted.picture.name);
        let folder = &self.file.folder;
        let entries = std::fs::read_dir(folder).with_context(|| format!("{}: cannot be read", folder.display()))?;
        for entry in entries {
            let path = entry?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let middle = name.strip_prefix(&prefix).and_then(|rest| rest.strip_suffix(".json"));
            let Some(range) = middle.and_then(sums::range) else {
                continue;
            };
            let mut document = wanted.document.clone();
            put_part(&mut document, range)?;
            let hash = self.hash(&document, wanted.picture, Some(range))?;
            if let Some(row) = Row::read(&path).filter(|row| row.hash == Some(hash)) {
                parts.push((range, row));
            }
        }
        parts.sort_by_key(|([from, to], _)| (*from, std::cmp::Reverse(*to)));
        Ok(parts)
    }
}

/// The hash of files' contents.
fn hash_of(files: &[PathBuf]) -> anyhow::Result<String> {
    let mut contents = Inputs::new();
    files.iter().try_for_each(|file| contents.file(file))?;
    Ok(contents.hash())
}

/// Takes a part of the samples.
fn put_part(document: &mut Document, [from, to]: [u32; 2]) -> anyhow::Result<()> {
    if from >= to {
        bail!("the part from sample {from} to {to} is empty; take fewer slices, or more samples");
    }
    let render = &mut document.render;
    let reasons = [
        // A noise to reach has samples go where the error is, too: what was asked for is named first.
        (render.noise.is_some(), "a part ends at its own noise"),
        (render.time_s.is_some(), "a part ends with its own time"),
        (
            render.is_adaptive(),
            "samples go where a part's own error is (adaptive)",
        ),
    ];
    if let Some((_, reason)) = reasons.into_iter().find(|(is_so, _)| *is_so) {
        bail!("parts have a number of samples that is known before, and here {reason}; give a number of samples alone");
    }
    (render.first_sample, render.samples) = (from, to - from);
    // That comes when they are joined.
    document.view.denoise = Denoise::Off;
    Ok(())
}
