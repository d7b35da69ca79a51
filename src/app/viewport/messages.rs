//! What lies over the image for the user to act on: messages, and the way to a model of one's own.

use super::*;
use crate::{render::shown::Shown, render::worker::Level, scene::ModelSource, services::messages::Offer};

/// How long a message stays, seconds.
const MESSAGE_SECONDS: f32 = 12.0;
/// Size of the button that asks for a model, points.
const OPEN_MODEL: Vec2 = vec2(132.0, theme::ROW_HEIGHT);

/// The latest warnings, errors and what was done, until they are old or closed.
pub fn show(ui: &mut Ui, area: Rect, desk: &mut Desk) {
    for entry in &mut desk.shared.messages {
        let stays = entry.level != Level::Info && entry.offer == Some(Offer::ImportReport);
        entry.is_open &= stays || entry.at.elapsed().as_secs_f32() < MESSAGE_SECONDS;
    }
    let mut open = desk
        .shared
        .messages
        .iter_mut()
        .filter(|entry| entry.is_open)
        .rev()
        .peekable();
    if open.peek().is_none() {
        return;
    }
    ui.ctx().request_repaint_after(std::time::Duration::from_secs(1));
    let width = (area.width() - 32.0).clamp(120.0, 520.0);
    let rect = Rect::from_x_y_ranges(
        area.center().x - 0.5 * width..=area.center().x + 0.5 * width,
        area.top() + 12.0..=area.bottom(),
    );
    let mut inside = laid_over(ui, "messages", rect, Layout::top_down(Align::Center));
    for entry in open.take(3) {
        // Named, as others may come above it while it is being closed.
        let number = ("message", entry.number);
        let color = theme::level_color(inside.visuals(), entry.level);
        let frame = Frame::popup(inside.style()).stroke(Stroke::new(1.0, color.gamma_multiply(0.6)));
        let message = |ui: &mut Ui| {
            let text = Label::new(RichText::new(&entry.text).color(color)).wrap();
            let render = Command::QueuePicture;
            let help = "What became of each part of the file";
            let offered = entry.offer.map(|offer| match offer {
                Offer::ImportReport => (130.0, "Show all", help, Command::ModelFile),
                Offer::Render => (190.0, render.label(), render.help(), render),
            });
            let buttons = offered.map_or(60.0, |(width, ..)| width);
            let text = ui.allocate_ui(vec2(width - buttons, 0.0), |ui| ui.add(text)).inner;
            if let Some(file) = &entry.file {
                text.on_hover_text(file.display().to_string());
            }
            if let Some((_, label, help, command)) = offered {
                let button = ui.button(label).on_hover_text(help);
                if button.clicked() {
                    desk.actions.push(Action::Do(command));
                    entry.is_open = false;
                }
                button.accessible_name(format!("{label} of message {}", entry.number));
            }
            let close = icons::button(ui, Icon::Close, &format!("Close message {}", entry.number), "Close");
            entry.is_open &= !close.clicked();
        };
        frame.show(&mut inside, |ui| {
            widgets::known_by(ui, number, |ui| ui.horizontal_top(message));
        });
    }
}

/// A way to the user's own model, as long as one of the program's is shown.
pub fn open_model(ui: &mut Ui, area: Rect, desk: &mut Desk) {
    let is_own = matches!(desk.document.model, ModelSource::File(_));
    let has_legend = desk.shared.viewing.shown != Shown::Picture;
    if is_own || has_legend || desk.shared.compare.is_on || area.width() < 320.0 {
        return;
    }
    let up = LOADING_MARGIN + theme::ROW_HEIGHT;
    let corner = area.left_bottom() + vec2(LOADING_MARGIN, -up);
    let mut inside = over(ui, "open your model", Rect::from_min_size(corner, OPEN_MODEL));
    let button = inside.add(Button::new("Open your model…").min_size(OPEN_MODEL));
    if button.on_hover_text(Command::Open.help()).clicked() {
        desk.act(Command::Open);
    }
}
