//! The menu bar and the sheets of help: both read the table of commands.

use super::*;
use crate::{
    actions::{Command, Menu, do_and_close},
    document::{ImportLobe, MaterialSettings},
    pane::Pane,
    render::EngineChoice,
    scene::{Model, path_text::file_name},
    services::{edits::Edits, recent::Recent},
    sheets::{import, palette, palette::Findable, question, scrolled, workspaces},
    store::examples::EXAMPLES,
};

/// What is open over the window.
#[derive(Default, PartialEq)]
pub enum Sheet {
    #[default]
    None,
    Palette {
        search: String,
        selected: usize,
        /// What can be used beside commands, with what uses it.
        things: Vec<Findable>,
    },
    Shortcuts,
    ModelFile,
    About,
    /// The account of a path.
    Path {
        text: String,
    },
}

/// Groups of *View* that are menus of their own. What has a higher number is found by the palette alone.
const SUBMENUS: [(u32, &str); 3] = [(4, "Camera"), (5, "Compare"), (6, "Pixels")];

pub fn bar(
    ui: &mut Ui,
    edits: &Edits,
    recent: &mut Recent,
    (import_lobe, engine): (ImportLobe, EngineChoice),
    (workspaces, is_open): ((&[&str], &str), impl Fn(Pane) -> bool),
    actions: &mut Vec<Action>,
) {
    MenuBar::new().ui(ui, |ui| {
        for &menu in Menu::ALL {
            ui.menu_button(menu.label(), |ui| {
                ui.set_min_width(200.0);
                let of_menu = Command::ALL.iter().filter(|command| command.menu() == menu);
                if menu == Menu::View {
                    for (group, label) in SUBMENUS {
                        ui.menu_button(label, |ui| {
                            let inside = of_menu.clone().filter(|command| command.group() == group);
                            inside.for_each(|command| entry(ui, *command, edits, actions));
                        });
                    }
                }
                let mut group = 0;
                for command in of_menu.filter(|command| command.group() < SUBMENUS[0].0) {
                    if command.group() != group {
                        if menu == Menu::File && group == 0 {
                            open_recent(ui, recent, actions);
                            import_lobes(ui, import_lobe, actions);
                        }
                        ui.separator();
                        group = command.group();
                    }
                    entry(ui, *command, edits, actions);
                }
                match menu {
                    Menu::View => panes(ui, &is_open, actions),
                    Menu::Render => engines(ui, engine, actions),
                    Menu::Help => examples(ui, actions),
                    _ => {}
                }
            });
        }
        widgets::at_right(ui, |ui| {
            let text = format!("Find a command  {}", palette::keys(ui, Command::Palette));
            if ui.button(RichText::new(text).weak()).clicked() {
                actions.push(Action::Do(Command::Palette));
            }
            workspaces::show(ui, workspaces, actions);
        });
    });
}

fn entry(ui: &mut Ui, command: Command, edits: &Edits, actions: &mut Vec<Action>) {
    let step = match command {
        Command::Undo => edits.history.undo_label(),
        Command::Redo => edits.history.redo_label(),
        _ => Some(""),
    };
    let mut label = command.label().to_owned();
    if let Some(step) = step.filter(|step| !step.is_empty()) {
        label += &format!(": {step}");
    }
    let button = Button::new(label).shortcut_text(palette::keys(ui, command));
    let button = ui.add_enabled(step.is_some(), button);
    if button.on_hover_text(command.help()).clicked() {
        do_and_close(ui, actions, Action::Do(command));
    }
}

/// A menu of the files opened and saved last; those that are not there any more are greyed.
fn open_recent(ui: &mut Ui, recent: &mut Recent, actions: &mut Vec<Action>) {
    ui.add_enabled_ui(!recent.paths.is_empty(), |ui| {
        ui.menu_button("Open recent", |ui| {
            ui.set_min_width(220.0);
            let missing = recent.missing(ui.ctx());
            for path in &recent.paths {
                let is_there = !missing.contains(path);
                let (name, full) = (file_name(path), path.display().to_string());
                let note = if is_there { "" } else { " (not there any more)" };
                if widgets::pressed_if(ui, is_there, name + note, &full, &full) {
                    do_and_close(ui, actions, Action::Open(path.clone()));
                }
            }
            ui.separator();
            if ui.button("Clear the list").clicked() {
                recent.paths.clear();
            }
        });
    });
}

/// The panels: a tick at those that are open.
fn panes(ui: &mut Ui, is_open: impl Fn(Pane) -> bool, actions: &mut Vec<Action>) {
    ui.menu_button("Panels", |ui| {
        for pane in Pane::ALL.into_iter().filter(|pane| *pane != Pane::Viewport) {
            let mut opens = is_open(pane);
            if ui.checkbox(&mut opens, pane.title()).changed() {
                let action = if opens {
                    Action::Reveal(pane)
                } else {
                    Action::Close(pane)
                };
                do_and_close(ui, actions, action);
            }
        }
    });
}

