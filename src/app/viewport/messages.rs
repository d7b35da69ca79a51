//! What lies over the image for the user to act on: messages, and the way to a model of one's own.

use egui::{Rect, Ui, Vec2, pos2, vec2};

use super::LOADING_MARGIN;
use crate::app::actions::{Action, Command};
use crate::app::desk::Desk;
use crate::app::kit::icons::{self, Icon};
use crate::app::kit::theme;
use crate::app::services::messages::Offer;
use crate::render::worker::Level;
use crate::scene::ModelSource;

/// How long a message stays, seconds.
const MESSAGE_SECONDS: f32 = 12.0;
/// Size of the button that asks for a model, and the width of the viewport that it needs, points.
const OPEN_MODEL: Vec2 = vec2(132.0, theme::ROW_HEIGHT);
const OPEN_MODEL_FROM: f32 = 320.0;

/// The latest warnings, errors and what was done, until they are old or closed.
pub fn show(ui: &mut Ui, area: Rect, desk: &mut Desk<'_>) {
    for entry in &mut desk.shared.messages {
        entry.is_open &= entry.offer == Some(Offer::ImportReport) || entry.at.elapsed().as_secs_f32() < MESSAGE_SECONDS;
    }
    let open: Vec<usize> = (0..desk.shared.messages.len())
        .filter(|i| desk.shared.messages[*i].is_open)
        .collect();
    if open.is_empty() {
        return;
    }
    ui.ctx().request_repaint_after(std::time::Duration::from_secs(1));
    let width = (area.width() - 32.0).clamp(120.0, 520.0);
    let rect = Rect::from_min_max(
        pos2(area.center().x - 0.5 * width, area.top() + 12.0),
        pos2(area.center().x + 0.5 * width, area.bottom()),
    );
    let mut inside = ui.new_child(
        egui::UiBuilder::new()
            .max_rect(rect)
            .layout(egui::Layout::top_down(egui::Align::Center)),
    );
    for index in open.into_iter().rev().take(3) {
        // Named, as others may come above it while it is being closed.
        let builder =
            egui::UiBuilder::new().scope_id(egui::Id::unique(("message", desk.shared.messages[index].number)));
        let entry = &mut desk.shared.messages[index];
        let actions = &mut desk.actions;
        let color = match entry.level {
            Level::Error => inside.visuals().error_fg_color,
            Level::Warning => inside.visuals().warn_fg_color,
            Level::Info => inside.visuals().text_color(),
        };
        let frame = egui::Frame::popup(inside.style()).stroke(egui::Stroke::new(1.0, color.gamma_multiply(0.6)));
        let message = |ui: &mut Ui| {
            let text = egui::Label::new(egui::RichText::new(&entry.text).color(color)).wrap();
            let render = Command::QueuePicture;
            let offered = entry.offer.map(|offer| match offer {
                Offer::ImportReport => (
                    130.0,
                    "Show all",
                    "What became of each part of the file",
                    Command::ModelFile,
                ),
                Offer::Render => (190.0, render.label(), render.help(), render),
            });
            let buttons = offered.map_or(60.0, |(width, ..)| width);
            let text = ui.allocate_ui(vec2(width - buttons, 0.0), |ui| ui.add(text)).inner;
            if let Some(file) = &entry.file {
                text.on_hover_text(file.display().to_string());
            }
            if let Some((_, label, help, command)) = offered {
                let button = ui.button(label).on_hover_text(help);
                button
                    .clone()
                    .accessible_name(format!("{label} of message {}", entry.number));
                if button.clicked() {
                    actions.push(Action::Do(command));
                    entry.is_open = false;
                }
            }
            let close = icons::button(ui, Icon::Close, &format!("Close message {}", entry.number), "Close");
            entry.is_open &= !close.clicked();
        };
        frame.show(&mut inside, |ui| {
            ui.scope_builder(builder, |ui| ui.horizontal_top(message));
        });
    }
}

/// A way to the user's own model, as long as one of the program's is shown.
pub fn open_model(ui: &mut Ui, area: Rect, desk: &mut Desk<'_>) {
    let is_own = matches!(desk.document.model, ModelSource::File(_));
    if is_own || desk.shared.compare.is_on || area.width() < OPEN_MODEL_FROM {
        return;
    }
    let up = LOADING_MARGIN + theme::ROW_HEIGHT;
    let corner = area.left_bottom() + vec2(LOADING_MARGIN, -up);
    let builder = egui::UiBuilder::new()
        .scope_id(egui::Id::unique("open your model"))
        .max_rect(Rect::from_min_size(corner, OPEN_MODEL));
    let button = egui::Button::new("Open your model…").min_size(OPEN_MODEL);
    let button = ui
        .new_child(builder)
        .add(button)
        .on_hover_text(Command::OpenModel.help());
    if button.clicked() {
        desk.act(Command::OpenModel);
    }
}
