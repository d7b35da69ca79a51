//! PNG images that are larger than needed, reduced while they are decoded: the whole image is never in memory.

use std::io::Cursor;

use png::{BitDepth, ColorType, Decoder, Limits, Reader, Transformations};

use super::DECODED_MAX;
use crate::scene::texture::scale::{Code, Halving, half, nearest_of_16};

/// A reduced image: red, green, blue and opacity of each texel, row by row from the top.
pub(super) struct Reduced {
    pub size: [u32; 2],
    pub texels: Texels,
}

/// Texels of 8 or 16 bits per channel.
pub(super) enum Texels {
    Codes8(Vec<u8>),
    Codes16(Vec<u16>),
}

/// Width and height halved until they are at most `side_max`.
pub(super) fn size_within(mut size: [u32; 2], side_max: u32) -> [u32; 2] {
    while size[0].max(size[1]) > side_max.max(1) {
        size = half(size);
    }
    size
}

/// The image with sides of at most `side_max`; `None` if its rows are not stored in order. An image of a single value has one
/// texel. Colours have 8 bits per channel.
///
/// # Errors
///
/// The fault of the file.
pub(super) fn reduced(bytes: &[u8], side_max: u32, is_color: bool) -> Result<Option<Reduced>, String> {
    let limits = Limits {
        bytes: DECODED_MAX as usize,
    };
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_transformations(Transformations::EXPAND);
    let reader = decoder.read_info().map_err(|error| error.to_string())?;
    if reader.info().interlaced {
        return Ok(None);
    }
    let (color, depth) = reader.output_color_type();
    let codes16 = |bytes: &[u8]| -> Vec<u16> {
        let pairs = bytes.as_chunks::<2>().0.iter();
        pairs.map(|pair| u16::from_be_bytes(*pair)).collect()
    };
    if depth != BitDepth::Sixteen {
        return rows(reader, side_max, is_color, |row| texels(color, row));
    }
    if is_color {
        return rows(reader, side_max, true, |row| {
            let codes: Vec<u8> = codes16(row).into_iter().map(nearest_of_16).collect();
            texels(color, &codes)
        });
    }
    rows(reader, side_max, false, |row| texels(color, &codes16(row)))
}

/// The texels of a row.
fn texels<C: Stored>(color: ColorType, codes: &[C]) -> Vec<[C; 4]> {
    let full = C::nearest(1.0);
    match color {
        ColorType::Rgba => codes.as_chunks::<4>().0.to_vec(),
        ColorType::GrayscaleAlpha => codes.as_chunks::<2>().0.iter().map(|&[g, a]| [g, g, g, a]).collect(),
        ColorType::Grayscale => codes.iter().map(|&g| [g, g, g, full]).collect(),
        // Indices are expanded.
        ColorType::Rgb | ColorType::Indexed => {
            let colors = codes.as_chunks::<3>().0.iter();
            colors.map(|&[r, g, b]| [r, g, b, full]).collect()
        }
    }
}

/// Codes that are texels of an image.
trait Stored: Code {
    fn texels(codes: Vec<Self>) -> Texels;
}

impl Stored for u8 {
    fn texels(codes: Vec<Self>) -> Texels {
        Texels::Codes8(codes)
    }
}

impl Stored for u16 {
    fn texels(codes: Vec<Self>) -> Texels {
        Texels::Codes16(codes)
    }
}

fn rows<C: Stored>(
    mut reader: Reader<Cursor<&[u8]>>,
    side_max: u32,
    is_color: bool,
    texels: impl Fn(&[u8]) -> Vec<[C; 4]>,
) -> Result<Option<Reduced>, String> {
    let whole = [reader.info().width, reader.info().height];
    let size = size_within(whole, side_max);
    let mut halvings = Vec::new();
    let mut step = whole;
    while step != size {
        halvings.push(Halving::new(step, is_color));
        step = half(step);
    }
    let mut image = Image::new(size);
    while let Some(row) = reader.next_row().map_err(|error| error.to_string())? {
        let all = Some(texels(row.data()));
        let reduced = halvings.iter_mut().fold(all, |row, halving| halving.put(&row?));
        reduced.into_iter().for_each(|row| image.put(&row));
    }
    image.finish().map(Some)
}