/// The engines, with a tick at the one that is chosen.
fn engines(ui: &mut Ui, chosen: EngineChoice, actions: &mut Vec<Action>) {
    ui.separator();
    for &choice in EngineChoice::ALL {
        let radio = ui.radio(choice == chosen, format!("Engine: {}", choice.label()));
        if radio.on_hover_text(choice.help()).clicked() {
            do_and_close(ui, actions, Action::UseEngine(choice));
        }
    }
}

/// Scenes to begin with.
fn examples(ui: &mut Ui, actions: &mut Vec<Action>) {
    ui.separator();
    ui.menu_button("Examples", |ui| {
        for (number, example) in EXAMPLES.iter().enumerate() {
            if widgets::pressed(ui, example.label, example.help) {
                do_and_close(ui, actions, Action::OpenExample(number));
            }
        }
    });
}

fn import_lobes(ui: &mut Ui, mut chosen: ImportLobe, actions: &mut Vec<Action>) {
    if widgets::choice_menu(ui, "Import glTF materials as", &mut chosen, &widgets::choices()) {
        actions.push(Action::ImportAs(chosen));
    }
}

/// Shows the sheet that is open.
pub fn sheet(
    ctx: &Context,
    sheet: &mut Sheet,
    desk: (&Document, &MaterialSettings),
    (model, lobe): (Option<&Model>, ImportLobe),
    actions: &mut Vec<Action>,
) {
    let (document, material) = desk;
    if *sheet == Sheet::None {
        return;
    }
    let id = ("sheet", std::mem::discriminant(sheet));
    let is_done = question(ctx, id, true, |ui| {
        let is_done = match sheet {
            Sheet::None => false,
            Sheet::Palette {
                search,
                selected,
                things,
            } => palette::show(ui, search, selected, document, (material, things), actions),
            Sheet::ModelFile => import::show(ui, document, (model, lobe), actions),
            Sheet::Shortcuts => shortcuts(ui),
            Sheet::About => about(ui),
            Sheet::Path { text } => path(ui, text),
        };
        is_done.then_some(true)
    });
    if is_done.is_some() {
        *sheet = Sheet::None;
    }
}

#[rustfmt::skip]
const MOUSE: [(&str, &str); 10] = [
    ("Drag", "Turn the camera"),
    ("Middle drag, or ctrl and drag", "Pan"),
    ("Wheel, or right drag", "Zoom"),
    ("Shift and drag", "Turn the light"),
    ("Drag a light's mark or handle", "Move or change it; Escape takes it back"),
    ("Click", "Select the material there"),
    ("Ctrl, shift and click", "Explain the last sample of the pixel"),
    ("Arrows, page up and down", "Turn and zoom, with the viewport focused"),
    ("Double-click on a label", "Reset the parameter"),
    ("Shift and drag a number", "Change it finely"),
];

fn shortcuts(ui: &mut Ui) -> bool {
    ui.set_width(440.0);
    ui.heading("Keys and mouse");
    ui.add_space(theme::GAP);
    scrolled(ui, |ui| {
        Grid::new("keys")
            .num_columns(2)
            .spacing(vec2(24.0, 5.0))
            .show(ui, |ui| {
                let mut all = MOUSE.map(|(how, what)| (how.to_owned(), what)).to_vec();
                let commands = Command::ALL
                    .iter()
                    .map(|command| (palette::keys(ui, *command), command.label()));
                all.extend(commands.filter(|(keys, _)| !keys.is_empty()));
                for (how, what) in all {
                    ui.label(RichText::new(how).strong());
                    ui.label(what);
                    ui.end_row();
                }
            });
    });
    ui.add_space(theme::GAP);
    ui.button("Close").clicked()
}

fn about(ui: &mut Ui) -> bool {
    ui.set_width(420.0);
    ui.heading(concat!("Glossmith ", env!("CARGO_PKG_VERSION")));
    ui.add_space(theme::GAP);
    ui.label(env!("CARGO_PKG_DESCRIPTION"));
    ui.add_space(theme::GAP);
    widgets::note(ui, concat!("Licence: ", env!("CARGO_PKG_LICENSE")));
    widgets::note(
        ui,
        "The geometric lobe: \"Fast Geometric Sampling for Phong-Like Reflection\", Advances in Computer Graphics \
                     (Computer Graphics International 2023), LNCS 14496, Springer.",
    );
    ui.hyperlink("https://doi.org/10.1007/978-3-031-50072-5_17");
    ui.add_space(theme::GAP);
    ui.button("Close").clicked()
}

/// Everything that made one sample of one pixel.
fn path(ui: &mut Ui, text: &str) -> bool {
    ui.set_width(900.0_f32.min(0.9 * ui.ctx().content_rect().width()));
    ui.heading("Path trace of this pixel");
    ui.add_space(theme::GAP);
    scrolled(ui, |ui| {
        ui.add(Label::new(RichText::new(text).monospace()).wrap());
    });
    ui.add_space(theme::GAP);
    ui.horizontal(|ui| {
        if widgets::pressed(ui, "Copy", "Copies the account as text.") {
            ui.ctx().copy_text(text.to_owned());
        }
        ui.button("Close").clicked()
    })
    .inner
}
