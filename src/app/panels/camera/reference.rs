//! The rows of the reference image.

use super::*;
use crate::document::{Background, ReferencePlace};

/// Which image, where it is shown, and how much of it is seen.
pub fn show(ui: &mut Ui, desk: &mut Desk) {
    let help = "A background plate or a photograph to work from. It is shown in the viewport, not rendered or saved.";
    let name = ["Reference image", "Reference", help];
    let file = desk
        .document
        .view
        .reference
        .as_ref()
        .map(|reference| reference.file.clone());
    let remove = ("Remove the reference image", "Removes it from the viewport");
    if desk.file_row(ui, name, file.as_deref(), Action::ChooseReference, remove) {
        desk.document.view.reference = None;
        desk.edits.did(remove.0);
    }
    let Some(reference) = &mut desk.document.view.reference else {
        return;
    };
    let name = ["Place of the reference", "Shown", "Where it is shown."];
    let mut is_edited = widgets::choice_row(ui, name, &mut reference.place);
    let style = NumberStyle::plain(0.0..=1.0, "", 0.01, 2).with_bar([0.0, 1.0]);
    let name = ["Opacity of the reference", "Opacity", "How much of it is seen."];
    is_edited |= widgets::number_row(ui, name, &mut reference.opacity, 1.0, &style);
    if is_edited {
        desk.edits.note("Reference image", "view.reference");
    }
    let is_hidden =
        reference.place == ReferencePlace::Under && desk.document.lighting.background != Background::Transparent;
    widgets::comes_and_goes(ui, |ui| {
        if let Some(why) = desk.shared.reference.failure(&reference.file) {
            let text = format!("It can't be shown: {why}. Put the file there, or choose another.");
            widgets::warning(ui, text);
        } else if is_hidden {
            let text = "Under the render it is seen where that is transparent: Light › Background.";
            widgets::note(ui, text);
        }
    });
}
