//! What was said, newest first.

use std::time::Instant;

use egui::{RichText, Ui};

use super::Panel;
use crate::app::desk::Desk;
use crate::app::kit::widgets;
use crate::render::worker::Level;

/// What was said, newest first.
#[derive(Default)]
pub struct LogPanel;

impl Panel for LogPanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        if desk.shared.messages.is_empty() {
            widgets::note(ui, "Nothing to report.");
        }
        for entry in desk.shared.messages.iter().rev() {
            let color = match entry.level {
                Level::Error => ui.visuals().error_fg_color,
                Level::Warning => ui.visuals().warn_fg_color,
                Level::Info => ui.visuals().text_color(),
            };
            ui.add(egui::Label::new(RichText::new(&entry.text).color(color)).wrap());
            widgets::note(ui, age(entry.at));
            ui.add_space(4.0);
        }
    }
}

fn age(at: Instant) -> String {
    match at.elapsed().as_secs() {
        0..10 => "just now".to_owned(),
        seconds @ 10..60 => format!("{} s ago", seconds / 10 * 10),
        seconds @ 60..3600 => format!("{} min ago", seconds / 60),
        seconds => format!("{} h ago", seconds / 3600),
    }
}
