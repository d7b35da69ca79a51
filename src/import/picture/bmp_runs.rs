//! BMP files of run lengths, whose runs may leave pixels out. The `image` crate makes these black, most programs the first
//! colour of the palette: here it decodes the indices, as greys.

use crate::files::u32_at;

/// A file whose palette is its indices, and the colours that they stand for; `None` if it has no run lengths.
pub fn indexed(bytes: &[u8]) -> Option<(Vec<u8>, Vec<[u8; 3]>)> {
    let number = |at| u32_at(bytes, at);
    // 1 and 2: runs of 8 and of 4 bits.
    if !bytes.starts_with(b"BM") || !matches!(number(30)?, 1 | 2) {
        return None;
    }
    let (bits, used) = (number(28)? as u16, number(46)?);
    let count = match used {
        0 => 1 << bits.min(8),
        used => used.min(256) as usize,
    };
    let start = 14_usize.checked_add(number(14)? as usize)?;
    let mut bytes = bytes.to_vec();
    let palette = bytes.get_mut(start..start.checked_add(4 * count)?)?;
    let take = |(index, color): (u8, &mut [u8; 4])| {
        let [blue, green, red, _] = std::mem::replace(color, [index, index, index, 0]);
        [red, green, blue]
    };
    let colors = (0..=255).zip(palette.as_chunks_mut().0).map(take).collect();
    Some((bytes, colors))
}
