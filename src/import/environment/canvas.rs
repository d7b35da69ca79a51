//! A file to be read, and the image that it becomes: filled pixel by pixel, and reduced on the fly if too large.

use std::{fmt::Display, io, path::Path};

use super::error::EnvironmentError;
use crate::{
    limits::{BYTES_MAX, Budget, OverBudget, length, read_watched},
    optics::primaries::{Chromaticities, Matrix, NoSpace, transformed},
    scene::Loading,
    scene::environment::{EnvironmentEncoding, MAX_HEIGHT, MAX_WIDTH, MapError, SOURCE_MAX_HEIGHT, SOURCE_MAX_WIDTH},
};

/// A file to be read.
#[derive(Clone, Copy)]
pub struct Source<'a> {
    pub path: &'a Path,
    /// Encoding of display-referred images.
    pub encoding: EnvironmentEncoding,
    pub loading: &'a Loading,
    /// Memory budget of the files and the map together.
    pub budget: &'a Budget,
}

impl Source<'_> {
    /// Contents of the file, counted against the budget.
    pub fn bytes(&self) -> Result<Vec<u8>, EnvironmentError> {
        let length = self.io(length(self.path))?;
        self.within(self.budget.take(length))?;
        self.io(read_watched(self.path, BYTES_MAX, self.loading))
    }

    /// The error for an exceeded budget.
    pub fn within(&self, taken: Result<(), OverBudget>) -> Result<(), EnvironmentError> {
        let path = self.path.display();
        taken.map_err(|over| EnvironmentError::Refused(format!("the environment {path} is not loaded: {over}")))
    }

    /// The file system's answer, or the matching error.
    pub fn io<T>(&self, result: io::Result<T>) -> Result<T, EnvironmentError> {
        result.map_err(|error| self.unreadable(error))
    }

    /// The file system refused.
    pub fn unreadable(&self, error: io::Error) -> EnvironmentError {
        let path = self.path.display();
        let remedy = "check the path and its permissions";
        EnvironmentError::Refused(format!("cannot read the environment {path}: {error}; {remedy}"))
    }

    /// An error that says this of the file.
    pub fn refused(&self, what: impl Display) -> EnvironmentError {
        EnvironmentError::Refused(format!("{} {what}", self.path.display()))
    }

    /// The decoder found a contradiction.
    pub fn damaged(&self, detail: impl Display) -> EnvironmentError {
        self.refused(format_args!(
            "is damaged: {detail}; copy or download it again, or re-save it"
        ))
    }

    /// The file ends too early.
    pub fn truncated(&self, detail: impl Display) -> EnvironmentError {
        self.refused(format_args!("is cut short: {detail}; copy or download it again"))
    }

    /// A valid file with an unsupported feature.
    pub fn unsupported(&self, feature: impl Display, remedy: &str) -> EnvironmentError {
        self.refused(format_args!("uses {feature}, which is not supported: {remedy}"))
    }

    /// The content does not match the ending.
    pub fn wrong(&self, expected: &str) -> EnvironmentError {
        self.refused(format_args!(
            "is not {expected} file although its name says so: its first bytes are different; check where it came from"
        ))
    }
}

/// A decoded image: `width` × `height` texels, rows from the top, values as in the file.
pub struct Picture {
    pub width: u32,
    pub height: u32,
    pub texels: Vec<[f32; 4]>,
    pub warnings: Vec<String>,
    /// The file says that it holds the six faces of a cube, in OpenEXR's order.
    pub is_cube: bool,
}

impl Picture {
    pub(super) fn new(width: u32, height: u32, texels: Vec<[f32; 4]>) -> Self {
        Self {
            width,
            height,
            texels,
            warnings: Vec::new(),
            is_cube: false,
        }
    }

    /// Converts its colours to Rec. 709 from another space. If that is invalid, they stay, with a warning.
    pub(super) fn bring_to_rec709(&mut self, path: &Path, space: &Chromaticities) {
        match space.rec709_from() {
            Ok(Some(matrix)) => self.transform(path, &matrix),
            Ok(None) => {}
            Err(NoSpace) => self.warnings.push(format!(
                "{}: its chromaticities are no space of colours; its numbers are shown as linear Rec. 709",
                path.display()
            )),
        }
    }

