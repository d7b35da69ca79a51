//! What the browser shows: each thing with its key, name and image, in groups.

use std::path::{Path, PathBuf};

use egui::{TextureHandle, Ui};

use crate::app::actions::{Action, Command};
use crate::app::desk::Desk;
use crate::app::kit::tile::{self, Layout, Tile};
use crate::app::kit::widgets;
use crate::app::pane::Pane;
use crate::app::services::compare::Rival;
use crate::app::services::environments::environment_label;
use crate::app::services::library::Change;
use crate::app::services::shelves::{KeptShelves, environment_key, preset_key};
use crate::document::MaterialSettings;
use crate::scene::environment::{BUILT_IN, EnvironmentSource};
use crate::store::PRESETS;
use crate::store::exchange::FORMATS;
use crate::store::preset::{SHIPPED, source_of_values};
use crate::store::shelf::{Contents, Item, ItemKind};

/// Things that stand together.
pub struct Group {
    pub title: String,
    pub entries: Vec<Entry>,
    /// What is to be said of them.
    pub notes: Vec<String>,
    /// The watched folder that they lie in.
    pub folder: Option<PathBuf>,
}

impl Group {
    fn new(title: impl Into<String>, entries: Vec<Entry>) -> Self {
        Self {
            title: title.into(),
            entries,
            notes: Vec::new(),
            folder: None,
        }
    }
}

/// Something that can be used.
pub struct Entry {
    /// By which it is known.
    pub key: String,
    name: String,
    /// What only it is called.
    pub full_name: String,
    /// The user's own file, which can be renamed and deleted.
    pub own: Option<PathBuf>,
    kind: EntryKind,
    picture: Option<TextureHandle>,
}

enum EntryKind {
    Material(Box<MaterialSettings>),
    Environment(EnvironmentSource),
    /// A file that can't be used, and why.
    Broken(String),
}

impl Entry {
    fn material(key: String, material: &MaterialSettings, picture: Option<&TextureHandle>) -> Self {
        Self {
            key,
            name: material.name.clone(),
            full_name: material.name.clone(),
            own: None,
            kind: EntryKind::Material(Box::new(material.clone())),
            picture: picture.cloned(),
        }
    }

    fn environment(source: EnvironmentSource, picture: Option<&TextureHandle>) -> Self {
        let label = environment_label(&source);
        Self {
            key: environment_key(&source),
            // The panel of the light calls it by its name alone.
            full_name: format!("Environment {label}"),
            name: label,
            own: None,
            kind: EntryKind::Environment(source),
            picture: picture.cloned(),
        }
    }

    fn broken(path: &Path, why: &str) -> Self {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Self {
            key: path.display().to_string(),
            full_name: name.clone(),
            name,
            own: None,
            kind: EntryKind::Broken(why.to_owned()),
            picture: None,
        }
    }

    /// Whether its name, its group, its tags and the words of its look have each word that is searched for, in lower case.
    pub fn is_wanted(&self, search: &str, group: &str, kept: &KeptShelves) -> bool {
        if search.is_empty() {
            return true;
        }
        let look = match &self.kind {
            EntryKind::Material(material) => material.look_words().join(" "),
            EntryKind::Environment(_) | EntryKind::Broken(_) => String::new(),
        };
        let texts = [&self.name, group, &kept.tags_of(&self.key), &look].map(str::to_lowercase);
        search
            .split_whitespace()
            .all(|word| texts.iter().any(|text| text.contains(word)))
    }

    /// Width of its image over the height.
    pub fn aspect(&self) -> f32 {
        match self.kind {
            EntryKind::Environment(_) => 2.0,
            EntryKind::Material(_) | EntryKind::Broken(_) => 1.0,
        }
    }

    /// Shows it, and takes what the user does with it.
    pub fn show(&self, ui: &mut Ui, desk: &mut Desk<'_>, layout: Layout, tagging: &mut Option<(String, String)>) {
        let (color, is_current) = match &self.kind {
            EntryKind::Material(material) => {
                let [r, g, b] = widgets::srgb_of(material.base_color);
                (egui::Color32::from_rgb(r, g, b), **material == desk.material())
            }
            EntryKind::Environment(source) => {
                let is_current = *source == desk.document.lighting.environment;
                (ui.visuals().extreme_bg_color, is_current)
            }
            EntryKind::Broken(why) => {
                let label = egui::Label::new(&self.name).truncate();
                ui.add_enabled(false, label).on_disabled_hover_text(why);
                return;
            }
        };
        let menu_name = match self.own {
            Some(_) => format!("Rename, export or delete {}", self.full_name),
            None => format!("More of {}", self.full_name),
        };
        let tile = Tile {
            name: &self.name,
            full_name: &self.full_name,
            menu_name: &menu_name,
            picture: self.picture.as_ref(),
            aspect: self.aspect(),
            color,
            is_current,
            is_favourite: desk.shared.shelves.kept.favourites.contains(&self.key),
        };
        let mut response = tile.show(ui, layout, |ui| self.menu(ui, desk, tagging));
        if let (EntryKind::Material(_), None) = (&self.kind, &self.own)
            && let Some(source) = source_of_values(&self.full_name)
        {
            response = response.on_hover_text(source);
        }
        match &self.kind {
            EntryKind::Material(material) => {
                if response.clicked() {
                    desk.actions.push(Action::UseMaterial(material.clone()));
                }
                // Onto an object in the viewport, or a material in the tree of the scene.
                response.dnd_set_drag_payload((**material).clone());
                if response.dragged() {
                    tile::at_pointer(ui, self.picture.as_ref(), color);
                }
            }
            EntryKind::Environment(source) if response.clicked() && !is_current => {
                desk.actions.push(Action::UseEnvironment(source.clone()));
            }
            _ => {}
        }
    }

