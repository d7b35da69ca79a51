//! Access to files that other files name.
//!
//! A file from a stranger may name anything. Only regular files are read, and only within reach of the naming file; others
//! only with the user's permission.

use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind, Read as _};
use std::path::{Component, Path, PathBuf, Prefix};
use std::sync::Mutex;

use crate::panics::lock;
use crate::scene::Loading;

/// The most bytes of one file.
pub(super) const BYTES_MAX: u64 = 4 << 30;

/// Permissions by the user, independent of the naming file.
static PERMITS: Mutex<Permits> = Mutex::new(Permits {
    everything: false,
    allowed: Vec::new(),
});

struct Permits {
    everything: bool,
    allowed: Vec<PathBuf>,
}

fn permits() -> std::sync::MutexGuard<'static, Permits> {
    lock(&PERMITS)
}

/// Allows files to name any file until the program ends.
pub fn allow_everything() {
    permits().everything = true;
}

/// Files may name these files.
pub fn allow(files: &[PathBuf]) {
    let mut permits = permits();
    for file in files.iter().map(|file| real(file)) {
        if !permits.allowed.contains(&file) {
            permits.allowed.push(file);
        }
    }
}

/// The files that were allowed, as far as settings, which are text, can name them.
pub fn allowed() -> Vec<PathBuf> {
    let allowed = permits().allowed.clone();
    allowed.into_iter().filter(|path| path.to_str().is_some()).collect()
}

/// Opens a regular file. Devices and pipes, which may block forever, are refused without waiting.
///
/// # Errors
///
/// The system's, or that it is not a regular file.
pub fn open(path: &Path) -> io::Result<File> {
    let no_file = || io::Error::new(ErrorKind::InvalidInput, "no regular file");
    // Opening a device may have side effects: checked before. A replacement in between is detected after.
    if !path.metadata()?.is_file() {
        return Err(no_file());
    }
    let mut options = OpenOptions::new();
    options.read(true);
    #[cfg(target_os = "linux")]
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, libc::O_NONBLOCK | libc::O_NOCTTY);
    let file = options.open(path)?;
    if file.metadata()?.is_file() {
        Ok(file)
    } else {
        Err(no_file())
    }
}

/// Contents of a regular file of at most `most` bytes.
///
/// # Errors
///
/// The system's, that it is not a regular file, or that it is larger.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    read_watched(path, most, &Loading::default())
}

/// The same with progress and cancellation.
pub(super) fn read_watched(path: &Path, most: u64, loading: &Loading) -> io::Result<Vec<u8>> {
    let file = open(path)?;
    let too_large = || io::Error::new(ErrorKind::FileTooLarge, format!("larger than {} MiB", most >> 20));
    let length = file.metadata()?.len();
    if length > most {
        return Err(too_large());
    }
    let mut bytes = Vec::with_capacity(length as usize);
    match loading.watched(file.take(most + 1)).read_to_end(&mut bytes)? as u64 {
        read if read > most => Err(too_large()),
        _ => Ok(bytes),
    }
}

/// The surroundings of a file: the folder above its own, with all below.
#[derive(Clone, Debug)]
pub struct Reach(PathBuf);

impl Reach {
    /// Reach of the files in a folder.
    pub fn of_folder(folder: &Path) -> Self {
        let folder = match folder.as_os_str().is_empty() {
            true => real(Path::new(".")),
            false => real(folder),
        };
        // The root of a disk is nobody's surroundings.
        let above = folder.parent().filter(|above| above.parent().is_some());
        Self(above.map_or(folder.clone(), Path::to_owned))
    }

    /// Checks that a file may be named; records a refusal in `loading`.
    ///
    /// # Errors
    ///
    /// That it lies outside, with the remedy.
    pub fn check(&self, path: &Path, loading: &Loading) -> io::Result<()> {
        if self.has(path) {
            return Ok(());
        }
        loading.refuse(path);
        let why = format!(
            "it lies outside of {}, and was not allowed (--allow-outside, or the window's question)",
            self.0.display()
        );
        Err(io::Error::new(ErrorKind::PermissionDenied, why))
    }

    /// Whether a file is within reach or permitted.
    pub fn has(&self, path: &Path) -> bool {
        let is_allowed = |permits: &Permits| permits.everything || permits.allowed.contains(&real(path));
        is_allowed(&permits()) || self.encloses(path)
    }

    /// Whether a file is within reach.
    pub fn encloses(&self, path: &Path) -> bool {
        // Network paths are refused without access.
        !is_elsewhere(path) && real(path).starts_with(&self.0)
    }
}

/// Whether a path names another machine or a device, as Windows has them.
pub(super) fn is_elsewhere(path: &Path) -> bool {
    let text = path.to_string_lossy();
    let is_disk = |prefix: Prefix<'_>| matches!(prefix, Prefix::Disk(_) | Prefix::VerbatimDisk(_));
    let is_local = path.components().all(|part| match part {
        Component::Prefix(prefix) => is_disk(prefix.kind()),
        _ => true,
    });
    !is_local || text.starts_with("//")
}

/// A path from the root without links and dots, as far as it is there.
fn real(path: &Path) -> PathBuf {
    if is_elsewhere(path) {
        return path.to_owned();
    }
    if let Ok(found) = path.canonicalize() {
        return found;
    }
    // A missing file cannot be read, but its name could probe for existence outside.
    let mut named = PathBuf::new();
    for part in std::path::absolute(path)
        .unwrap_or_else(|_| path.to_owned())
        .components()
    {
        match part {
            Component::ParentDir => {
                named.pop();
            }
            part => named.push(part),
        }
    }
    let folder = named.parent().and_then(|folder| folder.canonicalize().ok());
    match (folder, named.file_name()) {
        (Some(folder), Some(name)) => folder.join(name),
        _ => named,
    }
}