    /// Converts its colours to Rec. 709. Out-of-gamut colours lose their negative channels; their number is reported.
    fn transform(&mut self, path: &Path, matrix: &Matrix) {
        let mut outside = 0;
        for texel in &mut self.texels {
            let [r, g, b, _] = texel.map(f64::from);
            let color = transformed(matrix, [r, g, b]);
            // Rounding alone makes no colour one that can't be held.
            let least = -0.0001 * color.iter().sum::<f64>().abs();
            outside += usize::from(color.iter().any(|x| *x < least));
            for (channel, value) in texel.iter_mut().zip(color) {
                *channel = value.max(0.0) as f32;
            }
        }
        if outside > 0 {
            self.warnings.push(format!(
                "{}: {:.1} % of its colours are more saturated than linear Rec. 709 holds; they are shown less so",
                path.display(),
                100.0 * outside as f64 / self.texels.len().max(1) as f64
            ));
        }
    }
}

/// A canvas: each texel is the mean of `factor` × `factor` pixels of the file.
pub struct Canvas {
    source: [u32; 2],
    factor: u32,
    picture: Picture,
}

impl Canvas {
    /// An empty canvas for a file of this size, counted against the budget. Memory is only touched as pixels arrive: a header
    /// alone costs nothing.
    pub fn new(file: Source<'_>, width: u64, height: u64) -> Result<Self, EnvironmentError> {
        Self::check_size(file, width, height)?;
        let source = [width as u32, height as u32];
        let mut factor = 1;
        while source[0].div_ceil(factor) > MAX_WIDTH || source[1].div_ceil(factor) > MAX_HEIGHT {
            factor *= 2;
        }
        let [width, height] = source.map(|side| side.div_ceil(factor));
        let texels = width as usize * height as usize;
        file.within(file.budget.take((texels * size_of::<[f32; 4]>()) as u64))?;
        let picture = Picture::new(width, height, vec![[0.0; 4]; texels]);
        Ok(Self {
            source,
            factor,
            picture,
        })
    }

    /// Checks the size of a file's image.
    pub fn check_size(source: Source<'_>, width: u64, height: u64) -> Result<(), EnvironmentError> {
        if width == 0 || height == 0 {
            let name = source.path.display().to_string();
            return Err(MapError::Empty { name }.into());
        }
        if width > u64::from(SOURCE_MAX_WIDTH) || height > u64::from(SOURCE_MAX_HEIGHT) {
            return Err(source.refused(format_args!(
                "is {width} × {height}, larger than the {SOURCE_MAX_WIDTH} × {SOURCE_MAX_HEIGHT} that are read: scale it down"
            )));
        }
        Ok(())
    }

    /// Width and height of the file's image, in pixels.
    pub fn source_size(&self) -> [u32; 2] {
        self.source
    }

    /// Adds a colour at a pixel of the file's image, which must contain it.
    #[inline]
    pub fn add_color(&mut self, column: u32, row: u32, color: [f32; 3]) {
        for (channel, value) in color.into_iter().enumerate() {
            self.add(column, row, channel, value);
        }
    }

    /// Adds one channel at a pixel of the file's image, which must contain it.
    #[inline]
    pub fn add(&mut self, column: u32, row: u32, channel: usize, value: f32) {
        let Picture { width, texels, .. } = &mut self.picture;
        if self.factor == 1 {
            texels[(row * *width + column) as usize][channel] = value;
            return;
        }
        let (x, y) = (column / self.factor, row / self.factor);
        let covered = |place: u32, side: u32| (side - place * self.factor).min(self.factor) as f32;
        let count = covered(x, self.source[0]) * covered(y, self.source[1]);
        texels[(y * *width + x) as usize][channel] += value / count;
    }

    /// The image, with a warning if reduced.
    pub fn finish(self) -> Picture {
        let (mut picture, [width, height]) = (self.picture, self.source);
        if self.factor > 1 {
            let used = format!("{} × {}", picture.width, picture.height);
            picture
                .warnings
                .push(format!("The image is {width} × {height}; it is used at {used}."));
        }
        picture
    }
}
