//! Small pictures kept on disk from one start to the next.

use std::io::Cursor;
use std::path::Path;

use image::{ImageFormat, RgbaImage};

use crate::store::replace::save_atomically;

/// The picture that was kept, or else the one that is made, which is kept then; `None` where none could be made. A cache:
/// where it can't be written, the next start makes it again.
pub(super) fn kept_or_made<E>(
    path: &Path,
    size: [u32; 2],
    make: impl FnOnce() -> Result<Option<Vec<u8>>, E>,
) -> Result<Option<Vec<u8>>, E> {
    if let Some(kept) = read(path, size) {
        return Ok(Some(kept));
    }
    let made = make()?;
    if let Some(pixels) = &made
        && let Err(error) = write(path, size, pixels)
    {
        log::debug!("{error}");
    }
    Ok(made)
}

/// The pixels of a picture that was kept: red, green, blue and alpha of 8 bits, alpha not premultiplied, row by row from
/// the top; `None` where there is none of this size (columns, rows).
fn read(path: &Path, size: [u32; 2]) -> Option<Vec<u8>> {
    let bytes = std::fs::read(path).ok()?;
    let picture = image::load_from_memory_with_format(&bytes, ImageFormat::Png).ok()?;
    let picture = picture.into_rgba8();
    (picture.dimensions() == size.into()).then(|| picture.into_raw())
}

/// Keeps a picture; its folder is made where it is not there.
pub(super) fn write(path: &Path, [width, height]: [u32; 2], pixels: &[u8]) -> Result<(), String> {
    let picture = RgbaImage::from_raw(width, height, pixels.to_vec()).ok_or("not the size of a thumbnail")?;
    let mut bytes = Cursor::new(Vec::new());
    picture
        .write_to(&mut bytes, ImageFormat::Png)
        .map_err(|error| error.to_string())?;
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    save_atomically(path, bytes.get_ref()).map_err(|error| error.to_string())
}
