//! Images in GPU containers, KTX2 and DDS: flat ones, and the six faces of cubes. Texels are decoded by the basisu, bcdec_rs
//! and half crates.

mod masks;

use std::{borrow::Cow, io::Read};

use ddsfile::{Caps2, D3DFormat, Dds, MiscFlag};
use half::f16;
use image::{DynamicImage, metadata::Orientation};
use ruzstd::StreamingDecoder;

use self::masks::Masks;
use super::{Refusal, basis, codes, light, mapped};
use crate::files::u32_at;

/// The first bytes of a KTX2 file.
const KTX2: [u8; 12] = *b"\xabKTX 20\xbb\r\n\x1a\n";
/// The first bytes of a DDS file.
const DDS: [u8; 4] = *b"DDS ";
/// DDS code for BC3 blocks with red in the opacity channel.
const RXGB: u32 = u32::from_le_bytes(*b"RXGB");
/// Largest Zstandard expansion: factor, and additional bytes.
const ZSTD_GROWTH: [u64; 2] = [4096, 1 << 20];
/// The most columns or rows.
const SIDE_MAX: u32 = 1 << 16;

/// Layout of texels.
#[derive(Clone, Copy)]
enum Layout {
    /// Bytes per texel, and positions of red, green, blue and opacity in it; 255 for a missing one.
    Bytes(usize, [u8; 4]),
    /// Some bits of a texel's bytes for each channel.
    Masks(Masks),
    /// 16-bit integers per texel: 65535 is 1.
    Shorts(usize),
    /// 16-bit floats per texel.
    Halves(usize),
    /// 32-bit floats per texel.
    Floats(usize),
    /// 9 bits each with an exponent that they share.
    SharedExponent,
    /// 11, 11 and 10 bits with a point.
    SmallFloats,
    /// Blocks of 4 × 4 texels: bytes a block, channels, and what decodes it.
    Blocks(usize, usize, fn(&[u8], &mut [u8], usize)),
    /// The same of linear red, green and blue: BC6H, perhaps signed.
    LightBlocks(bool),
}

const GREY: Layout = Layout::Bytes(1, [0, 0, 0, 255]);
const RED_GREEN: Layout = Layout::Bytes(2, [0, 1, 255, 255]);
const RGB: Layout = Layout::Bytes(3, [0, 1, 2, 255]);
const BGR: Layout = Layout::Bytes(3, [2, 1, 0, 255]);
const RGBA: Layout = Layout::Bytes(4, [0, 1, 2, 3]);
const BGRA: Layout = Layout::Bytes(4, [2, 1, 0, 3]);
const BGRX: Layout = Layout::Bytes(4, [2, 1, 0, 255]);
const BC1: Layout = Layout::Blocks(8, 4, bcdec_rs::bc1);
const BC2: Layout = Layout::Blocks(16, 4, bcdec_rs::bc2);
const BC3: Layout = Layout::Blocks(16, 4, bcdec_rs::bc3);
const BC4: Layout = Layout::Blocks(8, 1, |block, texels, pitch| bcdec_rs::bc4(block, texels, pitch, false));
const SIGNED_BC4: Layout = Layout::Blocks(8, 1, |block, texels, pitch| bcdec_rs::bc4(block, texels, pitch, true));
const BC5: Layout = Layout::Blocks(16, 2, |block, texels, pitch| bcdec_rs::bc5(block, texels, pitch, false));
const SIGNED_BC5: Layout = Layout::Blocks(16, 2, |block, texels, pitch| bcdec_rs::bc5(block, texels, pitch, true));
const BC7: Layout = Layout::Blocks(16, 4, bcdec_rs::bc7);

const fn masks(bytes: usize, channels: [u32; 4]) -> Layout {
    Layout::Masks(Masks { bytes, channels })
}

