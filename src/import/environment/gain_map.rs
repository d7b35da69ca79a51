//! Ultra HDR: a display-referred JPEG followed by a second one with the gain per pixel (Google, Ultra HDR Image Format 1.1,
//! with the metadata of Adobe's gain maps).

use image::{DynamicImage, RgbImage};

use crate::optics::tone::linear_from_srgb;
use crate::optics::vector::Vec3;
use crate::picture::decode_image;

/// Prefix of metadata in a JPEG segment.
const XMP: &[u8] = b"http://ns.adobe.com/xap/1.0/\0";
/// Namespace of a gain map's metadata.
const NAMES: &str = "http://ns.adobe.com/hdr-gain-map/1.0/";
/// Segment markers: metadata, image list, pixels.
const APP1: u8 = 0xe1;
const APP2: u8 = 0xe2;
const SCAN: u8 = 0xda;
const END: [u8; 2] = [0xff, 0xd9];
/// Tag with the images' positions in an image list.
const PICTURES: usize = 0xb002;

/// Look-up tables to linear light.
pub(super) struct Light {
    shown: RgbImage,
    map: RgbImage,
    /// Linear values of the base image's codes.
    linear: [f32; 256],
    /// Gains of the map's codes, by channel.
    gains: [[f32; 256]; 3],
    metadata: Metadata,
}

impl Light {
    pub fn rgb(&self, column: u32, row: u32) -> [f32; 3] {
        let along = |at: u32, size: u32, map_size: u32| {
            let place = at as f32 / size as f32 * map_size as f32;
            let texel = (place as u32).min(map_size - 1);
            ([texel, (texel + 1).min(map_size - 1)], place.fract())
        };
        let (columns, right) = along(column, self.shown.width(), self.map.width());
        let (rows, below) = along(row, self.shown.height(), self.map.height());
        std::array::from_fn(|channel| {
            let gain = |x: u32, y: u32| self.gains[channel][usize::from(self.map.get_pixel(x, y).0[channel])];
            let of_row = |y: u32| gain(columns[0], y) * (1.0 - right) + gain(columns[1], y) * right;
            let gain = of_row(rows[0]) * (1.0 - below) + of_row(rows[1]) * below;
            let shown = self.linear[usize::from(self.shown.get_pixel(column, row).0[channel])];
            ((shown + self.metadata.shown_offset[channel]) * gain - self.metadata.light_offset[channel]).max(0.0)
        })
    }
}

/// The light of a JPEG whose pixels for screens have been decoded, as bright as its gain map allows; `None` where it has no such
/// map.
///
/// # Errors
/// What is wrong with the map.
pub(super) fn light(bytes: &[u8], shown: &DynamicImage) -> Option<Result<Light, String>> {
    let map = listed_picture(bytes).or_else(|| appended_picture(bytes));
    // The metadata are in the map, or in older files in the first image. Other files have a second image too.
    let metadata = Metadata::of(bytes).or_else(|| Metadata::of(map?))?;
    Some(apply(map, metadata, shown))
}

fn apply(map: Option<&[u8]>, metadata: Metadata, shown: &DynamicImage) -> Result<Light, String> {
    let map = map.ok_or("it is not there")?;
    if metadata.leads_to_screens {
        return Err("it leads from light to screens, not from screens to light".to_owned());
    }
    let map = decode_image("gain map", map).map_err(|error| error.to_string())?;
    let part = |code: usize| code as f32 / 255.0;
    let gain = |channel: usize, code: usize| {
        let share = part(code).powf(1.0 / metadata.gamma[channel]);
        let [least, most] = [metadata.least[channel], metadata.most[channel]];
        (least + share * (most - least)).exp2()
    };
    Ok(Light {
        shown: shown.to_rgb8(),
        map: map.into_rgb8(),
        linear: std::array::from_fn(|code| linear_from_srgb(Vec3::splat(part(code))).x),
        gains: std::array::from_fn(|channel| std::array::from_fn(|code| gain(channel, code))),
        metadata,
    })
}

/// Metadata of a gain map, by channel.
struct Metadata {
    /// Exponents of 2 for its lowest and highest code.
    least: [f32; 3],
    most: [f32; 3],
    gamma: [f32; 3],
    /// Offset added to the base value before the gain, and subtracted afterwards.
    shown_offset: [f32; 3],
    light_offset: [f32; 3],
    /// True if the base image is the bright one.
    leads_to_screens: bool,
}

