//! Unsaved documents saved for recovery, so that a crash loses little of them.
//!
//! Every window has a file of its own in one folder, and holds a lock on another beside it for as long as it lives. The
//! system lets go of the lock however the window ends: a file that is not locked was left by a crash. The files are
//! project files with one more key, so that they can be opened by hand, too. A window that panicked has written a report
//! beside its file; reports stay when the saved document goes, the latest few of them.

use std::{fs, fs::File, fs::OpenOptions, io, path::Path, path::PathBuf, time::SystemTime, time::UNIX_EPOCH};

use serde_json::{Value as Json, json};

use super::{FileError, project};
use crate::document::Document;

/// The key of what is kept beside the document.
const KEY: &str = "glossmith-recovery";
/// The file that is locked while others are made, looked for and removed.
const GUARD: &str = "folder.lock";

/// The name of the line of a report that says what the panic said.
pub const MESSAGE: &str = "Message";
/// Most reports that are kept.
const REPORTS: usize = 8;

/// A file for an unsaved document. While this lives nobody else takes the file.
#[derive(Debug)]
pub struct RecoveryFile {
    path: PathBuf,
    _lock: File,
}

/// What a panic wrote.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Report {
    pub path: PathBuf,
    /// What the latest panic in it said.
    pub message: String,
}

/// What a crash left.
#[derive(Clone, Debug, PartialEq)]
pub struct Recovered {
    /// The document as it was last saved for recovery.
    pub document: Document,
    /// The file that it had been opened from or saved to.
    pub project: Option<PathBuf>,
    /// When it was saved.
    pub at: SystemTime,
    /// What the user should know, one sentence each.
    pub warnings: Vec<String>,
}

impl RecoveryFile {
    /// A new file in the folder, which is made where it is not there; nothing is written to it yet.
    pub fn open(folder: &Path) -> Result<Self, FileError> {
        let _guard = guard(folder)?;
        let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let mut nanoseconds = since_1970.as_nanos();
        loop {
            let path = folder.join(format!("{}-{nanoseconds}.json", std::process::id()));
            let lock_path = lock_path(&path);
            match OpenOptions::new().write(true).create_new(true).open(&lock_path) {
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => nanoseconds += 1,
                Err(error) => return Err(FileError::writing(&lock_path)(error)),
                Ok(lock) => {
                    lock.lock().map_err(FileError::writing(&lock_path))?;
                    return Ok(Self { path, _lock: lock });
                }
            }
        }
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Puts a document aside instead of the last one; `project` is the file that it belongs to.
    ///
    /// # Errors
    /// [`FileError`] where it can't be written; the last one is then still there.
    pub fn save(&self, document: &Document, project: Option<&Path>) -> Result<(), FileError> {
        save_for_recovery(&self.path, document, project)
    }

    /// Whether something was saved for recovery.
    pub fn has_document(&self) -> bool {
        self.path.exists()
    }

    /// The report of a panic, where there was one.
    pub fn report(&self) -> Option<Report> {
        let path = report_path(&self.path);
        let text = String::from_utf8_lossy(&fs::read(&path).ok()?).into_owned();
        let mut messages = text
            .lines()
            .filter_map(|line| line.strip_prefix(MESSAGE)?.strip_prefix(": "));
        let message = messages.next_back().unwrap_or_default().to_owned();
        Some(Report { path, message })
    }

    /// What is in the file.
    pub fn load(&self) -> Result<Recovered, FileError> {
        let at = fs::metadata(&self.path).and_then(|metadata| metadata.modified());
        let loaded = project::load_document(&self.path)?;
        let mut document = loaded.value;
        let beside = document.extra.shift_remove(KEY).unwrap_or_default();
        Ok(Recovered {
            project: beside.get("project").and_then(Json::as_str).map(PathBuf::from),
            at: at.unwrap_or_else(|_| SystemTime::now()),
            document,
            warnings: loaded.warnings,
        })
    }

    /// Removes the saved document: it has been saved, or is not wanted any more. The slot can go on being used.
    pub fn clear(&self) -> Result<(), FileError> {
        match fs::remove_file(&self.path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(FileError::writing(&self.path)(error)),
            _ => Ok(()),
        }
    }

    /// Removes the file and all that belongs to it.
    pub fn remove(self) -> Result<(), FileError> {
        let folder = self.path.parent().unwrap_or(Path::new("."));
        let _guard = guard(folder)?;
        self.clear()?;
        let lock_path = lock_path(&self.path);
        fs::remove_file(&lock_path).map_err(FileError::writing(&lock_path))
    }
}

/// Takes over what crashes left in the folder, the newest first; what another window has taken stays with that one.
pub fn leftovers(folder: &Path) -> Result<Vec<RecoveryFile>, FileError> {
    let _guard = guard(folder)?;
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(FileError::writing(folder))?.flatten() {
        let path = entry.path();
        if path.file_name() == Some(GUARD.as_ref()) || path.extension() != Some("lock".as_ref()) {
            continue;
        }
        let Ok(lock) = OpenOptions::new().write(true).open(&path) else {
            continue;
        };
        if lock.try_lock().is_err() {
            continue;
        }
        let document = path.with_extension("json");
        let modified = |path: &Path| fs::metadata(path).and_then(|metadata| metadata.modified());
        match modified(&document).or_else(|_| modified(&report_path(&document))) {
            Ok(at) => found.push((
                at,
                RecoveryFile {
                    path: document,
                    _lock: lock,
                },
            )),
            // Left by a window that had nothing unsaved; where it can't be removed it does no harm.
            Err(_) => drop(fs::remove_file(&path)),
        }
    }
    found.sort_by_key(|(at, _)| std::cmp::Reverse(*at));
    remove_old_reports(folder);
    Ok(found.into_iter().map(|(_, slot)| slot).collect())
}

/// Writes a document to the file of a [`RecoveryFile`]; `project` is the file that it belongs to.
///
/// # Errors
/// [`FileError`] where it can't be written; what was there is then still there.
pub fn save_for_recovery(path: &Path, document: &Document, project: Option<&Path>) -> Result<(), FileError> {
    let mut document = document.clone();
    let project = project.and_then(Path::to_str);
    document.extra.insert(KEY.to_owned(), json!({ "project": project }));
    project::save_document(path, &document)
}

/// The report that belongs to the file of a [`RecoveryFile`].
pub fn report_path(path: &Path) -> PathBuf {
    path.with_extension("txt")
}

/// Leaves the latest reports, and those that belong to a saved document.
fn remove_old_reports(folder: &Path) {
    let entries = fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path());
    let is_old = |path: &PathBuf| path.extension() == Some("txt".as_ref()) && !lock_path(path).exists();
    let mut reports: Vec<PathBuf> = entries.filter(is_old).collect();
    reports.sort_by_key(|path| std::cmp::Reverse(fs::metadata(path).and_then(|metadata| metadata.modified()).ok()));
    for path in reports.iter().skip(REPORTS) {
        // Where it can't be removed it does no harm.
        let _ = fs::remove_file(path);
    }
}

fn lock_path(path: &Path) -> PathBuf {
    path.with_extension("lock")
}

/// A lock on the folder until it is dropped: it closes the gap between creating a file and locking it.
fn guard(folder: &Path) -> Result<File, FileError> {
    let path = folder.join(GUARD);
    let lock = || {
        fs::create_dir_all(folder)?;
        let file = OpenOptions::new()
            .write(true)
            .create(true)
            .truncate(false)
            .open(&path)?;
        file.lock()?;
        Ok(file)
    };
    lock().map_err(FileError::writing(&path))
}
