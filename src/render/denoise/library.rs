//! Open Image Denoise, loaded at run time: found, checked, and its C functions bound. Only [`super::filter`] calls them.
//!
//! The library is searched in the folder of [`FOLDER_VARIABLE`], and only there if it is set. Otherwise: beside the
//! executable; in the data folder, where `scripts/setup` puts it; then by the system's loader.

use std::ffi::{CStr, OsStr, c_char, c_int, c_void};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use super::device_choice::DenoiseDevice;

/// Environment variable with the folder of the library.
pub const FOLDER_VARIABLE: &str = "GLOSSMITH_OIDN";

/// The oldest supported version (major, minor): earlier ones lack a quality.
const MIN_VERSION: [i32; 2] = [2, 3];

#[cfg(target_os = "windows")]
const NAME: &str = "OpenImageDenoise.dll";
#[cfg(target_os = "macos")]
const NAME: &str = "libOpenImageDenoise.2.dylib";
#[cfg(not(any(target_os = "windows", target_os = "macos")))]
const NAME: &str = "libOpenImageDenoise.so.2";

/// File name prefixes of the library's own dependencies, in load order. Loaded first if they lie beside it, because the
/// loader does not search there.
const DEPENDENCIES: [&str; 2] = ["libtbb.so.12", "libOpenImageDenoise_core.so"];

/// Why there is no denoiser.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LibraryError {
    /// The library was not found.
    #[error(
        "the denoiser Open Image Denoise 2 was not found: run `scripts/setup denoiser`, or name the folder of {NAME} by \
         {FOLDER_VARIABLE}"
    )]
    Missing,
    /// The user's folder does not have the library.
    #[error("{}: there is no {NAME} in this folder, which {FOLDER_VARIABLE} names", .0.display())]
    NotInFolder(PathBuf),
    /// The file cannot be loaded.
    #[error("{}: can't be loaded as the denoiser ({reason}); install it again by `scripts/setup denoiser`", path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// The loader's message.
        reason: String,
    },
    /// The version is too old.
    #[error("{}: Open Image Denoise {found} is too old, {}.{} or newer is needed", path.display(), MIN_VERSION[0], MIN_VERSION[1])]
    TooOld {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: String,
    },
    /// The library refuses to work here.
    #[error("the denoiser can't be used here: {0}")]
    Device(String),
    /// The request was cancelled.
    #[error("denoising was stopped")]
    Cancelled,
}

/// The C library's handle of a device (`OIDNDevice`).
pub(super) type DeviceHandle = *mut c_void;
/// The C library's handle of a filter (`OIDNFilter`).
pub(super) type FilterHandle = *mut c_void;
/// The C library's handle of a buffer (`OIDNBuffer`).
pub(super) type BufferHandle = *mut c_void;
/// Callback of the C library during filtering (`OIDNProgressMonitorFunction`): gets the caller's pointer and the progress in
/// [0, 1]; returning `false` cancels.
pub(super) type ProgressMonitor = unsafe extern "C" fn(*mut c_void, f64) -> bool;

/// The library, once it was found.
static FOUND: OnceLock<Library> = OnceLock::new();
/// Why it was not found when it was looked for last.
static FAILED: Mutex<Option<LibraryError>> = Mutex::new(None);

fn lock_failed() -> MutexGuard<'static, Option<LibraryError>> {
    FAILED.lock().unwrap_or_else(PoisonError::into_inner)
}

