//! What the browser shows: each thing with its key, name and image, in groups.

use std::path::{Path, PathBuf};

use super::*;
use crate::{
    document::MaterialSettings,
    kit::tile::Tile,
    render::thumbnails::Subject,
    scene::environment::EnvironmentSource,
    services::{
        compare::Rival,
        pictures::Part,
        shelves::{environment_key, environment_label, preset_key},
        viewing::Pick,
    },
    store::{
        PRESETS,
        exchange::FORMATS,
        preset::{SHIPPED, source_of_values},
        shelf::{Item, ItemKind},
    },
};

/// Things that stand together.
pub struct Group {
    pub title: String,
    pub entries: Vec<Card>,
    /// What is to be said of them.
    pub notes: Vec<String>,
    /// The watched folder that they lie in.
    pub folder: Option<PathBuf>,
}

impl Group {
    fn new(title: impl Into<String>, entries: Vec<Card>) -> Self {
        Self {
            title: title.into(),
            entries,
            notes: Vec::new(),
            folder: None,
        }
    }
}

/// Something that can be used.
pub struct Card {
    /// By which it is known.
    pub key: String,
    name: String,
    /// What only it is called.
    pub full_name: String,
    /// The user's own file, which can be renamed and deleted.
    pub own: Option<PathBuf>,
    kind: CardKind,
    picture: Option<TextureHandle>,
}

enum CardKind {
    Material(Box<MaterialSettings>),
    Environment(EnvironmentSource),
    /// A file that can't be used, and why.
    Broken(String),
}

impl Card {
    fn new(desk: &Desk, key: String, name: String, kind: CardKind) -> Self {
        Self {
            picture: desk.shared.pictures.texture(&key).cloned(),
            key,
            full_name: name.clone(),
            name,
            own: None,
            kind,
        }
    }

    /// A file, or why it can't be used.
    fn file(desk: &Desk, path: &Path, material: Result<&MaterialSettings, &String>) -> Self {
        let key = path.display().to_string();
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        match material {
            Ok(material) => Self::material(desk, key, material),
            Err(why) => Self::new(desk, key, name, CardKind::Broken(why.clone())),
        }
    }

    fn material(desk: &Desk, key: String, material: &MaterialSettings) -> Self {
        let kind = CardKind::Material(Box::new(material.clone()));
        Self::new(desk, key, material.name.clone(), kind)
    }

    fn environment(desk: &Desk, source: EnvironmentSource) -> Self {
        let (key, label) = (environment_key(&source), environment_label(&source));
        Self::new(desk, key, label, CardKind::Environment(source))
    }

    /// Whether its name, its group and the words of its look have each word that is searched for, in lower case.
    pub fn is_wanted(&self, search: &str, group: &str) -> bool {
        if search.is_empty() {
            return true;
        }
        let look = match &self.kind {
            CardKind::Material(material) => material.look_words().join(" "),
            _ => String::new(),
        };
        let texts = [&self.name, group, &look].map(str::to_lowercase);
        search
            .split_whitespace()
            .all(|word| texts.iter().any(|text| text.contains(word)))
    }

    /// Whether its name has each word that is searched for, in lower case.
    pub fn is_named(&self, search: &str) -> bool {
        let name = self.name.to_lowercase();
        search.split_whitespace().all(|word| name.contains(word))
    }

    /// Width of its image over the height.
    pub fn aspect(&self) -> f32 {
        match self.kind {
            CardKind::Environment(_) => 2.0,
            _ => 1.0,
        }
    }

    /// Shows it, and takes what the user does with it.
    pub fn show(&self, ui: &mut Ui, desk: &mut Desk, layout: Layout) {
        let (color, is_current) = match &self.kind {
            CardKind::Material(material) => (widgets::shown(material.base_color), **material == desk.material()),
            CardKind::Environment(source) => {
                let is_current = *source == desk.document.lighting.environment;
                (ui.visuals().extreme_bg_color, is_current)
            }
            CardKind::Broken(why) => {
                let label = Label::new(&self.name).truncate();
                ui.add_enabled(false, label).on_disabled_hover_text(why);
                return;
            }
        };
        let menu_name = match self.own {
            Some(_) => format!("Rename, export or delete {}", self.full_name),
            None => format!("More of {}", self.full_name),
        };
        let (Layout::List(height) | Layout::Grid(height)) = layout;
        let tile = Tile {
            name: &self.name,
            full_name: &self.full_name,
            picture: self.picture.as_ref(),
            size: vec2(height * self.aspect(), height),
            color,
            is_current,
        };
        let is_favourite = desk.shared.shelves.kept.favourites.contains(&self.key);
        let response = tile.show(ui, layout, (&menu_name, is_favourite), |ui| self.menu(ui, desk));
        match &self.kind {
            CardKind::Material(material) => {
                if response.clicked() {
                    let picks = &mut desk.shared.viewing.picks;
                    let is_rival = picks.take_if(|pick| *pick == Pick::Rival).is_some();
                    desk.actions.push(match is_rival {
                        true => Action::CompareWith(Rival::Material(material.clone())),
                        false => Action::UseMaterial(material.clone()),
                    });
                }
                // Onto an object in the viewport, or a material in the tree of the scene.
                response.dnd_set_drag_payload((**material).clone());
                if response.dragged() {
                    tile.at_pointer(ui);
                }
                let source = source_of_values(&self.full_name).filter(|_| self.own.is_none());
                widgets::explained(response, source.unwrap_or_default());
            }
            CardKind::Environment(source) if response.clicked() && !is_current => {
                desk.actions.push(Action::UseEnvironment(source.clone()));
            }
            _ => {}
        }
    }

