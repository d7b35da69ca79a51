//! What was said to the user: for the log, and over the viewport until it is old or closed.

use std::{path::Path, path::PathBuf, time::Instant};

use crate::render::worker::Level;
use crate::scene::{Fate, ImportReport, path_text::file_name};

/// Most entries that are kept.
const LIMIT: usize = 500;

/// What a note has a button for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Offer {
    /// All that became of the model's file. A warning stays until it is closed.
    ImportReport,
    /// Rendering to the end what was saved unfinished.
    Render,
}

/// Something said.
#[derive(Clone, Debug)]
pub struct LogEntry {
    /// Distinguishes it from the others for as long as the window lives.
    pub number: u64,
    pub level: Level,
    pub text: String,
    pub at: Instant,
    /// Shown over the viewport until it is old or closed.
    pub is_open: bool,
    /// The file that it is about.
    pub file: Option<PathBuf>,
    pub offer: Option<Offer>,
}

impl LogEntry {
    pub fn new(level: Level, text: String) -> Self {
        Self {
            number: 0,
            is_open: level != Level::Info,
            level,
            text,
            at: Instant::now(),
            file: None,
            offer: None,
        }
    }

    /// Something that was done as asked.
    pub fn done(text: String) -> Self {
        Self {
            is_open: true,
            ..Self::new(Level::Info, text)
        }
    }

    /// The same about a file: what was done, the file's name, and details if there are any.
    pub fn done_with(done: &str, path: &Path, details: &str) -> Self {
        let separator = if details.is_empty() { "" } else { ": " };
        Self {
            file: Some(path.to_owned()),
            ..Self::done(format!("{done} {}{separator}{details}", file_name(path)))
        }
    }

    /// Offers to render to the end what is not finished.
    pub fn finished(self, is_finished: bool) -> Self {
        let offer = (!is_finished).then_some(Offer::Render);
        Self { offer, ..self }
    }
}

/// Adds an entry; one that says the same as the last stays that one, and is new again.
pub fn add(log: &mut Vec<LogEntry>, mut entry: LogEntry) {
    let text = &entry.text;
    match (entry.level, &entry.file) {
        (Level::Error, _) => log::error!("{text}"),
        (Level::Warning, _) => log::warn!("{text}"),
        (Level::Info, Some(file)) => log::info!("{text} ({})", file.display()),
        (Level::Info, None) => log::info!("{text}"),
    }
    entry.number = log.last().map_or(0, |last| last.number + 1);
    if let Some(same) = log.pop_if(|last| last.text == entry.text) {
        entry.number = same.number;
    }
    if log.len() >= LIMIT {
        log.remove(0);
    }
    log.push(entry);
}

/// Adds what became of a model's file where that is not all as the file says.
pub fn add_import(log: &mut Vec<LogEntry>, name: &str, report: &ImportReport) {
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
    let text = format!("{name}: {}{parts} – {meaning}.{more}", worst.what);
    let entry = match worst.fate {
        Fate::Used | Fate::Approximated => LogEntry::done(text),
        _ => LogEntry::new(Level::Warning, text),
    };
    let offer = Some(Offer::ImportReport);
    add(log, LogEntry { offer, ..entry });
}