macro_rules! functions {
    ($($field:ident = $symbol:literal: fn($($argument:ty),*) $(-> $result:ty)?;)*) => {
        /// The C functions, by their names in `oidn.h` without `oidn`.
        #[derive(Debug)]
        pub(super) struct Functions {
            $(pub(super) $field: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
        }

        impl Functions {
            /// Binds all of them, or names the one that is missing.
            fn bind(library: &libloading::Library) -> Result<Self, libloading::Error> {
                // SAFETY: the signatures are those of `oidn.h` of version 2, whose major number is in the file's name.
                unsafe { Ok(Self { $($field: *library.get($symbol)?,)* }) }
            }
        }
    };
}

functions! {
    get_num_physical_devices = b"oidnGetNumPhysicalDevices\0": fn() -> c_int;
    get_physical_device_int = b"oidnGetPhysicalDeviceInt\0": fn(c_int, *const c_char) -> c_int;
    new_device_by_id = b"oidnNewDeviceByID\0": fn(c_int) -> DeviceHandle;
    commit_device = b"oidnCommitDevice\0": fn(DeviceHandle);
    release_device = b"oidnReleaseDevice\0": fn(DeviceHandle);
    set_device_bool = b"oidnSetDeviceBool\0": fn(DeviceHandle, *const c_char, bool);
    get_device_int = b"oidnGetDeviceInt\0": fn(DeviceHandle, *const c_char) -> c_int;
    get_device_error = b"oidnGetDeviceError\0": fn(DeviceHandle, *mut *const c_char) -> c_int;
    new_buffer = b"oidnNewBuffer\0": fn(DeviceHandle, usize) -> BufferHandle;
    get_buffer_data = b"oidnGetBufferData\0": fn(BufferHandle) -> *mut c_void;
    get_buffer_storage = b"oidnGetBufferStorage\0": fn(BufferHandle) -> c_int;
    release_buffer = b"oidnReleaseBuffer\0": fn(BufferHandle);
    write_buffer = b"oidnWriteBuffer\0": fn(BufferHandle, usize, usize, *const c_void);
    read_buffer = b"oidnReadBuffer\0": fn(BufferHandle, usize, usize, *mut c_void);
    new_filter = b"oidnNewFilter\0": fn(DeviceHandle, *const c_char) -> FilterHandle;
    release_filter = b"oidnReleaseFilter\0": fn(FilterHandle);
    set_filter_image = b"oidnSetFilterImage\0":
        fn(FilterHandle, *const c_char, BufferHandle, c_int, usize, usize, usize, usize, usize);
    set_filter_bool = b"oidnSetFilterBool\0": fn(FilterHandle, *const c_char, bool);
    set_filter_int = b"oidnSetFilterInt\0": fn(FilterHandle, *const c_char, c_int);
    get_filter_int = b"oidnGetFilterInt\0": fn(FilterHandle, *const c_char) -> c_int;
    set_filter_float = b"oidnSetFilterFloat\0": fn(FilterHandle, *const c_char, f32);
    set_filter_progress_monitor = b"oidnSetFilterProgressMonitorFunction\0":
        fn(FilterHandle, Option<ProgressMonitor>, *mut c_void);
    commit_filter = b"oidnCommitFilter\0": fn(FilterHandle);
    execute_filter = b"oidnExecuteFilter\0": fn(FilterHandle);
}

/// The loaded library. It is never unloaded, because its threads do not survive that.
#[derive(Debug)]
pub struct Library {
    pub(super) functions: Functions,
    path: PathBuf,
    version: [i32; 3],
    device: &'static str,
}

impl Library {
    /// The library, found and loaded on the first call.
    ///
    /// # Errors
    /// [`LibraryError`] in one line with the remedy; the same on each call, until it is looked for again.
    pub fn get() -> Result<&'static Self, LibraryError> {
        if let Some(found) = FOUND.get() {
            return Ok(found);
        }
        let mut failed = lock_failed();
        if let Some(error) = failed.as_ref() {
            return Err(error.clone());
        }
        match Self::find() {
            Ok(library) => Ok(FOUND.get_or_init(|| library)),
            Err(error) => {
                *failed = Some(error.clone());
                Err(error)
            }
        }
    }

    /// Whether it was looked for and is not there. Does not look for it.
    pub fn is_missing() -> bool {
        matches!(*lock_failed(), Some(LibraryError::Missing))
    }

    /// Has it looked for again at the next call, after it was installed.
    pub fn look_again() {
        *lock_failed() = None;
    }

    fn find() -> Result<Self, LibraryError> {
        if let Some(folder) = std::env::var_os(FOLDER_VARIABLE).filter(|folder| !folder.is_empty()) {
            let folder = PathBuf::from(folder);
            return match folder.join(NAME) {
                path if path.exists() => Self::load(&path),
                _ => Err(LibraryError::NotInFolder(folder)),
            };
        }
        let executable = std::env::current_exe().ok();
        let beside = executable.as_deref().and_then(Path::parent).map(Path::to_owned);
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
    ///
    /// # Errors
    /// [`LibraryError`] naming it.
    pub fn load(path: &Path) -> Result<Self, LibraryError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let open = |path: &Path| {
            // SAFETY: a library's initialisers run. That of the file that the user installed as Open Image Denoise is
            // trusted as the program itself is.
            unsafe { libloading::Library::new(path) }.map_err(|error| LibraryError::Broken {
                path: path.to_owned(),
                reason: one_line(&error.to_string()),
            })
        };
        for needed in DEPENDENCIES.iter().filter_map(|name| file_beginning_with(folder, name)) {
            std::mem::forget(open(&needed)?);
        }
        Self::bind(open(path)?, path)
    }

    fn bind(loaded: libloading::Library, path: &Path) -> Result<Self, LibraryError> {
        let functions = Functions::bind(&loaded).map_err(|error| LibraryError::Broken {
            path: path.to_owned(),
            reason: one_line(&error.to_string()),
        })?;
        std::mem::forget(loaded);
        let mut library = Self {
            functions,
            path: path.to_owned(),
            version: [0; 3],
            device: "",
        };
        let (version, device) = {
            let device = super::filter::Device::of(&library, DenoiseDevice::chosen())?;
            (device.int(c"version"), device.kind_name())
        };
        library.version = [version / 10_000, version / 100 % 100, version % 100];
        library.device = device;
        if library.version[..2] < MIN_VERSION[..] {
            return Err(LibraryError::TooOld {
                path: library.path.clone(),
                found: library.version_text(),
            });
        }
        Ok(library)
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

/// The folder in which `scripts/setup` puts the library.
pub fn data_folder() -> Option<PathBuf> {
    let folders = directories::ProjectDirs::from("", "", "glossmith")?;
    Some(folders.data_local_dir().join("denoiser"))
}

/// The first file of a folder with a name prefix.
pub(super) fn file_beginning_with(folder: &Path, beginning: &str) -> Option<PathBuf> {
    let entries = std::fs::read_dir(folder).ok()?;
    let names = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let fits = |path: &PathBuf| {
        path.file_name()
            .and_then(OsStr::to_str)
            .is_some_and(|name| name.starts_with(beginning))
    };
    names.filter(fits).min()
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A message of the library; empty for null.
pub(super) unsafe fn message(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: as promised.
    one_line(&unsafe { CStr::from_ptr(text) }.to_string_lossy())
}
