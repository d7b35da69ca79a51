//! BMP images of 4 bits per texel with run lengths, some of which the `image` crate rejects as damaged.

/// Largest expansion in texels per byte, and additional texels.
const GROWTH: [u64; 2] = [1 << 10, 1 << 20];

/// Width, height, and RGBA of each texel, rows from the top; `None` for other images.
pub(super) fn decode(bytes: &[u8]) -> Option<(u32, u32, Vec<u8>)> {
    let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    let is_it = bytes.starts_with(b"BM") && bytes.get(28..30)? == [4, 0] && word(30)? == 2;
    let (width, height) = (word(18)?, word(22)?);
    let [growth, floor] = GROWTH;
    let is_sized = u64::from(width) * u64::from(height) <= growth * bytes.len() as u64 + floor;
    if !is_it || !is_sized || width == 0 || height == 0 {
        return None;
    }
    let palette = bytes.get(14 + word(14)? as usize..word(10)? as usize)?;
    let mut indices = vec![0; width as usize * height as usize];
    fill(&mut indices, width as usize, bytes.get(word(10)? as usize..)?)?;
    let color = |index: &u8| match palette.as_chunks::<4>().0.get(usize::from(*index)) {
        Some([blue, green, red, _]) => [*red, *green, *blue, 255],
        None => [0, 0, 0, 255],
    };
    // The last row is stored first.
    let rows = indices.rchunks_exact(width as usize);
    Some((width, height, rows.flatten().flat_map(color).collect()))
}

/// Sets the texels that the codes say, row by row from the bottom; the others stay.
fn fill(indices: &mut [u8], width: usize, mut codes: &[u8]) -> Option<()> {
    let rows = indices.len() / width;
    let (mut x, mut y) = (0_usize, 0_usize);
    let half = |pair: u8, place: usize| if place.is_multiple_of(2) { pair >> 4 } else { pair & 15 };
    while let [count, code, rest @ ..] = codes {
        let (count, code) = (usize::from(*count), *code);
        codes = rest;
        let mut put = |index: u8| {
            if x < width && y < rows {
                indices[y * width + x] = index;
            }
            x += 1;
        };
        match (count, code) {
            (0, 0) => (x, y) = (0, y + 1),
            (0, 1) => return Some(()),
            (0, 2) => {
                let [right, up, rest @ ..] = codes else { return None };
                (x, y) = (x + usize::from(*right), y + usize::from(*up));
                codes = rest;
            }
            (0, literal) => {
                let literal = usize::from(literal);
                // They fill whole words of 16 bits.
                let (pairs, rest) = codes.split_at_checked(literal.div_ceil(4) * 2)?;
                (0..literal).for_each(|place| put(half(pairs[place / 2], place)));
                codes = rest;
            }
            _ => (0..count).for_each(|place| put(half(code, place))),
        }
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_literals_and_moves_are_read() {
        let mut bytes = b"BM".to_vec();
        let words = [0_u32, 0, 62, 40, 4, 3, 0x4_0001, 2, 0, 0, 0, 2, 0];
        bytes.extend(words.iter().flat_map(|word| word.to_le_bytes()));
        bytes.extend([3, 2, 1, 0, 6, 5, 4, 0]);
        // A run that ends beyond the row; three texels as they are; in the next row two to the right, and one more.
        bytes.extend([5, 0x01, 0, 0, 0, 3, 0x11, 0x00, 0, 0, 0, 2, 2, 0, 1, 0x10, 0, 1]);
        let (width, height, texels) = decode(&bytes).expect("a picture");
        assert_eq!((width, height), (4, 3));
        let is_second = |texel: &[u8; 4]| *texel == [4, 5, 6, 255];
        let found: Vec<u8> = texels
            .as_chunks::<4>()
            .0
            .iter()
            .map(|texel| is_second(texel).into())
            .collect();
        assert_eq!(found, [0, 0, 1, 0, 1, 1, 0, 0, 0, 1, 0, 1]);
        assert_eq!(decode(&bytes[..40]), None);
    }
}
