//! The sheet that shows what another program's file loses, before it is written.

use super::*;
use crate::{
    book::EXPORT,
    kit::tile::rgb_pixels,
    render::looks::Compared,
    services::export::Ready,
    sheets::{answers, book, question, scrolled},
    store::exchange::{
        self, FORMATS, Prepared,
        report::{MaterialReport, Outcome},
    },
};

/// Points that the side of an image takes.
const PICTURE: f32 = 176.0;
/// What the images of a ball show.
const PICTURES: [&str; 3] = ["The material", "As the file shows it", "Difference"];

/// The sheet, while there is something to ask.
#[derive(Default)]
pub struct ExportSheet {
    /// The file, from when it was chosen.
    pub path: Option<PathBuf>,
    ready: Option<Ready>,
    textures: Vec<Option<[TextureHandle; 3]>>,
}

#[derive(PartialEq)]
pub enum Answer {
    Write,
    Cancel,
    /// In another format, to this file.
    Other(PathBuf),
}

impl ExportSheet {
    pub fn ask(&mut self, ctx: &Context, ready: Ready) {
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
        self.path.is_some()
    }

    /// Shows that a file is being made; without one the sheet is closed. The file that was ready.
    pub fn begin(&mut self, path: Option<PathBuf>) -> Option<Prepared> {
        self.textures.clear();
        self.path = path;
        Some(self.ready.take()?.prepared)
    }

    /// Shows the sheet where it is open.
    pub fn show(&self, ctx: &Context) -> Option<Answer> {
        let path = self.path.as_ref()?;
        question(ctx, "export", Answer::Cancel, |ui| {
            ui.set_width(580.0);
            book::heading(ui, "Export", EXPORT);
            ui.label(path.display().to_string());
            let current = exchange::by_ending(path).map_or("", |format| format.name);
            let mut chosen = current;
            let formats: Vec<_> = FORMATS
                .iter()
                .map(|format| (format.name, format.label, format.help))
                .collect();
            widgets::row(ui, ["Export format", "Format", ""], |ui| {
                widgets::choice(ui, "export format", &mut chosen, &formats)
            });
            ui.add_space(theme::GAP);
            widgets::comes_and_goes(ui, |ui| match &self.ready {
                None => {
                    ui.add(Spinner::new());
                    widgets::note(ui, "Rendering the balls, which show what is lost …");
                }
                Some(ready) => scrolled(ui, |ui| {
                    for (material, textures) in ready.prepared.report.materials.iter().zip(&self.textures) {
                        material_rows(ui, material, textures.as_ref());
                    }
                }),
            });
            ui.add_space(theme::GAP);
            let write = self.ready.as_ref().map(|_| ("Write the file", Answer::Write));
            let answer = answers(ui, [("Cancel", Answer::Cancel)].into_iter().chain(write));
            let other = exchange::by_name(chosen).filter(|_| chosen != current);
            answer.or(other.map(|format| Answer::Other(path.with_extension(format.extensions[0]))))
        })
    }
}

/// What becomes of a material's parts, and the images of a ball.
fn material_rows(ui: &mut Ui, material: &MaterialReport, textures: Option<&[TextureHandle; 3]>) {
    ui.label(RichText::new(&material.material).strong());
    // The last column is what fills the sheet: else its lines break anew each frame, and buttons below move away.
    let grid = Grid::new(&material.material).num_columns(2).spacing([12.0, 3.0]);
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
        let is_whole = material.entries.iter().all(|entry| entry.outcome != Outcome::Dropped);
        let rest = if is_whole {
            "nothing is lost"
        } else {
            "only what is dropped above is lost"
        };
        widgets::note(ui, format!("The exact parameters travel with it: opened here, {rest}."));
    }
    ui.add_space(theme::GAP);
}
