//! Texture maps that a user assigns to a material, instead of the model's.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::named::named;
use crate::optics::target::TextureTarget;

named! {
    /// Channel of a texel for a scalar parameter.
    #[derive(Default)]
    TextureChannel {
        #[default]
        Auto, "auto", "Automatic", "Alpha for an opacity, if the texture has one; green for the roughness and blue for the metalness of a texture named for several; else red.";
        Red, "red", "Red", "The red channel.";
        Green, "green", "Green", "The green channel.";
        Blue, "blue", "Blue", "The blue channel.";
        Alpha, "alpha", "Alpha", "The alpha channel.";
    }
}

named! {
    /// Encoding of a texture map's values.
    #[derive(Default)]
    TextureSpace {
        #[default]
        Auto, "auto", "Automatic", "sRGB for colours, plain numbers for all else.";
        Srgb, "srgb", "sRGB", "Codes for a screen.";
        Linear, "linear", "Linear", "Plain numbers.";
    }
}

named! {
    /// Projection of a texture map.
    #[derive(Default)]
    TextureProjection {
        #[default]
        Auto, "auto", "Automatic", "By the model's texture coordinates; as a box where it has none.";
        First, "first", "Coordinates", "By the model's first set of texture coordinates.";
        Second, "second", "Second coordinates", "By the model's second set of texture coordinates.";
        Box, "box", "Box", "From six sides, each part of the surface from the side that it faces; at a scale of 1 the texture is as large as the model.";
    }
}

/// A user's texture map and its mapping.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct UserTexture {
    /// File of the texture map.
    pub file: PathBuf,
    /// Channel, for a scalar target.
    pub channel: TextureChannel,
    /// Encoding of the values.
    pub space: TextureSpace,
    /// Projection onto the surface.
    pub projection: TextureProjection,
    /// Repetitions over the texture coordinates' unit, above 0.
    pub scale: f32,
    /// Vertical repetitions per horizontal one, above 0.
    pub stretch: f32,
    /// Rotation about the centre of the texture coordinates in degrees, anticlockwise as seen.
    pub rotation_deg: f32,
    /// Offset to the right and upwards, in its width and height.
    pub offset: [f32; 2],
    /// Blend amount in [0, 1]; 0 leaves the parameter unchanged.
    pub strength: f32,
    /// A dark texel counts as a bright one: gloss for roughness. Of a normal map, green points downwards.
    pub inverted: bool,
}

impl Default for UserTexture {
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

impl UserTexture {
    /// A texture map with default mapping.
    pub fn of(file: PathBuf) -> Self {
        Self {
            file,
            ..Self::default()
        }
    }

    /// Affine map from texture coordinates to image coordinates, as rows of (u, v, 1); v points down in both.
    pub fn picture_from_uv(&self) -> [f32; 6] {
        let (sine, cosine) = f64::from(self.rotation_deg).to_radians().sin_cos();
        let [along, down] = [f64::from(self.scale), f64::from(self.scale) * f64::from(self.stretch)];
        let [right, up] = self.offset.map(f64::from);
        // The image rotates anticlockwise if the coordinates rotate clockwise; v points down. The centre stays.
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
