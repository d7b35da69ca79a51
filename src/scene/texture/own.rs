//! Pictures that a user puts on a material, in place of the model's own.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::named::named;

named! {
    /// What a picture is put on.
    TextureTarget {
        BaseColor, "base-color", "Base colour", "Multiplies the base colour.";
        Roughness, "roughness", "Roughness", "Multiplies the roughness; its values are meant for GGX, as those of most pictures are.";
        Metalness, "metalness", "Metalness", "Multiplies the metalness.";
        Normal, "normal", "Normal", "Bends the normal.";
        Opacity, "opacity", "Opacity", "Multiplies the opacity.";
        Emission, "emission", "Emission", "Multiplies the emission.";
        Coat, "coat", "Coat", "Multiplies the weight of the coat.";
    }
}

named! {
    /// Which number of a texel is meant, where one is.
    #[derive(Default)]
    TextureChannel {
        #[default]
        Auto, "auto", "Automatic", "Alpha for an opacity, where the picture has one; green for the roughness and blue for the metalness of a picture that is named for several; else red.";
        Red, "red", "Red", "The red channel.";
        Green, "green", "Green", "The green channel.";
        Blue, "blue", "Blue", "The blue channel.";
        Alpha, "alpha", "Alpha", "The alpha channel.";
    }
}

named! {
    /// What a picture's numbers stand for.
    #[derive(Default)]
    TextureSpace {
        #[default]
        Auto, "auto", "Automatic", "sRGB for colours, plain numbers for all else.";
        Srgb, "srgb", "sRGB", "Codes for a screen.";
        Linear, "linear", "Linear", "Plain numbers.";
    }
}

named! {
    /// Where on a surface a picture lies.
    #[derive(Default)]
    TextureProjection {
        #[default]
        Auto, "auto", "Automatic", "By the model's texture coordinates; as a box where it has none.";
        First, "first", "Coordinates", "By the model's first set of texture coordinates.";
        Second, "second", "Second coordinates", "By the model's second set of texture coordinates.";
        Box, "box", "Box", "From six sides, each part of the surface from the side that it faces; at a scale of 1 the picture is as large as the model.";
    }
}

impl TextureTarget {
    /// True where a texel is a colour, false where it is a number or a normal.
    pub fn is_color(self) -> bool {
        matches!(self, Self::BaseColor | Self::Emission)
    }

    /// True where one channel counts.
    pub fn is_number(self) -> bool {
        !self.is_color() && self != Self::Normal
    }
}

/// A picture of the user's own, and how it is put on a surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct OwnTexture {
    /// The picture.
    pub file: PathBuf,
    /// Which of its numbers is meant, of a target that is one.
    pub channel: TextureChannel,
    /// What its numbers stand for.
    pub space: TextureSpace,
    /// Where it lies on the surface.
    pub projection: TextureProjection,
    /// How many times it repeats from one end of the texture coordinates to the other, above 0.
    pub scale: f32,
    /// How many times oftener it repeats upwards than sidewards, above 0.
    pub stretch: f32,
    /// Turn about the middle of the texture coordinates, counterclockwise as seen, degrees.
    pub rotation_deg: f32,
    /// By how much of its width and of its height it lies further to the right and further up.
    pub offset: [f32; 2],
    /// 0: what it is put on stays as it is; 1: the picture counts in full.
    pub strength: f32,
    /// A dark texel counts as a bright one: gloss for roughness. Of a normal map, green points downwards.
    pub inverted: bool,
}

impl Default for OwnTexture {
    fn default() -> Self {
        Self {
            file: PathBuf::new(),
            channel: TextureChannel::Auto,
            space: TextureSpace::Auto,
            projection: TextureProjection::Auto,
            scale: 1.0,
            stretch: 1.0,
            rotation_deg: 0.0,
            offset: [0.0; 2],
            strength: 1.0,
            inverted: false,
        }
    }
}

impl OwnTexture {
    /// A picture as it is.
    pub fn of(file: PathBuf) -> Self {
        Self {
            file,
            ..Self::default()
        }
    }

    /// Places in the picture from texture coordinates, as rows of (u, v, 1); v points down in both.
    pub fn picture_from_uv(&self) -> [f32; 6] {
        let (sine, cosine) = f64::from(self.rotation_deg).to_radians().sin_cos();
        let [along, down] = [f64::from(self.scale), f64::from(self.scale) * f64::from(self.stretch)];
        let [right, up] = self.offset.map(f64::from);
        // The picture turns counterclockwise where the coordinates turn clockwise; v points down. The middle stays.
        let [uu, uv] = [along * cosine, -along * sine];
        let [vu, vv] = [down * sine, down * cosine];
        let middle = |a: f64, b: f64| 0.5 - 0.5 * (a + b);
        [uu, uv, middle(uu, uv) - right, vu, vv, middle(vu, vv) + up].map(|x| x as f32)
    }

    /// Whether its texels are codes of sRGB.
    pub fn is_srgb(&self, target: TextureTarget) -> bool {
        match self.space {
            TextureSpace::Auto => target.is_color(),
            TextureSpace::Srgb => true,
            TextureSpace::Linear => false,
        }
    }
}
