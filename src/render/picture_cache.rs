//! Disk cache of thumbnails.

use std::io::Cursor;
use std::path::Path;

use image::{ImageFormat, RgbaImage};

use crate::store::replace::save_atomically;

/// The cached thumbnail, or a new one, which is cached; `None` if none could be made. If the cache cannot be written, the
/// next start makes it again.
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

/// Pixels of a cached thumbnail: RGBA, 8 bits each, alpha not premultiplied, rows from the top; `None` if there is none of
/// this size (columns, rows).
fn read(path: &Path, size: [u32; 2]) -> Option<Vec<u8>> {
    let bytes = std::fs::read(path).ok()?;
    let picture = image::load_from_memory_with_format(&bytes, ImageFormat::Png).ok()?;
    let picture = picture.into_rgba8();
    (picture.dimensions() == size.into()).then(|| picture.into_raw())
}

/// Writes a thumbnail; creates its folder if needed.
pub(super) fn write(path: &Path, [width, height]: [u32; 2], pixels: &[u8]) -> Result<(), String> {
    let picture = RgbaImage::from_raw(width, height, pixels.to_vec()).ok_or("not the size of a thumbnail")?;
    let mut bytes = Cursor::new(Vec::new());
    picture
        .write_to(&mut bytes, ImageFormat::Png)
        .map_err(crate::in_words)?;
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    save_atomically(path, bytes.get_ref()).map_err(crate::in_words)
}
