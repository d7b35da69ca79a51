//! What the tiff crate knows of TIFF images and the image crate does not: floating-point ones of 16, 32 or 64 bits, and
//! whether opacity multiplies the colours.

use std::io::Cursor;

use image::DynamicImage;
use tiff::{
    ColorType,
    decoder::{Decoder, DecodingResult, Limits},
    tags::Tag,
};

use super::light;

/// Memory limit of decoding in bytes.
const DECODED_MAX: usize = 2 << 30;

/// Width and height of a TIFF image of any type; `None` for other files.
pub fn size(bytes: &[u8]) -> Option<[u32; 2]> {
    let (width, height) = is_tiff(bytes).then(|| Decoder::new(Cursor::new(bytes)).ok()?.dimensions().ok())??;
    Some([width, height])
}

fn is_tiff(bytes: &[u8]) -> bool {
    [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"]
        .iter()
        .any(|start| bytes.starts_with(*start))
}

/// The image in a file's bytes; `None` if not floating-point.
pub fn decode(bytes: &[u8]) -> Result<Option<DynamicImage>, String> {
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
    let format = decoder.find_tag_unsigned_vec::<u16>(Tag::SampleFormat).map_err(text)?;
    if format.and_then(|formats| formats.first().copied()) != Some(3) {
        return Ok(None);
    }
    let numbers: Vec<f32> = match decoder.read_image().map_err(text)? {
        DecodingResult::F16(numbers) => numbers.into_iter().map(half::f16::to_f32).collect(),
        DecodingResult::F32(numbers) => numbers,
        DecodingResult::F64(numbers) => numbers.into_iter().map(|x| x as f32).collect(),
        _ => return Ok(None),
    };
    if numbers.len() != width as usize * height as usize * channels {
        return Err("its channels lie apart; save them interleaved".to_owned());
    }
    Ok(light([width, height], channels, numbers))
}

/// Whether an image says that opacity multiplies its colours.
pub fn is_premultiplied(bytes: &[u8]) -> bool {
    let extra = is_tiff(bytes).then(|| {
        let mut decoder = Decoder::new(Cursor::new(bytes)).ok()?;
        decoder.find_tag_unsigned_vec::<u16>(Tag::ExtraSamples).ok()?
    });
    // 1 is the number of associated alpha in TIFF 6.0.
    extra.flatten().is_some_and(|samples| samples.first() == Some(&1))
}
