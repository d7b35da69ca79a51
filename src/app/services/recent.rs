//! The files opened and saved last.

use std::{collections::HashSet, path::Path, path::PathBuf, sync::Arc};

use crate::{
    import::endings::is_picture, scene::environment::EnvironmentSource, services::beside::Beside,
    store::file_kind::may_hold_document,
};

/// Most that are remembered.
const COUNT: usize = 12;

/// The list, the latest first.
#[derive(Default)]
pub struct Recent {
    pub paths: Vec<PathBuf>,
    /// Looks each second which files are not there: a network folder may take its time.
    search: Beside<(u64, Vec<PathBuf>), Arc<HashSet<PathBuf>>>,
}

impl Recent {
    /// The list as the last start left it.
    pub fn new(paths: Vec<PathBuf>) -> Self {
        let search = Beside::default();
        Self { paths, search }
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
        if path.to_str().is_some() {
            self.paths.retain(|known| *known != path);
            self.paths.insert(0, path);
            self.paths.truncate(COUNT);
        }
    }

    /// Those that are not there any more, as far as is known.
    pub fn missing(&mut self, ctx: &egui::Context) -> Arc<HashSet<PathBuf>> {
        let query = (ctx.input(|input| input.time) as u64, self.paths.clone());
        let missing = self.search.ask(ctx, "recent files", query, |(_, paths), responder| {
            let missing = paths.into_iter().filter(|path| !path.is_file());
            responder.publish(Arc::new(missing.collect()));
        });
        missing.unwrap_or_default()
    }
}
