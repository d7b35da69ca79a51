//! Ultra HDR: a JPEG for screens with a second JPEG behind it, which tells by how much each place is brighter than screens show
//! it (Google, Ultra HDR Image Format 1.1; ISO 21496-1).

use image::{DynamicImage, GenericImageView as _};
use ultrahdr_rs::gainmap::apply::apply_gainmap;
use ultrahdr_rs::{
    ColorGamut, ColorTransfer, Decoder, GainMap, GainMapMetadata, HdrOutputFormat, PixelFormat, RawImage, Unstoppable,
};

use crate::scene::picture::decode_image;

/// Bytes of a pixel with its gain: four floats.
const PIXEL: usize = 16;

/// Linear light, row after row.
pub(super) struct Light(RawImage);

impl Light {
    pub fn rgb(&self, column: u32, row: u32) -> [f32; 3] {
        let start = row as usize * self.0.stride as usize + column as usize * PIXEL;
        let channel = |number: usize| {
            let bytes = &self.0.data[start + 4 * number..][..4];
            f32::from_le_bytes(bytes.try_into().expect("four bytes")).max(0.0)
        };
        [channel(0), channel(1), channel(2)]
    }
}

/// The light of a JPEG whose pixels for screens have been decoded, as bright as its gain map allows; `None` where it has no such
/// map.
///
/// # Errors
/// What is wrong with the map.
pub(super) fn light(bytes: &[u8], shown: &DynamicImage) -> Option<Result<Light, String>> {
    let file = Decoder::new(bytes).ok()?;
    // Other files have a second picture too.
    let metadata = file.metadata()?;
    Some(apply(file.gainmap_jpeg(), metadata, shown))
}

fn apply(map: Option<&[u8]>, metadata: &GainMapMetadata, shown: &DynamicImage) -> Result<Light, String> {
    let map = map.ok_or("it is not there")?;
    if metadata.backward_direction {
        return Err("it leads from light to screens, not from screens to light".to_owned());
    }
    let map = decode_image("gain map", map).map_err(|error| error.to_string())?;
    let (width, height) = map.dimensions();
    let (channels, data) = match map {
        DynamicImage::ImageLuma8(grey) => (1, grey.into_raw()),
        other => (3, other.into_rgb8().into_raw()),
    };
    let map = GainMap {
        width,
        height,
        channels,
        data,
    };
    let (width, height) = shown.dimensions();
    let codes = shown.to_rgb8().into_raw();
    let gamut = ColorGamut::Bt709;
    let shown = RawImage::from_data(width, height, PixelFormat::Rgb8, gamut, ColorTransfer::Srgb, codes);
    // What no display shows is light all the same.
    let boost = f32::MAX;
    let light = shown.and_then(|shown| {
        let format = HdrOutputFormat::LinearFloat;
        apply_gainmap(&shown, &map, metadata, boost, format, Unstoppable)
    });
    light.map(Light).map_err(|error| error.to_string())
}
