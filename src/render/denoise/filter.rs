//! A safe wrapper of Open Image Denoise's filter.

use std::ffi::{CStr, c_int, c_void};
use std::ptr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use super::device_choice::{DenoiseDevice, DeviceKind};
use super::functions::{BufferHandle, DeviceHandle, FilterHandle, Functions, message};
use super::library_error::LibraryError;

/// `OIDN_STORAGE_HOST` and `OIDN_STORAGE_MANAGED`.
const STORAGE_HOST: c_int = 1;
const STORAGE_MANAGED: c_int = 3;
/// `OIDN_FORMAT_FLOAT3`.
const FLOAT3: c_int = 3;
/// `OIDN_QUALITY_FAST` and `OIDN_QUALITY_HIGH`.
const QUALITY_FAST: c_int = 4;
const QUALITY_HIGH: c_int = 6;
/// `OIDN_ERROR_CANCELLED`.
const CANCELLED: c_int = 6;
/// Memory limit of the library in MB; it cuts larger images into tiles.
const MEMORY_MB: c_int = 1500;
/// Pixels of mirrored padding on each side. Without it, the library tints the border: in the corners of a uniform image by
/// up to 80 %.
const BORDER: usize = 16;
/// Bytes per pixel.
const PIXEL_BYTES: usize = size_of::<[f32; 3]>();

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// About half the time of `High`.
    Fast,
    /// The library's best quality.
    High,
}

// SAFETY: the library's handles may be used from any thread; each of these values is used from one at a time.
unsafe impl Send for Device<'_> {}
// SAFETY: what is called through a shared device (making buffers and filters, asking for errors, which the library keeps
// by thread) the library guards itself.
unsafe impl Sync for Device<'_> {}
// SAFETY: as of the device.
unsafe impl Send for Buffer<'_> {}
// SAFETY: as of the device.
unsafe impl Send for Filter<'_> {}

/// A device of the library.
pub(super) struct Device<'a> {
    functions: &'a Functions,
    handle: DeviceHandle,
    kind: DeviceKind,
}

impl<'a> Device<'a> {
    /// The first device that works of those that the choice names.
    pub(super) fn of(functions: &'a Functions, choice: DenoiseDevice) -> Result<Self, LibraryError> {
        // SAFETY: the library is asked for its devices, and then for each of them by its number.
        let count = unsafe { (functions.get_num_physical_devices)() };
        let kind = |id| DeviceKind::of(unsafe { (functions.get_physical_device_int)(id, c"type".as_ptr()) });
        let kinds: Vec<DeviceKind> = (0..count).map(kind).collect();
        let mut failure = LibraryError::Device("there is no device for it".to_owned());
        for place in choice.candidates(&kinds) {
            match Self::open(functions, place as c_int, kinds[place]) {
                Ok(device) => {
                    if choice == DenoiseDevice::Gpu && !device.is_gpu() {
                        warn_once(&format!("no GPU can denoise here ({failure}), so the CPU does"));
                    }
                    return Ok(device);
                }
                Err(error) => {
                    log::info!("the denoiser's {} device does not work: {error}", kinds[place].name());
                    failure = error;
                }
            }
        }
        Err(failure)
    }

    fn open(functions: &'a Functions, id: c_int, kind: DeviceKind) -> Result<Self, LibraryError> {
        // SAFETY: the number is one of the library's; a null handle is an answer.
        let handle = unsafe { (functions.new_device_by_id)(id) };
        let device = Self {
            functions,
            handle,
            kind,
        };
        if !handle.is_null() {
            // SAFETY: the handle is live, the name a C string. Threads bound to cores would get in our own's way.
            unsafe {
                (functions.set_device_bool)(handle, c"setAffinity".as_ptr(), false);
                (functions.commit_device)(handle);
            }
        }
        device.check()?;
        Ok(device)
    }

    /// Whether it is a GPU.
    pub(super) fn is_gpu(&self) -> bool {
        self.kind != DeviceKind::Cpu
    }

    /// Name of its kind.
    pub(super) fn kind_name(&self) -> &'static str {
        self.kind.name()
    }

    /// An integer parameter of the device.
    pub(super) fn int(&self, name: &CStr) -> i32 {
        // SAFETY: the handle is live.
        unsafe { (self.functions.get_device_int)(self.handle, name.as_ptr()) }
    }

    /// The error of the calls since the last check; with a null handle, the reason why there is no device.
    fn check(&self) -> Result<(), LibraryError> {
        let mut text = ptr::null();
        // SAFETY: the message lives until the next error of this thread.
        let (code, text) = unsafe {
            let code = (self.functions.get_device_error)(self.handle, &raw mut text);
            (code, message(text))
        };
        match (code, self.handle.is_null()) {
            (0, false) => Ok(()),
            (CANCELLED, _) => Err(LibraryError::Cancelled),
            (0, true) => Err(LibraryError::Device("there is no device for it".to_owned())),
            _ => Err(LibraryError::Device(text)),
        }
    }
}

