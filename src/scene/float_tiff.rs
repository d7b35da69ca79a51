//! TIFF pictures of numbers with a point, 16, 32 or 64 bits, by the tiff crate: the image crate knows only colours of 32.

use std::io::Cursor;

use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult, Limits};

/// The most bytes that a picture may take while it is decoded.
const DECODED_MAX: usize = 2 << 30;

/// A picture of linear light.
pub(super) struct FloatPicture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Numbers a texel: grey, or red, green and blue first.
    channels: usize,
    numbers: DecodingResult,
}

impl FloatPicture {
    /// Red, green and blue of a texel.
    pub fn rgb(&self, column: u32, row: u32) -> [f32; 3] {
        let first = (row as usize * self.width as usize + column as usize) * self.channels;
        let places = if self.channels < 3 { [0; 3] } else { [0, 1, 2] };
        places.map(|channel| self.number(first + channel))
    }

    /// The opacity of a texel.
    pub fn opacity(&self, column: u32, row: u32) -> f32 {
        let first = (row as usize * self.width as usize + column as usize) * self.channels;
        match self.channels {
            2 | 4 => self.number(first + self.channels - 1),
            _ => 1.0,
        }
    }

    fn number(&self, place: usize) -> f32 {
        match &self.numbers {
            DecodingResult::F16(numbers) => numbers[place].to_f32(),
            DecodingResult::F32(numbers) => numbers[place],
            DecodingResult::F64(numbers) => numbers[place] as f32,
            _ => 0.0,
        }
    }
}

/// Columns and rows of a TIFF picture, whatever its numbers; nothing where it is none.
pub(super) fn size(bytes: &[u8]) -> Option<[u32; 2]> {
    let (width, height) = is_tiff(bytes).then(|| Decoder::new(Cursor::new(bytes)).ok()?.dimensions().ok())??;
    Some([width, height])
}

fn is_tiff(bytes: &[u8]) -> bool {
    [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"]
        .iter()
        .any(|start| bytes.starts_with(*start))
}

/// The picture in a file's bytes; nothing where it is not of numbers with a point.
///
/// # Errors
/// Why it cannot be had, in a few words.
pub(super) fn decode(bytes: &[u8]) -> Result<Option<FloatPicture>, String> {
    if !is_tiff(bytes) {
        return Ok(None);
    }
    let text = |error: tiff::TiffError| error.to_string();
    let mut limits = Limits::default();
    limits.decoding_buffer_size = DECODED_MAX;
    let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(text)?.with_limits(limits);
    let (width, height) = decoder.dimensions().map_err(text)?;
    let channels = match decoder.colortype().map_err(text)? {
        ColorType::Gray(16..) => 1,
        ColorType::GrayA(16..) => 2,
        ColorType::RGB(16..) => 3,
        ColorType::RGBA(16..) => 4,
        _ => return Ok(None),
    };
    // 3 is the number of IEEE's numbers in TIFF 6.0.
    let format = decoder
        .find_tag_unsigned_vec::<u16>(tiff::tags::Tag::SampleFormat)
        .map_err(text)?;
    if format.and_then(|formats| formats.first().copied()) != Some(3) {
        return Ok(None);
    }
    let numbers = decoder.read_image().map_err(text)?;
    let count = match &numbers {
        DecodingResult::F16(numbers) => numbers.len(),
        DecodingResult::F32(numbers) => numbers.len(),
        DecodingResult::F64(numbers) => numbers.len(),
        _ => return Ok(None),
    };
    if count != width as usize * height as usize * channels {
        return Err("its channels lie apart; save them interleaved".to_owned());
    }
    Ok(Some(FloatPicture {
        width,
        height,
        channels,
        numbers,
    }))
}
