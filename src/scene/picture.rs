//! Pictures of models, whatever their format, as 8-bit RGBA.

use std::io::Cursor;

use image::{ImageReader, Limits};

use super::ktx2;
use super::model::Texture;

/// The most memory that decoding one picture may take.
const DECODED_MAX: u64 = 2 << 30;

/// Decodes a picture of any known format; deeper ones are brought to 8 bits.
pub(super) fn decode_bytes(name: String, bytes: &[u8]) -> Result<Texture, String> {
    if ktx2::is_ktx2(bytes) {
        let (width, height, rgba8) = ktx2::decode(bytes)?;
        return Ok(Texture {
            name,
            width,
            height,
            rgba8,
        });
    }
    let mut reader = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|error| error.to_string())?;
    let mut limits = Limits::default();
    limits.max_alloc = Some(DECODED_MAX);
    reader.limits(limits);
    let picture = reader.decode().map_err(|error| error.to_string())?.into_rgba8();
    Ok(Texture {
        name,
        width: picture.width(),
        height: picture.height(),
        rgba8: picture.into_raw(),
    })
}
