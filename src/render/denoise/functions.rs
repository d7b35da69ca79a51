//! The C functions of Open Image Denoise, bound at run time. Only [`super::filter`] calls them.

use std::ffi::{CStr, c_char, c_int, c_void};

/// The C library's handle of a device, a filter or a buffer.
pub type Handle = *mut c_void;
/// Callback of the C library during filtering (`OIDNProgressMonitorFunction`): gets the caller's pointer and the progress in
/// [0, 1]; returning `false` cancels.
pub type ProgressMonitor = unsafe extern "C" fn(*mut c_void, f64) -> bool;

macro_rules! functions {
    ($($field:ident = $symbol:literal: fn($($argument:ty),*) $(-> $result:ty)?;)*) => {
        /// The C functions, by their names in `oidn.h` without `oidn`.
        #[derive(Debug)]
        pub struct Functions {
            $(pub $field: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
        }

        impl Functions {
            /// Binds all of them, or names the one that is missing.
            pub fn bind(library: &libloading::Library) -> Result<Self, libloading::Error> {
                // SAFETY: the signatures are those of `oidn.h` of version 2, whose major number is in the file's name.
                unsafe { Ok(Self { $($field: *library.get($symbol)?,)* }) }
            }
        }
    };
}

functions! {
    get_num_physical_devices = b"oidnGetNumPhysicalDevices\0": fn() -> c_int;
    get_physical_device_int = b"oidnGetPhysicalDeviceInt\0": fn(c_int, *const c_char) -> c_int;
    new_device_by_id = b"oidnNewDeviceByID\0": fn(c_int) -> Handle;
    commit_device = b"oidnCommitDevice\0": fn(Handle);
    release_device = b"oidnReleaseDevice\0": fn(Handle);
    set_device_bool = b"oidnSetDeviceBool\0": fn(Handle, *const c_char, bool);
    get_device_int = b"oidnGetDeviceInt\0": fn(Handle, *const c_char) -> c_int;
    get_device_error = b"oidnGetDeviceError\0": fn(Handle, *mut *const c_char) -> c_int;
    new_buffer = b"oidnNewBuffer\0": fn(Handle, usize) -> Handle;
    release_buffer = b"oidnReleaseBuffer\0": fn(Handle);
    write_buffer = b"oidnWriteBuffer\0": fn(Handle, usize, usize, *const c_void);
    read_buffer = b"oidnReadBuffer\0": fn(Handle, usize, usize, *mut c_void);
    new_filter = b"oidnNewFilter\0": fn(Handle, *const c_char) -> Handle;
    release_filter = b"oidnReleaseFilter\0": fn(Handle);
    set_filter_image = b"oidnSetFilterImage\0":
        fn(Handle, *const c_char, Handle, c_int, usize, usize, usize, usize, usize);
    set_filter_bool = b"oidnSetFilterBool\0": fn(Handle, *const c_char, bool);
    set_filter_int = b"oidnSetFilterInt\0": fn(Handle, *const c_char, c_int);
    get_filter_int = b"oidnGetFilterInt\0": fn(Handle, *const c_char) -> c_int;
    set_filter_float = b"oidnSetFilterFloat\0": fn(Handle, *const c_char, f32);
    set_filter_progress_monitor = b"oidnSetFilterProgressMonitorFunction\0":
        fn(Handle, Option<ProgressMonitor>, *mut c_void);
    commit_filter = b"oidnCommitFilter\0": fn(Handle);
    execute_filter = b"oidnExecuteFilter\0": fn(Handle);
}

/// A text without line ends.
pub fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A message of the library; empty for null.
pub unsafe fn message(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: as promised.
    one_line(&unsafe { CStr::from_ptr(text) }.to_string_lossy())
}
