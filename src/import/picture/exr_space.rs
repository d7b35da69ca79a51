//! Colour spaces of OpenEXR files.

use exr::math::Vec2;
use exr::meta::header::Header;

use crate::optics::primaries::{Chromaticities, REC709};

/// Colour space of a file: Rec. 709 by default.
pub(crate) fn space(header: &Header) -> Chromaticities {
    let place = |Vec2(x, y): Vec2<f32>| [f64::from(x), f64::from(y)];
    let named = header.shared_attributes.chromaticities;
    named.map_or(REC709, |file| Chromaticities {
        primaries: [file.red, file.green, file.blue].map(place),
        white: place(file.white),
    })
}
