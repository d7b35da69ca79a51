//! Radiance .hdr files (RGBE and XYZE), run lengths old and new, by the `image` crate.

use std::io::{Cursor, ErrorKind, Read};

use image::{ImageDecoder, ImageError, codecs::hdr::HdrDecoder};

use super::canvas::{Canvas, Picture, Source};
use super::error::EnvironmentError;
use crate::{optics::primaries::Chromaticities, picture::radiance_gains};

/// Lines between two progress reports.
const LINES_A_STEP: u32 = 256;

/// Lines of text before the pixels, at most.
const HEADER_MAX: usize = 4096;

/// CIE XYZ, of `32-bit_rle_xyze`.
const XYZ: Chromaticities = Chromaticities {
    primaries: [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]],
    white: [1.0 / 3.0; 2],
};

/// Reads a file line by line, so that memory grows with actual lines and a truncation is located.
pub fn read(source: Source<'_>) -> Result<Picture, EnvironmentError> {
    let bytes = source.bytes()?;
    if bytes.is_empty() {
        return Err(source.truncated("it has no content"));
    }
    let (mut rest, mut header) = (&bytes[..], Vec::new());
    let is_complete = loop {
        match text_line(&mut rest) {
            Some(line) if line.is_empty() => break true,
            Some(line) if header.len() < HEADER_MAX => header.push(line),
            _ => break false,
        }
    };
    let values = |key: &'static str| {
        header
            .iter()
            .filter_map(move |line| line.strip_prefix(key)?.trim().into())
    };
    let mut formats = values("FORMAT=");
    // Very old files have no signature.
    if !bytes.starts_with(b"#?") && formats.clone().next().is_none() {
        return Err(source.wrong("a Radiance .hdr"));
    }
    if !is_complete {
        return Err(source.damaged("no empty line ends its header"));
    }
    let resolution = text_line(&mut rest).ok_or_else(|| source.damaged("it has no resolution"))?;
    let words: Vec<&str> = resolution.split_whitespace().collect();
    let size: Option<[u32; 2]> = match words[..] {
        ["-Y", height, "+X", width] => width.parse().ok().zip(height.parse().ok()).map(Into::into),
        _ => None,
    };
    let [width, height] = size.ok_or_else(|| {
        let order = format!("the resolution '{resolution}'");
        source.unsupported(order, "re-save it with its rows from the top")
    })?;
    let format = formats.next_back().unwrap_or("32-bit_rle_rgbe");
    let is_xyz = format == "32-bit_rle_xyze";
    if !is_xyz && format != "32-bit_rle_rgbe" {
        let format: String = format.chars().take(40).collect();
        return Err(source.unsupported(format!("the format {format}"), "re-save it as 32-bit_rle_rgbe"));
    }
    let gains = radiance_gains(&bytes);
    let space = values("PRIMARIES=").filter_map(numbers::<8>).next_back();
    let space = space.map(|[rx, ry, gx, gy, bx, by, wx, wy]| Chromaticities {
        primaries: [[rx, ry], [gx, gy], [bx, by]],
        white: [wx, wy],
    });
    let mut canvas = Canvas::new(source, width.into(), height.into())?;
    let mut line = vec![0.0_f32; 3 * width as usize];
    for row in 0..height {
        if row % LINES_A_STEP == 0 {
            source.loading.step(format!("line {row} of {height}"))?;
        }
        read_line(&mut rest, &mut line).map_err(|error| match error {
            ImageError::IoError(error) if error.kind() == ErrorKind::UnexpectedEof => {
                source.truncated(format_args!("it ends in row {} of {height}", row + 1))
            }
            error => source.damaged(format_args!("row {} cannot be decoded ({error})", row + 1)),
        })?;
        for (column, color) in (0..).zip(line.as_chunks::<3>().0) {
            canvas.add_color(column, row, [0, 1, 2].map(|i| gains[i] * color[i]));
        }
    }
    let mut picture = canvas.finish();
    if let Some(space) = if is_xyz { Some(XYZ) } else { space } {
        picture.bring_to_rec709(source.path, &space);
    }
    Ok(picture)
}

/// The next line of the text before the pixels, without its end: LF, or CR LF of files that were edited.
fn text_line(rest: &mut &[u8]) -> Option<String> {
    let length = rest.iter().position(|byte| *byte == b'\n')?;
    let (line, after) = rest.split_at(length + 1);
    *rest = after;
    Some(String::from_utf8_lossy(line).trim().to_owned())
}

/// Numbers with blanks between them.
fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let all: Option<Vec<f64>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
    all?.try_into().ok()
}

/// Decodes the next line of pixels (three numbers each). The decoder only accepts whole files: each line is passed as an
/// image of one row.
fn read_line(rest: &mut &[u8], line: &mut [f32]) -> Result<(), ImageError> {
    let header = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X {}\n", line.len() / 3);
    HdrDecoder::new(Cursor::new(header).chain(rest))?.read_image(bytemuck::cast_slice_mut(line))
}