/// The layout of a KTX2 file, by Vulkan's number of its format.
fn of_vulkan(format: u32) -> Option<Layout> {
    Some(match format {
        9 | 15 => GREY,
        16 | 22 => RED_GREEN,
        23 | 29 => RGB,
        30 | 36 => BGR,
        37 | 43 => RGBA,
        44 | 50 => BGRA,
        70 => Layout::Shorts(1),
        77 => Layout::Shorts(2),
        84 => Layout::Shorts(3),
        91 => Layout::Shorts(4),
        76 => Layout::Halves(1),
        83 => Layout::Halves(2),
        90 => Layout::Halves(3),
        97 => Layout::Halves(4),
        100 => Layout::Floats(1),
        103 => Layout::Floats(2),
        106 => Layout::Floats(3),
        109 => Layout::Floats(4),
        122 => Layout::SmallFloats,
        123 => Layout::SharedExponent,
        131..=134 => BC1,
        135 | 136 => BC2,
        137 | 138 => BC3,
        139 => BC4,
        140 => SIGNED_BC4,
        141 => BC5,
        142 => SIGNED_BC5,
        143 | 144 => Layout::LightBlocks(format == 144),
        145 | 146 => BC7,
        _ => return None,
    })
}

/// The layout of a DDS file: by DXGI's number of its format, or by that of Direct3D 9.
fn of_dds(dds: &Dds) -> Option<Layout> {
    if dds.header.spf.fourcc.as_ref().is_some_and(|code| code.0 == RXGB) {
        return Some(Layout::Blocks(16, 4, rxgb));
    }
    if let Some(format) = dds.get_d3d_format() {
        return Some(match format {
            D3DFormat::L16 => Layout::Shorts(1),
            D3DFormat::G16R16 => Layout::Shorts(2),
            D3DFormat::A16B16G16R16 => Layout::Shorts(4),
            D3DFormat::R16F => Layout::Halves(1),
            D3DFormat::G16R16F => Layout::Halves(2),
            D3DFormat::A16B16G16R16F => Layout::Halves(4),
            D3DFormat::R32F => Layout::Floats(1),
            D3DFormat::G32R32F => Layout::Floats(2),
            D3DFormat::A32B32G32R32F => Layout::Floats(4),
            D3DFormat::DXT1 => BC1,
            D3DFormat::DXT2 | D3DFormat::DXT3 => BC2,
            D3DFormat::DXT4 | D3DFormat::DXT5 => BC3,
            _ => return None,
        });
    }
    Some(match dds.get_dxgi_format()? as u32 {
        2 => Layout::Floats(4),
        6 => Layout::Floats(3),
        10 => Layout::Halves(4),
        11 => Layout::Shorts(4),
        24 => masks(4, [0x3ff, 0x3ff << 10, 0x3ff << 20, 0x3 << 30]),
        16 => Layout::Floats(2),
        26 => Layout::SmallFloats,
        28 | 29 => RGBA,
        34 => Layout::Halves(2),
        35 => Layout::Shorts(2),
        41 => Layout::Floats(1),
        49 => RED_GREEN,
        54 => Layout::Halves(1),
        56 => Layout::Shorts(1),
        61 => GREY,
        65 => masks(1, [0, 0, 0, 0xff]),
        67 => Layout::SharedExponent,
        71 | 72 => BC1,
        74 | 75 => BC2,
        77 | 78 => BC3,
        80 => BC4,
        81 => SIGNED_BC4,
        83 => BC5,
        84 => SIGNED_BC5,
        85 => masks(2, [0xf800, 0x7e0, 0x1f, 0]),
        86 => masks(2, [0x7c00, 0x3e0, 0x1f, 0x8000]),
        87 | 91 => BGRA,
        88 | 93 => BGRX,
        95 => Layout::LightBlocks(false),
        96 => Layout::LightBlocks(true),
        98 | 99 => BC7,
        115 => masks(2, [0xf00, 0xf0, 0xf, 0xf000]),
        _ => return None,
    })
}

/// Whether bytes start like such a container.
pub fn is_container(bytes: &[u8]) -> bool {
    bytes.starts_with(&KTX2) || bytes.starts_with(&DDS)
}

/// The image, or the six faces of the cube (+X, −X, +Y, −Y, +Z, −Z), at the largest level within `side_max` (of an image, of
/// a face), or the smallest level.
pub fn decode(bytes: &[u8], side_max: [u32; 2]) -> Result<Vec<DynamicImage>, Refusal> {
    if bytes.starts_with(&DDS) {
        return decode_dds(bytes, side_max);
    }
    let file = Ktx2::read(bytes).ok_or("its header is cut short")?;
    let images = file.decode(side_max)?;
    Ok(images.into_iter().map(|image| file.arranged(image)).collect())
}

