//! What a monkey does at the window.

use std::{
    collections::HashSet,
    hash::{DefaultHasher, Hash as _, Hasher as _},
    path::PathBuf,
};

use egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, Vec2, accesskit, accesskit::NodeId, accesskit::Role};
use egui_kittest::kittest::NodeT as _;
use glossmith::app::{actions::Action, actions::Command, layout::Pane};

use super::{support::Random, ui::Editor, ui::controls};

/// Numbers that are set: ordinary, at the ends and beyond.
const NUMBERS: [f64; 10] = [0.0, 1.0, 0.5, 0.03, -1.0, 7.3, 180.0, 1e9, -1e9, 1e-9];
/// What is typed.
const TEXTS: [&str; 9] = ["0", "0.5", "-3", "1e9", "nan", "#c8a060", "gold", "a name", "gloss"];
/// What is typed where a picture's side may have the keys.
const SMALL_TEXTS: [&str; 3] = ["20", "48", "64"];
/// Keys that are pressed, with and without control.
const KEYS: [Key; 19] = [
    Key::Tab,
    Key::Enter,
    Key::Escape,
    Key::Space,
    Key::ArrowUp,
    Key::ArrowDown,
    Key::ArrowLeft,
    Key::ArrowRight,
    Key::PageUp,
    Key::PageDown,
    Key::Delete,
    Key::B,
    Key::C,
    Key::F,
    Key::P,
    Key::X,
    Key::F11,
    Key::Z,
    Key::K,
];
/// Keys that leave a path as it is: it must stay in the temporary folder.
const KEYS_OF_PATHS: [Key; 3] = [Key::Tab, Key::Enter, Key::Escape];
/// Sides of pictures: large ones would take the machine's memory.
const SIDES: [&str; 4] = ["Width", "Height", "Turntable width", "Turntable height"];
/// Fields whose text names files.
const PATHS: [&str; 2] = ["Path", "Turntable output"];
/// Takes minutes of both cores, and can't be stopped.
const ENDLESS: [&str; 1] = ["Check this machine"];

/// What the monkey knows beside the window.
pub struct Surroundings {
    /// Where files may be written.
    pub folder: PathBuf,
    /// What it opens.
    pub files: Vec<PathBuf>,
    /// What there was before the deed before: what is new then is looked at first.
    pub before: HashSet<(Role, String)>,
    /// What it has had its hands on.
    pub touched: HashSet<(Role, String)>,
}

/// Something that can be clicked, dragged or typed into.
#[derive(Clone, Debug)]
pub struct Control {
    role: Role,
    name: String,
    id: NodeId,
    place: Rect,
    has_focus: bool,
}

/// What is done.
#[derive(Clone, Debug)]
pub enum Deed {
    Click(Control, PointerButton, usize),
    /// As a screen reader does, wherever the control is.
    Choose(Control),
    Drag {
        of: Option<Control>,
        from: Pos2,
        by: Vec2,
        /// A key that is pressed before the button is let go.
        between: Option<Key>,
    },
    SetNumber(Control, f64),
    SetText(Control, String),
    Type(&'static str),
    Press(Modifiers, Key),
    Scroll(Pos2, f32),
    Request(Action),
    Reveal(Pane),
    Resize(Vec2),
    Rest,
}

fn found(harness: &Editor) -> Vec<Control> {
    let nodes = harness.root().children_recursive();
    let control = |node: egui_kittest::Node<'_>| {
        let inner = node.accesskit_node();
        let takes = |action| inner.data().supports_action(action);
        let is_control = takes(accesskit::Action::Click) || takes(accesskit::Action::Focus);
        if !is_control || inner.is_disabled() || inner.bounding_box().is_none() {
            return None;
        }
        Some(Control {
            role: inner.role(),
            name: inner.label().unwrap_or_default(),
            id: inner.locate().0,
            place: node.rect(),
            has_focus: inner.is_focused(),
        })
    };
    nodes.filter_map(control).collect()
}

/// One of them, the same one as long as it is there, whatever else comes and goes.
fn pick(controls: &[Control], random: &mut Random) -> Option<Control> {
    let salt = random.bits();
    let rank = |control: &&Control| {
        let mut hasher = DefaultHasher::new();
        (salt, control.role, &control.name).hash(&mut hasher);
        hasher.finish()
    };
    controls.iter().min_by_key(rank).cloned()
}

