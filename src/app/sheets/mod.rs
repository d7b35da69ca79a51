//! What lies around and over the panels: menus, status bar, dialogs and sheets.

pub mod book;
pub mod dialogs;
pub mod export;
pub mod import;
pub mod menu;
pub mod outside;
pub mod palette;
pub mod recovery;
pub mod status;
pub mod turntable;
pub mod unsaved;
mod workspaces;

use std::path::PathBuf;

use egui::*;

use super::{actions::Action, kit::theme, kit::widgets};
use crate::document::Document;

/// A sheet over the window, and its answer; closed without one, it is `cancelled`.
pub fn question<A>(
    ctx: &Context,
    id: impl std::hash::Hash + std::fmt::Debug,
    cancelled: A,
    show: impl FnOnce(&mut Ui) -> Option<A>,
) -> Option<A> {
    let modal = Modal::new(Id::unique(id)).show(ctx, show);
    if modal.should_close() {
        Some(cancelled)
    } else {
        modal.inner
    }
}

/// Buttons side by side, each with the answer that it gives.
pub fn answers<A>(ui: &mut Ui, buttons: impl IntoIterator<Item = (&'static str, A)>) -> Option<A> {
    let pressed = |ui: &mut Ui| {
        let mut answer = None;
        for (text, of_button) in buttons {
            if ui.button(text).clicked() {
                answer = Some(of_button);
            }
        }
        answer
    };
    ui.horizontal(pressed).inner
}

/// Contents of a sheet, which scroll where the window has no room for them.
fn scrolled(ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
    let height = 0.7 * ui.ctx().content_rect().height();
    ScrollArea::vertical().max_height(height).show(ui, contents);
}