/// The level at which both sides are at most so long; else the last.
fn level_within(width: u32, height: u32, levels: u32, side_max: u32) -> u32 {
    let fits = |level: &u32| width.max(height).checked_shr(*level).unwrap_or(0) <= side_max;
    let last = levels.clamp(1, 32) - 1;
    (0..=last).find(fits).unwrap_or(last)
}

/// A KTX2 file's header, in so far as it matters here.
struct Ktx2<'a> {
    bytes: &'a [u8],
    format: u32,
    width: u32,
    height: u32,
    faces: u32,
    levels: u32,
    compression: u32,
}

impl<'a> Ktx2<'a> {
    fn read(bytes: &'a [u8]) -> Option<Self> {
        let number = |at| u32_at(bytes, at);
        Some(Self {
            bytes,
            format: number(12)?,
            width: number(20)?,
            height: number(24)?.max(1),
            faces: number(36)?,
            levels: number(40)?.max(1),
            compression: number(44)?,
        })
    }

    fn decode(&self, side_max: [u32; 2]) -> Result<Vec<DynamicImage>, Refusal> {
        let faces = if self.faces == 6 { 6 } else { 1 };
        let side_max = side_max[usize::from(faces == 6)];
        if self.width == 0 || self.width.max(self.height) > SIDE_MAX {
            return Err(format!("{} × {} texels are no size", self.width, self.height).into());
        }
        if self.format == 0 {
            let level = |[width, height]: [u32; 2], levels| level_within(width, height, levels, side_max);
            return Ok(basis::decode(self.bytes, faces, level)?);
        }
        let Some(layout) = of_vulkan(self.format) else {
            return Err(Refusal::NotRead(format!("number {} of Vulkan's formats", self.format)));
        };
        let level = level_within(self.width, self.height, self.levels, side_max);
        let [width, height] = [self.width, self.height].map(|side| (side >> level).max(1));
        let size = layout.bytes(width, height).ok_or("it is too large")?;
        let level = self.level(level, size * faces).ok_or("it is damaged")?;
        let faces = level.chunks_exact(size).take(faces);
        let faces: Option<_> = faces.map(|bytes| layout.image([width, height], bytes)).collect();
        faces.ok_or_else(|| "it is damaged".into())
    }

    /// The value of a key, which is a text (KTX 2.0, "Key/Value Data").
    fn value(&self, key: &str) -> &'a [u8] {
        let number = |at| u32_at(self.bytes, at).map(|x| x as usize);
        let found = || {
            let values = self.bytes.get(number(56)?..)?.get(..number(60)?)?;
            let (key, mut places) = (format!("{key}\0"), values.windows(key.len() + 1));
            let start = places.position(|place| place == key.as_bytes())? + key.len();
            values[start..].split(|byte| *byte == 0).next()
        };
        found().unwrap_or_default()
    }

    /// The image with its channels as `KTXswizzle` says, and its first texel at the top left: `KTXorientation` names where
    /// columns and rows go, right and down (`rd`) if it is not there. A cube always has that.
    fn arranged(&self, mut image: DynamicImage) -> DynamicImage {
        if let [r, g, b, a] = *self.value("KTXswizzle") {
            image = mapped(image, |texel| {
                [r, g, b, a].map(|channel| match channel {
                    b'r' => texel[0],
                    b'g' => texel[1],
                    b'b' => texel[2],
                    b'a' => texel[3],
                    b'0' => 0.0,
                    _ => 1.0,
                })
            });
        }
        let directions = self.value("KTXorientation");
        for (direction, turn) in [(b'l', Orientation::FlipHorizontal), (b'u', Orientation::FlipVertical)] {
            if self.faces != 6 && directions.contains(&direction) {
                image.apply_orientation(turn);
            }
        }
        image
    }

    /// The first `size` bytes of a level, decompressed.
    fn level(&self, level: u32, size: usize) -> Option<Cow<'a, [u8]>> {
        let entry = self.bytes.get(80 + 24 * level as usize..)?;
        let number = |at: usize| usize::try_from(u64::from_le_bytes(entry.get(at..at + 8)?.try_into().ok()?)).ok();
        let packed = self.bytes.get(number(0)?..)?.get(..number(8)?)?;
        match self.compression {
            0 => Some(Cow::Borrowed(packed.get(..size)?)),
            2 => {
                let [growth, floor] = ZSTD_GROWTH;
                if size as u64 > growth * packed.len() as u64 + floor {
                    return None;
                }
                let mut unpacked = Vec::new();
                let mut decoder = StreamingDecoder::new(packed).ok()?.take(size as u64);
                decoder.read_to_end(&mut unpacked).ok()?;
                (unpacked.len() == size).then_some(Cow::Owned(unpacked))
            }
            _ => None,
        }
    }
}

