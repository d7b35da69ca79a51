//! The workspaces beside the menus: a tab for each of the program's and for the one that is shown, and a menu of the rest.

use egui::containers::menu::{MenuButton, MenuConfig};

use super::*;
use crate::actions::do_and_close;
use crate::services::workspaces::{Change, LOOK, MEASURE, is_built_in};

/// Width of the field of a name, points.
const NAME_WIDTH: f32 = 160.0;

/// Shows tabs and menu, from right to left.
pub fn show(ui: &mut Ui, (names, current): (&[&str], &str), actions: &mut Vec<Action>) {
    menu(ui, (names, current), actions);
    let is_tab = |name: &&&str| is_built_in(name) || **name == current;
    for &name in names.iter().rev().filter(is_tab) {
        let is_shown = name == current;
        let text = RichText::new(name);
        let text = if is_shown { text.strong() } else { text };
        let tab = ui.selectable_label(is_shown, text).on_hover_text(help(name));
        if tab.clicked() && !is_shown {
            actions.push(Action::ChangeWorkspaces(Change::Use(name.to_owned())));
        }
        tab.accessible_name(format!("Workspace {name}"));
    }
}

fn help(name: &str) -> &'static str {
    match name {
        LOOK => "Presets, material, light and camera around a large viewport",
        MEASURE => "Effects, race, check, samples, lobe, inspector and convergence",
        _ => "A workspace of your own",
    }
}

/// The user's own: shown, saved and removed.
fn menu(ui: &mut Ui, (names, current): (&[&str], &str), actions: &mut Vec<Action>) {
    // A click into the field must not close it.
    let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let (button, _) = MenuButton::new(RichText::new("+").weak()).config(config).ui(ui, |ui| {
        ui.set_min_width(NAME_WIDTH);
        let mut change = None;
        for &name in names.iter().filter(|name| !is_built_in(name)) {
            if ui.radio(name == current, name).clicked() {
                change = Some(Change::Use(name.to_owned()));
            }
        }
        widgets::note(ui, "Keep the panels as they are now as a workspace:");
        let id = ui.scope_id().with("name");
        let mut name: String = ui.data(|data| data.get_temp(id).unwrap_or_default());
        let field = TextEdit::singleline(&mut name).hint_text("Name");
        let field = ui
            .add(field.desired_width(NAME_WIDTH))
            .accessible_name("Workspace name");
        let is_entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        let is_named = !name.trim().is_empty();
        if widgets::pressed_if(ui, is_named, "Save workspace", "", "") || (is_entered && is_named) {
            change = Some(Change::Save(std::mem::take(&mut name)));
        }
        ui.data_mut(|data| data.insert_temp(id, name));
        if !is_built_in(current) && ui.button(format!("Remove the workspace {current}")).clicked() {
            change = Some(Change::Remove(current.to_owned()));
        }
        if let Some(change) = change {
            do_and_close(ui, actions, Action::ChangeWorkspaces(change));
        }
    });
    button
        .on_hover_text("Workspaces of your own")
        .accessible_name("Workspaces");
}
