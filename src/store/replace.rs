//! Atomic replacement of a file: readers, and restarts after a crash, find the old contents or the new, never a part.
//!
//! The new contents grow in a hidden file beside it, which its writer keeps locked. What a killed program has left there is
//! locked by nobody, and [`remove_leftovers`] takes it away.

use std::{fs, fs::File, fs::OpenOptions, io, io::BufWriter, io::Write, path::Path, path::PathBuf};

use super::FileError;

/// The suffix of files that are still being written.
const ENDING: &str = ".glossmith-part";
/// Most files that grow for one name at the same time.
const ATTEMPTS: u32 = 100;

/// Replaces a file's contents at once. Permissions stay; a link is followed.
///
/// # Errors
/// [`FileError::Write`]; the old file is then untouched.
pub fn save_atomically(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    save_by(path, |file| file.write_all(bytes))
}

/// The same with the contents that `write` writes.
pub fn save_by(path: &Path, write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>) -> Result<(), FileError> {
    let target = target_of(path);
    let saved = check_target(&target).and_then(|()| Growing::beside(&target));
    let saved = saved.and_then(|growing| {
        let mut file = BufWriter::new(&growing.file);
        write(&mut file)?;
        file.flush()?;
        drop(file);
        growing.take_the_place_of(&target)
    });
    saved.map_err(FileError::writing(path))
}

/// Whether a file can be replaced, asked before the work that fills it.
pub fn check_saving(path: &Path) -> Result<(), FileError> {
    let target = target_of(path);
    let growing = check_target(&target).and_then(|()| Growing::beside(&target));
    growing.map(drop).map_err(FileError::writing(path))
}

/// Removes what programs that were killed have left half written in a folder. What others write now stays.
pub fn remove_leftovers(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let is_growing = |name: &str| name.starts_with('.') && name.ends_with(ENDING);
    for path in entries.map(|entry| entry.path()) {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if !is_growing(&name) {
            continue;
        }
        // To be locked it must be open for writing on some systems.
        let file = OpenOptions::new().write(true).open(&path);
        if file.is_ok_and(|file| file.try_lock().is_ok()) {
            let _ = fs::remove_file(&path);
        }
    }
}

/// The file itself, where the path is a link.
fn target_of(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

/// Devices, pipes and folders are not replaced: programs rely on them.
fn check_target(target: &Path) -> io::Result<()> {
    match fs::metadata(target) {
        Ok(found) if found.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
        Ok(found) if !found.is_file() => Err(io::Error::other("a device or a pipe, which is not replaced")),
        _ => Ok(()),
    }
}

/// A hidden file with contents to come; removed unless it takes another's place.
struct Growing {
    path: PathBuf,
    file: File,
}

impl Growing {
    /// A new one in the same folder, so that renaming it does not cross file systems.
    fn beside(target: &Path) -> io::Result<Self> {
        let name = target.file_name().ok_or(io::ErrorKind::IsADirectory)?.to_string_lossy();
        let mut attempt = 0;
        loop {
            let path = target.with_file_name(format!(".{name}.{}-{attempt}{ENDING}", std::process::id()));
            attempt += 1;
            let file = match OpenOptions::new().write(true).create_new(true).open(&path) {
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists && attempt < ATTEMPTS => continue,
                opened => opened?,
            };
            // Not every file system can; leftovers stay there.
            let _ = file.lock();
            // Somebody may have taken it for a leftover before it was locked.
            if path.exists() {
                return Ok(Self { path, file });
            }
        }
    }

    fn take_the_place_of(self, target: &Path) -> io::Result<()> {
        if let Ok(old) = fs::metadata(target) {
            self.file.set_permissions(old.permissions())?;
        }
        self.file.sync_all()?;
        fs::rename(&self.path, target)?;
        // Makes the new name last through a power cut; not every file system can.
        #[cfg(unix)]
        if let Some(folder) = target.parent() {
            let folder = if folder.as_os_str().is_empty() {
                Path::new(".")
            } else {
                folder
            };
            let _ = File::open(folder).and_then(|folder| folder.sync_all());
        }
        Ok(())
    }
}

impl Drop for Growing {
    fn drop(&mut self) {
        // Gone where it has taken the other's place.
        let _ = fs::remove_file(&self.path);
    }
}