fn decode_dds(bytes: &[u8], side_max: [u32; 2]) -> Result<Vec<DynamicImage>, Refusal> {
    let dds = Dds::read(bytes).map_err(|error| error.to_string())?;
    let (width, height, levels) = (dds.get_width(), dds.get_height(), dds.get_num_mipmap_levels());
    if width == 0 || height == 0 || width.max(height) > SIDE_MAX {
        return Err(format!("{width} × {height} texels are no size").into());
    }
    let layout = of_dds(&dds)
        .or_else(|| Masks::of_dds(bytes).map(Layout::Masks))
        .ok_or_else(|| {
            let format = dds.get_dxgi_format();
            let what = format.map_or("this layout of DDS".to_owned(), |format| {
                format!("DXGI's format {format:?}")
            });
            Refusal::NotRead(what)
        })?;
    let is_new_cube = |header: &ddsfile::Header10| header.misc_flag.contains(MiscFlag::TEXTURECUBE);
    let is_cube = dds.header.caps2.contains(Caps2::CUBEMAP) || dds.header10.as_ref().is_some_and(is_new_cube);
    let level = level_within(width, height, levels, side_max[usize::from(is_cube)]);
    let size_of = |level: u32| layout.bytes((width >> level).max(1), (height >> level).max(1));
    let sizes: Option<Vec<usize>> = (0..levels.clamp(1, 32)).map(size_of).collect();
    let sizes = sizes.ok_or("it is too large")?;
    // Each face has its levels behind it.
    let (before, whole) = (
        sizes[..level as usize].iter().sum::<usize>(),
        sizes.iter().sum::<usize>(),
    );
    let size = sizes[level as usize];
    let [width, height] = [width, height].map(|side| (side >> level).max(1));
    let face = |face: usize| {
        let bytes = dds.data.get(face * whole + before..)?.get(..size)?;
        layout.image([width, height], bytes)
    };
    let faces: Option<_> = (0..if is_cube { 6 } else { 1 }).map(face).collect();
    faces.ok_or_else(|| "it is cut short".into())
}

impl Layout {
    /// Bytes of so many texels.
    fn bytes(self, width: u32, height: u32) -> Option<usize> {
        let (side, size) = match self {
            Self::Bytes(bytes, _) | Self::Masks(Masks { bytes, .. }) => (1, bytes),
            Self::Shorts(channels) | Self::Halves(channels) => (1, 2 * channels),
            Self::Floats(channels) => (1, 4 * channels),
            Self::SharedExponent | Self::SmallFloats => (1, 4),
            Self::Blocks(size, ..) => (4, size),
            Self::LightBlocks(_) => (4, 16),
        };
        let [columns, rows] = [width, height].map(|texels| texels.div_ceil(side) as usize);
        columns.checked_mul(rows)?.checked_mul(size)
    }

