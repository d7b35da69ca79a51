//! Pictures of models, whatever their format, as 8-bit RGBA.

use std::io::Cursor;

use basisu::{DecodeFlags, TargetFormat, Transcoder};
use image::{ImageReader, Limits};

use super::model::Texture;

/// The first bytes of a KTX2 file.
const KTX2: [u8; 12] = *b"\xabKTX 20\xbb\r\n\x1a\n";
/// The most memory that decoding one picture may take.
const DECODED_MAX: u64 = 2 << 30;

/// Decodes a picture of any known format; deeper ones are brought to 8 bits.
pub(super) fn decode_bytes(name: String, bytes: &[u8]) -> Result<Texture, String> {
    if bytes.starts_with(&KTX2) {
        return decode_ktx2(name, bytes);
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

/// Decodes KTX2 with Basis Universal (KHR_texture_basisu).
fn decode_ktx2(name: String, bytes: &[u8]) -> Result<Texture, String> {
    let decoded = std::panic::catch_unwind(|| {
        let transcoder = Transcoder::new(bytes).map_err(|error| format!("KTX2: {error:?}"))?;
        let (width, height) = transcoder.base_dimensions();
        // One bit a texel is what the best of its codecs can do.
        if u64::from(width) * u64::from(height) > 64 * bytes.len() as u64 + (1 << 20) {
            return Err(format!("{} bytes cannot hold {width} × {height}", bytes.len()));
        }
        let rgba8 = transcoder
            .transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE)
            .map_err(|error| format!("KTX2: {error:?}"))?;
        Ok((width, height, rgba8))
    });
    let (width, height, rgba8) = decoded.map_err(|_| "it is damaged".to_owned())??;
    Ok(Texture {
        name,
        width,
        height,
        rgba8,
    })
}
