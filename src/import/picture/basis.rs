//! Basis Universal, the texels of most KTX2 files, decoded by the basisu crate.

use image::DynamicImage;

/// Each of the faces, of the level of so many that `level_of` chooses for columns and rows.
#[cfg(feature = "basis")]
pub fn decode(
    bytes: &[u8],
    faces: usize,
    level_of: impl Fn([u32; 2], u32) -> u32,
) -> Result<Vec<DynamicImage>, String> {
    use basisu::{DecodeFlags, TargetFormat, Transcoder};
    /// Largest expansion in texels per byte, and additional texels.
    const GROWTH: [u64; 2] = [64, 1 << 20];
    let text = |error: basisu::Error| format!("Basis Universal: {error:?}");
    let transcoder = Transcoder::new(bytes).map_err(text)?;
    let (width, height) = transcoder.base_dimensions();
    let texels = u64::from(width) * u64::from(height) * faces as u64;
    if texels > GROWTH[0] * bytes.len() as u64 + GROWTH[1] {
        return Err(format!("{} bytes cannot hold {width} × {height}", bytes.len()));
    }
    let level = level_of([width, height], transcoder.level_count());
    let [width, height] = [width, height].map(|side| (side >> level).max(1));
    let face = |face: usize| {
        let (target, flags) = (TargetFormat::Rgba32, DecodeFlags::NONE);
        let codes = transcoder.transcode_image(level, 0, face as u32, target, flags);
        super::codes([width, height], 4, codes.map_err(text)?).ok_or_else(|| "it is cut short".to_owned())
    };
    (0..faces).map(face).collect()
}

/// Says that the program was built without.
#[cfg(not(feature = "basis"))]
pub fn decode(
    _bytes: &[u8],
    _faces: usize,
    _level_of: impl Fn([u32; 2], u32) -> u32,
) -> Result<Vec<DynamicImage>, String> {
    Err("this program was built without Basis Universal (the feature `basis`)".to_owned())
}
