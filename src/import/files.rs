//! The files beside a model: in its folder, or in the archive that it came in.

use std::{
    borrow::Cow,
    collections::HashMap,
    ffi::OsStr,
    fs,
    fs::File,
    io::{self, BufReader, ErrorKind, Read},
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
};

use zip::ZipArchive;

use crate::{
    limits::{self, Budget, Reach, is_elsewhere},
    panics::lock,
    scene::Loading,
};

/// Size in bytes from which an archive's contents may be at most [`PACKED_MOST`] times their packed size.
const PACKED_FROM: u64 = 64 << 20;
/// Largest packing ratio: images and models reach a hundredth at best; more is an attack on memory.
const PACKED_MOST: u64 = 500;

/// The files that a model may name, and its import.
#[derive(Debug)]
pub struct Files {
    place: Place,
    /// Files that were given with the model.
    given: Vec<PathBuf>,
    /// The import: files asked for, budget and progress.
    pub import: Import,
}

/// State of one import, shared by all its files and clones.
#[derive(Clone, Debug)]
pub struct Import {
    /// Files that were asked for, by the names that they have on the disk.
    pub asked: Seen,
    /// Memory budget of the files and images together.
    pub budget: Budget,
    pub loading: Loading,
}

impl Import {
    /// An import that begins now.
    pub fn new(loading: &Loading) -> Self {
        Self {
            asked: Seen::default(),
            budget: Budget::of_import(),
            loading: loading.clone(),
        }
    }

    /// Contents of a file, counted against the budget.
    pub fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        limits::read_counted(path, &self.budget, &self.loading)
    }
}

/// Files that were asked for, shared with who wants to know.
#[derive(Clone, Debug, Default)]
pub struct Seen(Arc<Mutex<Vec<PathBuf>>>);

impl Seen {
    /// Notes a file, once.
    pub fn note(&self, path: &Path) {
        let mut seen = lock(&self.0);
        if !seen.iter().any(|known| known == path) {
            seen.push(path.to_owned());
        }
    }

    pub fn take(&self) -> Vec<PathBuf> {
        std::mem::take(&mut lock(&self.0))
    }
}

/// Search location of the files that a model names.
#[derive(Debug)]
enum Place {
    Folder(PathBuf),
    /// In an archive, below one of its folders (with a slash at its end, or empty).
    Archive(Box<Archive>, String),
}

/// An archive with its names.
#[derive(Debug)]
struct Archive {
    zip: Mutex<ZipArchive<BufReader<File>>>,
    /// The names of its files that can be written as text, with slashes, and their numbers in it.
    names: Vec<(String, usize)>,
    /// The first of them by each spelling that finds it: as it is; in lower case; without its folder, in lower case.
    found: [HashMap<String, usize>; 3],
}

impl Archive {
    fn open(path: &Path) -> io::Result<Self> {
        let zip = ZipArchive::new(BufReader::new(limits::open(path)?))?;
        // Old tools of Windows write backslashes.
        let names = zip.file_names().enumerate();
        let names = names.filter_map(|(number, name)| Some((name.ok()?.replace('\\', "/"), number)));
        let names: Vec<(String, usize)> = names.collect();
        let mut found: [HashMap<String, usize>; 3] = Default::default();
        for (place, (name, _)) in names.iter().enumerate() {
            for (by, spelling) in found.iter_mut().zip(spellings(name)) {
                by.entry(spelling).or_insert(place);
            }
        }
        let zip = Mutex::new(zip);
        Ok(Self { zip, names, found })
    }

    /// Contents of a file, or of one with nearly the same name.
    fn read(&self, wanted: &str, import: &Import) -> io::Result<Vec<u8>> {
        let mut spelled = self.found.iter().zip(spellings(wanted));
        let place = spelled.find_map(|(by, spelling)| by.get(&spelling));
        let (_, number) = self.names[*place.ok_or(ErrorKind::NotFound)?];
        let mut zip = lock(&self.zip);
        let file = zip.by_index(number)?;
        let size = file.size();
        if size > PACKED_FROM && size / PACKED_MOST > file.compressed_size() {
            let why = format!(
                "it is packed to a {PACKED_MOST}th of its {} MiB, as no model or image is; unpack the archive where you trust it",
                size >> 20
            );
            return Err(io::Error::new(ErrorKind::InvalidData, why));
        }
        import.budget.take(size)?;
        let mut bytes = Vec::new();
        import.loading.watched(file.take(size + 1)).read_to_end(&mut bytes)?;
        match bytes.len() as u64 > size {
            true => Err(io::Error::new(
                ErrorKind::InvalidData,
                "it is longer than the archive says",
            )),
            false => Ok(bytes),
        }
    }
}

