//! What the browser of materials and environments keeps: favourites, the size of its images, the folders that it
//! watches and what lies in them.

use std::{collections::BTreeSet, path::PathBuf, sync::Arc, time::Duration};

use serde::{Deserialize, Serialize};

use crate::{
    document::MaterialSettings,
    named::with_defaults,
    scene::{environment::EnvironmentSource, path_text::file_name},
    services::beside::Beside,
    store::preset::command_line_name,
    store::shelf::{Contents, Shelf},
};

/// From one look into the watched folders to the next, while they are seen.
const INTERVAL: Duration = Duration::from_secs(2);

with_defaults! {
    /// What is remembered from one start to the next. Things are known by a key: `preset:gold`, `environment:studio`, or a path.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(default)]
    pub struct KeptShelves {
        /// Those that come first.
        pub favourites: BTreeSet<String>,
        /// Folders that are watched.
        pub folders: Vec<PathBuf>,
        /// Side of a material's image, points; [`LIST`] and below are rows of a list.
        pub picture_side: f32 = 80.0,
    }
}

/// The key of a shipped material.
pub fn preset_key(material: &MaterialSettings) -> String {
    format!("preset:{}", command_line_name(&material.name))
}

/// What to call an environment in a menu.
pub fn environment_label(source: &EnvironmentSource) -> String {
    match source {
        EnvironmentSource::File(path) => file_name(path),
        other => other.built_in().map_or("", |built_in| built_in.label).to_owned(),
    }
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

impl KeptShelves {
    /// Makes something a favourite, or none any more.
    pub fn favour(&mut self, key: &str) {
        if !self.favourites.remove(key) {
            self.favourites.insert(key.to_owned());
        }
    }
}

/// The browser's state.
#[derive(Default)]
pub struct Shelves {
    pub kept: KeptShelves,
    worker: Beside<(u64, Vec<PathBuf>), Arc<Vec<Contents>>>,
    /// What the folders hold.
    pub contents: Arc<Vec<Contents>>,
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

    /// Looks into the folders now and then. To be called while they are seen.
    pub fn look(&mut self, ctx: &egui::Context) {
        if self.kept.folders.is_empty() && self.contents.is_empty() {
            return;
        }
        let turn = (ctx.input(|input| input.time) / INTERVAL.as_secs_f64()) as u64;
        let mut shelf = Shelf::default();
        let query = (turn, self.kept.folders.clone());
        let contents = self.worker.ask(ctx, "folders", query, move |(_, folders), responder| {
            responder.publish(Arc::new(shelf.list(&folders)));
        });
        self.contents = contents.unwrap_or_default();
        ctx.request_repaint_after(INTERVAL);
    }
}
