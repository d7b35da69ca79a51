//! What lies around and over the panels: menus, status bar, dialogs and sheets.

pub(super) mod book;
pub(super) mod dialogs;
pub(super) mod export;
pub(super) mod import;
pub(super) mod menu;
pub(super) mod outside;
pub(super) mod palette;
pub(super) mod recovery;
pub mod status;
pub(super) mod turntable;
pub(super) mod unsaved;
mod workspaces;

use egui::Ui;

/// Share of the window's height that long sheets scroll within.
const SHEET_SHARE: f32 = 0.7;

/// Contents of a sheet, which scroll where the window has no room for them.
fn scrolled(ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
    let height = SHEET_SHARE * ui.ctx().content_rect().height();
    egui::ScrollArea::vertical().max_height(height).show(ui, contents);
}