/// Search keys of a file in an archive, best first.
fn spellings(name: &str) -> [String; 3] {
    let lower = name.to_ascii_lowercase();
    let last = lower.rsplit('/').next().unwrap_or(&lower).to_owned();
    [name.to_owned(), lower, last]
}

impl Files {
    /// Files in a folder.
    pub(super) fn in_folder(folder: &Path, given: &[PathBuf], import: &Import) -> Self {
        Self {
            place: Place::Folder(folder.to_owned()),
            given: given.to_owned(),
            import: import.clone(),
        }
    }

    /// Files in an archive.
    pub(super) fn in_archive(path: &Path, import: &Import) -> io::Result<Self> {
        Ok(Self {
            place: Place::Archive(Box::new(Archive::open(path)?), String::new()),
            given: Vec::new(),
            import: import.clone(),
        })
    }

    /// All files, relative to the search location: directly in the folder, or anywhere in the archive.
    pub(super) fn names(&self) -> io::Result<Vec<String>> {
        let mut names: Vec<String> = match &self.place {
            Place::Folder(folder) => fs::read_dir(folder)?
                .flatten()
                .filter(|entry| entry.path().is_file())
                .filter_map(|entry| entry.file_name().into_string().ok())
                .collect(),
            Place::Archive(archive, _) => archive.names.iter().map(|(name, _)| name.clone()).collect(),
        };
        names.sort();
        Ok(names)
    }

    /// The same files, relative to the folder of one of them.
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

    /// Contents of a file. Without an exact match: a name that differs in case, a file beside the model instead of in
    /// another folder, or one given with the model.
    pub(super) fn read(&self, name: &str) -> io::Result<Vec<u8>> {
        let name = name.replace('\\', "/");
        match &self.place {
            Place::Folder(folder) => self.read_in(folder, &name),
            Place::Archive(archive, folder) => archive.read(&normal_path(&format!("{folder}{name}")), &self.import),
        }
    }

    fn read_in(&self, folder: &Path, name: &str) -> io::Result<Vec<u8>> {
        let base = name.rsplit('/').next().unwrap_or(name);
        let wanted = folder.join(name);
        let (reach, loading) = (Reach::of_folder(folder), &self.import.loading);
        if is_elsewhere(&wanted) {
            reach.check(&wanted, loading)?;
        }
        let found = if wanted.is_file() {
            wanted
        } else {
            same_but_for_case(folder, name)
                .or_else(|| same_but_for_case(folder, base))
                .or_else(|| self.given.iter().find(|given| is_called(given, base)).cloned())
                .unwrap_or(wanted)
        };
        if !self.given.contains(&found) {
            reach.check(&found, loading)?;
        }
        self.import.asked.note(&found);
        self.import.read(&found)
    }
}

/// Whether a file has this name, ignoring case. Names that are not Unicode are taken as Latin-1.
fn is_called(path: &Path, name: &str) -> bool {
    let known = path.file_name().map(OsStr::as_encoded_bytes);
    known.is_some_and(|known| text_or_latin_1(known).eq_ignore_ascii_case(name))
}

/// The little-endian number at a place.
pub fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().copied().map(u32::from_le_bytes)
}

/// Text of bytes in UTF-8, or else in Latin-1, where every byte is a character.
pub fn text_or_latin_1(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.into(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect::<String>().into(),
    }
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

/// A file below a folder whose name, or those of the folders in between, differ in upper and lower case only.
fn same_but_for_case(folder: &Path, name: &str) -> Option<PathBuf> {
    let found = name.split('/').try_fold(folder.to_owned(), |at, part| {
        let exact = at.join(part);
        if exact.exists() {
            return Some(exact);
        }
        // A file that is named without a folder lies in the current one.
        let folder = if at.as_os_str().is_empty() { Path::new(".") } else { &at };
        let mut paths = fs::read_dir(folder).ok()?.flatten().map(|entry| entry.path());
        paths.find(|path| is_called(path, part))
    });
    found.filter(|path| path.is_file())
}
