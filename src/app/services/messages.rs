//! What was said to the user: for the log, and over the viewport until it is old or closed.

use std::time::Instant;

use crate::render::worker::Level;

/// Most entries that are kept.
const LIMIT: usize = 500;

/// Something said.
#[derive(Clone, Debug)]
pub(in crate::app) struct Entry {
    /// Distinguishes it from the others for as long as the window lives.
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
