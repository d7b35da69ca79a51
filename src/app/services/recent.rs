//! The files opened and saved last.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::app::services::beside::started;
use crate::import::endings::is_picture;
use crate::render::background::Background;
use crate::scene::environment::EnvironmentSource;
use crate::store::file_kind::may_hold_document;

/// Most that are remembered.
const COUNT: usize = 12;
/// How long an answer to which files are there is good for.
const FRESH: Duration = Duration::from_secs(1);

/// Looks which files are not there, beside the window: a network folder may take its time.
type Search = Background<Vec<PathBuf>, Arc<HashSet<PathBuf>>>;

/// The list, the latest first.
#[derive(Default)]
pub struct Recent {
    paths: Vec<PathBuf>,
    search: Option<Search>,
    searched_at: Option<Instant>,
}

impl Recent {
    /// The list as the last start left it.
    pub fn new(paths: Vec<PathBuf>) -> Self {
        Self {
            paths,
            ..Self::default()
        }
    }

    /// What the next start is to have.
    pub fn paths(&self) -> &[PathBuf] {
        &self.paths
    }

    /// Those that are environments.
    pub fn environments(&self) -> impl Iterator<Item = EnvironmentSource> {
        // Of images only environments are remembered, and those that have a document inside.
        let is_map = |path: &&PathBuf| is_picture(path) && !may_hold_document(path);
        self.paths.iter().filter(is_map).cloned().map(EnvironmentSource::File)
    }

    /// A file was opened or saved. Files not named in Unicode can't be remembered, as the settings are text.
    pub fn add(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        if path.to_str().is_none() {
            return;
        }
        self.paths.retain(|known| *known != path);
        self.paths.insert(0, path);
        self.paths.truncate(COUNT);
        self.searched_at = None;
    }

    pub fn clear(&mut self) {
        self.paths.clear();
    }

    /// Those that are not there any more, as far as is known; looks again where that was long ago.
    pub fn missing(&mut self, ctx: &egui::Context) -> Arc<HashSet<PathBuf>> {
        self.look(ctx);
        self.search.as_ref().and_then(Background::latest).unwrap_or_default()
    }

    fn look(&mut self, ctx: &egui::Context) {
        if self.searched_at.is_some_and(|at| at.elapsed() < FRESH) {
            return;
        }
        let search = started(&mut self.search, ctx, |repaint| {
            Background::spawn("recent files", repaint, |paths: Vec<PathBuf>, responder| {
                let missing = paths.into_iter().filter(|path| !path.is_file());
                responder.publish(Arc::new(missing.collect()));
            })
        });
        // Without a thread nothing is greyed: opening says then what is missing.
        if let Some(search) = search {
            search.ask(self.paths.clone());
        }
        self.searched_at = Some(Instant::now());
    }
}
