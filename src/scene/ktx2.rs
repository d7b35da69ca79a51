//! KTX2 pictures: Basis Universal by its crate, and plain ones of 8 bits a channel.

use std::io::Read;

use basisu::{DecodeFlags, TargetFormat, Transcoder};
use ruzstd::StreamingDecoder;

use crate::panics::contained;

/// The first bytes of a KTX2 file.
const MAGIC: [u8; 12] = *b"\xabKTX 20\xbb\r\n\x1a\n";
/// Texels that a byte of Basis Universal may stand for, and beyond them.
const BASIS_GROWTH: [u64; 2] = [64, 1 << 20];
/// The same of Zstandard, in bytes.
const ZSTD_GROWTH: [u64; 2] = [4096, 1 << 20];

/// Formats of 8 bits a channel, by Vulkan's number: where red, green, blue and opacity are among the bytes of a texel; 255
/// where they are not.
const PLAIN: [(u32, usize, [u8; 4]); 12] = [
    (9, 1, [0, 0, 0, 255]),
    (15, 1, [0, 0, 0, 255]),
    (16, 2, [0, 1, 255, 255]),
    (22, 2, [0, 1, 255, 255]),
    (23, 3, [0, 1, 2, 255]),
    (29, 3, [0, 1, 2, 255]),
    (30, 3, [2, 1, 0, 255]),
    (36, 3, [2, 1, 0, 255]),
    (37, 4, [0, 1, 2, 3]),
    (43, 4, [0, 1, 2, 3]),
    (44, 4, [2, 1, 0, 3]),
    (50, 4, [2, 1, 0, 3]),
];

/// Whether a file's bytes begin as those of KTX2.
pub(super) fn is_ktx2(bytes: &[u8]) -> bool {
    bytes.starts_with(&MAGIC)
}

/// Width, height and RGBA of the largest level.
///
/// # Errors
/// Why it cannot be had, in a few words.
pub(super) fn decode(bytes: &[u8]) -> Result<(u32, u32, Vec<u8>), String> {
    let number = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    let format = number(12).ok_or("its header is cut short")?;
    match PLAIN.iter().find(|(known, ..)| *known == format) {
        Some(&(_, size, places)) => decode_plain(bytes, size, places).ok_or_else(|| "it is damaged".to_owned()),
        None if format == 0 => decode_basis(bytes),
        None => Err(format!("its format (number {format} of Vulkan) is not read")),
    }
}

fn decode_basis(bytes: &[u8]) -> Result<(u32, u32, Vec<u8>), String> {
    // Some damaged files fail assertions inside the crate instead of giving errors.
    let decoded = contained(|| {
        let transcoder = Transcoder::new(bytes).map_err(|error| format!("Basis Universal: {error:?}"))?;
        let (width, height) = transcoder.base_dimensions();
        let [growth, floor] = BASIS_GROWTH;
        if u64::from(width) * u64::from(height) > growth * bytes.len() as u64 + floor {
            return Err(format!("{} bytes cannot hold {width} × {height}", bytes.len()));
        }
        let rgba8 = transcoder.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE);
        Ok((
            width,
            height,
            rgba8.map_err(|error| format!("Basis Universal: {error:?}"))?,
        ))
    });
    decoded.ok_or("it is damaged")?
}

/// Texels of `size` bytes, as they are or compressed by Zstandard.
fn decode_plain(bytes: &[u8], size: usize, places: [u8; 4]) -> Option<(u32, u32, Vec<u8>)> {
    let number = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    let offset = |at: usize| usize::try_from(u64::from_le_bytes(bytes.get(at..at + 8)?.try_into().ok()?)).ok();
    let (width, height, compression) = (number(20)?, number(24)?.max(1), number(44)?);
    let length = (width as usize).checked_mul(height as usize)?.checked_mul(size)?;
    let level = bytes.get(offset(80)?..)?.get(..offset(88)?)?;
    let owned;
    let texels = match compression {
        0 => level,
        2 => {
            let [growth, floor] = ZSTD_GROWTH;
            if length as u64 > growth * level.len() as u64 + floor {
                return None;
            }
            let mut unpacked = Vec::new();
            StreamingDecoder::new(level)
                .ok()?
                .take(length as u64)
                .read_to_end(&mut unpacked)
                .ok()?;
            owned = unpacked;
            &owned
        }
        _ => return None,
    };
    let channel = |texel: &[u8], place: u8| match place {
        255 => 255,
        place => texel[usize::from(place)],
    };
    let rgba = |texel: &[u8]| places.map(|place| channel(texel, place));
    let texels = texels.get(..length)?.chunks_exact(size);
    Some((width, height, texels.flat_map(rgba).collect()))
}
