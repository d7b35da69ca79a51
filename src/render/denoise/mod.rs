//! Denoising by Open Image Denoise, if installed, with an estimate of the remaining error.
//!
//! Both halves of the samples are denoised separately, each guided by the first-hit guides of its own samples. The result is
//! their mean. The halves' common part and their difference give the error estimate ([`crate::analysis::denoised`]).

mod device_choice;
pub mod fetch;
mod filter;
mod functions;
mod library;
mod library_error;
mod picture;

use std::{ffi::c_int, sync::Arc, sync::atomic::AtomicBool, time::Instant};

pub use device_choice::DenoiseDevice;
use filter::{Device, Filter, QUALITY_FAST, QUALITY_HIGH};
pub use library::{Library, data_folder};
pub use library_error::{FOLDER_VARIABLE, LibraryError};
use picture::NoisyHalf;
pub use picture::{Denoised, Noisy};

use crate::{
    analysis::denoised::{Colors, DenoisedHalves, Errors},
    document::Denoise,
    render::MachineOptions,
};

/// Pixels per filter run at most. Larger images are filtered in bands, to bound memory.
const PIXELS_MAX: usize = 1 << 22;
/// Filters kept besides the latest, and the most pixels of such a filter. The window alternates between reduced and full
/// size, fast and high, and preparing a filter takes a tenth of the first image's time.
const FILTERS_KEPT: usize = 3;
const PIXELS_KEPT: usize = 1 << 19;

/// A denoiser; it denoises one image at a time.
pub struct Denoiser {
    device: Arc<Device>,
    /// Most recently used first.
    filters: Vec<Filter>,
    pixels_max: usize,
}

impl Denoiser {
    /// A denoiser on the chosen device.
    pub fn open() -> Result<Self, LibraryError> {
        Ok(Self {
            device: Arc::new(Device::of(
                Library::get()?.functions,
                MachineOptions::get().denoise_device,
            )?),
            filters: Vec::new(),
            pixels_max: PIXELS_MAX,
        })
    }

    /// Goes over to the CPU, after an error of the GPU.
    fn leave_gpu(&mut self, error: &LibraryError) -> Result<(), LibraryError> {
        log::warn!(
            "the {} device stopped denoising ({error}), so the CPU denoises",
            self.device.kind_name()
        );
        self.filters.clear();
        self.device = Arc::new(Device::of(Library::get()?.functions, DenoiseDevice::Cpu)?);
        Ok(())
    }

    /// The same with bands of at most `pixels_max` pixels.
    pub fn in_bands_of(self, pixels_max: usize) -> Self {
        Self { pixels_max, ..self }
    }

    /// Denoises a render. Returns the render itself if it has no samples.
    pub fn denoise(&mut self, noisy: &Noisy, mode: Denoise) -> Result<Denoised, LibraryError> {
        self.denoise_cancellable(noisy, mode, &AtomicBool::new(false))
    }

    /// The same; cancelled soon after `cancel` becomes true. Where a GPU fails, the CPU denoises.
    pub fn denoise_cancellable(
        &mut self,
        noisy: &Noisy,
        mode: Denoise,
        cancel: &AtomicBool,
    ) -> Result<Denoised, LibraryError> {
        match self.denoise_on_device(noisy, mode, cancel) {
            Err(error @ LibraryError::Device(_)) if self.device.is_gpu() => {
                self.leave_gpu(&error)?;
                self.denoise_on_device(noisy, mode, cancel)
            }
            outcome => outcome,
        }
    }

