//! The inspector: what is known of a pixel, and how bright the image is.

mod histogram;

use histogram::Brightness;

use super::*;
use crate::{
    kit::words::percent,
    render::{
        display::exposure,
        shown::{PixelFacts, luminance, stops_of},
        worker::Picture,
    },
    services::look::middle,
};

#[derive(Default)]
pub struct InspectorPanel {
    brightness: Brightness,
}

impl Panel for InspectorPanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk) {
        desk.shared.look.is_shown = true;
        let Some(picture) = desk.snapshot.picture.clone() else {
            widgets::note(ui, "Nothing has been rendered yet.");
            return;
        };
        choose(ui, desk, &picture);
        widgets::comes_and_goes(ui, |ui| match desk.shared.look.pixel([picture.width, picture.height]) {
            Some(pixel) => values(ui, desk, &picture, pixel),
            None => widgets::note(ui, "Move the pointer over the image. I pins the pixel."),
        });
        widgets::group(ui, "Histogram", |ui| self.brightness.show(ui, &picture));
    }
}

/// Pins the pixel, or goes to one that stands out.
fn choose(ui: &mut Ui, desk: &mut Desk, picture: &Picture) {
    ui.horizontal_wrapped(|ui| {
        let look = &mut desk.shared.look;
        ui.checkbox(&mut look.is_pinned, "Pinned")
            .on_hover_text(Command::Inspect.help());
        let mut found = None;
        let mut button = |ui: &mut Ui, text: &str, help: &str, is_known: bool, index: &dyn Fn() -> Option<usize>| {
            let button = ui.add_enabled(is_known, Button::new(text).small());
            if button.on_hover_text(help).clicked() {
                found = index();
            }
        };
        let facts = picture.facts.as_ref();
        let help = "Goes to the pixel with the largest error.";
        button(ui, "Noisiest pixel", help, facts.is_some(), &|| {
            largest(facts?.errors.iter().copied())
        });
        let help = "Goes to the pixel with the most light.";
        button(ui, "Brightest pixel", help, true, &|| {
            let pixels = picture.image.pixels.iter();
            largest(pixels.map(|[r, g, b, _]| luminance([*r, *g, *b]) as f32))
        });
        if let Some(index) = found {
            let index = index as u32;
            let pixel = [index % picture.width, index / picture.width];
            look.pin(middle(pixel, [picture.width, picture.height]));
        }
    });
}

/// Where the largest of some numbers is; those that are none do not count.
fn largest(values: impl Iterator<Item = f32>) -> Option<usize> {
    let finite = values.enumerate().filter(|(_, value)| value.is_finite());
    finite.max_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(index, _)| index)
}

/// The table of what is known of a pixel.
fn values(ui: &mut Ui, desk: &Desk, picture: &Picture, [x, y]: [u32; 2]) {
    let index = (y * picture.width + x) as usize;
    let Some([r, g, b, alpha]) = picture.image.pixels.get(index).copied() else {
        return;
    };
    let shown = [r, g, b];
    Grid::new("pixel").num_columns(2).striped(true).show(ui, |ui| {
        let mut line = |name: &str, text: String| {
            ui.weak(name);
            widgets::line(ui, text);
            ui.end_row();
        };
        // At full size, also while a smaller image is shown.
        let render = &picture.document.render;
        if let Some([x, y]) = desk.shared.look.pixel([render.width, render.height]) {
            line("Pixel", format!("{x}, {y} of {} × {}", render.width, render.height));
        }
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
    if let Some(samples) = facts.features.samples.get(index) {
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
fn of_surface(line: &mut impl FnMut(&str, String), desk: &Desk) {
    let Some(seen) = desk.shared.look.seen else {
        return line("Material", "none: the background".to_owned());
    };
    let material = seen.slot.map(|slot| desk.document.material(slot).name);
    line(
        "Material",
        material.unwrap_or_else(|| "ground or area light".to_owned()),
    );
    if let Some(name) = seen.object.and_then(|object| desk.object_name(object)) {
        line("Object", name);
    }
    line("Distance", format!("{:.4} scene units", seen.depth));
    line("View angle", format!("{:.1}°", seen.view_angle_deg));
}

fn triple(values: [f32; 3]) -> String {
    let [a, b, c] = values;
    format!("{a:.4}  {b:.4}  {c:.4}")
}

/// The pixel as the screen shows it.
fn displayed(ui: &mut Ui, picture: &Picture, index: usize) {
    if let Some(&[r, g, b, _]) = picture.rgba.as_chunks().0.get(index) {
        ui.horizontal(|ui| {
            widgets::swatch(ui, vec2(34.0, 16.0), Color32::from_rgb(r, g, b));
            ui.label(format!("Displayed #{r:02x}{g:02x}{b:02x} · {r} {g} {b}"));
        });
    }
}
