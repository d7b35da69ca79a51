//! The colour spaces that MaterialX and USD name.

use crate::{
    optics::{
        primaries::{Chromaticities, REC709, transformed},
        tone::linear_from_srgb,
        vector::Vec3,
    },
    scene::texture::TextureMean,
};

/// What codes of a space are of light.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Curve {
    Linear,
    Srgb,
    Gamma(f32),
}

const fn space(primaries: [[f64; 2]; 3], white: [f64; 2]) -> Chromaticities {
    Chromaticities { primaries, white }
}

const ACES_WHITE: [f64; 2] = [0.32168, 0.33767];
const AP0: Chromaticities = space([[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.077]], ACES_WHITE);
const AP1: Chromaticities = space([[0.713, 0.293], [0.165, 0.83], [0.128, 0.044]], ACES_WHITE);
const REC2020: Chromaticities = space([[0.708, 0.292], [0.17, 0.797], [0.131, 0.046]], REC709.white);
const P3: Chromaticities = space([[0.68, 0.32], [0.265, 0.69], [0.15, 0.06]], REC709.white);
const ADOBE: Chromaticities = space([[0.64, 0.33], [0.21, 0.71], [0.15, 0.06]], REC709.white);

/// Names, with blanks between; curve; primaries.
const SPACES: &[(&str, Curve, Chromaticities)] = &[
    ("lin_rec709 lin_srgb none raw data unknown", Curve::Linear, REC709),
    ("srgb_texture srgb_rec709 sRGB", Curve::Srgb, REC709),
    ("g18_rec709 gamma18", Curve::Gamma(1.8), REC709),
    ("g22_rec709 gamma22", Curve::Gamma(2.2), REC709),
    ("rec709_display g24_rec709 gamma24", Curve::Gamma(2.4), REC709),
    ("acescg lin_ap1", Curve::Linear, AP1),
    ("srgb_ap1", Curve::Srgb, AP1),
    ("g22_ap1", Curve::Gamma(2.2), AP1),
    ("g18_ap1", Curve::Gamma(1.8), AP1),
    ("lin_ap0 aces2065_1", Curve::Linear, AP0),
    ("lin_rec2020", Curve::Linear, REC2020),
    ("lin_displayp3 lin_p3d65", Curve::Linear, P3),
    ("srgb_displayp3 srgb_p3d65", Curve::Srgb, P3),
    ("lin_adobergb", Curve::Linear, ADOBE),
    ("adobergb g22_adobergb", Curve::Gamma(563.0 / 256.0), ADOBE),
];

/// A colour space that is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Space {
    curve: Curve,
    primaries: Chromaticities,
}

impl Space {
    /// Linear Rec. 709.
    pub fn working() -> Self {
        Self {
            curve: Curve::Linear,
            primaries: REC709,
        }
    }

    /// The space of that name; linear Rec. 709 where there is none.
    pub fn named(name: &str) -> Option<Self> {
        // The Color Interop Forum's names of the same spaces.
        let name = name.strip_suffix("_scene").unwrap_or(name);
        let is_it = |names: &str| names.split(' ').any(|other| other == name) || name.is_empty();
        let (_, curve, primaries) = *SPACES.iter().find(|(names, ..)| is_it(names))?;
        Some(Self { curve, primaries })
    }

    /// A colour in linear Rec. 709.
    pub fn rec709(&self, color: [f32; 3]) -> [f32; 3] {
        self.with_primaries(match self.curve {
            Curve::Linear => color,
            Curve::Srgb => linear_from_srgb(Vec3::<f32>::from_f32(color)).to_f32(),
            Curve::Gamma(gamma) => color.map(|x| x.max(0.0).powf(gamma)),
        })
    }

    /// The mean of an image in linear Rec. 709; of a gamma other than sRGB's that of the mean code.
    pub fn rec709_of_mean(&self, mean: &TextureMean) -> [f32; 3] {
        match self.curve {
            Curve::Srgb => self.with_primaries(mean.linear),
            _ => self.rec709([mean.codes[0], mean.codes[1], mean.codes[2]]),
        }
    }

    fn with_primaries(&self, color: [f32; 3]) -> [f32; 3] {
        let Ok(Some(matrix)) = self.primaries.rec709_from() else {
            return color;
        };
        transformed(&matrix, color.map(f64::from)).map(|x| x as f32)
    }

    /// Whether images of it are read as they are by a texture of sRGB codes, or of plain numbers; none where neither does.
    pub fn is_srgb(&self) -> Option<bool> {
        match self.curve {
            _ if self.primaries != REC709 => None,
            Curve::Linear => Some(false),
            Curve::Srgb => Some(true),
            Curve::Gamma(_) => None,
        }
    }
}
