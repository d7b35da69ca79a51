//! The sheet that shows what another program's file loses, before it is written.

use std::path::Path;

use super::*;
use crate::app::book::EXPORT;
use crate::app::kit::tile::rgb_pixels;
use crate::app::services::export::Ready;
use crate::app::sheets::{answers, book, question, scrolled};
use crate::render::looks::Compared;
use crate::store::exchange::report::{MaterialReport, Outcome};
use crate::store::exchange::{FORMATS, Prepared, Registered, by_name};

/// Points that the side of an image takes.
const PICTURE: f32 = 176.0;
/// What the images of a ball show.
const PICTURES: [&str; 3] = ["The material", "As the file shows it", "Difference"];

/// The sheet, while there is something to ask.
#[derive(Default)]
pub struct ExportSheet {
    /// The file, until there is an answer.
    asked: Option<(PathBuf, &'static Registered)>,
    /// `None` until the balls are rendered.
    ready: Option<Ready>,
    textures: Vec<Option<[TextureHandle; 3]>>,
}

pub enum Answer {
    Write(Box<Prepared>),
    /// Another format, and the file in it.
    As(PathBuf, &'static Registered),
}

impl ExportSheet {
    /// Opens the sheet.
    pub fn ask(&mut self, path: PathBuf, format: &'static Registered) {
        *self = Self {
            asked: Some((path, format)),
            ..Self::default()
        };
    }

    /// Takes the file that was made; none closes the sheet. What was called off meanwhile is left out.
    pub fn put(&mut self, ctx: &Context, path: &Path, format: &Registered, ready: Option<Ready>) {
        let is_asked = |asked: &(PathBuf, &Registered)| asked.0 == path && asked.1.name == format.name;
        if !self.asked.as_ref().is_some_and(is_asked) {
            return;
        }
        let Some(ready) = ready else {
            return *self = Self::default();
        };
        let texture = |(name, picture): (&&str, &image::RgbImage)| {
            ctx.load_texture(*name, rgb_pixels(picture), TextureOptions::LINEAR)
        };
        let textures = |compared: &Option<Compared>| {
            let pictures = &compared.as_ref()?.pictures;
            let textures: Vec<_> = PICTURES.iter().zip(pictures).map(texture).collect();
            textures.try_into().ok()
        };
        self.textures = ready.compared.iter().map(textures).collect();
        self.ready = Some(ready);
    }

    pub fn is_open(&self) -> bool {
        self.asked.is_some()
    }

    /// Shows the sheet where it is open, and closes it with an answer.
    pub fn show(&mut self, ctx: &Context) -> Option<Answer> {
        let (path, format) = self.asked.as_ref()?;
        let mut chosen = format.name;
        let is_written = question(ctx, "export", false, |ui| {
            ui.set_width(580.0);
            book::heading(ui, "Export", EXPORT);
            ui.label(path.display().to_string());
            let formats = FORMATS.iter().map(|format| (format.name, format.label, format.help));
            let formats: Vec<_> = formats.collect();
            widgets::row(ui, ["Export format", "Format", format.help], |ui| {
                widgets::choice(ui, "export format", &mut chosen, &formats)
            });
            ui.add_space(theme::GAP);
            widgets::comes_and_goes(ui, |ui| match &self.ready {
                Some(ready) => scrolled(ui, |ui| {
                    for (material, textures) in ready.prepared.report.materials.iter().zip(&self.textures) {
                        material_rows(ui, material, textures.as_ref());
                    }
                }),
                None => {
                    ui.spinner();
                    ui.label("Rendering balls to show what it loses …");
                }
            });
            ui.add_space(theme::GAP);
            let write = self.ready.as_ref().map(|_| ("Write the file", true));
            answers(ui, write.into_iter().chain([("Cancel", false)]))
        });
        if chosen != format.name {
            let format = by_name(chosen)?;
            return Some(Answer::As(path.with_extension(format.extensions[0]), format));
        }
        let ready = is_written.and_then(|_| std::mem::take(self).ready);
        let ready = ready.filter(|_| is_written == Some(true))?;
        Some(Answer::Write(Box::new(ready.prepared)))
    }
}

/// What becomes of a material's parts, and the images of a ball.
fn material_rows(ui: &mut Ui, material: &MaterialReport, textures: Option<&[TextureHandle; 3]>) {
    ui.label(RichText::new(&material.material).strong());
    let grid = Grid::new(&material.material).spacing([12.0, 3.0]);
    grid.show(ui, |ui| {
        for entry in &material.entries {
            let word = RichText::new(entry.outcome.word());
            ui.label(match entry.outcome {
                Outcome::Exact => word.weak(),
                _ => word.color(ui.visuals().warn_fg_color),
            });
            let mut text = entry.what.clone();
            if !entry.detail.is_empty() {
                text += &format!(": {}", entry.detail);
            }
            if let Some(residual) = entry.residual {
                text += &format!(" ({} {:.3})", residual.measure, residual.residual);
            }
            ui.add(Label::new(text).wrap());
            ui.end_row();
        }
    });
    if let Some(textures) = textures {
        ui.add_space(theme::GAP);
        ui.horizontal(|ui| {
            for (texture, name) in textures.iter().zip(PICTURES) {
                ui.vertical(|ui| {
                    let picture = Image::new((texture.id(), vec2(PICTURE, PICTURE))).alt_text(name);
                    ui.add(picture);
                    ui.label(name);
                });
            }
        });
    }
    if let Some(difference) = material.difference {
        ui.label(format!("The two balls differ by {:.1} %.", 100.0 * difference));
        widgets::note(
            ui,
            "Difference: dark for none, yellow from half the mean brightness; noise is left out.",
        );
    }
    if material.carries_exact_parameters {
        widgets::note(
            ui,
            "Glossmith itself reads all of it back, textures by their paths: the exact parameters travel with it.",
        );
    }
    ui.add_space(theme::GAP);
}
