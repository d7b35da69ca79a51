//! What was said to the user: for the log, and over the viewport until it is old or closed.

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::render::worker::Level;
use crate::scene::{Fate, ImportReport};

/// Most entries that are kept.
const LIMIT: usize = 500;

/// What a note has a button for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Offer {
    /// All that became of the model's file. The note stays until it is closed.
    ImportReport,
    /// Rendering to the end what was saved unfinished.
    Render,
}

/// Something that was done as asked, for a note.
#[derive(Debug)]
pub struct Success {
    text: String,
    file: Option<PathBuf>,
    offer: Option<Offer>,
}

impl Success {
    pub fn new(text: String) -> Self {
        let (file, offer) = (None, None);
        Self { text, file, offer }
    }

    /// About a file: what was done, the file's name, and details if there are any.
    pub fn with_file(done: &str, path: &Path, details: &str) -> Self {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let separator = if details.is_empty() { "" } else { ": " };
        Self {
            file: Some(path.to_owned()),
            ..Self::new(format!("{done} {name}{separator}{details}"))
        }
    }

    /// Offers to render to the end what is not finished.
    pub fn finished(self, is_finished: bool) -> Self {
        let offer = (!is_finished).then_some(Offer::Render);
        Self { offer, ..self }
    }
}

/// Something said.
#[derive(Clone, Debug)]
pub struct Entry {
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

/// Adds an entry; one that says the same as the last stays that one, and is new again.
pub fn add(log: &mut Vec<Entry>, level: Level, text: String) {
    match level {
        Level::Error => log::error!("{text}"),
        Level::Warning => log::warn!("{text}"),
        Level::Info => log::info!("{text}"),
    }
    push(log, level, Success::new(text), level != Level::Info);
}

/// Adds what was done as asked.
pub fn add_success(log: &mut Vec<Entry>, success: Success) {
    match &success.file {
        Some(file) => log::info!("{} ({})", success.text, file.display()),
        None => log::info!("{}", success.text),
    }
    push(log, Level::Info, success, true);
}

fn push(log: &mut Vec<Entry>, level: Level, said: Success, is_open: bool) {
    let Success { text, file, offer } = said;
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
        is_open,
        file,
        offer,
    });
}

/// Adds what became of a model's file where that is not all as the file says.
pub fn add_import(log: &mut Vec<Entry>, name: &str, report: &ImportReport) {
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
        entry.offer = Some(Offer::ImportReport);
    }
}