impl Drop for Device<'_> {
    fn drop(&mut self) {
        if !self.handle.is_null() {
            // SAFETY: live, and nothing of the device is left: filters and buffers hold it by an `Arc`.
            unsafe { (self.functions.release_device)(self.handle) };
        }
    }
}

/// Logs a warning, if it is the first one: devices are opened more than once.
fn warn_once(text: &str) {
    static WAS_SAID: AtomicBool = AtomicBool::new(false);
    if !WAS_SAID.swap(true, Relaxed) {
        log::warn!("{text}");
    }
}

/// An RGB image in the device's memory.
struct Buffer<'a> {
    device: Arc<Device<'a>>,
    handle: BufferHandle,
    pixels: usize,
}

impl<'a> Buffer<'a> {
    fn new(device: &Arc<Device<'a>>, pixels: usize) -> Result<Self, LibraryError> {
        // SAFETY: the device is live.
        let handle = unsafe { (device.functions.new_buffer)(device.handle, pixels * PIXEL_BYTES) };
        let buffer = Self {
            device: device.clone(),
            handle,
            pixels,
        };
        device.check()?;
        Ok(buffer)
    }

    /// The pixels where the host sees the buffer's own memory, as on the CPU and on GPUs that share memory with it.
    fn in_place(&self) -> Option<*mut [f32; 3]> {
        let functions = self.device.functions;
        // SAFETY: the buffer is live. Of other storage the address is not the host's, and is not used.
        let (storage, data) = unsafe {
            let storage = (functions.get_buffer_storage)(self.handle);
            (storage, (functions.get_buffer_data)(self.handle))
        };
        (matches!(storage, STORAGE_HOST | STORAGE_MANAGED) && !data.is_null()).then(|| data.cast())
    }

    /// Has `fill` write all pixels: into the buffer's memory, else with one copy.
    fn write(&mut self, fill: impl FnOnce(&mut [[f32; 3]])) {
        if let Some(data) = self.in_place() {
            // SAFETY: so many pixels lie there, which nothing else uses: the filter does not run.
            return fill(unsafe { std::slice::from_raw_parts_mut(data, self.pixels) });
        }
        let mut values = vec![[0.0; 3]; self.pixels];
        fill(&mut values);
        // SAFETY: as many bytes as the buffer has are read from the vector.
        unsafe {
            let from = values.as_ptr().cast::<c_void>();
            (self.device.functions.write_buffer)(self.handle, 0, size_of_val(&values[..]), from);
        }
    }

    /// Has `take` read all pixels: in the buffer's memory, else in one copy.
    fn read<A>(&self, take: impl FnOnce(&[[f32; 3]]) -> A) -> A {
        if let Some(data) = self.in_place() {
            // SAFETY: as in `write`.
            return take(unsafe { std::slice::from_raw_parts(data, self.pixels) });
        }
        let mut values = vec![[0.0; 3]; self.pixels];
        // SAFETY: as many bytes as the buffer has are written to the vector's elements.
        unsafe {
            let to = values.as_mut_ptr().cast::<c_void>();
            (self.device.functions.read_buffer)(self.handle, 0, size_of_val(&values[..]), to);
        }
        take(&values)
    }
}

impl Drop for Buffer<'_> {
    fn drop(&mut self) {
        if !self.handle.is_null() {
            // SAFETY: live, and released once.
            unsafe { (self.device.functions.release_buffer)(self.handle) };
        }
    }
}

/// Guide images, by which the filter preserves edges and textures.
#[derive(Clone, Copy, Debug)]
pub struct Guides<'a> {
    /// Albedo in [0, 1]: share of the light that is reflected or transmitted.
    pub albedo: &'a [[f32; 3]],
    /// Shading normal in world space, of length at most 1.
    pub normal: &'a [[f32; 3]],
}

/// A filter with guides for images of one size.
pub(super) struct Filter<'a> {
    device: Arc<Device<'a>>,
    handle: FilterHandle,
    size: [usize; 2],
    quality: Quality,
    color: Buffer<'a>,
    albedo: Buffer<'a>,
    normal: Buffer<'a>,
    output: Buffer<'a>,
    /// The input scale with which the filter was committed.
    input_scale: f32,
}

