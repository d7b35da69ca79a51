//! What an import may read, and how much memory it may take.
//!
//! A file from a stranger may name anything. Only regular files are read, and only within reach of the naming file; others
//! only with the user's permission.

use std::{
    fs::{File, OpenOptions},
    io::{self, ErrorKind, Read as _},
    path::{Component, Path, PathBuf, Prefix},
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, AtomicU64, Ordering::Relaxed},
    },
};

use sysinfo::{MemoryRefreshKind, RefreshKind, System};

use crate::{panics::lock, scene::Loading, shipped::shipped};

/// The most bytes of one file.
pub(super) const BYTES_MAX: u64 = 4 << 30;

/// Whether the user allows any file to be named, whatever names it.
static EVERYTHING: AtomicBool = AtomicBool::new(false);
/// Files that the user allows to be named.
static ALLOWED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Allows files to name any file until the program ends.
pub fn allow_everything() {
    EVERYTHING.store(true, Relaxed);
}

/// Files may name these files.
pub fn allow(files: &[PathBuf]) {
    let mut allowed = lock(&ALLOWED);
    for file in files.iter().map(|file| real(file)) {
        if !allowed.contains(&file) {
            allowed.push(file);
        }
    }
}

/// The files that were allowed, as far as settings, which are text, can name them.
pub fn allowed() -> Vec<PathBuf> {
    let allowed = lock(&ALLOWED).clone();
    allowed.into_iter().filter(|path| path.to_str().is_some()).collect()
}

/// Opens a regular file. Devices and pipes, which may block forever, are refused without waiting.
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

/// Bytes of a regular file or a shipped map.
pub(super) fn length(path: &Path) -> io::Result<u64> {
    shipped(path).map_or_else(|| Ok(open(path)?.metadata()?.len()), |map| Ok(map.len() as u64))
}

/// Contents of a file, counted against the budget.
pub(super) fn read_counted(path: &Path, budget: &Budget, loading: &Loading) -> io::Result<Vec<u8>> {
    budget.take(length(path)?)?;
    read_watched(path, BYTES_MAX, loading)
}

/// Contents of a regular file of at most `most` bytes, or of a shipped map.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    read_watched(path, most, &Loading::default())
}

/// The same with progress and cancellation.
pub(super) fn read_watched(path: &Path, most: u64, loading: &Loading) -> io::Result<Vec<u8>> {
    if let Some(map) = shipped(path) {
        return Ok(map.to_vec());
    }
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
        EVERYTHING.load(Relaxed) || lock(&ALLOWED).contains(&real(path)) || self.encloses(path)
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
    let is_foreign = |part: Component<'_>| matches!(part, Component::Prefix(prefix) if !is_disk(prefix.kind()));
    path.components().any(is_foreign) || text.starts_with("//")
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
            Component::ParentDir => drop(named.pop()),
            part => named.push(part),
        }
    }
    let folder = named.parent().and_then(|folder| folder.canonicalize().ok());
    match (folder, named.file_name()) {
        (Some(folder), Some(name)) => folder.join(name),
        _ => named,
    }
}

/// Memory budget of one import: files, archives and images together; clones share it.
#[derive(Clone, Debug)]
pub struct Budget {
    allowed: u64,
    taken: Arc<AtomicU64>,
}

/// An import exceeds its budget.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "it takes {} MiB, and {} are left of the {} MiB that everything of one import may take; make it smaller or leave others \
     out, or allow more by {LIMIT_VARIABLE}=MIB",
    needed.div_ceil(1 << 20), left >> 20, allowed >> 20
)]
pub struct OverBudget {
    needed: u64,
    left: u64,
    allowed: u64,
}

impl From<OverBudget> for io::Error {
    fn from(over: OverBudget) -> Self {
        Self::new(ErrorKind::FileTooLarge, over)
    }
}

impl Budget {
    /// A budget of `allowed` bytes, unused.
    pub fn new(allowed: u64) -> Self {
        let taken = Arc::default();
        Self { allowed, taken }
    }

    /// The budget of an import that begins now: what the user allows, or a share of the free memory.
    pub fn of_import() -> Self {
        Self::new(limit().unwrap_or_else(|| (IMPORT_SHARE * free(0) as f64) as u64))
    }

    /// The bytes that are left.
    pub fn left(&self) -> u64 {
        self.allowed.saturating_sub(self.taken.load(Relaxed))
    }

    /// Checks that `needed` bytes are left, for temporary use.
    pub fn check(&self, needed: u64) -> Result<(), OverBudget> {
        let (left, allowed) = (self.left(), self.allowed);
        let over = OverBudget { needed, left, allowed };
        if needed <= left { Ok(()) } else { Err(over) }
    }

    /// Takes `needed` bytes permanently. Called in the order of the files and images, whichever is read first: what is left
    /// out must not depend on timing.
    pub fn take(&self, needed: u64) -> Result<(), OverBudget> {
        self.check(needed)?;
        self.taken.fetch_add(needed, Relaxed);
        Ok(())
    }
}

/// Environment variable with the memory limit of a render and its imports, in MiB.
pub const LIMIT_VARIABLE: &str = "GLOSSMITH_MEMORY";
/// Share of the free memory that a render may use: other parts and programs need the rest.
const SHARE: f64 = 0.9;
/// Share of that for the files of one import: the scene is built from them, and the render follows.
const IMPORT_SHARE: f64 = 0.5;

/// The bytes that [`LIMIT_VARIABLE`] names.
pub fn limit() -> Option<u64> {
    let mib: u64 = std::env::var(LIMIT_VARIABLE).ok()?.trim().parse().ok()?;
    Some(mib.saturating_mul(1 << 20))
}

/// Remaining bytes of the process's limit, if any (`ulimit -v`).
#[cfg(target_os = "linux")]
fn of_process() -> u64 {
    let mut limit = libc::rlimit {
        rlim_cur: 0,
        rlim_max: 0,
    };
    // SAFETY: it writes into the given struct.
    let is_known = unsafe { libc::getrlimit(libc::RLIMIT_AS, &raw mut limit) } == 0;
    if !is_known || limit.rlim_cur == libc::RLIM_INFINITY {
        return u64::MAX;
    }
    let sizes = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let size = sizes
        .lines()
        .find_map(|line| line.strip_prefix("VmSize:")?.trim().strip_suffix(" kB"));
    let taken_kib: Option<u64> = size.and_then(|size| size.parse().ok());
    // At least 1, because 0 means unknown.
    limit.rlim_cur.saturating_sub(taken_kib.unwrap_or(0) << 10).max(1)
}

/// Other systems have no such limit.
#[cfg(not(target_os = "linux"))]
fn of_process() -> u64 {
    u64::MAX
}

/// Default memory of a render in bytes. `held` is memory that is freed when it starts.
pub fn free(held: u64) -> u64 {
    let ram = MemoryRefreshKind::nothing().with_ram();
    let Ok(system) = System::new_with_specifics(RefreshKind::nothing().with_memory(ram)) else {
        return u64::MAX;
    };
    // A container may have less than the machine.
    let of_container = system.cgroup_limits().map_or(u64::MAX, |limits| limits.free_memory);
    match system.available_memory().min(of_container).min(of_process()) {
        // The system does not say.
        0 => u64::MAX,
        free => (SHARE * free.saturating_add(held) as f64) as u64,
    }
}
