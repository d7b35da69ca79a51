//! Workspaces: arrangements of the panels under names, two of the program's and the user's own.

use egui_tiles::Tree;
use serde::{Deserialize, Serialize};

pub use crate::services::workspaces::{Change, LOOK, MEASURE};
use crate::{layout, layout::Pane, services::workspaces::is_built_in};

/// Longest name of a workspace, characters: a row of them fits beside the menus.
const NAME_MAX: usize = 16;

/// An arrangement of the panels with its name.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Workspace {
    name: String,
    layout: Tree<Pane>,
}

/// The workspaces, the program's own first; the editor shows the arrangement of the current one.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Workspaces {
    current: String,
    all: Vec<Workspace>,
}

impl Workspaces {
    /// The workspaces as they were left, with the arrangement of the current one.
    pub fn new(kept: Self, requested: Option<String>) -> (Self, Tree<Pane>) {
        let all = [LOOK, MEASURE].map(built_in).into();
        let current = requested.unwrap_or(kept.current);
        let mut workspaces = Self { current, all };
        for Workspace { name, layout } in kept.all {
            if let Some(layout) = layout::complete(layout) {
                workspaces.put(&name, layout);
            }
        }
        let place = workspaces.place(&workspaces.current).unwrap_or(0);
        let layout = workspaces.shown(place);
        (workspaces, layout)
    }

    fn place(&self, name: &str) -> Option<usize> {
        self.all.iter().position(|workspace| workspace.name == name)
    }

    /// Makes a workspace the current one; its arrangement.
    fn shown(&mut self, place: usize) -> Tree<Pane> {
        let Workspace { name, layout } = self.all[place].clone();
        self.current = name;
        layout
    }

    /// Keeps an arrangement under a name, in the place of one that has it.
    fn put(&mut self, name: &str, layout: Tree<Pane>) {
        match self.place(name) {
            Some(place) => self.all[place].layout = layout,
            None => self.all.push(Workspace {
                name: name.to_owned(),
                layout,
            }),
        }
    }

    /// The name of the current one.
    pub fn current(&self) -> &str {
        &self.current
    }

    /// The names of all, the program's own first.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.all.iter().map(|workspace| workspace.name.as_str())
    }

    /// The same with this arrangement of the current one.
    pub fn with(&self, layout: Tree<Pane>) -> Self {
        let mut kept = self.clone();
        kept.put(&self.current, layout);
        kept
    }

    /// Makes a change; `layout` is the arrangement of the current one.
    pub fn change(&mut self, change: Change, layout: &mut Tree<Pane>) {
        match change {
            Change::Use(name) => {
                if let Some(place) = self.place(&name) {
                    *self = self.with(layout.clone());
                    *layout = self.shown(place);
                }
            }
            Change::Save(name) => {
                let name: String = name.trim().chars().take(NAME_MAX).collect();
                if !name.is_empty() {
                    self.put(&name, layout.clone());
                    self.current = name;
                }
            }
            Change::Remove(name) if !is_built_in(&name) => {
                self.all.retain(|workspace| workspace.name != name);
                if self.current == name {
                    *layout = self.shown(0);
                }
            }
            Change::Remove(_) => {}
        }
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
    let name = name.to_owned();
    Workspace { name, layout }
}