impl<'a> Filter<'a> {
    /// A filter for images of `size` (width, height) in pixels.
    pub(super) fn new(device: &Arc<Device<'a>>, size: [usize; 2], quality: Quality) -> Result<Self, LibraryError> {
        let functions = device.functions;
        let pixels = padded_size(size).iter().product();
        // SAFETY: the device is live, the name a C string.
        let handle = unsafe { (functions.new_filter)(device.handle, c"RT".as_ptr()) };
        let filter = Self {
            device: device.clone(),
            handle,
            size,
            quality,
            color: Buffer::new(device, pixels)?,
            albedo: Buffer::new(device, pixels)?,
            normal: Buffer::new(device, pixels)?,
            output: Buffer::new(device, pixels)?,
            input_scale: 0.0,
        };
        device.check()?;
        let level = match quality {
            Quality::Fast => QUALITY_FAST,
            Quality::High => QUALITY_HIGH,
        };
        filter.set_image(c"color", &filter.color);
        filter.set_image(c"albedo", &filter.albedo);
        filter.set_image(c"normal", &filter.normal);
        filter.set_image(c"output", &filter.output);
        // SAFETY: the filter is live, the names are C strings.
        unsafe {
            (functions.set_filter_bool)(handle, c"hdr".as_ptr(), true);
            (functions.set_filter_int)(handle, c"quality".as_ptr(), level);
            (functions.set_filter_int)(handle, c"maxMemoryMB".as_ptr(), MEMORY_MB);
        }
        device.check()?;
        Ok(filter)
    }

    fn set_image(&self, name: &CStr, buffer: &Buffer<'_>) {
        let [width, height] = padded_size(self.size);
        // SAFETY: the buffer has width × height pixels of this format and lives as long as the filter.
        unsafe {
            let set = self.device.functions.set_filter_image;
            set(
                self.handle,
                name.as_ptr(),
                buffer.handle,
                FLOAT3,
                width,
                height,
                0,
                0,
                0,
            );
        }
    }

    /// Whether the filter has this size and quality.
    pub(super) fn fits(&self, size: [usize; 2], quality: Quality) -> bool {
        (self.size, self.quality) == (size, quality)
    }

    /// Number of pixels of its images.
    pub(super) fn pixels(&self) -> usize {
        self.size.iter().product()
    }

    /// Overlap of separately filtered parts, and alignment of their positions, both in pixels.
    pub(super) fn overlap_and_alignment(&self) -> [usize; 2] {
        // The library knows both only after a commit.
        unsafe { (self.device.functions.commit_filter)(self.handle) };
        let number = |name: &CStr| {
            // SAFETY: the filter is live.
            let value = unsafe { (self.device.functions.get_filter_int)(self.handle, name.as_ptr()) };
            usize::try_from(value).unwrap_or(0)
        };
        [number(c"tileOverlap"), number(c"tileAlignment").max(1)]
    }

    /// Sets the guides of the following runs.
    pub(super) fn set_guides(&mut self, guides: Guides<'_>) {
        let size = self.size;
        self.albedo.write(|to| pad(guides.albedo, size, to));
        self.normal.write(|to| pad(guides.normal, size, to));
    }

    /// Denoises an image. `input_scale` maps its middle grey to 0.18, where the filter works best. Ends with
    /// [`LibraryError::Cancelled`] soon after `cancel` becomes true.
    pub(super) fn run(
        &mut self,
        color: &[[f32; 3]],
        input_scale: f32,
        cancel: &AtomicBool,
    ) -> Result<Vec<[f32; 3]>, LibraryError> {
        let functions = self.device.functions;
        let size = self.size;
        self.color.write(|to| pad(color, size, to));
        // SAFETY: the filter and what it refers to are live; the flag outlives the monitor, which is taken away again.
        unsafe {
            if self.input_scale != input_scale {
                (functions.set_filter_float)(self.handle, c"inputScale".as_ptr(), input_scale);
                (functions.commit_filter)(self.handle);
                self.input_scale = input_scale;
            }
            let flag = ptr::from_ref(cancel).cast_mut().cast();
            (functions.set_filter_progress_monitor)(self.handle, Some(continues), flag);
            (functions.execute_filter)(self.handle);
            (functions.set_filter_progress_monitor)(self.handle, None, ptr::null_mut());
        }
        self.device.check()?;
        Ok(self.output.read(|pixels| cropped(pixels, size)))
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

/// Writes an image with mirrored padding.
fn pad(pixels: &[[f32; 3]], [width, height]: [usize; 2], to: &mut [[f32; 3]]) {
    let [columns, _] = padded_size([width, height]);
    for (y, row) in to.chunks_exact_mut(columns).enumerate() {
        let from = &pixels[mirrored(y, height) * width..][..width];
        for (x, pixel) in row.iter_mut().enumerate() {
            *pixel = from[mirrored(x, width)];
        }
    }
}

/// An image without its padding.
fn cropped(pixels: &[[f32; 3]], [width, height]: [usize; 2]) -> Vec<[f32; 3]> {
    let columns = width + 2 * BORDER;
    let rows = pixels.chunks_exact(columns).skip(BORDER).take(height);
    rows.flat_map(|row| &row[BORDER..BORDER + width]).copied().collect()
}

impl Drop for Filter<'_> {
    fn drop(&mut self) {
        if !self.handle.is_null() {
            // SAFETY: live, and released once; what it refers to is released after it.
            unsafe { (self.device.functions.release_filter)(self.handle) };
        }
    }
}
