//! Environments from files: which decoder, and what is mended afterwards.

use std::path::Path;

use super::{Environment, EnvironmentEncoding, EnvironmentError};
use super::{container, cube, display_referred, open_exr, radiance_hdr};
use crate::optics::primaries::{Chromaticities, Matrix, NoSpace, transformed};
use crate::scene::endings::{ending, is_picture};
use crate::scene::loading::Loading;

/// The most columns that are kept of a file's picture; larger ones are made smaller.
pub const MAX_WIDTH: u32 = 8192;
/// The most rows that are kept of a file's picture.
pub const MAX_HEIGHT: u32 = 4096;
/// The most columns of a file's picture.
pub const SOURCE_MAX_WIDTH: u32 = 32768;
/// The most rows of a file's picture: a strip of six faces stands upright.
pub const SOURCE_MAX_HEIGHT: u32 = 32768;

/// A file to be read.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub path: &'a Path,
    /// What the numbers of pictures for screens stand for.
    pub encoding: EnvironmentEncoding,
    /// Who waits.
    pub loading: &'a Loading,
}

/// A decoded picture: `width` × `height` texels, rows from the top, numbers as they were in the file.
pub(super) struct Picture {
    pub width: u32,
    pub height: u32,
    pub texels: Vec<[f32; 4]>,
    pub warnings: Vec<String>,
    /// The file says that it holds the six faces of a cube, in OpenEXR's order.
    pub is_cube: bool,
}

impl Picture {
    /// Brings its colours to Rec. 709 from another space. Where that is none they stay as they are, which is told.
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

    /// Brings its colours to Rec. 709. What that space can't hold is nearest without the channel that would be negative; how
    /// much of it there is is told.
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

/// Loads a picture of the whole sphere: a lat-long map or a cube map in a file, or the six faces of one in a folder.
pub(super) fn load(
    path: &Path,
    encoding: EnvironmentEncoding,
    loading: &Loading,
) -> Result<Environment, EnvironmentError> {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    loading.step(format!("reading {name}"))?;
    let source = Source {
        path,
        encoding,
        loading,
    };
    let mut picture = if path.is_dir() {
        cube::read_folder(source)?
    } else {
        cube::unfolded(decode(source)?)
    };
    loading.step("the environment's distribution")?;
    mend(&mut picture);
    let mut environment = Environment::from_texels(name, picture.width, picture.height, picture.texels)?;
    environment.warnings = picture.warnings;
    Ok(environment)
}

/// The picture in a file.
pub(super) fn decode(source: Source<'_>) -> Result<Picture, EnvironmentError> {
    match ending(source.path).as_str() {
        "hdr" | "pic" | "rgbe" => radiance_hdr::read(source),
        "exr" => open_exr::read(source),
        "ktx2" | "dds" => container::read(source),
        _ if is_picture(source.path) => display_referred::read(source),
        _ => Err(EnvironmentError::UnknownExtension {
            path: source.path.to_owned(),
        }),
    }
}

/// The file system's answer, or the matching error.
pub(super) fn io<T>(path: &Path, result: std::io::Result<T>) -> Result<T, EnvironmentError> {
    result.map_err(|source| EnvironmentError::Read {
        path: path.to_owned(),
        source,
    })
}

/// Replaces what is no radiance, makes the texels opaque, and says what was odd.
fn mend(picture: &mut Picture) {
    let (mut not_a_number, mut negative, mut infinite) = (0_u64, 0_u64, 0_u64);
    let mut largest = 0.0_f32;
    for texel in &mut picture.texels {
        for value in &mut texel[..3] {
            if value.is_nan() {
                not_a_number += 1;
                *value = 0.0;
            } else if *value < 0.0 {
                negative += 1;
                *value = 0.0;
            } else if value.is_infinite() {
                infinite += 1;
            } else {
                largest = largest.max(*value);
            }
        }
        texel[3] = 1.0;
    }
    if infinite > 0 {
        for value in picture.texels.as_flattened_mut() {
            *value = value.min(largest.max(1.0));
        }
    }
    let warnings = &mut picture.warnings;
    let mut tell = |count: u64, what: &str, instead: &str| {
        if count > 0 {
            warnings.push(format!("{count} {what} values were replaced by {instead}."));
        }
    };
    tell(not_a_number, "not-a-number", "0");
    tell(negative, "negative", "0");
    tell(infinite, "infinite", &format!("the largest finite one, {largest}"));
    if picture.width != 2 * picture.height {
        warnings.push(format!(
            "The picture is {} × {}, not twice as wide as it is high; it is stretched over the whole sphere.",
            picture.width, picture.height
        ));
    }
}
