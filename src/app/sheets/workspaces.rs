//! The workspaces beside the menus: a tab for each of the program's and for the one that is shown, and a menu of the rest.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{PopupCloseBehavior, RichText, Ui};

use crate::app::actions::{Action, do_and_close};
use crate::app::kit::widgets;
use crate::app::services::workspaces::{Change, LOOK, MEASURE, is_built_in};

/// Width of the field of a name, points.
const NAME_WIDTH: f32 = 160.0;

/// Shows tabs and menu, from right to left.
pub fn show(ui: &mut Ui, (names, current): (&[&str], &str), actions: &mut Vec<Action>) {
    menu(ui, (names, current), actions);
    let is_tab = |name: &&&str| is_built_in(name) || **name == current;
    for &name in names.iter().rev().filter(is_tab) {
        let is_shown = name == current;
        let text = if is_shown {
            RichText::new(name).strong()
        } else {
            RichText::new(name)
        };
        let tab = ui.selectable_label(is_shown, text).on_hover_text(help(name));
        tab.clone().accessible_name(format!("Workspace {name}"));
        if tab.clicked() && !is_shown {
            actions.push(Action::ChangeWorkspaces(Change::Use(name.to_owned())));
        }
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
        for &name in names.iter().filter(|name| !is_built_in(name)) {
            if ui.radio(name == current, name).clicked() {
                do_and_close(ui, actions, Action::ChangeWorkspaces(Change::Use(name.to_owned())));
            }
        }
        widgets::note(ui, "Keep the panels as they are now as a workspace:");
        let id = ui.scope_id().with("name");
        let mut name: String = ui.data(|data| data.get_temp(id).unwrap_or_default());
        let field = egui::TextEdit::singleline(&mut name)
            .hint_text("Name")
            .desired_width(NAME_WIDTH);
        let field = ui.add(field);
        let is_entered = field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        field.accessible_name("Workspace name");
        let save = ui.add_enabled(!name.trim().is_empty(), egui::Button::new("Save workspace"));
        if save.clicked() || (is_entered && !name.trim().is_empty()) {
            do_and_close(
                ui,
                actions,
                Action::ChangeWorkspaces(Change::Save(std::mem::take(&mut name))),
            );
        }
        ui.data_mut(|data| data.insert_temp(id, name));
        if !is_built_in(current) && ui.button(format!("Remove the workspace {current}")).clicked() {
            do_and_close(
                ui,
                actions,
                Action::ChangeWorkspaces(Change::Remove(current.to_owned())),
            );
        }
    });
    button
        .on_hover_text("Workspaces of your own")
        .accessible_name("Workspaces");
}