    /// What else can be done with it.
    fn menu(&self, ui: &mut Ui, desk: &mut Desk<'_>, tagging: &mut Option<(String, String)>) {
        let kept = &mut desk.shared.shelves.kept;
        let is_favourite = kept.favourites.contains(&self.key);
        let label = if is_favourite {
            "Remove from favourites"
        } else {
            "Add to favourites"
        };
        if widgets::pressed(ui, label, "Favourites stand at the top.") {
            kept.favour(&self.key);
        }
        if widgets::pressed(ui, "Tags…", "Words to find it by.") {
            *tagging = Some((self.key.clone(), kept.tags_of(&self.key)));
        }
        if let EntryKind::Material(material) = &self.kind {
            let help = "Shows it beside the material that is edited.";
            if widgets::pressed(ui, "Compare as B", help) {
                desk.actions
                    .push(Action::CompareWith(Rival::Material(material.clone())));
            }
            usage(ui, desk, material);
            ui.separator();
            taking_along(ui, material, desk.actions);
        }
        let Some(path) = &self.own else { return };
        ui.separator();
        let is_material = matches!(self.kind, EntryKind::Material(_));
        if ui.add_enabled(is_material, egui::Button::new("Rename")).clicked() {
            desk.shared.library.renaming = Some((path.clone(), self.name.clone()));
        }
        if ui.add_enabled(is_material, egui::Button::new("Duplicate")).clicked() {
            desk.actions
                .push(Action::ChangeLibrary(Change::Duplicate(path.clone())));
        }
        if ui.button("Delete").clicked() {
            desk.actions.push(Action::ChangeLibrary(Change::Remove(path.clone())));
        }
    }
}

/// Where a material is used in the scene, and using it everywhere in place of the one that is edited.
fn usage(ui: &mut Ui, desk: &mut Desk<'_>, material: &MaterialSettings) {
    let users = desk.slots_where(|used| used.name == material.name);
    let show = egui::Button::new(format!("Show where it is used ({})", users.len()));
    let show = ui.add_enabled(!users.is_empty(), show);
    let show =
        show.on_hover_text("Chooses the materials of the scene that have its name, and outlines their surfaces.");
    if show
        .on_disabled_hover_text("No material of the scene has its name.")
        .clicked()
    {
        desk.actions.push(Action::SelectSlots(users));
        desk.actions.push(Action::Reveal(Pane::Scene));
        ui.close();
    }
    let edited = desk.material();
    let alike = desk.slots_where(|used| *used == edited);
    let replace = egui::Button::new(format!("Replace on all that use {} ({})", edited.name, alike.len()));
    let replace = ui.add_enabled(alike.len() > 1, replace);
    let replace = replace.on_hover_text("Gives this material to all slots that have the one that is edited.");
    if replace
        .on_disabled_hover_text("No other slot has the material that is edited.")
        .clicked()
    {
        desk.actions.push(Action::SelectSlots(alike));
        desk.actions.push(Action::UseMaterial(Box::new(material.clone())));
        ui.close();
    }
}

/// The ways of a material into other programs: nothing can be dragged out of the window on every system that it runs on.
fn taking_along(ui: &mut Ui, material: &MaterialSettings, actions: &mut Vec<Action>) {
    if ui.button(Command::Export.label()).clicked() {
        actions.push(Action::Export(Box::new(material.clone())));
    }
    ui.menu_button("Copy as", |ui| {
        for format in FORMATS
            .iter()
            .filter(|format| format.is_written && format.format.is_text())
        {
            if widgets::pressed(ui, format.label, format.help) {
                actions.push(Action::CopyAs(Box::new(material.clone()), format.name));
            }
        }
    });
}

