//! The files beside a model: in its folder, or in the archive that it came in.

use std::fs::{self, File};
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use zip::ZipArchive;

/// The most that one file of an archive may unpack to.
const UNPACKED_MAX: u64 = 4 << 30;

/// Where files that a model names are looked for.
#[derive(Debug)]
pub(super) enum Files {
    /// In a folder.
    Folder(PathBuf),
    /// In an archive, below one of its folders (with a slash at its end, or empty).
    Archive(Mutex<ZipArchive<BufReader<File>>>, String),
}

impl Files {
    /// Those in the folder of a file.
    pub(super) fn beside(path: &Path) -> Self {
        Self::Folder(path.parent().unwrap_or(Path::new("")).to_owned())
    }

    /// Those in an archive.
    pub(super) fn in_archive(path: &Path) -> io::Result<Self> {
        let archive = ZipArchive::new(BufReader::new(File::open(path)?))?;
        Ok(Self::Archive(Mutex::new(archive), String::new()))
    }

    /// Every file, relative to where they are looked for: in a folder those directly in it, in an archive all.
    pub(super) fn names(&self) -> io::Result<Vec<String>> {
        let mut names: Vec<String> = match self {
            Self::Folder(folder) => fs::read_dir(folder)?
                .flatten()
                .filter(|entry| entry.path().is_file())
                .filter_map(|entry| entry.file_name().into_string().ok())
                .collect(),
            Self::Archive(archive, _) => {
                let archive = archive.lock().unwrap_or_else(PoisonError::into_inner);
                names_in(&archive)
            }
        };
        names.sort();
        Ok(names)
    }

    /// The same files seen from the folder of one of them.
    pub(super) fn seen_from(self, name: &str) -> Self {
        match self {
            Self::Archive(archive, _) => {
                let folder = name.rfind('/').map_or("", |end| &name[..=end]);
                Self::Archive(archive, folder.to_owned())
            }
            folder => folder,
        }
    }

    /// The contents of a file. Where there is none of this name, one whose name differs in upper and lower case, or that
    /// lies beside the model instead of in another folder, is taken.
    pub(super) fn read(&self, name: &str) -> io::Result<Vec<u8>> {
        let name = name.replace('\\', "/");
        let base = name.rsplit('/').next().unwrap_or(&name);
        match self {
            Self::Folder(folder) => {
                let wanted = folder.join(&name);
                let found = if wanted.is_file() {
                    wanted
                } else {
                    same_but_for_case(&wanted)
                        .or_else(|| same_but_for_case(&folder.join(base)))
                        .unwrap_or(wanted)
                };
                fs::read(found)
            }
            Self::Archive(archive, folder) => {
                let mut archive = archive.lock().unwrap_or_else(PoisonError::into_inner);
                let wanted = normal_path(&format!("{folder}{name}"));
                let names = names_in(&archive);
                let last = |known: &str| {
                    known
                        .rsplit('/')
                        .next()
                        .is_some_and(|last| last.eq_ignore_ascii_case(base))
                };
                let found = names.iter().find(|known| **known == wanted);
                let found = found.or_else(|| names.iter().find(|known| known.eq_ignore_ascii_case(&wanted)));
                let found = found.or_else(|| names.iter().find(|known| last(known)));
                let mut bytes = Vec::new();
                let file = archive.by_name(found.ok_or(io::ErrorKind::NotFound)?)?;
                file.take(UNPACKED_MAX).read_to_end(&mut bytes)?;
                Ok(bytes)
            }
        }
    }
}

/// The names of an archive's files that can be written as text.
fn names_in(archive: &ZipArchive<BufReader<File>>) -> Vec<String> {
    archive.file_names().flatten().map(|name| name.into_owned()).collect()
}

/// A path without `.` and `..`.
fn normal_path(path: &str) -> String {
    let mut parts = Vec::new();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop();
            }
            part => parts.push(part),
        }
    }
    parts.join("/")
}

/// A file of the same folder whose name differs in upper and lower case only.
fn same_but_for_case(path: &Path) -> Option<PathBuf> {
    let name = path.file_name()?.to_str()?;
    let entries = fs::read_dir(path.parent()?).ok()?;
    let mut paths = entries.flatten().map(|entry| entry.path());
    paths.find(|path| {
        let known = path.file_name().and_then(|known| known.to_str());
        known.is_some_and(|known| known.eq_ignore_ascii_case(name)) && path.is_file()
    })
}
