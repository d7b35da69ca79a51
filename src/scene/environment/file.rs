//! Environments from .hdr and .exr files: which decoder, and what is mended afterwards.

use std::path::Path;

use super::{Environment, EnvironmentError};

/// The most columns of a file's picture.
pub const MAX_WIDTH: u32 = 8192;
/// The most rows of a file's picture.
pub const MAX_HEIGHT: u32 = 4096;

/// A decoded picture: `width` × `height` texels, rows from the top, numbers as they were in the file.
pub(super) struct Picture {
    pub width: u32,
    pub height: u32,
    pub texels: Vec<[f32; 4]>,
    pub warnings: Vec<String>,
}

/// Loads a .hdr or .exr file.
pub(super) fn load(path: &Path) -> Result<Environment, EnvironmentError> {
    let extension = path
        .extension()
        .map(|extension| extension.to_string_lossy().to_lowercase());
    let mut picture = match extension.as_deref() {
        Some("hdr") => super::radiance_hdr::read(path)?,
        Some("exr") => super::open_exr::read(path)?,
        _ => {
            return Err(EnvironmentError::UnknownExtension { path: path.to_owned() });
        }
    };
    mend(&mut picture);
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    let mut environment = Environment::from_texels(name, picture.width, picture.height, picture.texels)?;
    environment.warnings = picture.warnings;
    Ok(environment)
}

/// Refuses sizes that do not fit or are nothing.
pub(super) fn check_size(path: &Path, width: u64, height: u64) -> Result<(u32, u32), EnvironmentError> {
    if width == 0 || height == 0 {
        return Err(EnvironmentError::Empty {
            name: path.display().to_string(),
        });
    }
    if width > u64::from(MAX_WIDTH) || height > u64::from(MAX_HEIGHT) {
        return Err(EnvironmentError::TooLarge {
            path: path.to_owned(),
            width,
            height,
        });
    }
    Ok((width as u32, height as u32))
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
