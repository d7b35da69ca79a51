//! The inspector: what is known of a pixel, and how bright the image is.

mod histogram;

use std::sync::Arc;

use egui::{Color32, Sense, Ui, vec2};

use histogram::Brightness;

use super::Panel;
use crate::app::actions::Command;
use crate::app::desk::Desk;
use crate::app::kit::widgets;
use crate::app::kit::words::percent;
use crate::app::services::look::middle;
use crate::render::display::exposure;
use crate::render::shown::{PixelFacts, luminance, stops_of};
use crate::render::worker::Picture;

#[derive(Default)]
pub struct InspectorPanel {
    brightness: Brightness,
}

impl Panel for InspectorPanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        desk.shared.look.is_shown = true;
        let Some(picture) = desk.snapshot.picture.clone() else {
            widgets::note(ui, "Nothing has been rendered yet.");
            return;
        };
        choose(ui, desk, &picture);
        widgets::comes_and_goes(ui, |ui| match desk.shared.look.pixel([picture.width, picture.height]) {
            Some(pixel) => values(ui, desk, &picture, pixel),
            None => widgets::note(ui, "Move the pointer over the image. I stays at a pixel."),
        });
        widgets::group(ui, "Histogram", |ui| self.brightness.show(ui, &picture));
    }
}

/// Pins the pixel, or goes to one that stands out.
fn choose(ui: &mut Ui, desk: &mut Desk<'_>, picture: &Picture) {
    ui.horizontal_wrapped(|ui| {
        let mut is_pinned = desk.shared.look.is_pinned;
        if ui
            .checkbox(&mut is_pinned, "Pinned")
            .on_hover_text(Command::Inspect.help())
            .changed()
        {
            desk.shared.look.is_pinned = is_pinned;
        }
        let size = [picture.width, picture.height];
        let mut go_to = |index: Option<usize>| {
            if let Some(index) = index {
                let width = size[0] as usize;
                let pixel = [(index % width) as u32, (index / width) as u32];
                desk.shared.look.pin(middle(pixel, size));
            }
        };
        let noisiest = ui.add_enabled(picture.facts.is_some(), egui::Button::new("Noisiest pixel").small());
        if noisiest
            .on_hover_text("Goes to the pixel with the largest error.")
            .clicked()
        {
            go_to(
                picture
                    .facts
                    .as_ref()
                    .and_then(|facts| largest(facts.errors.iter().copied())),
            );
        }
        let brightest = ui.add(egui::Button::new("Brightest pixel").small());
        if brightest
            .on_hover_text("Goes to the pixel with the most light.")
            .clicked()
        {
            go_to(largest(
                picture
                    .image
                    .pixels
                    .iter()
                    .map(|[r, g, b, _]| luminance([*r, *g, *b]) as f32),
            ));
        }
    });
}

/// Where the largest of some numbers is; those that are none do not count.
fn largest(values: impl Iterator<Item = f32>) -> Option<usize> {
    let finite = values.enumerate().filter(|(_, value)| value.is_finite());
    finite.max_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(index, _)| index)
}

/// The table of what is known of a pixel.
fn values(ui: &mut Ui, desk: &Desk<'_>, picture: &Picture, [x, y]: [u32; 2]) {
    let index = (y * picture.width + x) as usize;
    let Some([r, g, b, alpha]) = picture.image.pixels.get(index).copied() else {
        return;
    };
    let shown = [r, g, b];
    egui::Grid::new("pixel").num_columns(2).striped(true).show(ui, |ui| {
        let mut line = |name: &str, text: String| {
            ui.weak(name);
            ui.add(egui::Label::new(text).truncate());
            ui.end_row();
        };
        line("Pixel", format!("{x}, {y} of {} × {}", picture.width, picture.height));
        line("Linear", triple(shown));
        if picture.is_denoised() {
            let [r, g, b, _] = picture.samples.pixels.get(index).copied().unwrap_or_default();
            line("Samples' mean", triple([r, g, b]));
        }
        let view = &picture.document.view;
        let light = luminance(shown);
        let stops = stops_of(light * f64::from(exposure(&picture.image, view)));
        let stops = if stops.is_finite() {
            format!("{stops:+.2} stops from grey")
        } else {
            "black".to_owned()
        };
        line("Luminance", format!("{light:.4}, {stops}"));
        if alpha < 1.0 {
            line("Opacity", percent(f64::from(alpha)));
        }
        of_facts(&mut line, picture.facts.as_ref(), index);
        of_surface(&mut line, desk);
    });
    displayed(ui, picture, index);
}

/// Samples, error and what is seen first.
fn of_facts(line: &mut impl FnMut(&str, String), facts: Option<&Arc<PixelFacts>>, index: usize) {
    let Some(facts) = facts else { return };
    if let Some(samples) = facts.samples.get(index) {
        line("Samples", samples.to_string());
    }
    let error = facts.errors.get(index).map(|error| f64::from(*error));
    line(
        "Error",
        match error.filter(|error| error.is_finite()) {
            Some(error) => format!("{} of the mean luminance", percent(error)),
            None => "not known yet".to_owned(),
        },
    );
    if let Some(albedo) = facts.features.albedo.get(index) {
        line("Albedo", triple(*albedo));
    }
    if let Some(normal) = facts.features.normal.get(index) {
        line("Normal", triple(*normal));
    }
}

/// What the ray through the pixel meets.
fn of_surface(line: &mut impl FnMut(&str, String), desk: &Desk<'_>) {
    let material = match desk.shared.look.seen {
        None => "none: the background".to_owned(),
        Some(seen) => match seen.slot {
            Some(slot) => desk.document.material(slot).name,
            None => "ground or area light".to_owned(),
        },
    };
    line("Material", material);
    if let Some(name) = desk.shared.look.seen.and_then(|seen| desk.object_name(seen.object?)) {
        line("Object", name);
    }
    if let Some(seen) = desk.shared.look.seen {
        line("Distance", format!("{:.4} scene units", seen.depth));
        line("View angle", format!("{:.1}°", seen.view_angle_deg));
    }
}

fn triple(values: [f32; 3]) -> String {
    let [a, b, c] = values;
    format!("{a:.4}  {b:.4}  {c:.4}")
}

/// The pixel as the screen shows it.
fn displayed(ui: &mut Ui, picture: &Picture, index: usize) {
    let Some([r, g, b]) = picture
        .rgba
        .get(4 * index..4 * index + 3)
        .and_then(|bytes| <[u8; 3]>::try_from(bytes).ok())
    else {
        return;
    };
    ui.horizontal(|ui| {
        let (swatch, _) = ui.allocate_exact_size(vec2(34.0, 16.0), Sense::hover());
        let line = ui.visuals().widgets.noninteractive.bg_stroke;
        let color = Color32::from_rgb(r, g, b);
        ui.painter().rect(swatch, 3.0, color, line, egui::StrokeKind::Inside);
        ui.label(format!("Displayed #{r:02x}{g:02x}{b:02x} · {r} {g} {b}"));
    });
}
