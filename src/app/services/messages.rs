//! What was said to the user: for the log, and over the viewport until it is old or closed.

use std::time::Instant;

use crate::render::worker::Level;
use crate::scene::{Fate, ImportReport};

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
    /// It is about the model's file: shown until it is closed, with a way to all that became of the file.
    pub(in crate::app) is_of_import: bool,
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
        is_of_import: false,
    });
}

/// Adds what became of a model's file where that is not all as the file says.
pub(in crate::app) fn add_import(log: &mut Vec<Entry>, name: &str, report: &ImportReport) {
    let Some(worst) = Fate::ALL[1..].iter().rev().find_map(|fate| report.of(*fate).next()) else {
        return;
    };
    let count = report.entries.iter().filter(|entry| entry.fate != Fate::Used).count();
    let more = match count - 1 {
        0 => String::new(),
        1 => " One thing more differs.".to_owned(),
        more => format!(" {more} things more differ."),
    };
    let meaning = match worst.fate {
        Fate::Used | Fate::Approximated => "looks a little different here",
        Fate::Ignored => "is not shown",
        Fate::Missing => "was not found beside the file",
    };
    let parts = match worst.names.as_slice() {
        [] => String::new(),
        [only] => format!(", in {only}"),
        [first, rest @ ..] => format!(", in {first} and {} more", rest.len()),
    };
    add(
        log,
        Level::Warning,
        format!("{name}: {}{parts} – {meaning}.{more}", worst.what),
    );
    if let Some(entry) = log.last_mut() {
        entry.is_of_import = true;
    }
}
