//! Radiance .hdr files (RGBE), by the `image` crate.

use std::io::{Chain, Cursor, ErrorKind, Read};
use std::path::Path;

use image::codecs::hdr::HdrDecoder;
use image::{ImageDecoder, ImageError};

use super::EnvironmentError;
use super::file::{Picture, check_size, io};

/// Reads a file row by row, so that memory grows with the rows that are really there and a cut is found where it is.
pub(super) fn read(path: &Path) -> Result<Picture, EnvironmentError> {
    let bytes = io(path, std::fs::read(path))?;
    if bytes.is_empty() {
        return Err(EnvironmentError::Truncated {
            path: path.to_owned(),
            detail: "it has no content".to_owned(),
        });
    }
    if !bytes.starts_with(b"#?") {
        return Err(EnvironmentError::WrongContent {
            path: path.to_owned(),
            expected: "a Radiance .hdr",
        });
    }
    let mut rest = bytes.as_slice();
    // Not strict: programs sign with #?RGBE, too, and leave odd lines in the header.
    let header = HdrDecoder::new_nonstrict(&mut rest)
        .map_err(|error| header_error(path, error))?
        .metadata();
    let (width, height) = check_size(path, header.width.into(), header.height.into())?;

    let mut texels: Vec<[f32; 4]> = Vec::new();
    let mut line = vec![0.0_f32; 3 * width as usize];
    for row in 0..height {
        read_row(&mut rest, width, &mut line).map_err(|error| row_error(path, error, row, height))?;
        if row == height / 8 {
            texels.reserve_exact(width as usize * (height - row) as usize);
        }
        texels.extend(
            line.as_chunks::<3>()
                .0
                .iter()
                .map(|&[red, green, blue]| [red, green, blue, 1.0]),
        );
    }
    let mut warnings = Vec::new();
    if header.exposure.is_some_and(|exposure| exposure != 1.0) {
        warnings.push("The file's EXPOSURE is ignored, as most programs do; set the strength instead.".to_owned());
    }
    Ok(Picture {
        width,
        height,
        texels,
        warnings,
    })
}

/// Decodes the next row into `line` (red, green, blue, …). The decoder only knows whole files: each row is handed to it
/// as a picture of one row.
fn read_row(rest: &mut &[u8], width: u32, line: &mut [f32]) -> Result<(), ImageError> {
    let header = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X {width}\n");
    let file: Chain<Cursor<String>, &mut &[u8]> = Cursor::new(header).chain(rest);
    HdrDecoder::new(file)?.read_image(bytemuck::cast_slice_mut(line))
}

/// What is wrong with a header.
fn header_error(path: &Path, error: ImageError) -> EnvironmentError {
    let path = path.to_owned();
    match error {
        ImageError::Unsupported(error) => EnvironmentError::Unsupported {
            path,
            feature: error.to_string(),
            remedy: "re-save it as 32-bit_rle_rgbe, rows from the top, at most 8192 × 4096",
        },
        error => EnvironmentError::Damaged {
            path,
            detail: format!("its header cannot be read ({error})"),
        },
    }
}

/// What is wrong with a row.
fn row_error(path: &Path, error: ImageError, row: u32, height: u32) -> EnvironmentError {
    let path = path.to_owned();
    match error {
        ImageError::IoError(error) if error.kind() == ErrorKind::UnexpectedEof => EnvironmentError::Truncated {
            path,
            detail: format!("it ends in row {} of {height}", row + 1),
        },
        error => EnvironmentError::Damaged {
            path,
            detail: format!("row {} cannot be decoded ({error})", row + 1),
        },
    }
}
