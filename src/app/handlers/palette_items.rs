//! What the palette finds beside commands and parameters: what can be used, each with what uses it.

use std::fmt::Write as _;

use crate::app::App;
use crate::app::actions::Action;
use crate::app::services::environments::environment_label;
use crate::app::services::shelves::{environment_key, preset_key};
use crate::app::sheets::palette::Findable;
use crate::app::workspaces::Change;
use crate::document::MaterialSettings;
use crate::scene::environment::{BUILT_IN, EnvironmentSource};
use crate::store::PRESETS;

impl App {
    /// Materials, environments, views of the camera, workspaces and recent files.
    pub fn things(&self) -> Vec<Findable> {
        let shipped = PRESETS
            .iter()
            .map(|material| self.material(preset_key(material), material));
        let own = self.shared.library.own.iter().filter_map(|shown| {
            let material = shown.entry.material.as_ref().ok()?;
            Some(self.material(shown.entry.path.display().to_string(), material))
        });
        let built_in = BUILT_IN.iter().map(|built_in| built_in.source.clone());
        let environments = built_in
            .chain(self.shared.recent.environments())
            .map(|source: EnvironmentSource| {
                let label = format!("Environment {}", environment_label(&source));
                let key = environment_key(&source);
                self.of_browser(key, Findable::new(label, Action::UseEnvironment(source)))
            });
        let views = self.document.bookmarks.iter().enumerate();
        let views =
            views.map(|(number, view)| Findable::new(format!("View {}", view.name), Action::UseBookmark(number)));
        let workspaces = self.workspaces.names().map(|name| {
            let change = Change::Use(name.to_owned());
            Findable::new(format!("Workspace {name}"), Action::ChangeWorkspaces(change))
        });
        let files = self.shared.recent.paths().iter().map(|path| {
            let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
            Findable::new(format!("Open {name}"), Action::Open(path.clone()))
        });
        shipped
            .chain(own)
            .chain(environments)
            .chain(views)
            .chain(workspaces)
            .chain(files)
            .collect()
    }

    fn material(&self, key: String, material: &MaterialSettings) -> Findable {
        let label = format!("Material {}", material.name);
        let mut found = self.of_browser(
            key,
            Findable::new(label, Action::UseMaterial(Box::new(material.clone()))),
        );
        for word in material.look_words() {
            let _ = write!(found.tags, " {word}");
        }
        found
    }

    /// With its tags, and whether it is a favourite, as in the browser.
    fn of_browser(&self, key: String, findable: Findable) -> Findable {
        let kept = &self.shared.shelves.kept;
        Findable {
            tags: kept.tags_of(&key),
            is_favourite: kept.favourites.contains(&key),
            ..findable
        }
    }
}