/// An image that grows by rows. While all texels are equal, it takes no memory.
struct Image<C> {
    size: [u32; 2],
    first: Option<[C; 4]>,
    equal: usize,
    texels: Vec<[C; 4]>,
}

impl<C: Stored> Image<C> {
    fn new(size: [u32; 2]) -> Self {
        Self {
            size,
            first: None,
            equal: 0,
            texels: Vec::new(),
        }
    }

    fn put(&mut self, row: &[[C; 4]]) {
        let Some(&texel) = row.first() else { return };
        let first = *self.first.get_or_insert(texel);
        if self.texels.is_empty() && row.iter().all(|texel| *texel == first) {
            self.equal += row.len();
            return;
        }
        if self.texels.is_empty() {
            let [width, height] = self.size.map(|side| side as usize);
            self.texels.reserve_exact(width * height);
            self.texels.resize(self.equal, first);
        }
        self.texels.extend_from_slice(row);
    }

    fn finish(self) -> Result<Reduced, String> {
        let [width, height] = self.size.map(|side| side as usize);
        let first = self.first.ok_or("it has no texels")?;
        if self.texels.len().max(self.equal) != width * height {
            return Err("it is cut short".to_owned());
        }
        let (size, texels) = match self.texels.is_empty() {
            true => ([1; 2], vec![first]),
            false => (self.size, self.texels),
        };
        let texels = C::texels(texels.into_flattened());
        Ok(Reduced { size, texels })
    }
}

#[cfg(test)]
mod tests {
    use image::{DynamicImage, ImageFormat};

    use super::*;
    use crate::budget::Budget;
    use crate::picture::{Encoded, Wanted, decode_bytes};
    use crate::scene::texture::scale::scaled_to;

    fn encoded(image: &DynamicImage) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, ImageFormat::Png).expect("written");
        bytes.into_inner()
    }

    /// The same texels as by decoding all and reducing then, for each type of pixel.
    #[test]
    fn rows_are_reduced_to_what_the_whole_image_is() {
        let rgba = image::RgbaImage::from_fn(37, 22, |x, y| {
            image::Rgba([7 * x as u8, 11 * y as u8, (x * y) as u8, 255 - x as u8])
        });
        let rgba = DynamicImage::ImageRgba8(rgba);
        let images = [
            rgba.clone(),
            rgba.to_rgb8().into(),
            rgba.to_luma8().into(),
            rgba.to_luma_alpha8().into(),
            rgba.to_rgba16().into(),
            rgba.to_luma16().into(),
        ];
        for image in images {
            let bytes = encoded(&image);
            for is_color in [true, false] {
                for side_max in [20, 9, 1] {
                    let (name, found) = ("a.png".to_owned(), bytes.clone().into());
                    let wanted = Wanted { is_color, side_max };
                    let scaled = Encoded { name, bytes: found }.texture(wanted, &Budget::of_import());
                    let by_rows = scaled.unwrap_or_else(|why| panic!("{why}")).texture;
                    let decoded = decode_bytes("a.png".to_owned(), &bytes).unwrap_or_else(|why| panic!("{why}"));
                    let (as_whole, _) = scaled_to(decoded.texture(is_color), side_max, is_color);
                    let of = (image.color(), is_color, side_max);
                    assert_eq!([by_rows.width, by_rows.height], [as_whole.width, as_whole.height]);
                    assert!(
                        by_rows.rgba16 == as_whole.rgba16 && by_rows.rgba8 == as_whole.rgba8,
                        "{of:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn an_image_of_one_value_has_one_texel_and_a_cut_one_is_told() {
        let plain = image::RgbaImage::from_pixel(64, 64, image::Rgba([1, 2, 3, 255]));
        let bytes = encoded(&plain.into());
        let found = reduced(&bytes, 32, true).expect("decoded").expect("by rows");
        assert_eq!(found.size, [1, 1]);
        assert!(matches!(found.texels, Texels::Codes8(codes) if codes == [1, 2, 3, 255]));
        let noise = image::RgbaImage::from_fn(64, 64, |x, y| image::Rgba([(x * 37 + y * 91) as u8; 4]));
        let bytes = encoded(&noise.into());
        assert!(reduced(&bytes[..bytes.len() / 2], 32, true).is_err());
    }
}
