//! What the palette finds beside commands and parameters: what can be used, each with what uses it.

use crate::app::App;
use crate::app::actions::Action;
use crate::app::services::environments::environment_label;
use crate::app::workspaces::Change;
use crate::scene::environment::{BUILT_IN, EnvironmentSource};
use crate::store::PRESETS;

impl App {
    /// Materials, environments, views of the camera, workspaces and recent files.
    pub(in crate::app) fn things(&self) -> Vec<(String, Action)> {
        let own = self.shared.library.own.iter();
        let own = own.filter_map(|shown| shown.entry.material.as_ref().ok());
        let materials = PRESETS.iter().chain(own).map(|material| {
            let label = format!("Material {}", material.name);
            (label, Action::UseMaterial(Box::new(material.clone())))
        });
        let built_in = BUILT_IN.iter().map(|built_in| built_in.source.clone());
        let environments = built_in
            .chain(self.shared.recent.environments())
            .map(|source: EnvironmentSource| {
                let label = format!("Environment {}", environment_label(&source));
                (label, Action::UseEnvironment(source))
            });
        let views = self.document.bookmarks.iter().enumerate();
        let views = views.map(|(number, view)| (format!("View {}", view.name), Action::UseBookmark(number)));
        let workspaces = self.workspaces.names().map(|name| {
            let change = Change::Use(name.to_owned());
            (format!("Workspace {name}"), Action::ChangeWorkspaces(change))
        });
        let files = self.shared.recent.paths().iter().map(|path| {
            let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
            (format!("Open {name}"), Action::Open(path.clone()))
        });
        materials
            .chain(environments)
            .chain(views)
            .chain(workspaces)
            .chain(files)
            .collect()
    }
}
