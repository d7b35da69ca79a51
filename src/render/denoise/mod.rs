//! Pictures without their noise, by Open Image Denoise where it is installed, with the error that is left.
//!
//! Both halves of the samples are denoised by themselves, each led by what its own samples saw first: the picture is
//! their mean, and what they have in common and what not tells how far it is from the truth
//! ([`crate::analysis::denoised`]).

mod filter;
mod library;
mod picture;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use filter::{Device, Filter};
pub use filter::{Guides, Quality};
pub use library::{FOLDER_VARIABLE, Library, LibraryError, data_folder};
use picture::NoisyHalf;
pub use picture::{Denoised, Noisy};

use crate::analysis::denoised::{Colors, DenoisedHalves, Errors};
use crate::document::Denoise;

/// Pixels that are filtered at once: larger pictures in bands, so that the memory that it takes is bounded.
const PIXELS_MAX: usize = 1 << 22;
/// Filters that are kept for the next picture besides the latest, and the most pixels of such: the window goes to and fro
/// between a small picture and the full one, fast and high, and making a filter ready takes a tenth of the first look's time.
const FILTERS_KEPT: usize = 3;
const PIXELS_KEPT: usize = 1 << 19;

/// Makes denoised pictures, one at a time.
pub struct Denoiser {
    device: Arc<Device<'static>>,
    /// The latest first.
    filters: Vec<Filter<'static>>,
    pixels_max: usize,
}

impl Denoiser {
    /// Opens the library's fastest device.
    ///
    /// # Errors
    /// [`LibraryError`] in one line that says what to do.
    pub fn open() -> Result<Self, LibraryError> {
        let device = Arc::new(Device::of(Library::get()?)?);
        Ok(Self {
            device,
            filters: Vec::new(),
            pixels_max: PIXELS_MAX,
        })
    }

    /// The same, but pictures of more pixels than this are filtered in bands.
    pub fn in_bands_of(self, pixels_max: usize) -> Self {
        Self { pixels_max, ..self }
    }

    /// The picture without its noise; the same where nothing was rendered.
    ///
    /// # Errors
    /// Where the library fails.
    pub fn denoise(&mut self, noisy: &Noisy, how: Denoise) -> Result<Denoised, LibraryError> {
        self.denoise_unless(noisy, how, &AtomicBool::new(false))
    }

    /// The same, given up soon after `stops` has become true.
    ///
    /// # Errors
    /// [`LibraryError::Stopped`] then; where the library fails.
    pub fn denoise_unless(
        &mut self,
        noisy: &Noisy,
        how: Denoise,
        stops: &AtomicBool,
    ) -> Result<Denoised, LibraryError> {
        let begun = Instant::now();
        let quality = match how {
            Denoise::Off => return Ok(Denoised::untouched(noisy)),
            Denoise::Fast => Quality::Fast,
            Denoise::High | Denoise::Auto => Quality::High,
        };
        let present: Vec<&NoisyHalf> = noisy.halves.iter().flatten().collect();
        if present.is_empty() || noisy.size().contains(&0) {
            return Ok(Denoised::untouched(noisy));
        }
        let size = noisy.size();
        let mut clean = |color: &[[f32; 3]], guides: Guides<'_>, scale: f32| {
            let mut pass = Pass {
                denoiser: &mut *self,
                size,
                guides,
                quality,
                scale,
                stops,
            };
            pass.clean(color)
        };
        // The scale is a half's own, too.
        let mut clean_half = |half: &NoisyHalf| {
            let NoisyHalf { color, albedo, normal } = half;
            clean(color, Guides { albedo, normal }, picture::input_scale(color, size))
        };
        let mut done = Denoised::untouched(noisy);
        let colors = match present[..] {
            [even, odd] => {
                let denoised = [clean_half(even)?, clean_half(odd)?];
                let errors = Errors::of(&DenoisedHalves {
                    noisy: [&even.color, &odd.color],
                    denoised: [&denoised[0], &denoised[1]],
                    width: size[0],
                });
                let shares = (how == Denoise::Auto).then(|| errors.shares());
                done.error = Some(errors.error(shares.as_deref()));
                done.bias = Some(errors.bias(shares.as_deref()));
                done.error_map = noisy.spread(&errors.map(shares.as_deref()));
                noisy.mixed(&denoised, shares.as_deref())
            }
            _ => clean_half(present[0])?,
        };
        let alpha = noisy.alphas();
        let alpha = if alpha.iter().any(|alpha| *alpha < 1.0) {
            let grey: Colors = alpha.iter().map(|alpha| [*alpha; 3]).collect();
            let [albedo, normal] = &noisy.guides();
            let clean = clean(&grey, Guides { albedo, normal }, 1.0)?;
            clean.iter().map(|[alpha, ..]| alpha.clamp(0.0, 1.0)).collect()
        } else {
            alpha
        };
        done.image = Arc::new(noisy.with(&colors, &alpha));
        done.seconds = begun.elapsed().as_secs_f64();
        Ok(done)
    }

    fn filter(&mut self, size: [usize; 2], quality: Quality) -> Result<&mut Filter<'static>, LibraryError> {
        let known = self.filters.iter().position(|filter| filter.fits(size, quality));
        let filter = match known {
            Some(place) => self.filters.remove(place),
            None => {
                self.filters.retain(|filter| filter.pixels() <= PIXELS_KEPT);
                self.filters.truncate(FILTERS_KEPT);
                Filter::new(&self.device, size, quality)?
            }
        };
        self.filters.insert(0, filter);
        Ok(&mut self.filters[0])
    }
}

/// One filtering of a picture.
struct Pass<'a> {
    denoiser: &'a mut Denoiser,
    size: [usize; 2],
    guides: Guides<'a>,
    quality: Quality,
    scale: f32,
    stops: &'a AtomicBool,
}

impl Pass<'_> {
    /// A picture without its noise, in bands where it is large.
    fn clean(&mut self, color: &[[f32; 3]]) -> Result<Colors, LibraryError> {
        let [width, height] = self.size;
        let pixels_max = self.denoiser.pixels_max;
        if width * height <= pixels_max {
            return self.clean_rows(color, 0..height);
        }
        let filter = self.denoiser.filter([width, 1], self.quality)?;
        let [overlap, alignment] = filter.overlap_and_alignment();
        let rows = ((pixels_max / width).saturating_sub(2 * overlap) / alignment).max(1) * alignment;
        let mut clean = Colors::with_capacity(color.len());
        for first in (0..height).step_by(rows) {
            let last = (first + rows).min(height);
            // From an aligned row on, whatever the overlap.
            let from = first.saturating_sub(overlap) / alignment * alignment;
            let to = (last + overlap).min(height);
            let band = self.clean_rows(color, from..to)?;
            clean.extend_from_slice(&band[(first - from) * width..(last - from) * width]);
        }
        Ok(clean)
    }

    fn clean_rows(&mut self, color: &[[f32; 3]], rows: std::ops::Range<usize>) -> Result<Colors, LibraryError> {
        let [width, _] = self.size;
        let pixels = rows.start * width..rows.end * width;
        let filter = self.denoiser.filter([width, rows.len()], self.quality)?;
        filter.guide(Guides {
            albedo: &self.guides.albedo[pixels.clone()],
            normal: &self.guides.normal[pixels.clone()],
        });
        let mut clean = filter.run(&color[pixels], self.scale, self.stops)?;
        // No picture of ours has such numbers; the filter promises nothing.
        for value in clean.iter_mut().flatten() {
            *value = if value.is_finite() { value.max(0.0) } else { 0.0 };
        }
        Ok(clean)
    }
}
