//! Texels of whole numbers whose channels are some of their bits each.

use crate::files::u32_at;

/// The bits of a texel's bytes that are each channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Masks {
    /// Bytes a texel, at most 4.
    pub bytes: usize,
    /// Bit masks of red, green, blue and opacity; 0 for a missing channel.
    pub channels: [u32; 4],
}

/// Some texels have an opacity.
const WITH_OPACITY: u32 = 0x1;
/// Texels have nothing but an opacity.
const OPACITY: u32 = 0x2;
/// The format stands in a code.
const CODE: u32 = 0x4;
const COLORS: u32 = 0x40;
const GREY: u32 = 0x2_0000;

impl Masks {
    /// Masks of a DDS file that states them.
    pub fn of_dds(bytes: &[u8]) -> Option<Self> {
        let number = |at| u32_at(bytes, at);
        let (flags, bits) = (number(80)?, number(88)?);
        let [red, green, blue, opacity] = [number(92)?, number(96)?, number(100)?, number(104)?];
        let has = |flag: u32| flags & flag != 0;
        let [red, green, blue] = match (has(COLORS), has(GREY), has(OPACITY)) {
            (true, ..) => [red, green, blue],
            (_, true, _) => [red; 3],
            (_, _, true) => [0; 3],
            _ => return None,
        };
        let opacity = if has(WITH_OPACITY | OPACITY) { opacity } else { 0 };
        let is_read = !has(CODE) && matches!(bits, 8 | 16 | 24 | 32);
        is_read.then_some(Self {
            bytes: bits as usize / 8,
            channels: [red, green, blue, opacity],
        })
    }

    /// Codes of 8 bits, four a texel: a colour that is not there is 0, opacity 255.
    pub fn codes(self, bytes: &[u8]) -> Vec<u8> {
        let [red, green, blue, opacity] = self.channels;
        let texel = |texel: &[u8]| {
            let word = texel.iter().rev().fold(0, |word, byte| word << 8 | u32::from(*byte));
            let code = |mask, otherwise| code(word, mask).unwrap_or(otherwise);
            [code(red, 0), code(green, 0), code(blue, 0), code(opacity, 255)]
        };
        bytes.chunks_exact(self.bytes).flat_map(texel).collect()
    }
}

/// The masked bits of a word as an 8-bit code; `None` for an empty mask.
fn code(word: u32, mask: u32) -> Option<u8> {
    let [value, most] = [word & mask, mask].map(|bits| u64::from(bits.checked_shr(mask.trailing_zeros()).unwrap_or(0)));
    Some(((value * 255 + most / 2).checked_div(most)?) as u8)
}