impl Metadata {
    /// Metadata of a JPEG.
    fn of(jpeg: &[u8]) -> Option<Self> {
        let mut segments = segments(jpeg).filter(|segment| segment.marker == APP1);
        let packet = segments.find_map(|segment| segment.data.strip_prefix(XMP))?;
        let text = std::str::from_utf8(packet)
            .ok()?
            .trim_matches(['\0', '\u{feff}', ' ', '\n', '\r']);
        let document = roxmltree::Document::parse(text).ok()?;
        // Properties are attributes, or elements with a text or a list of texts.
        let property = |name: &str| {
            document
                .descendants()
                .find_map(|node| match node.attribute((NAMES, name)) {
                    Some(value) => Some(value.to_owned()),
                    None if node.has_tag_name((NAMES, name)) => {
                        let texts = node.descendants().filter(|node| node.is_text());
                        Some(texts.filter_map(|node| node.text()).collect::<Vec<_>>().join(" "))
                    }
                    None => None,
                })
        };
        let numbers = |name: &str| {
            let text = property(name)?;
            let numbers = text.split([',', ' ', '\n', '\r', '\t']).filter(|part| !part.is_empty());
            let numbers: Result<Vec<f32>, _> = numbers.map(str::parse).collect();
            match numbers.ok()?[..] {
                [one] => Some([one; 3]),
                [r, g, b] => Some([r, g, b]),
                _ => None,
            }
        };
        let gamma = numbers("Gamma").filter(|gamma| gamma.iter().all(|gamma| *gamma > 0.0));
        Some(Self {
            least: numbers("GainMapMin").unwrap_or([0.0; 3]),
            most: numbers("GainMapMax")?,
            gamma: gamma.unwrap_or([1.0; 3]),
            shown_offset: numbers("OffsetSDR").unwrap_or([1.0 / 64.0; 3]),
            light_offset: numbers("OffsetHDR").unwrap_or([1.0 / 64.0; 3]),
            leads_to_screens: property("BaseRenditionIsHDR")
                .is_some_and(|text| text.trim().eq_ignore_ascii_case("true")),
        })
    }
}

/// A part of a JPEG before its pixels.
struct Segment<'a> {
    marker: u8,
    /// Start of its data in the file.
    at: usize,
    data: &'a [u8],
}

/// Up to the first with pixels.
fn segments(jpeg: &[u8]) -> impl Iterator<Item = Segment<'_>> {
    let mut next = 2;
    std::iter::from_fn(move || {
        // A marker may be filled up in front.
        while jpeg.get(next..next + 2)? == [0xff, 0xff] {
            next += 1;
        }
        let [0xff, marker, high, low] = *jpeg.get(next..)?.first_chunk()? else {
            return None;
        };
        let (at, end) = (next + 4, next + 2 + usize::from(u16::from_be_bytes([high, low])));
        let data = jpeg.get(at..end)?;
        next = if marker == SCAN { jpeg.len() } else { end };
        Some(Segment { marker, at, data })
    })
}

/// The second image of a file with an image list (CIPA DC-007, multi-picture format).
fn listed_picture(bytes: &[u8]) -> Option<&[u8]> {
    let mut segments = segments(bytes).filter(|segment| segment.marker == APP2);
    let (start, list) = segments.find_map(|segment| Some((segment.at + 4, segment.data.strip_prefix(b"MPF\0")?)))?;
    let is_big_endian = list.starts_with(b"MM");
    let number = |at: usize, size: usize| {
        let bytes = list.get(at..)?.get(..size)?.iter();
        let add = |sum: usize, byte: &u8| (sum << 8) | usize::from(*byte);
        Some(if is_big_endian {
            bytes.fold(0, add)
        } else {
            bytes.rev().fold(0, add)
        })
    };
    let directory = number(4, 4)?;
    let mut entries = (0..number(directory, 2)?).map(|entry| directory + 2 + 12 * entry);
    let pictures = entries.find(|at| number(*at, 2) == Some(PICTURES))?;
    let second = number(pictures + 8, 4)? + 16;
    let (size, offset) = (number(second + 4, 4)?, number(second + 8, 4)?);
    bytes.get(start + offset..)?.get(..size)
}

/// An image appended after the first one.
fn appended_picture(bytes: &[u8]) -> Option<&[u8]> {
    let scan = segments(bytes).find(|segment| segment.marker == SCAN)?.at;
    let behind = scan + bytes[scan..].windows(2).position(|pair| pair == END)?;
    let start = behind
        + bytes[behind..]
            .windows(3)
            .position(|bytes| bytes == [0xff, 0xd8, 0xff])?;
    let end = bytes.windows(2).rposition(|pair| pair == END)? + END.len();
    bytes.get(start..end)
}
