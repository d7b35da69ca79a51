//! What the browser of materials and environments keeps: favourites, tags, the size of its images, the folders that it
//! watches and what lies in them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use crate::app::services::beside::started;
use crate::app::services::environments::environment_label;
use crate::app::services::library::Library;
use crate::document::MaterialSettings;
use crate::render::background::Background;
use crate::render::thumbnails;
use crate::scene::environment::EnvironmentSource;
use crate::store::preset::command_line_name;
use crate::store::shelf::{Contents, ItemKind, Shelf};

/// From one look into the watched folders to the next, while they are seen.
const INTERVAL: Duration = Duration::from_secs(2);

/// What is remembered from one start to the next. Things are known by a key: `preset:gold`, `environment:studio`, or a path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct KeptShelves {
    /// Those that come first.
    pub favourites: BTreeSet<String>,
    /// By what is tagged.
    pub tags: BTreeMap<String, BTreeSet<String>>,
    /// Folders that are watched.
    pub folders: Vec<PathBuf>,
    /// Side of a material's image, points; [`LIST`] and below are rows of a list.
    pub picture_side: f32,
}

/// The key of a shipped material.
pub fn preset_key(material: &MaterialSettings) -> String {
    format!("preset:{}", command_line_name(&material.name))
}

/// The key of an environment.
pub fn environment_key(source: &EnvironmentSource) -> String {
    match source {
        EnvironmentSource::File(path) => path.display().to_string(),
        _ => format!("environment:{}", environment_label(source).to_lowercase()),
    }
}

/// The side of an image in a list.
pub const LIST: f32 = 36.0;
/// The largest side of an image.
pub const SIDE_MAX: f32 = 256.0;

impl Default for KeptShelves {
    fn default() -> Self {
        Self {
            favourites: BTreeSet::new(),
            tags: BTreeMap::new(),
            folders: Vec::new(),
            picture_side: 80.0,
        }
    }
}

impl KeptShelves {
    /// Makes something a favourite, or none any more.
    pub fn favour(&mut self, key: &str) {
        if !self.favourites.remove(key) {
            self.favourites.insert(key.to_owned());
        }
    }

    /// The tags of something, commas between them.
    pub fn tags_of(&self, key: &str) -> String {
        let tags: Vec<&str> = self.tags.get(key).into_iter().flatten().map(String::as_str).collect();
        tags.join(", ")
    }

    /// Gives something the tags of a text, commas between them.
    pub fn tag(&mut self, key: &str, text: &str) {
        let tags = text.split(',').map(|tag| tag.trim().to_lowercase());
        let tags: BTreeSet<String> = tags.filter(|tag| !tag.is_empty()).collect();
        if tags.is_empty() {
            self.tags.remove(key);
        } else {
            self.tags.insert(key.to_owned(), tags);
        }
    }

    /// Every tag that something has.
    pub fn all_tags(&self) -> BTreeSet<&str> {
        self.tags.values().flatten().map(String::as_str).collect()
    }
}

/// The browser's state.
#[derive(Default)]
pub struct Shelves {
    pub kept: KeptShelves,
    worker: Option<Background<Vec<PathBuf>, Arc<Vec<Contents>>>>,
    has_failed: bool,
    asked: Option<(Instant, Vec<PathBuf>)>,
    contents: Arc<Vec<Contents>>,
    /// The keys of the images of the materials, in the order of folders and items; 0 for what is no material.
    picture_keys: Vec<Vec<u64>>,
}

impl Shelves {
    pub fn new(kept: KeptShelves) -> Self {
        Self {
            kept,
            ..Self::default()
        }
    }

    /// Watches a folder from now on.
    pub fn watch(&mut self, folder: PathBuf) {
        if !self.kept.folders.contains(&folder) {
            self.kept.folders.push(folder);
        }
    }

    /// Looks into the folders now and then, and has images made of the materials that lie there. To be called while they
    /// are seen.
    pub fn look(&mut self, ctx: &egui::Context, library: &mut Library) {
        if self.kept.folders.is_empty() && self.asked.is_none() || self.has_failed {
            return;
        }
        let worker = started(&mut self.worker, ctx, |repaint| {
            let mut shelf = Shelf::default();
            let mut last = Arc::default();
            Background::spawn("folders", repaint, move |folders: Vec<PathBuf>, responder| {
                let contents = shelf.list(&folders);
                if contents != *last {
                    last = Arc::new(contents);
                    responder.publish(last.clone());
                }
            })
        });
        let Some(worker) = worker else {
            self.has_failed = true;
            return;
        };
        let is_asked =
            |(when, folders): &(Instant, Vec<PathBuf>)| when.elapsed() < INTERVAL && *folders == self.kept.folders;
        if !self.asked.as_ref().is_some_and(is_asked) {
            worker.ask(self.kept.folders.clone());
            self.asked = Some((Instant::now(), self.kept.folders.clone()));
        }
        ctx.request_repaint_after(INTERVAL);
        let Some(latest) = worker.latest().filter(|latest| !Arc::ptr_eq(latest, &self.contents)) else {
            return;
        };
        let materials = |contents: &Contents| -> Vec<u64> {
            let items = contents.items.iter().flatten();
            items
                .map(|item| match &item.kind {
                    ItemKind::Material(Ok(material)) => thumbnails::key(material),
                    _ => 0,
                })
                .collect()
        };
        self.picture_keys = latest.iter().map(materials).collect();
        let items = latest.iter().flat_map(|contents| contents.items.iter().flatten());
        library.watched = items
            .filter_map(|item| match &item.kind {
                ItemKind::Material(Ok(material)) => Some((**material).clone()),
                _ => None,
            })
            .collect();
        library.is_asked = false;
        self.contents = latest;
    }

    /// What the folders hold, each with the keys of its images.
    pub fn contents(&self) -> (Arc<Vec<Contents>>, Vec<Vec<u64>>) {
        (self.contents.clone(), self.picture_keys.clone())
    }
}