    /// Decodes an image from exactly the bytes that it needs.
    fn image(self, size: [u32; 2], bytes: &[u8]) -> Option<DynamicImage> {
        let shorts = || bytes.as_chunks().0.iter();
        match self {
            Self::Bytes(count, places) => {
                let channel = |texel: &[u8], place: u8| texel.get(usize::from(place)).copied().unwrap_or(255);
                let rgba = |texel: &[u8]| places.map(|place| channel(texel, place));
                codes(size, 4, bytes.chunks_exact(count).flat_map(rgba).collect())
            }
            Self::Masks(masks) => codes(size, 4, masks.codes(bytes)),
            Self::Shorts(channels) => {
                let fraction = |pair: &[u8; 2]| f32::from(u16::from_le_bytes(*pair)) / 65535.0;
                linear(size, channels, shorts().map(fraction).collect())
            }
            Self::Halves(channels) => {
                let number = |pair: &[u8; 2]| f16::from_le_bytes(*pair).to_f32();
                linear(size, channels, shorts().map(number).collect())
            }
            Self::Floats(channels) => {
                let number = |bytes: &[u8; 4]| f32::from_le_bytes(*bytes);
                linear(size, channels, bytes.as_chunks().0.iter().map(number).collect())
            }
            Self::SharedExponent => light(size, 3, words(bytes).flat_map(shared_exponent).collect()),
            Self::SmallFloats => light(size, 3, words(bytes).flat_map(small_floats).collect()),
            Self::Blocks(count, channels, decode) => {
                let texels = blocks(size, channels, bytes.chunks_exact(count), decode);
                match channels {
                    2 => codes(size, 3, with_blue(&texels, 255)),
                    _ => codes(size, channels, texels),
                }
            }
            Self::LightBlocks(is_signed) => {
                let decode = |block: &[u8], texels: &mut [f32], pitch| {
                    bcdec_rs::bc6h_float(block, texels, pitch, is_signed);
                };
                light(size, 3, blocks(size, 3, bytes.chunks_exact(16), decode))
            }
        }
    }
}

/// Linear numbers: two channels are red and green.
fn linear(size: [u32; 2], channels: usize, numbers: Vec<f32>) -> Option<DynamicImage> {
    match channels {
        2 => light(size, 3, with_blue(&numbers, 1.0)),
        _ => light(size, channels, numbers),
    }
}

fn with_blue<T: Copy>(numbers: &[T], blue: T) -> Vec<T> {
    numbers
        .as_chunks()
        .0
        .iter()
        .flat_map(|[red, green]| [*red, *green, blue])
        .collect()
}

/// BC3 with red in the opacity channel.
fn rxgb(block: &[u8], texels: &mut [u8], pitch: usize) {
    bcdec_rs::bc3(block, texels, pitch);
    for [red, _, _, opacity] in texels.as_chunks_mut().0 {
        *red = std::mem::replace(opacity, 255);
    }
}

/// The texels of blocks of 4 × 4 row by row, the channels of each together; those beyond the image are skipped.
fn blocks<'a, T: Copy + Default>(
    size: [u32; 2],
    channels: usize,
    blocks: impl Iterator<Item = &'a [u8]>,
    decode: impl Fn(&[u8], &mut [T], usize),
) -> Vec<T> {
    let [width, height] = size.map(|side| side as usize);
    let (across, pitch) = (width.div_ceil(4), 4 * channels);
    let mut texels = vec![T::default(); width * height * channels];
    let mut decoded = vec![T::default(); 4 * pitch];
    for (number, block) in blocks.enumerate() {
        decode(block, &mut decoded, pitch);
        let (left, top) = (number % across * 4, number / across * 4);
        let columns = (width - left).min(4) * channels;
        for (row, line) in decoded.chunks_exact(pitch).enumerate().take(height - top) {
            let start = ((top + row) * width + left) * channels;
            texels[start..start + columns].copy_from_slice(&line[..columns]);
        }
    }
    texels
}

fn words(bytes: &[u8]) -> impl Iterator<Item = u32> {
    bytes.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word))
}

/// E5B9G9R9 (Vulkan specification, shared exponent to RGB).
fn shared_exponent(word: u32) -> [f32; 3] {
    let scale = f32::exp2((word >> 27) as f32 - 24.0);
    [0, 9, 18].map(|shift| (word >> shift & 0x1ff) as f32 * scale)
}

/// B10G11R11: halves without sign and with fewer digits (Vulkan specification, unsigned 11-bit and 10-bit numbers).
fn small_floats(word: u32) -> [f32; 3] {
    let halves = [(word & 0x7ff) << 4, (word >> 11 & 0x7ff) << 4, (word >> 22) << 5];
    halves.map(|half| f16::from_bits(half as u16).to_f32())
}
