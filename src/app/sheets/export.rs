//! The sheet that shows what another program's file loses, before it is written.

use super::*;
use crate::app::book::EXPORT;
use crate::app::kit::tile::rgb_pixels;
use crate::app::services::export::Ready;
use crate::app::sheets::{answers, book, question, scrolled};
use crate::render::looks::Compared;
use crate::store::exchange::Prepared;
use crate::store::exchange::report::{MaterialReport, Outcome};

/// Points that the side of an image takes.
const PICTURE: f32 = 176.0;
/// What the images of a ball show.
const PICTURES: [&str; 3] = ["The material", "As the file shows it", "Difference"];

/// The sheet, while there is something to ask.
#[derive(Default)]
pub struct ExportSheet {
    ready: Option<Ready>,
    textures: Vec<Option<[TextureHandle; 3]>>,
}

#[derive(PartialEq)]
pub enum Answer {
    Write,
    Cancel,
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
        self.ready.is_some()
    }

    /// The file, to be written; the sheet is closed.
    pub fn take(&mut self) -> Option<Prepared> {
        self.textures.clear();
        Some(self.ready.take()?.prepared)
    }

    /// Shows the sheet where it is open.
    pub fn show(&self, ctx: &Context) -> Option<Answer> {
        let ready = self.ready.as_ref()?;
        question(ctx, "export", Answer::Cancel, |ui| {
            ui.set_width(580.0);
            book::heading(ui, "Export", EXPORT);
            let report = &ready.prepared.report;
            ui.label(report.output.display().to_string());
            ui.add_space(theme::GAP);
            scrolled(ui, |ui| {
                for (material, textures) in report.materials.iter().zip(&self.textures) {
                    material_rows(ui, material, textures.as_ref());
                }
            });
            ui.add_space(theme::GAP);
            answers(ui, [("Write the file", Answer::Write), ("Cancel", Answer::Cancel)])
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
        widgets::note(ui, "The exact parameters travel with it: opened here, nothing is lost.");
    }
    ui.add_space(theme::GAP);
}
