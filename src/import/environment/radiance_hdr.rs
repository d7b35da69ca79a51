//! Radiance .hdr files (RGBE and XYZE), run lengths old and new, in any of the eight orders of pixels, by the `image`
//! crate.

use std::io::{Chain, Cursor, ErrorKind, Read};
use std::path::Path;

use image::codecs::hdr::HdrDecoder;
use image::{ImageDecoder, ImageError};

use super::canvas::Canvas;
use super::decoded::{Picture, Source};
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
    let path = source.path;
    let bytes = source.bytes()?;
    if bytes.is_empty() {
        return Err(EnvironmentError::truncated(path, "it has no content"));
    }
    if !bytes.starts_with(b"#?") {
        return Err(EnvironmentError::WrongContent {
            path: path.to_owned(),
            expected: "a Radiance .hdr",
        });
    }
    let (header, mut rest) = Header::split(path, &bytes)?;
    let layout = header.layout;
    let mut canvas = Canvas::new(source, layout.width.into(), layout.height.into())?;
    let mut line = vec![0.0_f32; 3 * layout.line_length() as usize];
    for number in 0..layout.lines() {
        if number % LINES_A_STEP == 0 {
            source.loading.step(format!("line {number} of {}", layout.lines()))?;
        }
        read_line(&mut rest, &mut line).map_err(|error| line_error(path, error, number, layout))?;
        for (element, color) in (0..).zip(line.as_chunks::<3>().0) {
            let [column, row] = layout.place(number, element);
            canvas.add_color(column, row, header.linear_rgb(*color));
        }
    }
    let mut picture = canvas.finish();
    if header.has_exposure {
        let text = "The file's EXPOSURE is ignored, as most programs do; set the strength instead.";
        picture.warnings.push(text.to_owned());
    }
    Ok(picture)
}

/// Header of a file.
struct Header {
    layout: Layout,
    is_xyz: bool,
    has_exposure: bool,
}

impl Header {
    /// The header, and the pixels after it.
    fn split<'a>(path: &Path, bytes: &'a [u8]) -> Result<(Self, &'a [u8]), EnvironmentError> {
        let damaged = |detail: &str| EnvironmentError::Damaged {
            path: path.to_owned(),
            detail: format!("its header cannot be read ({detail})"),
        };
        // The text ends with an empty line, the resolution's line follows.
        let end = bytes.windows(2).position(|pair| pair == b"\n\n");
        let end = end.ok_or_else(|| damaged("no empty line ends it"))? + 1;
        let after = &bytes[end + 1..];
        let length = after.iter().position(|byte| *byte == b'\n');
        let (resolution, rest) = after.split_at(length.ok_or_else(|| damaged("it has no resolution"))?);
        let resolution = String::from_utf8_lossy(resolution);
        let layout = Layout::parse(&resolution).ok_or_else(|| damaged(&format!("the resolution '{resolution}'")))?;
        let text = String::from_utf8_lossy(&bytes[..end]);
        let values = |key: &'static str| text.lines().filter_map(move |line| line.trim().strip_prefix(key));
        let format = values("FORMAT=").next_back().map_or("32-bit_rle_rgbe", str::trim);
        let is_xyz = format == "32-bit_rle_xyze";
        if !is_xyz && format != "32-bit_rle_rgbe" {
            return Err(EnvironmentError::Unsupported {
                path: path.to_owned(),
                feature: format!("the format {}", format.chars().take(40).collect::<String>()),
                remedy: "re-save it as 32-bit_rle_rgbe",
            });
        }
        let exposures = values("EXPOSURE=").filter_map(|value| value.trim().parse::<f32>().ok());
        let has_exposure = exposures.product::<f32>() != 1.0;
        let header = Self {
            layout,
            is_xyz,
            has_exposure,
        };
        Ok((header, &rest[1..]))
    }

    fn linear_rgb(&self, color: [f32; 3]) -> [f32; 3] {
        if !self.is_xyz {
            return color;
        }
        // Colours beyond Rec. 709 would be negative light.
        [0, 1, 2].map(|to| {
            (0..3)
                .map(|from| RGB_FROM_XYZ[from][to] * color[from])
                .sum::<f32>()
                .max(0.0)
        })
    }
}

/// Size of the image and order of its pixels.
#[derive(Clone, Copy)]
struct Layout {
    width: u32,
    height: u32,
    /// True if a line of the file is an image column.
    is_by_columns: bool,
    /// Columns are counted from the right.
    from_right: bool,
    /// Rows are counted from the bottom.
    from_bottom: bool,
}

impl Layout {
    /// From a line such as `-Y 512 +X 1024`, the slower coordinate first; +Y is upwards.
    fn parse(resolution: &str) -> Option<Self> {
        let mut words = resolution.split_whitespace();
        let mut next = || Some((words.next()?, words.next()?.parse::<u32>().ok()?));
        let ((slow, lines), (fast, length)) = (next()?, next()?);
        let (is_by_columns, [x, width], [y, height]) = match (slow.as_bytes(), fast.as_bytes()) {
            ([y, b'Y'], [x, b'X']) => (false, [u32::from(*x), length], [u32::from(*y), lines]),
            ([x, b'X'], [y, b'Y']) => (true, [u32::from(*x), lines], [u32::from(*y), length]),
            _ => return None,
        };
        let is_sign = |sign: u32| sign == u32::from(b'+') || sign == u32::from(b'-');
        (is_sign(x) && is_sign(y)).then_some(Self {
            width,
            height,
            is_by_columns,
            from_right: x == u32::from(b'-'),
            from_bottom: y == u32::from(b'+'),
        })
    }

    fn lines(&self) -> u32 {
        if self.is_by_columns { self.width } else { self.height }
    }

    fn line_length(&self) -> u32 {
        if self.is_by_columns { self.height } else { self.width }
    }

    /// Column and row, from the top left, of an element of a line.
    fn place(&self, line: u32, element: u32) -> [u32; 2] {
        let (x, y) = if self.is_by_columns {
            (line, element)
        } else {
            (element, line)
        };
        [
            if self.from_right { self.width - 1 - x } else { x },
            if self.from_bottom { self.height - 1 - y } else { y },
        ]
    }
}

/// Decodes the next line of pixels (three numbers each). The decoder only accepts whole files: each line is passed as an
/// image of one row.
fn read_line(rest: &mut &[u8], line: &mut [f32]) -> Result<(), ImageError> {
    let header = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X {}\n", line.len() / 3);
    let file: Chain<Cursor<String>, &mut &[u8]> = Cursor::new(header).chain(rest);
    HdrDecoder::new(file)?.read_image(bytemuck::cast_slice_mut(line))
}

/// Error of a line of pixels.
fn line_error(path: &Path, error: ImageError, number: u32, layout: Layout) -> EnvironmentError {
    let path = path.to_owned();
    let what = if layout.is_by_columns { "column" } else { "row" };
    match error {
        ImageError::IoError(error) if error.kind() == ErrorKind::UnexpectedEof => EnvironmentError::Truncated {
            path,
            detail: format!("it ends in {what} {} of {}", number + 1, layout.lines()),
        },
        error => EnvironmentError::Damaged {
            path,
            detail: format!("{what} {} cannot be decoded ({error})", number + 1),
        },
    }
}
