//! What was said, newest first.

use std::time::Instant;

use super::*;

/// What was said, newest first.
#[derive(Default)]
pub struct LogPanel;

impl Panel for LogPanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk) {
        if desk.shared.messages.is_empty() {
            widgets::note(ui, "Nothing to report.");
        }
        for entry in desk.shared.messages.iter().rev() {
            let color = theme::level_color(ui.visuals(), entry.level);
            ui.colored_label(color, &entry.text);
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
