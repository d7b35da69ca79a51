//! The two workspaces: arrangements of the panels that are kept from one start to the next.

use egui_tiles::Tree;
use serde::{Deserialize, Serialize};

use crate::app::layout::{self, Pane};

/// The workspace at the start: presets, material, light and camera around a large viewport.
pub const LOOK: &str = "Look";
/// The workspace of effects, races, checks, samples and errors.
pub const MEASURE: &str = "Measure";

/// An arrangement of the panels with its name.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Workspace {
    name: String,
    layout: Tree<Pane>,
}

/// Both, and which is shown; the editor has the arrangement of that one.
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
            if let (Some(place), Some(layout)) = (workspaces.place(&name), layout::complete(layout)) {
                workspaces.all[place].layout = layout;
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

    /// The name of the current one.
    pub fn current(&self) -> &str {
        &self.current
    }

    /// The same with this arrangement of the current one.
    pub fn with(&self, layout: Tree<Pane>) -> Self {
        let mut kept = self.clone();
        if let Some(place) = self.place(&self.current) {
            kept.all[place].layout = layout;
        }
        kept
    }

    /// Shows the workspace of a name; `layout` is the arrangement of the current one.
    pub fn change(&mut self, name: &str, layout: &mut Tree<Pane>) {
        if let Some(place) = self.place(name) {
            *self = self.with(layout.clone());
            *layout = self.shown(place);
        }
    }

    /// The arrangement that the current one has at first.
    pub fn at_first(&self) -> Tree<Pane> {
        built_in(&self.current).layout
    }
}

/// A workspace as it is at first.
fn built_in(name: &str) -> Workspace {
    let layout = match name {
        MEASURE => layout::to_measure(),
        _ => layout::to_look(),
    };
    let name = name.to_owned();
    Workspace { name, layout }
}
