//! Floating-point TIFF images of 16, 32 or 64 bits, by the tiff crate: the image crate only supports colours of 32 bits.

use std::io::Cursor;

use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult, Limits};

/// Memory limit of decoding in bytes.
const DECODED_MAX: usize = 2 << 30;

/// A linear image.
pub(crate) struct FloatPicture {
    pub width: u32,
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

/// Width and height of a TIFF image of any type; `None` for other files.
pub(crate) fn size(bytes: &[u8]) -> Option<[u32; 2]> {
    let (width, height) = is_tiff(bytes).then(|| Decoder::new(Cursor::new(bytes)).ok()?.dimensions().ok())??;
    Some([width, height])
}

fn is_tiff(bytes: &[u8]) -> bool {
    [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"]
        .iter()
        .any(|start| bytes.starts_with(*start))
}

/// The image in a file's bytes; `None` if not floating-point.
pub(crate) fn decode(bytes: &[u8]) -> Result<Option<FloatPicture>, String> {
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
