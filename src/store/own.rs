//! The mark by which files are known that this user saved here: they may name files anywhere, as their maker did.
//!
//! It is a hash of the names that lead away from the file, with a key that stays on this machine. Who changes a name does not
//! have it.

use std::{
    hash::{BuildHasher as _, Hasher as _, RandomState},
    io::Write as _,
    path::{Path, PathBuf},
    sync::OnceLock,
};

use serde_json::Value as Json;
use siphasher::sip128::{Hasher128 as _, SipHasher24};

use super::{FileError, Loaded, file};
use crate::import::limits::Reach;

/// The key under which the mark is kept.
pub const KEY: &str = "saved-by";
/// The file of the user's key.
const KEY_FILE: &str = "own-key";

/// The mark of a file at `path` that names these files; none where all lie in its folder, or the system has no place for a key.
pub fn mark(path: &Path, named: &[PathBuf]) -> Option<String> {
    let mut away: Vec<PathBuf> = named.iter().filter(|named| leads_away(path, named)).cloned().collect();
    if away.is_empty() {
        return None;
    }
    away.sort();
    let mut hasher = SipHasher24::new_with_key(key()?);
    for name in away {
        hasher.write(name.as_os_str().as_encoded_bytes());
        hasher.write(&[0]);
    }
    Some(format!("{:032x}", hasher.finish128().as_u128()))
}

/// Whether a name is written from the root, and counts for the mark.
pub fn leads_away(path: &Path, named: &Path) -> bool {
    !file::seen_from(path)(named).is_relative()
}

/// What was read from a file, with warnings of what it names that was allowed. A file from elsewhere that names what lies
/// outside of its surroundings is refused; what was saved by this user is trusted.
pub fn within_reach<T>(
    path: &Path,
    bytes: &[u8],
    mut loaded: Loaded<T>,
    named: impl Fn(&T) -> Vec<PathBuf>,
) -> Result<Loaded<T>, FileError> {
    let mark = file::object(path, bytes)?.shift_remove(KEY);
    let allowed = check_reach(path, mark.as_ref(), &named(&loaded.value))?;
    loaded.warnings.extend(allowed);
    Ok(loaded)
}

fn check_reach(path: &Path, found: Option<&Json>, named: &[PathBuf]) -> Result<Vec<String>, FileError> {
    let reach = Reach::of_folder(file::folder(path));
    let is_own = found.is_some_and(|found| found.as_str() == mark(path, named).as_deref());
    let is_meant = |named: &PathBuf| is_own && leads_away(path, named);
    let outside = named.iter().filter(|named| !is_meant(named) && !reach.encloses(named));
    let (allowed, files): (Vec<_>, Vec<_>) = outside.cloned().partition(|named| reach.has(named));
    if !files.is_empty() {
        let path = path.to_owned();
        return Err(FileError::Outside { path, files });
    }
    let message = |named: &PathBuf| format!("{}: names {}, which lies elsewhere", path.display(), named.display());
    Ok(allowed.iter().map(message).collect())
}

/// The user's key, made when it is first needed.
fn key() -> Option<&'static [u8; 16]> {
    static OF_USER: OnceLock<Option<[u8; 16]>> = OnceLock::new();
    OF_USER.get_or_init(read_key).as_ref()
}

fn read_key() -> Option<[u8; 16]> {
    let folder = directories::ProjectDirs::from("", "", "glossmith")?
        .data_local_dir()
        .to_owned();
    let path = folder.join(KEY_FILE);
    let read = || std::fs::read(&path).ok()?.try_into().ok();
    read().or_else(|| {
        std::fs::create_dir_all(&folder).ok()?;
        // Readable for the user alone; who is first makes it.
        let mut file = tempfile::NamedTempFile::new_in(&folder).ok()?;
        let numbers = [0; 2].map(|_| RandomState::new().build_hasher().finish().to_le_bytes());
        file.write_all(&numbers.concat()).ok()?;
        let _ = file.persist_noclobber(&path);
        read()
    })
}