    /// What else can be done with it.
    fn menu(&self, ui: &mut Ui, desk: &mut Desk) {
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
        if let CardKind::Material(material) = &self.kind {
            let help = "Shows it beside the material that is edited.";
            if widgets::pressed(ui, "Compare as B", help) {
                let rival = Rival::Material(material.clone());
                desk.actions.push(Action::CompareWith(rival));
            }
            usage(ui, desk, material);
            ui.separator();
            taking_along(ui, material, desk.actions);
        }
        let Some(path) = &self.own else { return };
        ui.separator();
        let is_material = matches!(self.kind, CardKind::Material(_));
        if widgets::pressed_if(ui, is_material, "Rename", "", "") {
            desk.shared.library.renaming = Some((path.clone(), self.name.clone()));
        }
        let mut change = None;
        if widgets::pressed_if(ui, is_material, "Duplicate", "", "") {
            change = Some(Change::Duplicate(path.clone()));
        }
        if ui.button("Delete").clicked() {
            change = Some(Change::Remove(path.clone()));
        }
        desk.actions.extend(change.map(Action::ChangeLibrary));
    }
}

/// Where a material is used in the scene, and using it everywhere in place of the one that is edited.
fn usage(ui: &mut Ui, desk: &mut Desk, material: &MaterialSettings) {
    let users = desk.slots_where(|used| used.name == material.name);
    let text = format!("Show where it is used ({})", users.len());
    let help = "Chooses the materials of the scene that have its name, and outlines their surfaces.";
    let why_not = "No material of the scene has its name.";
    if widgets::pressed_if(ui, !users.is_empty(), text, help, why_not) {
        desk.actions.push(Action::SelectSlots(users));
        desk.actions.push(Action::Reveal(Pane::Material));
        ui.close();
    }
    let edited = desk.material();
    let alike = desk.slots_where(|used| *used == edited);
    let text = format!("Replace on all that use {} ({})", edited.name, alike.len());
    let help = "Gives this material to all slots that have the one that is edited.";
    let why_not = "No other slot has the material that is edited.";
    if widgets::pressed_if(ui, alike.len() > 1, text, help, why_not) {
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
        for format in FORMATS.iter().filter(|format| format.is_text()) {
            if widgets::pressed(ui, format.label, format.help) {
                actions.push(Action::CopyAs(Box::new(material.clone()), format.name));
            }
        }
    });
}

/// Everything, in groups: favourites, shipped materials by kind, the user's own, watched folders.
pub fn groups(desk: &mut Desk) -> Vec<Group> {
    let mut groups: Vec<Group> = shipped(desk);
    groups.push(Group::new("Mine", own(desk)));
    groups.extend(watched(desk));
    let entries = groups.iter().flat_map(|group| &group.entries);
    let subject = |entry: &Card| {
        let subject = match &entry.kind {
            CardKind::Material(material) => Subject::Material(material.clone()),
            CardKind::Environment(source) => Subject::Environment(source.clone()),
            CardKind::Broken(_) => return None,
        };
        Some((entry.key.clone(), subject))
    };
    desk.shared.pictures.want(Part::Browser, entries.filter_map(subject));
    let favourites = &desk.shared.shelves.kept.favourites;
    let mut first = Vec::new();
    for group in &mut groups {
        let is_favourite = |entry: &mut Card| favourites.contains(&entry.key);
        first.extend(group.entries.extract_if(.., is_favourite));
    }
    groups.insert(0, Group::new("Favourites", first));
    groups
}

fn shipped(desk: &Desk) -> Vec<Group> {
    let entry = |material| Card::material(desk, preset_key(material), material);
    let mut entries = PRESETS.iter().map(entry);
    let group = |(title, files): &(&str, &[&str])| Group::new(*title, entries.by_ref().take(files.len()).collect());
    SHIPPED.iter().map(group).collect()
}

fn own(desk: &Desk) -> Vec<Card> {
    let own = desk.shared.library.entries.iter().map(|own| Card {
        own: Some(own.path.clone()),
        ..Card::file(desk, &own.path, own.material.as_ref())
    });
    own.collect()
}

fn watched(desk: &Desk) -> Vec<Group> {
    let folders = &desk.shared.shelves.kept.folders;
    let mut groups = Vec::new();
    for contents in desk.shared.shelves.contents.iter() {
        let folder = &contents.folder;
        if !folders.contains(folder) {
            continue;
        }
        let name = folder.file_name().unwrap_or(folder.as_os_str()).to_string_lossy();
        let mut group = Group::new(name, Vec::new());
        group.folder = Some(folder.clone());
        match &contents.items {
            Ok(items) if items.is_empty() => {
                let note = "No materials (.json, .mtlx) and no environments (.hdr, .exr).";
                group.notes.push(note.to_owned());
            }
            Ok(items) => group.entries = items.iter().map(|item| found(desk, folder, item)).collect(),
            Err(why) => group.notes.push(why.clone()),
        }
        if contents.has_more {
            group.notes.push(format!("The first {} files.", group.entries.len()));
        }
        groups.push(group);
    }
    groups
}

/// A file in a watched folder, which others may share their name with.
fn found(desk: &Desk, folder: &Path, item: &Item) -> Card {
    let path = &item.path;
    let mut entry = match &item.kind {
        ItemKind::Material(material) => Card::file(desk, path, material.as_deref()),
        ItemKind::Environment => Card::environment(desk, EnvironmentSource::File(path.clone())),
    };
    let within = path.strip_prefix(folder.parent().unwrap_or(folder)).unwrap_or(path);
    entry.full_name = format!("{} ({})", entry.name, within.display());
    entry
}
