//! A picture that is filled pixel by pixel and made smaller meanwhile, where it is larger than what is kept.

use std::path::Path;

use super::EnvironmentError;
use super::decoded::Picture;
use super::{MAX_HEIGHT, MAX_WIDTH, SOURCE_MAX_HEIGHT, SOURCE_MAX_WIDTH};

/// A picture in the making: each kept texel is the mean of `factor` × `factor` of the file's.
pub(super) struct Canvas {
    source: [u32; 2],
    factor: u32,
    width: u32,
    height: u32,
    texels: Vec<[f32; 4]>,
}

impl Canvas {
    /// An empty picture for a file of this size. Its memory is not touched before pixels are put into it: a header's
    /// promise alone costs nothing.
    ///
    /// # Errors
    /// Sizes of nothing, and sizes beyond [`SOURCE_MAX_WIDTH`] × [`SOURCE_MAX_HEIGHT`].
    pub(super) fn new(path: &Path, width: u64, height: u64) -> Result<Self, EnvironmentError> {
        if width == 0 || height == 0 {
            return Err(EnvironmentError::Empty {
                name: path.display().to_string(),
            });
        }
        if width > u64::from(SOURCE_MAX_WIDTH) || height > u64::from(SOURCE_MAX_HEIGHT) {
            return Err(EnvironmentError::TooLarge {
                path: path.to_owned(),
                width,
                height,
            });
        }
        let source = [width as u32, height as u32];
        let mut factor = 1;
        while source[0].div_ceil(factor) > MAX_WIDTH || source[1].div_ceil(factor) > MAX_HEIGHT {
            factor *= 2;
        }
        let [width, height] = source.map(|side| side.div_ceil(factor));
        Ok(Self {
            source,
            factor,
            width,
            height,
            texels: vec![[0.0; 4]; width as usize * height as usize],
        })
    }

    /// Columns and rows of the file's picture.
    pub(super) fn source_size(&self) -> [u32; 2] {
        self.source
    }

    /// Puts a colour at a place of the file's picture, which must lie in it.
    #[inline]
    pub(super) fn add_color(&mut self, column: u32, row: u32, color: [f32; 3]) {
        for (channel, value) in color.into_iter().enumerate() {
            self.add(column, row, channel, value);
        }
    }

    /// Puts one channel of a colour at a place of the file's picture, which must lie in it.
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

    /// The picture, and a word where it was made smaller.
    pub(super) fn finish(self) -> Picture {
        let [width, height] = self.source;
        let warnings = if self.factor == 1 {
            Vec::new()
        } else {
            vec![format!(
                "The picture is {width} × {height}; it is used at {} × {}.",
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
