//! Windows and errors of OpenEXR files.

use std::path::Path;

use exr::error::Error as ExrError;
use exr::meta::header::Header;

use super::canvas::Canvas;
use super::decoded::Source;
use super::error::EnvironmentError;

/// An empty image of the display window, and the position of the first stored pixel in it: negative for pixels outside the
/// window.
pub(super) fn window(source: Source<'_>, header: &Header) -> Result<(Canvas, [i64; 2]), EnvironmentError> {
    let display = header.shared_attributes.display_window;
    let canvas = Canvas::new(source, display.size.width() as u64, display.size.height() as u64)?;
    Canvas::check_size(
        source,
        header.layer_size.width() as u64,
        header.layer_size.height() as u64,
    )?;
    let position = header.own_attributes.layer_position;
    let offset = [
        i64::from(position.x()) - i64::from(display.position.x()),
        i64::from(position.y()) - i64::from(display.position.y()),
    ];
    Ok((canvas, offset))
}

/// Converts the crate's error.
pub(super) fn exr_error(path: &Path, error: ExrError) -> EnvironmentError {
    let path = path.to_owned();
    match error {
        ExrError::Io(source) => EnvironmentError::Read { path, source },
        ExrError::NotSupported(feature) => EnvironmentError::Unsupported {
            path,
            feature: format!("an OpenEXR feature ({feature})"),
            remedy: "re-save it as a plain RGB scan-line EXR with ZIP or PIZ compression",
        },
        ExrError::Invalid(detail) if detail == "reference to missing bytes" => EnvironmentError::Truncated {
            path,
            detail: "bytes that it refers to are missing".to_owned(),
        },
        error => EnvironmentError::damaged(&path, error),
    }
}
