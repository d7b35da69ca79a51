//! A safe wrapper of Open Image Denoise's filter.

use std::{
    ffi::{CStr, c_int, c_void},
    ptr,
    sync::Arc,
    sync::atomic::{AtomicBool, Ordering::Relaxed},
};

use super::{
    device_choice::{CPU, DenoiseDevice, kind_name},
    functions::{Functions, Handle, message},
    library_error::LibraryError,
};

/// `OIDN_FORMAT_FLOAT3`.
const FLOAT3: c_int = 3;
/// `OIDN_QUALITY_FAST`, which takes about half the time, and `OIDN_QUALITY_HIGH`.
pub const QUALITY_FAST: c_int = 4;
pub const QUALITY_HIGH: c_int = 6;
/// `OIDN_ERROR_CANCELLED`.
const CANCELLED: c_int = 6;
/// Memory limit of the library in MB; it cuts larger images into tiles, which give the same bits and take longer where they
/// overlap.
const MEMORY_MB: c_int = 600;
/// Pixels of mirrored padding on each side. Without it, the library tints the border: in the corners of a uniform image by
/// up to 80 %.
const BORDER: usize = 16;

/// A handle of the library's, released with this.
struct Owned {
    handle: Handle,
    release: unsafe extern "C" fn(Handle),
}

// SAFETY: the library's handles may be used from any thread; filters and buffers are used from one at a time, and what is
// called through a shared device (making buffers and filters, asking for errors, which the library keeps by thread) the
// library guards itself.
unsafe impl Send for Owned {}
// SAFETY: as above.
unsafe impl Sync for Owned {}

impl Drop for Owned {
    fn drop(&mut self) {
        if !self.handle.is_null() {
            // SAFETY: live, and released once. What a handle refers to is released after it: the fields of a structure are
            // dropped in their order, and the device is held by an `Arc`.
            unsafe { (self.release)(self.handle) };
        }
    }
}

/// A device of the library.
pub struct Device {
    own: Owned,
    functions: &'static Functions,
    kind: c_int,
}

impl Device {
    /// The first device that works of those that the choice names.
    pub fn of(functions: &'static Functions, choice: DenoiseDevice) -> Result<Self, LibraryError> {
        // SAFETY: the library is asked for its devices, and then for each of them by its number.
        let count = unsafe { (functions.get_num_physical_devices)() };
        let kinds: Vec<c_int> = (0..count)
            .map(|id| unsafe { (functions.get_physical_device_int)(id, c"type".as_ptr()) })
            .collect();
        let mut failure = LibraryError::Device("there is no device for it".to_owned());
        for place in choice.candidates(&kinds) {
            match Self::open(functions, place as c_int, kinds[place]) {
                Ok(device) => return Ok(device),
                Err(error) => {
                    log::info!(
                        "the denoiser's {} device does not work: {error}",
                        kind_name(kinds[place])
                    );
                    failure = error;
                }
            }
        }
        Err(failure)
    }

    fn open(functions: &'static Functions, id: c_int, kind: c_int) -> Result<Self, LibraryError> {
        let own = Owned {
            // SAFETY: the number is one of the library's; a null handle is an answer.
            handle: unsafe { (functions.new_device_by_id)(id) },
            release: functions.release_device,
        };
        if !own.handle.is_null() {
            // SAFETY: the handle is live, the name a C string. Threads bound to cores would get in our own's way.
            unsafe {
                (functions.set_device_bool)(own.handle, c"setAffinity".as_ptr(), false);
                (functions.commit_device)(own.handle);
            }
        }
        let device = Self { own, functions, kind };
        device.check()?;
        Ok(device)
    }

    /// Whether it is a GPU.
    pub fn is_gpu(&self) -> bool {
        self.kind != CPU
    }

    /// Name of its kind.
    pub fn kind_name(&self) -> &'static str {
        kind_name(self.kind)
    }

    /// An integer parameter of the device.
    pub fn int(&self, name: &CStr) -> i32 {
        // SAFETY: the handle is live.
        unsafe { (self.functions.get_device_int)(self.own.handle, name.as_ptr()) }
    }

    /// The error of the calls since the last check; with a null handle, the reason why there is no device.
    fn check(&self) -> Result<(), LibraryError> {
        let mut text = ptr::null();
        // SAFETY: the message lives until the next error of this thread.
        let (code, text) = unsafe {
            let code = (self.functions.get_device_error)(self.own.handle, &raw mut text);
            (code, message(text))
        };
        match (code, self.own.handle.is_null()) {
            (0, false) => Ok(()),
            (CANCELLED, _) => Err(LibraryError::Cancelled),
            (0, true) => Err(LibraryError::Device("there is no device for it".to_owned())),
            _ => Err(LibraryError::Device(text)),
        }
    }
}

/// A filter for images of one size, guided by albedo and normal.
pub struct Filter {
    own: Owned,
    /// In the device's memory: colour, albedo, normal, and the output.
    images: [Owned; 4],
    device: Arc<Device>,
    size: [usize; 2],
    quality: c_int,
    /// The input scale with which the filter was committed.
    input_scale: f32,
}

