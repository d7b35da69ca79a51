//! The panels, one a file, listed in [`crate::pane`]. A panel keeps its state to itself: it sees the desk and no
//! other panel.

// What most panels use: they take it all.
use std::sync::Arc;

use egui::*;

use super::{
    actions::{Action, Command},
    desk::Desk,
    kit::{icons, icons::Icon, theme, widgets, widgets::NumberStyle},
    pane::Pane,
};

/// A panel: what it remembers, and how it is drawn.
pub trait Panel {
    /// Draws it and takes what the user does with it.
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk);

    /// Runs once a frame before anything is drawn, whether the panel is seen or not.
    fn tick(&mut self, _desk: &mut Desk) {}

    /// Hears of a command that was chosen somewhere else and concerns a panel.
    fn on_command(&mut self, _command: Command) {}
}

macro_rules! panels {
    ($($(#[$doc:meta])* $name:ident, $title:literal, $home:ident, $module:ident::$panel:ident, $manual:literal;)*) => {
        $(mod $module;)*

        impl Default for Panels {
            fn default() -> Self {
                Self(vec![$((Pane::$name, Box::<$module::$panel>::default()),)*])
            }
        }
    };
}

crate::pane::list!(panels);

/// The panels with what they remember.
pub struct Panels(Vec<(Pane, Box<dyn Panel>)>);

impl Panels {
    pub fn show(&mut self, pane: Pane, ui: &mut Ui, desk: &mut Desk) {
        if let Some((_, panel)) = self.0.iter_mut().find(|(of, _)| *of == pane) {
            panel.show(ui, desk);
        }
    }

    /// See [`Panel::tick`].
    pub fn tick(&mut self, desk: &mut Desk) {
        self.0.iter_mut().for_each(|(_, panel)| panel.tick(desk));
    }

    /// See [`Panel::hear`].
    pub fn on_command(&mut self, command: Command) {
        self.0.iter_mut().for_each(|(_, panel)| panel.on_command(command));
    }
}
