//! Radiance .hdr files (RGBE and XYZE), run lengths old and new, by the `image` crate.

use std::io::{Cursor, ErrorKind, Read};

use image::codecs::hdr::HdrDecoder;
use image::{ImageDecoder, ImageError};

use super::canvas::{Canvas, Picture, Source};
use super::error::EnvironmentError;

/// Lines between two progress reports.
const LINES_A_STEP: u32 = 256;

/// Columns: linear Rec. 709 red, green and blue of CIE X, Y and Z relative to the white D65.
const RGB_FROM_XYZ: [[f32; 3]; 3] = [
    [3.240_97, -0.969_244, 0.055_630],
    [-1.537_383, 1.875_968, -0.203_977],
    [-0.498_611, 0.041_555, 1.056_972],
];

/// Reads a file line by line, so that memory grows with actual lines and a truncation is located.
pub(super) fn read(source: Source<'_>) -> Result<Picture, EnvironmentError> {
    let bytes = source.bytes()?;
    if bytes.is_empty() {
        return Err(source.truncated("it has no content"));
    }
    if !bytes.starts_with(b"#?") {
        return Err(source.wrong("a Radiance .hdr"));
    }
    // The text ends with an empty line, the resolution's line follows.
    let end = bytes.windows(2).position(|pair| pair == b"\n\n");
    let end = end.ok_or_else(|| source.damaged("no empty line ends its header"))?;
    let after = &bytes[end + 2..];
    let length = after.iter().position(|byte| *byte == b'\n');
    let (resolution, mut rest) = after.split_at(length.ok_or_else(|| source.damaged("it has no resolution"))? + 1);
    let resolution = String::from_utf8_lossy(resolution);
    let words: Vec<&str> = resolution.split_whitespace().collect();
    let size: Option<[u32; 2]> = match words[..] {
        ["-Y", height, "+X", width] => width.parse().ok().zip(height.parse().ok()).map(Into::into),
        _ => None,
    };
    let [width, height] = size.ok_or_else(|| {
        let order = format!("the resolution '{}'", resolution.trim());
        source.unsupported(order, "re-save it with its rows from the top")
    })?;
    let text = String::from_utf8_lossy(&bytes[..end]);
    let values = |key: &'static str| text.lines().filter_map(move |line| line.trim().strip_prefix(key));
    let format = values("FORMAT=").next_back().map_or("32-bit_rle_rgbe", str::trim);
    let is_xyz = format == "32-bit_rle_xyze";
    if !is_xyz && format != "32-bit_rle_rgbe" {
        let format: String = format.chars().take(40).collect();
        return Err(source.unsupported(format!("the format {format}"), "re-save it as 32-bit_rle_rgbe"));
    }
    let exposures = values("EXPOSURE=").filter_map(|value| value.trim().parse::<f32>().ok());
    let has_exposure = exposures.product::<f32>() != 1.0;
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
            canvas.add_color(column, row, if is_xyz { rgb_from_xyz(*color) } else { *color });
        }
    }
    let mut picture = canvas.finish();
    if has_exposure {
        let text = "The file's EXPOSURE is ignored, as most programs do; set the strength instead.";
        picture.warnings.push(text.to_owned());
    }
    Ok(picture)
}

/// Colours beyond Rec. 709 would be negative light.
fn rgb_from_xyz(xyz: [f32; 3]) -> [f32; 3] {
    let channel = |to: usize| (0..3).map(|from| RGB_FROM_XYZ[from][to] * xyz[from]).sum::<f32>();
    [0, 1, 2].map(|to| channel(to).max(0.0))
}

/// Decodes the next line of pixels (three numbers each). The decoder only accepts whole files: each line is passed as an
/// image of one row.
fn read_line(rest: &mut &[u8], line: &mut [f32]) -> Result<(), ImageError> {
    let header = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X {}\n", line.len() / 3);
    HdrDecoder::new(Cursor::new(header).chain(rest))?.read_image(bytemuck::cast_slice_mut(line))
}
