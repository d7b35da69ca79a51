//! The browser: materials to start from, the shipped ones, the user's own and those in watched folders, and environments.

mod entries;

use entries::{Card, groups};

use super::*;
use crate::{
    kit::{keys, tile, tile::Layout},
    services::{library::Change, shelves::LIST, shelves::SIDE_MAX, viewing::Pick},
};

/// The materials and environments to start from.
#[derive(Default)]
pub struct PresetsPanel {
    /// What is searched for.
    search: String,
}

impl Panel for PresetsPanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk) {
        self.header(ui, desk);
        if desk.shared.viewing.picks == Some(Pick::Rival) {
            widgets::note(ui, "Click what to compare with.");
        }
        ui.add_space(0.5 * theme::GAP);
        desk.shared.shelves.look(ui.ctx());
        widgets::comes_and_goes(ui, |ui| self.groups(ui, desk));
        ui.add_space(theme::GAP);
        widgets::comes_and_goes(ui, |ui| restoring(ui, desk));
        ui.horizontal_wrapped(|ui| {
            for command in [Command::SaveToMyPresets, Command::WatchFolder] {
                desk.button(ui, command);
            }
        });
    }
}

impl PresetsPanel {
    /// Search, and the size of the images.
    fn header(&mut self, ui: &mut Ui, desk: &mut Desk) {
        keys::search_field(ui, &mut self.search, "Search", "Search presets");
        let slider = Slider::new(&mut desk.shared.shelves.kept.picture_side, LIST..=SIDE_MAX)
            .show_value(false)
            .step_by(4.0);
        ui.add(slider)
            .on_hover_text("Size of the thumbnails; the smallest make a list.")
            .accessible_name("Size of the thumbnails");
    }

    /// Everything that is looked for, in groups.
    fn groups(&mut self, ui: &mut Ui, desk: &mut Desk) {
        let layout = match desk.shared.shelves.kept.picture_side {
            side if side > LIST => Layout::Grid(side),
            side => Layout::List(side),
        };
        // The name of what was just saved is asked for where it stands.
        let own = desk.shared.library.renaming.as_ref().map(|_| "Mine");
        if own.is_some() {
            self.search.clear();
        }
        let wanted = self.search.to_lowercase();
        let mut groups = groups(desk);
        // Names that are searched for stand before groups and looks.
        groups
            .iter_mut()
            .for_each(|group| group.entries.sort_by_key(|entry| !entry.is_named(&wanted)));
        groups.sort_by_key(|group| group.entries.first().is_some_and(|entry| !entry.is_named(&wanted)));
        let mut found = false;
        for mut group in groups {
            group.entries.retain(|entry| entry.is_wanted(&wanted, &group.title));
            if group.entries.is_empty() && (group.notes.is_empty() || !wanted.is_empty()) {
                continue;
            }
            found = true;
            let opens = (own == Some(&*group.title)).then_some(true);
            widgets::group_open(ui, &group.title, opens, |ui| {
                if let Some(folder) = &group.folder
                    && ui.small_button(format!("Stop watching {}", group.title)).clicked()
                {
                    desk.shared.shelves.kept.folders.retain(|watched| watched != folder);
                }
                group.notes.iter().for_each(|note| widgets::note(ui, note));
                let mut entries = |ui: &mut Ui| {
                    for entry in &group.entries {
                        show_entry(ui, desk, entry, layout);
                    }
                };
                match layout {
                    Layout::List(_) => entries(ui),
                    Layout::Grid(_) => tile::grid(ui, entries),
                }
            });
        }
        if !found {
            widgets::note(ui, "No preset of that name.");
        }
    }
}

/// One thing, or the field in which its name is typed.
fn show_entry(ui: &mut Ui, desk: &mut Desk, entry: &Card, layout: Layout) {
    if let Layout::Grid(height) = layout {
        tile::make_room(ui, height * entry.aspect());
    }
    // By what it is, as others may come before it.
    widgets::known_by(ui, ("preset", &entry.key), |ui| {
        if let Some((path, name)) = &mut desk.shared.library.renaming
            && entry.own.as_ref() == Some(path)
        {
            if let Some(chosen) = widgets::name_field(ui, name) {
                let rename = |name| Action::ChangeLibrary(Change::Rename(path.clone(), name));
                desk.actions.extend(chosen.map(rename));
                desk.shared.library.renaming = None;
            }
        } else {
            entry.show(ui, desk, layout);
        }
    });
}

/// The button that brings back what was deleted last.
fn restoring(ui: &mut Ui, desk: &mut Desk) {
    if widgets::restores(ui, desk.shared.library.removed.as_ref().map(|removed| &*removed.path)) {
        desk.actions.push(Action::ChangeLibrary(Change::Restore));
    }
}
