//! Pinned states as thumbnails: to bring back, to compare with, to remove.

use super::*;
use crate::{kit::tile, kit::tile::Tile, services::compare::Rival, services::library::Change};

/// Width and height of an image's place, points.
const PLACE: Vec2 = vec2(104.0, 66.0);

/// The pinned states.
#[derive(Default)]
pub struct SnapshotsPanel;

impl Panel for SnapshotsPanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk) {
        ui.horizontal_wrapped(|ui| {
            desk.button(ui, Command::Pin);
            if widgets::restores(ui, desk.shared.snapshots.removed.as_ref().map(|removed| &*removed.path)) {
                desk.actions.push(Action::ChangeSnapshots(Change::Restore));
            }
        });
        ui.add_space(theme::GAP);
        renaming(ui, desk);
        if desk.shared.snapshots.entries.is_empty() {
            widgets::note(
                ui,
                "P pins material, light and camera as they are, to come back to and to compare with.",
            );
            return;
        }
        tile::grid(ui, |ui| {
            for index in 0..desk.shared.snapshots.entries.len() {
                tile::make_room(ui, PLACE.x);
                // By its file, as others may come before it.
                let path = desk.shared.snapshots.entries[index].0.path.clone();
                widgets::known_by(ui, ("snapshot", path), |ui| entry(ui, desk, index));
            }
        });
    }
}

/// The field for the new name of the one that is being renamed.
fn renaming(ui: &mut Ui, desk: &mut Desk) {
    let Some((path, name)) = &mut desk.shared.snapshots.renaming else {
        return;
    };
    let chosen = widgets::name_field(ui, name);
    ui.add_space(theme::GAP);
    if let Some(chosen) = chosen {
        let rename = |name| Action::ChangeSnapshots(Change::Rename(path.clone(), name));
        desk.actions.extend(chosen.map(rename));
        desk.shared.snapshots.renaming = None;
    }
}

fn entry(ui: &mut Ui, desk: &mut Desk, index: usize) {
    let (pinned, picture) = &desk.shared.snapshots.entries[index];
    let (name, path, materials) = (&pinned.name, &pinned.path, &pinned.document.materials);
    let tile = Tile {
        name,
        full_name: name,
        picture: Some(picture),
        size: PLACE,
        color: ui.visuals().extreme_bg_color,
        is_current: *materials == desk.document.materials
            && pinned.document.camera == desk.document.camera
            && pinned.document.lighting == desk.document.lighting,
    };
    let mut is_renaming = false;
    let mut more = |ui: &mut Ui| {
        if ui.button("Bring back").clicked() {
            desk.actions.push(Action::UseSnapshot(path.clone()));
        }
        if ui.button("Compare as B").clicked() {
            let rival = Rival::Materials(name.clone(), materials.clone());
            desk.actions.push(Action::CompareWith(rival));
        }
        is_renaming |= ui.button("Rename").clicked();
        if ui.button("Delete").clicked() {
            desk.actions.push(Action::ChangeSnapshots(Change::Remove(path.clone())));
        }
    };
    let response = tile.cell(ui, &format!("More of {name}"), &mut more);
    response.context_menu(more);
    let help = "Click to bring it back; right-click for more";
    if response.on_hover_text(help).clicked() {
        desk.actions.push(Action::UseSnapshot(path.clone()));
    }
    if is_renaming {
        desk.shared.snapshots.renaming = Some((path.clone(), name.clone()));
    }
}
