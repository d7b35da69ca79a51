//! A canvas that is filled pixel by pixel and reduced on the fly if too large.

use std::path::Path;

use super::decoded::Picture;
use crate::scene::environment::{EnvironmentError, MAX_HEIGHT, MAX_WIDTH, SOURCE_MAX_HEIGHT, SOURCE_MAX_WIDTH};

/// A canvas: each texel is the mean of `factor` × `factor` pixels of the file.
pub(super) struct Canvas {
    source: [u32; 2],
    factor: u32,
    width: u32,
    height: u32,
    texels: Vec<[f32; 4]>,
}

impl Canvas {
    /// An empty canvas for a file of this size. Memory is only touched as pixels arrive: a header alone costs nothing.
    ///
    /// # Errors
    ///
    /// Empty sizes, and sizes beyond [`SOURCE_MAX_WIDTH`] × [`SOURCE_MAX_HEIGHT`].
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