fn of_role(controls: &[Control], random: &mut Random, role: Role) -> Option<Control> {
    let of: Vec<Control> = controls
        .iter()
        .filter(|control| control.role == role)
        .cloned()
        .collect();
    pick(&of, random)
}

impl Deed {
    pub fn random(random: &mut Random, harness: &Editor, around: &mut Surroundings) -> Self {
        let mut all = found(harness);
        all.retain(|control| !ENDLESS.contains(&&*control.name));
        let key = |control: &Control| (control.role, control.name.clone());
        let those = |is_it: &dyn Fn(&Control) -> bool| all.iter().filter(|of| is_it(of)).cloned().collect::<Vec<_>>();
        let new = those(&|of| !around.before.contains(&key(of)));
        let untouched = those(&|of| !around.touched.contains(&key(of)));
        let window = harness.ctx.content_rect();
        let has_path = all.iter().any(|control| PATHS.contains(&&*control.name));
        let has_side = all
            .iter()
            .any(|control| control.has_focus && SIDES.contains(&&*control.name));
        // Menus and sheets that have just come up are what a hand goes to next, and what it has not tried yet.
        let some = match random.below(4) {
            0 | 1 if !new.is_empty() => &new,
            2 if !untouched.is_empty() => &untouched,
            _ => &all,
        };
        let chosen = pick(some, random);
        around.before = all.iter().map(key).collect();
        let Some(control) = chosen else {
            return Self::Rest;
        };
        around.touched.insert(key(&control));
        let is_path = PATHS.contains(&&*control.name);
        match random.below(100) {
            0..36 => Self::click(random, window, control),
            36..52 => Self::drag(random, window, &all, control),
            52..66 => match of_role(&all, random, Role::SpinButton) {
                Some(of) if SIDES.contains(&&*of.name) => Self::SetNumber(of, [20.0, 33.0, 64.0][random.below(3)]),
                Some(of) => Self::SetNumber(of, NUMBERS[random.below(NUMBERS.len())]),
                None => Self::Choose(control),
            },
            66..70 => match of_role(&all, random, Role::TextInput) {
                Some(of) if PATHS.contains(&&*of.name) => {
                    let name = ["new.json", "new.png", "none/new.json", "square.glb", ""][random.below(5)];
                    Self::SetText(of, around.folder.join(name).display().to_string())
                }
                Some(of) => Self::SetText(of, TEXTS[random.below(TEXTS.len())].to_owned()),
                None => Self::Rest,
            },
            70..74 if !has_path => {
                let texts: &[&str] = if has_side { &SMALL_TEXTS } else { &TEXTS };
                Self::Type(texts[random.below(texts.len())])
            }
            74..84 => Self::press(random, has_path),
            84..88 if !has_path => {
                let command = Command::ALL[random.below(Command::ALL.len())];
                Self::Request(Action::Do(command))
            }
            88..90 => Self::Request(Action::Open(around.files[random.below(around.files.len())].clone())),
            90..94 => Self::Reveal(Pane::ALL[random.below(Pane::ALL.len())]),
            94..96 => Self::Scroll(control.place.center(), 240.0 * (random.unit() - 0.5)),
            96 => Self::Resize(Vec2::new(760.0 + 640.0 * random.unit(), 480.0 + 420.0 * random.unit())),
            97..99 if !is_path => Self::Choose(control),
            _ => Self::Rest,
        }
    }

    fn click(random: &mut Random, window: Rect, control: Control) -> Self {
        if !window.contains(control.place.center()) {
            return Self::Choose(control);
        }
        match random.below(12) {
            0 => Self::Click(control, PointerButton::Secondary, 1),
            1 => Self::Click(control, PointerButton::Primary, 2),
            2 => Self::Click(control, PointerButton::Middle, 1),
            _ => Self::Click(control, PointerButton::Primary, 1),
        }
    }

    /// From a control, from the picture, or from anywhere: panels are drawn larger and docked elsewhere.
    fn drag(random: &mut Random, window: Rect, all: &[Control], control: Control) -> Self {
        let by = 120.0 * (Vec2::new(random.unit(), random.unit()) - Vec2::splat(0.5));
        let between = (random.below(4) == 0).then(|| [Key::Z, Key::Escape, Key::X, Key::Delete][random.below(4)]);
        let within =
            |place: Rect, random: &mut Random| place.min + place.size() * Vec2::new(random.unit(), random.unit());
        let canvas = of_role(all, random, Role::Canvas);
        let (of, from) = match (random.below(10), canvas) {
            (0, _) => (None, within(window, random)),
            (1..3, Some(canvas)) => {
                let from = within(canvas.place, random);
                (Some(canvas), from)
            }
            _ => {
                let from = within(control.place, random);
                (Some(control), from)
            }
        };
        // Drawn at a point each, they stay small.
        let is_side = of.as_ref().is_some_and(|of| SIDES.contains(&&*of.name));
        let by = if is_side { 0.3 * by } else { by };
        Self::Drag { of, from, by, between }
    }

