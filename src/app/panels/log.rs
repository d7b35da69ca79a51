//! What was said, newest first.

use std::time::Instant;

use egui::{RichText, Ui};

use super::Desk;
use crate::app::widgets;
use crate::render::worker::Level;

/// Most entries that are kept.
const LIMIT: usize = 500;

/// Something said.
#[derive(Clone, Debug)]
pub(in crate::app) struct Entry {
    /// Tells it from the others for as long as the window lives.
    pub(in crate::app) number: u64,
    pub(in crate::app) level: Level,
    pub(in crate::app) text: String,
    pub(in crate::app) at: Instant,
    /// Shown over the viewport until it is old or closed.
    pub(in crate::app) is_open: bool,
}

/// Adds an entry; one that says the same as the last stays that one, and is new again.
pub(in crate::app) fn add(log: &mut Vec<Entry>, level: Level, text: String) {
    match level {
        Level::Error => log::error!("{text}"),
        Level::Warning => log::warn!("{text}"),
        Level::Info => log::info!("{text}"),
    }
    let number = match log.last() {
        Some(last) if last.text == text => {
            let number = last.number;
            log.pop();
            number
        }
        last => last.map_or(0, |last| last.number + 1),
    };
    if log.len() >= LIMIT {
        log.remove(0);
    }
    log.push(Entry {
        number,
        level,
        text,
        at: Instant::now(),
        is_open: level != Level::Info,
    });
}

pub(in crate::app) fn show(ui: &mut Ui, desk: &mut Desk<'_>) {
    if desk.state.log.is_empty() {
        widgets::note(ui, "Nothing to report.");
    }
    for entry in desk.state.log.iter().rev() {
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

fn age(at: Instant) -> String {
    match at.elapsed().as_secs() {
        0..10 => "just now".to_owned(),
        seconds @ 10..60 => format!("{} s ago", seconds / 10 * 10),
        seconds @ 60..3600 => format!("{} min ago", seconds / 60),
        seconds => format!("{} h ago", seconds / 3600),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_said_again_stays_the_entry_that_it_was() {
        let mut log = Vec::new();
        for text in ["a", "a", "b", "b", "a"] {
            add(&mut log, Level::Warning, text.to_owned());
        }
        let entries: Vec<(u64, &str)> = log.iter().map(|entry| (entry.number, &*entry.text)).collect();
        assert_eq!(entries, [(0, "a"), (1, "b"), (2, "a")]);
    }
}