    fn denoise_on_device(
        &mut self,
        noisy: &Noisy,
        mode: Denoise,
        cancel: &AtomicBool,
    ) -> Result<Denoised, LibraryError> {
        let start = Instant::now();
        let quality = match mode {
            Denoise::Off => return Ok(Denoised::untouched(noisy)),
            Denoise::Fast => QUALITY_FAST,
            Denoise::High | Denoise::Auto => QUALITY_HIGH,
        };
        let present: Vec<&NoisyHalf> = noisy.halves.iter().flatten().collect();
        if present.is_empty() || noisy.size.contains(&0) {
            return Ok(Denoised::untouched(noisy));
        }
        let size = noisy.size;
        let mut denoise = |images: Images<'_>, scale: f32| {
            let how = How { quality, scale, cancel };
            self.denoise_image(images, size, how)
        };
        // Each half has its own scale, so that the halves stay independent.
        let mut denoise_half = |half: &NoisyHalf| {
            let NoisyHalf { color, albedo, normal } = half;
            denoise([color, albedo, normal], picture::input_scale(color, size))
        };
        let mut done = Denoised::untouched(noisy);
        let colors = match present[..] {
            [even, odd] => {
                let denoised = [denoise_half(even)?, denoise_half(odd)?];
                let errors = Errors::of(&DenoisedHalves {
                    noisy: [&even.color, &odd.color],
                    denoised: [&denoised[0], &denoised[1]],
                    width: size[0],
                });
                let shares = (mode == Denoise::Auto).then(|| errors.shares());
                done.error = Some(errors.error(shares.as_deref()));
                done.bias = Some(errors.bias(shares.as_deref()));
                done.error_map = noisy.spread(&errors.map(shares.as_deref()));
                noisy.mixed(&denoised, shares.as_deref())
            }
            _ => denoise_half(present[0])?,
        };
        let alpha = noisy.alphas();
        let alpha = if alpha.iter().any(|alpha| *alpha < 1.0) {
            let grey: Colors = alpha.iter().map(|alpha| [*alpha; 3]).collect();
            let [albedo, normal] = &noisy.guides();
            denoise([&grey, albedo, normal], 1.0)?
                .iter()
                .map(|[alpha, ..]| alpha.clamp(0.0, 1.0))
                .collect()
        } else {
            alpha
        };
        done.image = Arc::new(noisy.with(&colors, &alpha));
        done.seconds = start.elapsed().as_secs_f64();
        Ok(done)
    }

    /// Frees what large images took: several hundred MB.
    pub fn release_large(&mut self) {
        self.filters.retain(|filter| filter.pixels() <= PIXELS_KEPT);
    }

    fn filter(&mut self, size: [usize; 2], quality: c_int) -> Result<&mut Filter, LibraryError> {
        let filter = match self.filters.iter().position(|filter| filter.fits(size, quality)) {
            Some(place) => self.filters.remove(place),
            None => {
                self.release_large();
                self.filters.truncate(FILTERS_KEPT);
                Filter::new(&self.device, size, quality)?
            }
        };
        self.filters.insert(0, filter);
        Ok(&mut self.filters[0])
    }

    /// Denoises an image, in bands if it is large.
    fn denoise_image(&mut self, images: Images<'_>, size: [usize; 2], how: How<'_>) -> Result<Colors, LibraryError> {
        let [width, height] = size;
        if width * height <= self.pixels_max {
            return self.denoise_band(images, size, how);
        }
        let [overlap, alignment] = self.filter([width, 1], how.quality)?.overlap_and_alignment();
        let rows = ((self.pixels_max / width).saturating_sub(2 * overlap) / alignment).max(1) * alignment;
        let mut denoised = Colors::with_capacity(width * height);
        for first in (0..height).step_by(rows) {
            let last = (first + rows).min(height);
            // Bands start at an aligned row.
            let from = first.saturating_sub(overlap) / alignment * alignment;
            let to = (last + overlap).min(height);
            let of_band = images.map(|image| &image[from * width..to * width]);
            let band = self.denoise_band(of_band, [width, to - from], how)?;
            denoised.extend_from_slice(&band[(first - from) * width..(last - from) * width]);
        }
        Ok(denoised)
    }

    fn denoise_band(&mut self, images: Images<'_>, size: [usize; 2], how: How<'_>) -> Result<Colors, LibraryError> {
        let filter = self.filter(size, how.quality)?;
        let mut denoised = filter.run(images, how.scale, how.cancel)?;
        // Radiance is finite and not negative; the filter does not guarantee it.
        for value in denoised.iter_mut().flatten() {
            *value = if value.is_finite() { value.max(0.0) } else { 0.0 };
        }
        Ok(denoised)
    }
}

/// Colours, albedo and normals.
type Images<'a> = [&'a [[f32; 3]]; 3];

/// Parameters of filtering one image.
#[derive(Clone, Copy)]
struct How<'a> {
    quality: c_int,
    scale: f32,
    cancel: &'a AtomicBool,
}