impl Filter {
    /// A filter for images of `size` (width, height) in pixels.
    pub fn new(device: &Arc<Device>, size: [usize; 2], quality: c_int) -> Result<Self, LibraryError> {
        let functions = device.functions;
        let [width, height] = padded_size(size);
        let image = || Owned {
            // SAFETY: the device is live.
            handle: unsafe { (functions.new_buffer)(device.own.handle, width * height * size_of::<[f32; 3]>()) },
            release: functions.release_buffer,
        };
        let filter = Self {
            own: Owned {
                // SAFETY: the device is live, the name a C string.
                handle: unsafe { (functions.new_filter)(device.own.handle, c"RT".as_ptr()) },
                release: functions.release_filter,
            },
            images: std::array::from_fn(|_| image()),
            device: device.clone(),
            size,
            quality,
            input_scale: 0.0,
        };
        device.check()?;
        let handle = filter.own.handle;
        for (name, image) in [c"color", c"albedo", c"normal", c"output"].iter().zip(&filter.images) {
            let (name, set) = (name.as_ptr(), functions.set_filter_image);
            // SAFETY: the buffer has width × height pixels of this format and lives as long as the filter.
            unsafe { set(handle, name, image.handle, FLOAT3, width, height, 0, 0, 0) };
        }
        // SAFETY: the filter is live, the names are C strings.
        unsafe {
            (functions.set_filter_bool)(handle, c"hdr".as_ptr(), true);
            (functions.set_filter_int)(handle, c"quality".as_ptr(), quality);
            (functions.set_filter_int)(handle, c"maxMemoryMB".as_ptr(), MEMORY_MB);
        }
        device.check()?;
        Ok(filter)
    }

    /// Whether the filter has this size and quality.
    pub fn fits(&self, size: [usize; 2], quality: c_int) -> bool {
        (self.size, self.quality) == (size, quality)
    }

    /// Number of pixels of its images.
    pub fn pixels(&self) -> usize {
        self.size.iter().product()
    }

    /// Overlap of separately filtered parts, and alignment of their positions, both in pixels.
    pub fn overlap_and_alignment(&self) -> [usize; 2] {
        // SAFETY: the filter is live. The library knows both only after a commit.
        unsafe { (self.device.functions.commit_filter)(self.own.handle) };
        let number = |name: &CStr| {
            // SAFETY: the filter is live.
            let value = unsafe { (self.device.functions.get_filter_int)(self.own.handle, name.as_ptr()) };
            usize::try_from(value).unwrap_or(0)
        };
        [number(c"tileOverlap"), number(c"tileAlignment").max(1)]
    }

    /// Denoises colours by albedo (in [0, 1]: share of the light that is reflected or transmitted) and normal (in world
    /// space, of length at most 1). `input_scale` maps the image's middle grey to 0.18, where the filter works best. Ends
    /// with [`LibraryError::Cancelled`] soon after `cancel` becomes true.
    pub fn run(
        &mut self,
        images: [&[[f32; 3]]; 3],
        input_scale: f32,
        cancel: &AtomicBool,
    ) -> Result<Vec<[f32; 3]>, LibraryError> {
        let (functions, handle) = (self.device.functions, self.own.handle);
        for (pixels, image) in images.iter().zip(&self.images) {
            let padded = padded(pixels, self.size);
            // SAFETY: as many bytes as the buffer has are read from the vector.
            unsafe {
                let from = padded.as_ptr().cast::<c_void>();
                (functions.write_buffer)(image.handle, 0, size_of_val(&padded[..]), from);
            }
        }
        // SAFETY: the filter and what it refers to are live; the flag outlives the monitor, which is taken away again.
        unsafe {
            if self.input_scale != input_scale {
                (functions.set_filter_float)(handle, c"inputScale".as_ptr(), input_scale);
                (functions.commit_filter)(handle);
                self.input_scale = input_scale;
            }
            let flag = ptr::from_ref(cancel).cast_mut().cast();
            (functions.set_filter_progress_monitor)(handle, Some(continues), flag);
            (functions.execute_filter)(handle);
            (functions.set_filter_progress_monitor)(handle, None, ptr::null_mut());
        }
        self.device.check()?;
        let mut output = vec![[0.0; 3]; padded_size(self.size).iter().product()];
        // SAFETY: as many bytes as the buffer has are written to the vector's elements.
        unsafe {
            let to = output.as_mut_ptr().cast::<c_void>();
            (functions.read_buffer)(self.images[3].handle, 0, size_of_val(&output[..]), to);
        }
        Ok(cropped(&output, self.size))
    }
}

/// Progress callback over a cancellation flag: a [`ProgressMonitor`](super::functions::ProgressMonitor) that returns false to
/// cancel.
unsafe extern "C" fn continues(cancel: *mut c_void, _share: f64) -> bool {
    // SAFETY: the pointer is that of the flag which `Filter::run` was given.
    !unsafe { &*cancel.cast::<AtomicBool>() }.load(Relaxed)
}

fn padded_size(size: [usize; 2]) -> [usize; 2] {
    size.map(|side| side + 2 * BORDER)
}

/// Index in a row of `side` pixels that is mirrored to index `place` of the padded row.
fn mirrored(place: usize, side: usize) -> usize {
    let period = 2 * side;
    let along = (place + period * BORDER - BORDER) % period;
    along.min(period - 1 - along)
}

/// An image with mirrored padding.
fn padded(pixels: &[[f32; 3]], [width, height]: [usize; 2]) -> Vec<[f32; 3]> {
    let [columns, rows] = padded_size([width, height]);
    let row = |y: usize| &pixels[mirrored(y, height) * width..][..width];
    (0..rows)
        .map(row)
        .flat_map(|row| (0..columns).map(|x| row[mirrored(x, width)]))
        .collect()
}

/// An image without its padding.
fn cropped(pixels: &[[f32; 3]], [width, height]: [usize; 2]) -> Vec<[f32; 3]> {
    let rows = pixels.chunks_exact(width + 2 * BORDER).skip(BORDER).take(height);
    rows.flat_map(|row| &row[BORDER..BORDER + width]).copied().collect()
}