/// Everything, in groups: favourites, shipped materials by kind, the user's own, watched folders, environments.
pub fn groups(ctx: &egui::Context, desk: &mut Desk<'_>) -> Vec<Group> {
    let mut groups: Vec<Group> = shipped(desk);
    groups.push(Group::new("Mine", own(desk)));
    groups.extend(watched(desk));
    groups.push(Group::new("Environments", environments(desk)));
    let sources: Vec<EnvironmentSource> = groups
        .iter()
        .flat_map(|group| &group.entries)
        .filter_map(|entry| match &entry.kind {
            EntryKind::Environment(source) => Some(source.clone()),
            _ => None,
        })
        .collect();
    desk.make_environment_pictures(ctx, "browser", &sources);
    let favourites = &desk.shared.shelves.kept.favourites;
    let mut first = Vec::new();
    for group in &mut groups {
        let is_favourite = |entry: &mut Entry| favourites.contains(&entry.key);
        first.extend(group.entries.extract_if(.., is_favourite));
    }
    groups.insert(0, Group::new("Favourites", first));
    groups
}

fn shipped(desk: &Desk<'_>) -> Vec<Group> {
    let mut entries = PRESETS.iter().enumerate().map(|(index, material)| {
        let picture = desk.shared.library.shipped_picture(index);
        Entry::material(preset_key(material), material, picture)
    });
    let group = |(title, files): &(&str, &[&str])| Group::new(*title, entries.by_ref().take(files.len()).collect());
    SHIPPED.iter().map(group).collect()
}

fn own(desk: &Desk<'_>) -> Vec<Entry> {
    let library = &desk.shared.library;
    let entry = |shown: &crate::app::services::library::MaterialCard| {
        let path = &shown.entry.path;
        let entry = match &shown.entry.material {
            Ok(material) => Entry::material(path.display().to_string(), material, library.picture(shown.key)),
            Err(why) => Entry::broken(path, why),
        };
        Entry {
            own: Some(path.clone()),
            ..entry
        }
    };
    library.own.iter().map(entry).collect()
}

fn watched(desk: &Desk<'_>) -> Vec<Group> {
    let (contents, keys) = desk.shared.shelves.contents();
    let group = |(contents, keys): (&Contents, &Vec<u64>)| {
        let folder = contents.folder.file_name().unwrap_or(contents.folder.as_os_str());
        let mut group = Group::new(folder.to_string_lossy(), Vec::new());
        group.folder = Some(contents.folder.clone());
        match &contents.items {
            Ok(items) => {
                let items = items.iter().zip(keys);
                group.entries = items
                    .map(|(item, key)| found(desk, &contents.folder, item, *key))
                    .collect();
                if group.entries.is_empty() {
                    group
                        .notes
                        .push("No materials (.json, .mtlx) and no environments (.hdr, .exr).".to_owned());
                }
            }
            Err(why) => group.notes.push(why.clone()),
        }
        if contents.has_more {
            group.notes.push(format!("The first {} files.", group.entries.len()));
        }
        group
    };
    let folders = &desk.shared.shelves.kept.folders;
    let is_watched = |(contents, _): &(&Contents, &Vec<u64>)| folders.contains(&contents.folder);
    contents.iter().zip(&keys).filter(is_watched).map(group).collect()
}

/// A file in a watched folder, which others may share their name with.
fn found(desk: &Desk<'_>, folder: &Path, item: &Item, picture_key: u64) -> Entry {
    let path = &item.path;
    let mut entry = match &item.kind {
        ItemKind::Material(Ok(material)) => {
            let picture = desk.shared.library.picture(picture_key);
            Entry::material(path.display().to_string(), material, picture)
        }
        ItemKind::Material(Err(why)) => Entry::broken(path, why),
        ItemKind::Environment => {
            let source = EnvironmentSource::File(path.clone());
            let picture = desk.shared.environments.picture(&source);
            Entry::environment(source.clone(), picture)
        }
    };
    let within = path.strip_prefix(folder.parent().unwrap_or(folder)).unwrap_or(path);
    entry.full_name = format!("{} ({})", entry.name, within.display());
    entry
}

/// Those that come with the program, the one in use, and those opened last, but for what lies in watched folders.
fn environments(desk: &Desk<'_>) -> Vec<Entry> {
    let folders = &desk.shared.shelves.kept.folders;
    let is_shown = |source: &EnvironmentSource| match source {
        EnvironmentSource::File(path) => !folders.iter().any(|folder| path.starts_with(folder)),
        _ => true,
    };
    let mut sources: Vec<EnvironmentSource> = BUILT_IN.iter().map(|built_in| built_in.source.clone()).collect();
    let current = std::iter::once(desk.document.lighting.environment.clone());
    for source in current.chain(desk.shared.recent.environments()).filter(is_shown) {
        if !sources.contains(&source) {
            sources.push(source);
        }
    }
    let entry = |source: EnvironmentSource| {
        let picture = desk.shared.environments.picture(&source);
        Entry::environment(source.clone(), picture)
    };
    sources.into_iter().map(entry).collect()
}
