//! Input and output of decoders.

use std::path::Path;

use super::error::EnvironmentError;
use crate::budget::{Budget, OverBudget};
use crate::optics::primaries::{Chromaticities, Matrix, NoSpace, transformed};
use crate::picture::Encoded;
use crate::resource;
use crate::scene::Loading;
use crate::scene::environment::EnvironmentEncoding;

/// A file to be read.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub path: &'a Path,
    /// Encoding of display-referred images.
    pub encoding: EnvironmentEncoding,
    pub loading: &'a Loading,
    /// Memory budget of the files and the map together.
    pub budget: &'a Budget,
}

impl Source<'_> {
    /// Contents of the file, counted against the budget.
    pub(super) fn bytes(&self) -> Result<Vec<u8>, EnvironmentError> {
        let length = io(self.path, resource::open(self.path).and_then(|file| file.metadata()))?.len();
        self.within(self.budget.take(length))?;
        io(
            self.path,
            resource::read_watched(self.path, resource::BYTES_MAX, self.loading),
        )
    }

    /// Checks that an image can be decoded as a whole.
    pub(super) fn check_decoding(&self, bytes: &[u8]) -> Result<(), EnvironmentError> {
        let name = self.path.to_string_lossy().into_owned();
        let bytes = bytes.into();
        self.within(self.budget.check(Encoded { name, bytes }.cost()))
    }

    /// The error for an exceeded budget.
    pub(super) fn within(&self, taken: Result<(), OverBudget>) -> Result<(), EnvironmentError> {
        taken.map_err(|over| EnvironmentError::OverBudget {
            path: self.path.to_owned(),
            over,
        })
    }
}

/// A decoded image: `width` × `height` texels, rows from the top, values as in the file.
pub(super) struct Picture {
    pub width: u32,
    pub height: u32,
    pub texels: Vec<[f32; 4]>,
    pub warnings: Vec<String>,
    /// The file says that it holds the six faces of a cube, in OpenEXR's order.
    pub is_cube: bool,
}

impl Picture {
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
            let least = -1e-4 * color.iter().sum::<f64>().abs();
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

/// The file system's answer, or the matching error.
pub(super) fn io<T>(path: &Path, result: std::io::Result<T>) -> Result<T, EnvironmentError> {
    result.map_err(|source| EnvironmentError::Read {
        path: path.to_owned(),
        source,
    })
}
