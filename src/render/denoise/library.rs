//! Open Image Denoise, loaded at run time: found and checked.
//!
//! The library is searched in the folder of [`FOLDER_VARIABLE`], and only there if it is set. Otherwise: beside the
//! executable; in the data folder, where `scripts/setup` puts it; then by the system's loader.

use std::{ffi::OsStr, path::Path, path::PathBuf, sync::Mutex};

use super::{
    device_choice::DenoiseDevice,
    filter::Device,
    functions::{Functions, one_line},
    library_error::{FOLDER_VARIABLE, LibraryError, MIN_VERSION, NAME},
};
use crate::{panics::lock, render::MachineOptions};

/// File name prefixes of the library's own dependencies, in load order. Loaded first if they lie beside it, because the
/// loader does not search there.
const DEPENDENCIES: [&str; 2] = ["libtbb.so.12", "libOpenImageDenoise_core.so"];

/// The library, once it was looked for, or why it was not found.
static FOUND: Mutex<Option<Result<&'static Library, LibraryError>>> = Mutex::new(None);

/// The loaded library. It is never unloaded, because its threads do not survive that.
#[derive(Debug)]
pub struct Library {
    pub functions: &'static Functions,
    version: [i32; 3],
    device: &'static str,
}

impl Library {
    /// The library, found and loaded on the first call.
    ///
    /// # Errors
    /// [`LibraryError`] in one line with the remedy; the same on each call, until it is looked for again.
    pub fn get() -> Result<&'static Self, LibraryError> {
        lock(&FOUND).get_or_insert_with(Self::find).clone()
    }

    /// Whether it was looked for and is not there. Does not look for it.
    pub fn is_missing() -> bool {
        matches!(*lock(&FOUND), Some(Err(LibraryError::Missing)))
    }

    /// Has it looked for again at the next call, after it was installed.
    pub fn look_again() {
        lock(&FOUND).take_if(|found| found.is_err());
    }

    fn find() -> Result<&'static Self, LibraryError> {
        if let Some(folder) = std::env::var_os(FOLDER_VARIABLE).filter(|folder| !folder.is_empty()) {
            let folder = PathBuf::from(folder);
            return match folder.join(NAME) {
                path if path.exists() => Self::load(&path),
                _ => {
                    let reason = format!("there is no {NAME} in this folder, which {FOLDER_VARIABLE} names");
                    Err(LibraryError::Unusable { path: folder, reason })
                }
            };
        }
        let beside = std::env::current_exe()
            .ok()
            .as_deref()
            .and_then(Path::parent)
            .map(Path::to_owned);
        for folder in [beside, data_folder()].into_iter().flatten() {
            let path = folder.join(NAME);
            if path.exists() {
                return Self::load(&path);
            }
        }
        match Self::of_system() {
            Ok(loaded) => Self::bind(loaded, Path::new(NAME)),
            Err(_) => Err(LibraryError::Missing),
        }
    }

    /// The library of the system, never one of the current folder, where what was downloaded may lie.
    fn of_system() -> Result<libloading::Library, libloading::Error> {
        // SAFETY: as in `load`.
        #[cfg(not(windows))]
        let loaded = unsafe { libloading::Library::new(NAME) };
        #[cfg(windows)]
        let loaded = {
            use libloading::os::windows::{LOAD_LIBRARY_SEARCH_DEFAULT_DIRS, Library as Loaded};
            // SAFETY: as in `load`.
            unsafe { Loaded::load_with_flags(NAME, LOAD_LIBRARY_SEARCH_DEFAULT_DIRS) }.map(Into::into)
        };
        loaded
    }

    /// Loads the file.
    fn load(path: &Path) -> Result<&'static Self, LibraryError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let open = |path: &Path| {
            // SAFETY: a library's initialisers run. That of the file that the user installed as Open Image Denoise is
            // trusted as the program itself is.
            unsafe { libloading::Library::new(path) }.map_err(|error| broken(path, &error))
        };
        for needed in DEPENDENCIES.iter().filter_map(|name| file_beginning_with(folder, name)) {
            std::mem::forget(open(&needed)?);
        }
        Self::bind(open(path)?, path)
    }

    fn bind(loaded: libloading::Library, path: &Path) -> Result<&'static Self, LibraryError> {
        let functions = Functions::bind(&loaded).map_err(|error| broken(path, &error))?;
        std::mem::forget(loaded);
        let functions: &'static Functions = Box::leak(Box::new(functions));
        let choice = MachineOptions::get().denoise_device;
        let device = Device::of(functions, choice)?;
        if choice == DenoiseDevice::Gpu && !device.is_gpu() {
            log::warn!("no GPU can denoise here, so the CPU does");
        }
        let version = device.int(c"version");
        let library = Self {
            functions,
            version: [version / 10_000, version / 100 % 100, version % 100],
            device: device.kind_name(),
        };
        if library.version[..2] < MIN_VERSION[..] {
            let [major, minor] = MIN_VERSION;
            let found = library.version_text();
            return Err(LibraryError::Unusable {
                path: path.to_owned(),
                reason: format!("Open Image Denoise {found} is too old, {major}.{minor} or newer is needed"),
            });
        }
        Ok(Box::leak(Box::new(library)))
    }

    /// The version as text, such as 2.5.1.
    fn version_text(&self) -> String {
        self.version.map(|number| number.to_string()).join(".")
    }
}

impl std::fmt::Display for Library {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Open Image Denoise {} ({})", self.version_text(), self.device)
    }
}

fn broken(path: &Path, error: &libloading::Error) -> LibraryError {
    let why = one_line(&error.to_string());
    LibraryError::Unusable {
        path: path.to_owned(),
        reason: format!("can't be loaded as the denoiser ({why}); install it again by `scripts/setup denoiser`"),
    }
}

/// The folder in which `scripts/setup` puts the library.
pub fn data_folder() -> Option<PathBuf> {
    Some(
        directories::ProjectDirs::from("", "", "glossmith")?
            .data_local_dir()
            .join("denoiser"),
    )
}

/// The first file of a folder with a name prefix.
pub fn file_beginning_with(folder: &Path, beginning: &str) -> Option<PathBuf> {
    std::fs::read_dir(folder)
        .ok()?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| {
            path.file_name()
                .and_then(OsStr::to_str)
                .is_some_and(|name| name.starts_with(beginning))
        })
        .min()
}
