//! Import report of a file: its parts that were used, approximated, ignored or missing.

use serde::Serialize;

/// Most names that are kept of one entry.
const NAMES_MAX: usize = 20;

/// Fate of a part of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Fate {
    /// Shown as the file says.
    Used,
    /// Shown in another way than the file says.
    Approximated,
    /// There, and not shown.
    Ignored,
    /// The file refers to it, and it is not there or cannot be read.
    Missing,
}

impl Fate {
    /// Every fate, the best first.
    pub const ALL: &[Self] = &[Self::Used, Self::Approximated, Self::Ignored, Self::Missing];

    /// Label: "used", "approximated", …
    pub fn label(self) -> &'static str {
        match self {
            Self::Used => "used",
            Self::Approximated => "approximated",
            Self::Ignored => "ignored",
            Self::Missing => "missing",
        }
    }
}

/// One kind of part in a file, and its fate.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ImportNote {
    /// Whether the part was used, approximated, ignored or missing.
    pub fate: Fate,
    /// Description, and what is shown instead.
    pub what: String,
    pub count: usize,
    /// The objects, materials or files concerned, each once, the first twenty of them.
    pub names: Vec<String>,
}

/// Import report of a file.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ImportReport {
    /// One entry per kind of part, in order of occurrence.
    pub entries: Vec<ImportNote>,
}

impl ImportReport {
    /// Counts one part. `name` is its object, material or file; empty for the file itself.
    pub fn note(&mut self, fate: Fate, what: impl Into<String>, name: &str) {
        self.count(fate, what, name, 1);
    }

    /// Counts several things of one kind; none leave no entry.
    pub fn count(&mut self, fate: Fate, what: impl Into<String>, name: &str, count: usize) {
        let names = [name]
            .into_iter()
            .filter(|name| !name.is_empty())
            .map(str::to_owned)
            .collect();
        let what = what.into();
        self.add(ImportNote {
            fate,
            what,
            count,
            names,
        });
    }

    /// Appends another report's entries.
    pub fn append(&mut self, other: Self) {
        other.entries.into_iter().for_each(|entry| self.add(entry));
    }

    fn add(&mut self, more: ImportNote) {
        if more.count == 0 {
            return;
        }
        let mut entries = self.entries.iter_mut();
        let Some(known) = entries.find(|entry| entry.fate == more.fate && entry.what == more.what) else {
            return self.entries.push(more);
        };
        known.count += more.count;
        for name in more.names {
            if known.names.len() < NAMES_MAX && !known.names.contains(&name) {
                known.names.push(name);
            }
        }
    }

    /// The entries with this fate.
    pub fn of(&self, fate: Fate) -> impl Iterator<Item = &ImportNote> {
        self.entries.iter().filter(move |entry| entry.fate == fate)
    }

    /// Whether everything is shown as the file says.
    pub fn is_clean(&self) -> bool {
        self.entries.iter().all(|entry| entry.fate == Fate::Used)
    }

    /// Everything that is not shown as the file says, one line each.
    pub fn lines(&self) -> Vec<String> {
        self.entries
            .iter()
            .filter(|entry| entry.fate != Fate::Used)
            .map(ImportNote::line)
            .collect()
    }

    /// One line about all deviations from the file; `None` without any.
    pub fn summary(&self) -> Option<String> {
        let count = |fate: Fate| match self.of(fate).map(|entry| entry.count).sum::<usize>() {
            0 => None,
            count => Some(format!("{count} {}", fate.label())),
        };
        let counts: Vec<String> = Fate::ALL[1..].iter().rev().filter_map(|fate| count(*fate)).collect();
        let worst = Fate::ALL[1..].iter().rev().find_map(|fate| self.of(*fate).next())?;
        Some(format!("{} ({})", counts.join(", "), worst.line()))
    }
}

impl ImportNote {
    /// The entry in one line: fate, description, count, name.
    pub fn line(&self) -> String {
        let mut line = format!("{}: {}", self.fate.label(), self.what);
        if self.count > 1 {
            line.push_str(&format!(" (× {})", self.count));
        }
        if let [first, rest @ ..] = self.names.as_slice() {
            line.push_str(&format!(", in {first}"));
            if !rest.is_empty() {
                line.push_str(&format!(" and {} more", rest.len()));
            }
        }
        line
    }
}
