//! The rows of the reference image.

use egui::Ui;

use crate::app::actions::Action;
use crate::app::desk::Desk;
use crate::app::kit::widgets::{self, Name, NumberStyle};
use crate::document::{Background, Reference, ReferencePlace};

/// Which image, where it is shown, and how much of it is seen.
pub fn show(ui: &mut Ui, desk: &mut Desk<'_>) {
    let before = desk.document.view.reference.clone();
    file(ui, desk, before.as_ref());
    let Some(mut reference) = before.clone().filter(|_| desk.document.view.reference.is_some()) else {
        return;
    };
    let name = Name::new("Place of the reference", "Shown", "Where it is shown.");
    let response = widgets::row(ui, name, |ui| {
        widgets::choice(ui, "place of the reference", &mut reference.place, &widgets::choices())
    });
    if response.reset {
        reference.place = ReferencePlace::default();
    }
    let style = NumberStyle::plain(0.0..=1.0, "", 0.01, 2).with_bar([0.0, 1.0]);
    let name = Name::new("Opacity of the reference", "Opacity", "How much of it is seen.");
    let response = widgets::row(ui, name, |ui| widgets::number(ui, &mut reference.opacity, &style));
    if response.reset {
        reference.opacity = 1.0;
    }
    let is_hidden =
        reference.place == ReferencePlace::Under && desk.document.lighting.background != Background::Transparent;
    let failure = desk.shared.reference.failure(&reference.file).map(str::to_owned);
    widgets::comes_and_goes(ui, |ui| {
        if let Some(why) = failure {
            let text = format!("It can't be shown: {why}. Put the file there, or choose another.");
            ui.colored_label(ui.visuals().warn_fg_color, text);
        } else if is_hidden {
            widgets::note(
                ui,
                "Under the render it is seen where that is transparent: Light › Background.",
            );
        }
    });
    if Some(&reference) != before.as_ref() {
        desk.document.view.reference = Some(reference);
        desk.edits.note("Reference image", "view.reference");
    }
}

/// The file, with a button to choose one or take it away.
fn file(ui: &mut Ui, desk: &mut Desk<'_>, reference: Option<&Reference>) {
    let help = "A background plate or a photograph to work from. It is shown in the viewport, not rendered or saved.";
    let name = Name::new("Reference image", "Reference", help);
    let file = reference.map(|reference| reference.file.as_path());
    let remove = ("Remove the reference image", "Removes it from the viewport");
    if desk.file_row(ui, name, file, Action::ChooseReference, remove) {
        desk.document.view.reference = None;
        desk.edits.note(remove.0, "");
    }
}