    fn press(random: &mut Random, has_path: bool) -> Self {
        let modifiers = match random.below(6) {
            0..2 => Modifiers::COMMAND,
            2 => Modifiers::COMMAND | Modifiers::SHIFT,
            3 => Modifiers::SHIFT,
            _ => Modifiers::NONE,
        };
        if has_path {
            return Self::Press(Modifiers::NONE, KEYS_OF_PATHS[random.below(KEYS_OF_PATHS.len())]);
        }
        // Escape and undo more often than the others: they leave things half done.
        match random.below(8) {
            0 => Self::Press(Modifiers::NONE, Key::Escape),
            1 => Self::Press(Modifiers::COMMAND, Key::Z),
            _ => Self::Press(modifiers, KEYS[random.below(KEYS.len())]),
        }
    }

    pub fn perform(&self, harness: &mut Editor) {
        match self {
            Self::Click(control, button, times) => click(harness, control.place.center(), *button, *times),
            Self::Choose(control) => ask(harness, control, accesskit::Action::Click, None),
            Self::Drag { of, from, by, between } => drag(harness, of.as_ref(), *from, *by, *between),
            Self::SetNumber(control, value) => {
                let value = accesskit::ActionData::NumericValue(*value);
                ask(harness, control, accesskit::Action::SetValue, Some(value));
            }
            Self::SetText(control, text) => {
                let value = accesskit::ActionData::Value(text.as_str().into());
                ask(harness, control, accesskit::Action::SetValue, Some(value));
            }
            Self::Type(text) => harness.event(Event::Text((*text).to_owned())),
            Self::Press(modifiers, key) => harness.key_press_modifiers(*modifiers, *key),
            Self::Scroll(at, points) => {
                harness.hover_at(*at);
                harness.event(Event::MouseWheel {
                    unit: egui::MouseWheelUnit::Point,
                    delta: Vec2::new(0.0, *points),
                    phase: egui::TouchPhase::Move,
                    source: egui::MouseWheelSource::Wheel,
                    modifiers: Modifiers::NONE,
                });
            }
            Self::Request(action) => harness.state_mut().request(action.clone()),
            Self::Reveal(pane) => harness.state_mut().reveal(*pane),
            Self::Resize(size) => {
                harness.set_size(*size);
            }
            Self::Rest => std::thread::sleep(std::time::Duration::from_millis(10)),
        }
    }
}

fn ask(harness: &Editor, control: &Control, action: accesskit::Action, data: Option<accesskit::ActionData>) {
    harness.event(Event::AccessKitActionRequest(accesskit::ActionRequest {
        target_node: control.id,
        target_tree: accesskit::TreeId::ROOT,
        action,
        data,
    }));
}

fn click(harness: &Editor, at: Pos2, button: PointerButton, times: usize) {
    harness.hover_at(at);
    for _ in 0..times {
        for pressed in [true, false] {
            harness.event(Event::PointerButton {
                pos: at,
                button,
                pressed,
                modifiers: Modifiers::NONE,
            });
        }
    }
}

/// Drags in three moves; what is dragged must stay what it is.
fn drag(harness: &mut Editor, of: Option<&Control>, from: Pos2, by: Vec2, between: Option<Key>) {
    harness.hover_at(from);
    harness.drag_at(from);
    for step in 1..=3 {
        harness.step();
        harness.hover_at(from + by * (step as f32 / 3.0));
        if let Some(key) = between.filter(|_| step == 2) {
            let modifiers = if key == Key::Z {
                Modifiers::COMMAND
            } else {
                Modifiers::NONE
            };
            harness.key_press_modifiers(modifiers, key);
        }
    }
    harness.step();
    if let Some(of) = of.filter(|_| between.is_none()) {
        let now = controls(harness).get(&(of.role, of.name.clone())).copied().flatten();
        assert!(
            now.is_none_or(|id| id == of.id),
            "{of:?} became another while it was dragged"
        );
    }
    harness.drop_at(from + by);
}
