//! The browser: materials to start from, the shipped ones, the user's own and those in watched folders, and environments.

mod entries;

use entries::{Entry, groups};

use super::*;
use crate::app::kit::keys;
use crate::app::kit::tile::{self, Layout};
use crate::app::services::library::Change;
use crate::app::services::shelves::{LIST, SIDE_MAX};

/// The materials and environments to start from.
#[derive(Default)]
pub struct PresetsPanel {
    /// What is searched for.
    search: String,
    /// A tag that all that is shown must have.
    tag: Option<String>,
    /// What is being tagged, with its tags as they are typed.
    tagging: Option<(String, String)>,
}

impl Panel for PresetsPanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk) {
        self.header(ui, desk);
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
    /// Search, tags, and the size of the images.
    fn header(&mut self, ui: &mut Ui, desk: &mut Desk) {
        keys::search_field(ui, &mut self.search, "Search", "Search presets");
        ui.horizontal(|ui| {
            let kept = &mut desk.shared.shelves.kept;
            let slider = Slider::new(&mut kept.picture_side, LIST..=SIDE_MAX)
                .show_value(false)
                .step_by(4.0);
            ui.add(slider)
                .on_hover_text("Size of the thumbnails; the smallest make a list.")
                .accessible_name("Size of the thumbnails");
            let tags: Vec<String> = kept.all_tags().into_iter().map(str::to_owned).collect();
            if self.tag.as_ref().is_some_and(|tag| !tags.contains(tag)) {
                self.tag = None;
            }
            if tags.is_empty() {
                return;
            }
            let label = |tag: &Option<String>| tag.clone().unwrap_or_else(|| "All tags".to_owned());
            let button = ui.menu_button(label(&self.tag), |ui| {
                for tag in std::iter::once(None).chain(tags.into_iter().map(Some)) {
                    let text = label(&tag);
                    ui.selectable_value(&mut self.tag, tag, text);
                }
            });
            button.response.accessible_name("Only what has a tag");
        });
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
            (self.search, self.tag) = Default::default();
        }
        let wanted = self.search.to_lowercase();
        let mut groups = groups(desk);
        // Names that are searched for stand before groups, tags and looks.
        groups
            .iter_mut()
            .for_each(|group| group.entries.sort_by_key(|entry| !entry.is_named(&wanted)));
        groups.sort_by_key(|group| group.entries.first().is_some_and(|entry| !entry.is_named(&wanted)));
        let mut found = false;
        for mut group in groups {
            let kept = &desk.shared.shelves.kept;
            group.entries.retain(|entry| {
                let has_tag = |tag: &String| kept.tags.get(&entry.key).is_some_and(|tags| tags.contains(tag));
                self.tag.as_ref().is_none_or(has_tag) && entry.is_wanted(&wanted, &group.title, kept)
            });
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
                        self.entry(ui, desk, entry, layout);
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

    /// One thing, or the field in which its name or its tags are typed.
    fn entry(&mut self, ui: &mut Ui, desk: &mut Desk, entry: &Entry, layout: Layout) {
        if let Layout::Grid(height) = layout {
            tile::make_room(ui, height * entry.aspect());
        }
        // By what it is, as others may come before it.
        widgets::known_by(ui, ("preset", &entry.key), |ui| {
            if let Some((key, text)) = &mut self.tagging
                && *key == entry.key
            {
                let name = format!("Tags of {}", entry.full_name);
                if let Some(typed) = widgets::text_field(ui, &name, text) {
                    if typed {
                        desk.shared.shelves.kept.tag(key, text);
                    }
                    self.tagging = None;
                }
            } else if let Some((path, name)) = &mut desk.shared.library.renaming
                && entry.own.as_ref() == Some(path)
            {
                if let Some(chosen) = widgets::name_field(ui, name) {
                    let rename = |name| Action::ChangeLibrary(Change::Rename(path.clone(), name));
                    desk.actions.extend(chosen.map(rename));
                    desk.shared.library.renaming = None;
                }
            } else {
                entry.show(ui, desk, layout, &mut self.tagging);
            }
        });
    }
}

/// The button that brings back what was deleted last.
fn restoring(ui: &mut Ui, desk: &mut Desk) {
    if widgets::restores(ui, desk.shared.library.removed.as_ref().map(|removed| &*removed.path)) {
        desk.actions.push(Action::ChangeLibrary(Change::Restore));
    }
}
