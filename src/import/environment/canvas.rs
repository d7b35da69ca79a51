//! A canvas that is filled pixel by pixel and reduced on the fly if too large.

use super::decoded::{Picture, Source};
use super::error::EnvironmentError;
use crate::scene::environment::{MAX_HEIGHT, MAX_WIDTH, MapError, SOURCE_MAX_HEIGHT, SOURCE_MAX_WIDTH};

/// A canvas: each texel is the mean of `factor` × `factor` pixels of the file.
pub(super) struct Canvas {
    source: [u32; 2],
    factor: u32,
    width: u32,
    height: u32,
    texels: Vec<[f32; 4]>,
}

impl Canvas {
    /// An empty canvas for a file of this size, counted against the budget. Memory is only touched as pixels arrive: a header
    /// alone costs nothing.
    pub(super) fn new(source: Source<'_>, width: u64, height: u64) -> Result<Self, EnvironmentError> {
        Self::check_size(source, width, height)?;
        let size = [width as u32, height as u32];
        let mut factor = 1;
        while size[0].div_ceil(factor) > MAX_WIDTH || size[1].div_ceil(factor) > MAX_HEIGHT {
            factor *= 2;
        }
        let [width, height] = size.map(|side| side.div_ceil(factor));
        let texels = width as usize * height as usize;
        source.within(source.budget.take((texels * size_of::<[f32; 4]>()) as u64))?;
        Ok(Self {
            source: size,
            factor,
            width,
            height,
            texels: vec![[0.0; 4]; texels],
        })
    }

    /// Checks the size of a file's image.
    ///
    /// # Errors
    ///
    /// Empty sizes, and sizes beyond [`SOURCE_MAX_WIDTH`] × [`SOURCE_MAX_HEIGHT`].
    pub(super) fn check_size(source: Source<'_>, width: u64, height: u64) -> Result<(), EnvironmentError> {
        let path = source.path;
        if width == 0 || height == 0 {
            return Err(MapError::Empty {
                name: path.display().to_string(),
            }
            .into());
        }
        if width > u64::from(SOURCE_MAX_WIDTH) || height > u64::from(SOURCE_MAX_HEIGHT) {
            return Err(EnvironmentError::TooLarge {
                path: path.to_owned(),
                width,
                height,
            });
        }
        Ok(())
    }

    /// Width and height of the file's image, in pixels.
    pub(super) fn source_size(&self) -> [u32; 2] {
        self.source
    }

    /// Adds a colour at a pixel of the file's image, which must contain it.
    #[inline]
    pub(super) fn add_color(&mut self, column: u32, row: u32, color: [f32; 3]) {
        for (channel, value) in color.into_iter().enumerate() {
            self.add(column, row, channel, value);
        }
    }

    /// Adds one channel at a pixel of the file's image, which must contain it.
    #[inline]
    pub(super) fn add(&mut self, column: u32, row: u32, channel: usize, value: f32) {
        if self.factor == 1 {
            self.texels[(row * self.width + column) as usize][channel] = value;
            return;
        }
        let (x, y) = (column / self.factor, row / self.factor);
        let covered = |place: u32, side: u32| (side - place * self.factor).min(self.factor) as f32;
        let count = covered(x, self.source[0]) * covered(y, self.source[1]);
        self.texels[(y * self.width + x) as usize][channel] += value / count;
    }

    /// The image, with a warning if reduced.
    pub(super) fn finish(self) -> Picture {
        let [width, height] = self.source;
        let warnings = if self.factor == 1 {
            Vec::new()
        } else {
            vec![format!(
                "The image is {width} × {height}; it is used at {} × {}.",
                self.width, self.height
            )]
        };
        Picture {
            width: self.width,
            height: self.height,
            texels: self.texels,
            warnings,
            is_cube: false,
        }
    }
}
