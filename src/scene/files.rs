//! The files beside a model: in its folder, or in the archive that it came in.

use std::fs::{self, File};
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use zip::ZipArchive;

use super::loading::Loading;
use super::resource::{self, BYTES_MAX, Reach, is_elsewhere};

/// The files that a model may name, and what is told while it is read.
#[derive(Debug)]
pub(super) struct Files {
    place: Place,
    /// Files that were given with the model.
    given: Vec<PathBuf>,
    /// Files that were asked for, by the names that they have on the disk.
    asked: Seen,
    /// Who waits.
    pub loading: Loading,
}

/// Files that were asked for, shared with who wants to know.
#[derive(Clone, Debug, Default)]
pub(super) struct Seen(Arc<Mutex<Vec<PathBuf>>>);

impl Seen {
    /// Notes a file, once.
    pub fn note(&self, path: &Path) {
        let mut seen = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if !seen.iter().any(|known| known == path) {
            seen.push(path.to_owned());
        }
    }

    /// What was noted.
    pub fn take(&self) -> Vec<PathBuf> {
        std::mem::take(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Where files that a model names are looked for.
#[derive(Debug)]
enum Place {
    /// In a folder.
    Folder(PathBuf),
    /// In an archive, below one of its folders (with a slash at its end, or empty).
    Archive(Mutex<ZipArchive<BufReader<File>>>, String),
}

impl Files {
    fn at(place: Place, given: &[PathBuf], asked: &Seen, loading: &Loading) -> Self {
        Self {
            place,
            given: given.to_owned(),
            asked: asked.clone(),
            loading: loading.clone(),
        }
    }

    /// Those in a folder.
    pub(super) fn in_folder(folder: &Path, given: &[PathBuf], asked: &Seen, loading: &Loading) -> Self {
        Self::at(Place::Folder(folder.to_owned()), given, asked, loading)
    }

    /// Those in an archive.
    pub(super) fn in_archive(path: &Path, asked: &Seen, loading: &Loading) -> io::Result<Self> {
        let archive = ZipArchive::new(BufReader::new(resource::open(path)?))?;
        let place = Place::Archive(Mutex::new(archive), String::new());
        Ok(Self::at(place, &[], asked, loading))
    }

    /// Every file, relative to where they are looked for: in a folder those directly in it, in an archive all.
    pub(super) fn names(&self) -> io::Result<Vec<String>> {
        let mut names: Vec<String> = match &self.place {
            Place::Folder(folder) => fs::read_dir(folder)?
                .flatten()
                .filter(|entry| entry.path().is_file())
                .filter_map(|entry| entry.file_name().into_string().ok())
                .collect(),
            Place::Archive(archive, _) => {
                let archive = archive.lock().unwrap_or_else(PoisonError::into_inner);
                names_in(&archive)
            }
        };
        names.sort();
        Ok(names)
    }

    /// The same files seen from the folder of one of them.
    pub(super) fn seen_from(self, name: &str) -> Self {
        let place = match self.place {
            Place::Archive(archive, _) => {
                let folder = name.rfind('/').map_or("", |end| &name[..=end]);
                Place::Archive(archive, folder.to_owned())
            }
            folder => folder,
        };
        Self { place, ..self }
    }

    /// The contents of a file. Where there is none of this name, one whose name differs in upper and lower case, that
    /// lies beside the model instead of in another folder, or that was given with the model, is taken.
    pub(super) fn read(&self, name: &str) -> io::Result<Vec<u8>> {
        let name = name.replace('\\', "/");
        let base = name.rsplit('/').next().unwrap_or(&name);
        match &self.place {
            Place::Folder(folder) => {
                let wanted = folder.join(&name);
                let reach = Reach::of_folder(folder);
                if is_elsewhere(&wanted) {
                    reach.check(&wanted)?;
                }
                let found = if wanted.is_file() {
                    wanted
                } else {
                    same_but_for_case(&wanted)
                        .or_else(|| same_but_for_case(&folder.join(base)))
                        .or_else(|| self.given.iter().find(|given| is_called(given, base)).cloned())
                        .unwrap_or(wanted)
                };
                if !self.given.contains(&found) {
                    reach.check(&found)?;
                }
                self.asked.note(&found);
                resource::read(&found, BYTES_MAX)
            }
            Place::Archive(archive, folder) => {
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
                file.take(BYTES_MAX).read_to_end(&mut bytes)?;
                Ok(bytes)
            }
        }
    }
}

/// Whether a file has this name, upper and lower case not told apart.
fn is_called(path: &Path, name: &str) -> bool {
    let known = path.file_name().and_then(|known| known.to_str());
    known.is_some_and(|known| known.eq_ignore_ascii_case(name))
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
    paths.find(|path| is_called(path, name) && path.is_file())
}
