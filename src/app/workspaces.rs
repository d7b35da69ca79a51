//! Workspaces: arrangements of the panels under names, two of the program's and the user's own.

use egui_tiles::Tree;
use serde::{Deserialize, Serialize};

use crate::app::layout::{self, Pane};
use crate::app::services::workspaces::is_built_in;
pub use crate::app::services::workspaces::{Change, LOOK, MEASURE};

/// The name of an arrangement that was left before there were workspaces.
const FORMER: &str = "Mine";
/// Longest name of a workspace, characters: a row of them fits beside the menus.
const NAME_MAX: usize = 16;

/// An arrangement of the panels with its name.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Workspace {
    name: String,
    layout: Tree<Pane>,
}

/// What is kept of them from one start to the next.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct KeptWorkspaces {
    current: String,
    all: Vec<Workspace>,
}

/// The workspaces but for the arrangement of the current one, which the editor shows.
#[derive(Debug)]
pub struct Workspaces {
    current: String,
    all: Vec<Workspace>,
}

impl Workspaces {
    /// The workspaces as they were left, with the arrangement of the current one. `former` is an arrangement without a
    /// name, which earlier versions kept.
    pub fn new(kept: KeptWorkspaces, former: Option<Tree<Pane>>, requested: Option<String>) -> (Self, Tree<Pane>) {
        let mut all: Vec<Workspace> = [LOOK, MEASURE].map(built_in).into();
        let whole = |kept: Workspace| Some((kept.name, layout::complete(kept.layout)?));
        for (name, layout) in kept.all.into_iter().filter_map(whole) {
            put(&mut all, &name, layout);
        }
        let mut current = kept.current;
        if let Some(former) = former {
            put(&mut all, FORMER, former);
            current = FORMER.to_owned();
        }
        let current = requested.unwrap_or(current);
        let shown = all
            .iter()
            .find(|workspace| workspace.name == current)
            .unwrap_or(&all[0]);
        let (current, layout) = (shown.name.clone(), shown.layout.clone());
        (Self { current, all }, layout)
    }

    /// The name of the current one.
    pub fn current(&self) -> &str {
        &self.current
    }

    /// The names of all, the program's own first.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.all.iter().map(|workspace| workspace.name.as_str())
    }

    /// What is kept for the next start.
    pub fn kept(&self, layout: Tree<Pane>) -> KeptWorkspaces {
        let mut all = self.all.clone();
        put(&mut all, &self.current, layout);
        let current = self.current.clone();
        KeptWorkspaces { current, all }
    }

    /// Makes a change; `layout` is the arrangement of the current one.
    pub fn change(&mut self, change: Change, layout: &mut Tree<Pane>) {
        match change {
            Change::Use(name) => self.show(&name, layout),
            Change::Save(name) => {
                let name: String = name.trim().chars().take(NAME_MAX).collect();
                if !name.is_empty() {
                    put(&mut self.all, &name, layout.clone());
                    self.current = name;
                }
            }
            Change::Remove(name) if !is_built_in(&name) => {
                self.all.retain(|workspace| workspace.name != name);
                if self.current == name {
                    let first = &self.all[0];
                    (self.current, *layout) = (first.name.clone(), first.layout.clone());
                }
            }
            Change::Remove(_) => {}
        }
    }

    fn show(&mut self, name: &str, layout: &mut Tree<Pane>) {
        let Some(next) = self.all.iter().find(|workspace| workspace.name == name) else {
            return;
        };
        let next = next.layout.clone();
        let left = std::mem::replace(layout, next);
        put(&mut self.all, &self.current, left);
        self.current = name.to_owned();
    }

    /// The arrangement that the current one has at first.
    pub fn at_first(&self) -> Tree<Pane> {
        built_in(&self.current).layout
    }
}

/// A workspace of the program's as it is at first; another name has the panels of *Look*.
fn built_in(name: &str) -> Workspace {
    let layout = match name {
        MEASURE => layout::to_measure(),
        _ => layout::to_look(),
    };
    Workspace {
        name: name.to_owned(),
        layout,
    }
}

/// Keeps an arrangement under a name, in the place of one that has it.
fn put(all: &mut Vec<Workspace>, name: &str, layout: Tree<Pane>) {
    match all.iter_mut().find(|workspace| workspace.name == name) {
        Some(known) => known.layout = layout,
        None => all.push(Workspace {
            name: name.to_owned(),
            layout,
        }),
    }
}
