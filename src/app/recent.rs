//! The files opened and saved last.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::Ui;

use super::actions::Action;
use super::menu::do_and_close;
use crate::render::background::Background;
use crate::scene::environment::EnvironmentSource;

/// Most that are remembered.
const COUNT: usize = 12;
/// How long an answer to which files are there is good for.
const FRESH: Duration = Duration::from_secs(1);

/// Looks which files are not there, beside the window: a network folder may take its time.
type Search = Background<Vec<PathBuf>, Arc<HashSet<PathBuf>>>;

/// The list, the latest first.
#[derive(Default)]
pub(super) struct Recent {
    paths: Vec<PathBuf>,
    search: Option<Search>,
    searched_at: Option<Instant>,
}

impl Recent {
    /// The list as the last start left it.
    pub(super) fn new(paths: Vec<PathBuf>) -> Self {
        Self {
            paths,
            ..Self::default()
        }
    }

    /// What the next start is to have.
    pub(super) fn paths(&self) -> &[PathBuf] {
        &self.paths
    }

    /// Those that are environments.
    pub(super) fn environments(&self) -> impl Iterator<Item = EnvironmentSource> {
        let is_map = |path: &&PathBuf| {
            let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
            ending.is_some_and(|ending| ending == "hdr" || ending == "exr")
        };
        self.paths.iter().filter(is_map).cloned().map(EnvironmentSource::File)
    }

    /// A file was opened or saved. Files not named in Unicode can't be remembered, as the settings are text.
    pub(super) fn add(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        if path.to_str().is_none() {
            return;
        }
        self.paths.retain(|known| *known != path);
        self.paths.insert(0, path);
        self.paths.truncate(COUNT);
        self.searched_at = None;
    }

    /// A menu of the files; those that are not there any more are greyed.
    pub(super) fn menu(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        ui.add_enabled_ui(!self.paths.is_empty(), |ui| {
            ui.menu_button("Open recent", |ui| {
                ui.set_min_width(220.0);
                self.look(ui.ctx());
                let missing = self.search.as_ref().and_then(Background::latest).unwrap_or_default();
                for path in &self.paths {
                    if entry(ui, path, missing.contains(path)) {
                        do_and_close(ui, actions, Action::Open(path.clone()));
                    }
                }
                ui.separator();
                if ui.button("Clear the list").clicked() {
                    self.paths.clear();
                }
            });
        });
    }

    fn look(&mut self, ctx: &egui::Context) {
        if self.searched_at.is_some_and(|at| at.elapsed() < FRESH) {
            return;
        }
        if self.search.is_none() {
            let ctx = ctx.clone();
            let work = |paths: Vec<PathBuf>, desk: &crate::render::background::Desk<'_, _, _>| {
                let missing = paths.into_iter().filter(|path| !path.is_file());
                desk.publish(Arc::new(missing.collect()));
            };
            // Without a thread nothing is greyed: opening says then what is missing.
            self.search = Background::spawn("recent files", move || ctx.request_repaint(), work).ok();
        }
        if let Some(search) = &self.search {
            search.ask(self.paths.clone());
        }
        self.searched_at = Some(Instant::now());
    }
}

fn entry(ui: &mut Ui, path: &Path, is_missing: bool) -> bool {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    let label = if is_missing {
        format!("{name} (not there any more)")
    } else {
        name.into_owned()
    };
    let full = path.display().to_string();
    ui.add_enabled(!is_missing, egui::Button::new(label))
        .on_hover_text(&full)
        .on_disabled_hover_text(full)
        .clicked()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_comes_first_and_only_once() {
        let mut recent = Recent::default();
        for name in ["/a.json", "/b.glb", "/a.json"] {
            recent.add(Path::new(name));
        }
        assert_eq!(recent.paths(), [Path::new("/a.json"), Path::new("/b.glb")]);
        for number in 0..2 * COUNT {
            recent.add(Path::new(&format!("/{number}.glb")));
        }
        assert_eq!(recent.paths().len(), COUNT);
    }
}
