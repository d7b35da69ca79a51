//! The command palette: every command, panel and parameter by a few letters, without the mouse.

use super::*;
use crate::{
    actions::Command,
    document::{MaterialSettings, PARAMETERS, Parameter, SETTINGS},
    kit::parameter_row,
    pane::Pane,
};

/// Something to be found.
#[derive(Clone, PartialEq)]
pub struct Findable {
    pub label: String,
    /// Words beside those of the label.
    pub tags: String,
    pub help: &'static str,
    pub keys: String,
    pub is_favourite: bool,
    pub action: Action,
}

impl Findable {
    pub fn new(label: String, action: Action) -> Self {
        Self {
            label,
            tags: String::new(),
            help: "",
            keys: String::new(),
            is_favourite: false,
            action,
        }
    }
}

/// The keys go to the palette with the next frame: what is typed right after it was asked for is not lost.
pub fn focus(ctx: &Context) {
    ctx.memory_mut(|memory| memory.request_focus(field_id()));
}

/// Height of the rows that are seen, ten of them at least, points.
const ROWS: f32 = 360.0;

fn field_id() -> Id {
    Id::unique("palette field")
}

/// Shows it; true once something was chosen.
pub fn show(
    ui: &mut Ui,
    search: &mut String,
    selected: &mut usize,
    document: &Document,
    (edited, things): (&MaterialSettings, &[Findable]),
    actions: &mut Vec<Action>,
) -> bool {
    ui.set_width(420.0);
    let step = |ui: &mut Ui, key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
    let (up, down) = (step(ui, Key::ArrowUp), step(ui, Key::ArrowDown));
    let field = TextEdit::singleline(search)
        .id(field_id())
        .hint_text("Find a command, parameter, material or environment")
        .desired_width(f32::INFINITY);
    let response = ui.add(field.margin(vec2(8.0, 5.0))).accessible_name("Find a command");
    if response.changed() {
        *selected = 0;
    }
    let is_entered = ui.input(|input| input.key_pressed(Key::Enter));
    response.request_focus();
    ui.add_space(theme::GAP);
    let mut found = found(ui, search, document, (edited, things));
    let last = found.len().saturating_sub(1);
    *selected = (*selected + usize::from(down))
        .min(last)
        .saturating_sub(usize::from(up));
    let mut chosen = is_entered.then_some(*selected);
    let rows = ScrollArea::vertical().max_height(ROWS).min_scrolled_height(ROWS);
    rows.show(ui, |ui| {
        ui.set_min_width(ui.available_width());
        for (index, entry) in found.iter().enumerate() {
            let button = Button::selectable(index == *selected, &entry.label).shortcut_text(&entry.keys);
            // By its words: entries come and go with what is loaded meanwhile.
            let size = vec2(ui.available_width(), theme::ROW_HEIGHT);
            let known = ("palette", &entry.label, &entry.tags);
            let response = widgets::known_by(ui, known, |ui| ui.add_sized(size, button));
            let response = widgets::explained(response, entry.help);
            if index == *selected && (up || down) {
                response.scroll_to_me(None);
            }
            if response.clicked() {
                chosen = Some(index);
            }
        }
        if found.is_empty() {
            widgets::note(ui, "No matches.");
        }
    });
    let chosen = chosen.filter(|index| *index < found.len());
    actions.extend(chosen.map(|index| found.swap_remove(index).action));
    chosen.is_some()
}

/// The keys of a command, if it has any.
pub fn keys(ui: &Ui, command: Command) -> String {
    let keys = command.shortcut().map(|shortcut| ui.ctx().format_shortcut(&shortcut));
    keys.unwrap_or_default()
}

/// A parameter that has a row, with its value. A texture's switch stands beside its image.
fn of_parameter<T>(parameter: &Parameter<T>, of: &T) -> Option<Findable> {
    let has_row = parameter_row::has_row(parameter) && !parameter.key.ends_with("_texture");
    has_row.then(|| Findable {
        tags: parameter.key.to_owned(),
        help: parameter.help,
        keys: parameter.text(&parameter.get(of)),
        ..Findable::new(parameter.full_name(), Action::Edit(parameter.key))
    })
}

/// What has all the words of the search: panels whose names begin with it, then what has them in its name; commands, then
/// parameters, then panels, then what can be used: materials, environments, views, files, workspaces. Favourites of the
/// browser stand before others, and are found by their tags as there.
fn found(
    ui: &Ui,
    search: &str,
    document: &Document,
    (edited, things): (&MaterialSettings, &[Findable]),
) -> Vec<Findable> {
    let search = search.to_lowercase();
    let words: Vec<&str> = search.split_whitespace().collect();
    let commands = Command::ALL.iter().filter(|command| **command != Command::Palette);
    let commands = commands.map(|command| Findable {
        tags: format!("{} {}", command.menu().label(), command.help()),
        help: command.help(),
        keys: keys(ui, *command),
        ..Findable::new(command.label().to_owned(), Action::Do(*command))
    });
    let panes = Pane::ALL.into_iter().filter(|pane| *pane != Pane::Viewport);
    let panes = panes.map(|pane| Findable::new(format!("Panel {}", pane.title()), Action::Reveal(pane)));
    let has_words = |text: &str| {
        let text = text.to_lowercase();
        words.iter().all(|word| text.contains(word))
    };
    let mut found: Vec<Findable> = commands.collect();
    found.extend(
        PARAMETERS
            .iter()
            .filter_map(|parameter| of_parameter(parameter, edited)),
    );
    found.extend(SETTINGS.iter().filter_map(|setting| of_parameter(setting, document)));
    found.extend(panes.chain(things.iter().cloned()));
    found.retain(|entry| has_words(&format!("{} {}", entry.label, entry.tags)));
    // The name of a panel leads to it: commands that have it in their names act at once.
    let begins = |pane: Pane| !search.is_empty() && pane.title().to_lowercase().starts_with(&search);
    let is_panel = |entry: &Findable| matches!(entry.action, Action::Reveal(pane) if begins(pane));
    found.sort_by_key(|entry| (!is_panel(entry), !has_words(&entry.label), !entry.is_favourite));
    found
}
