//! Texture maps that a user assigns to a material, instead of the model's.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::{named::named, named::with_defaults, optics::target::TextureTarget};

/// The folder of texture maps that are part of the program, such as `shipped:/weave.png`. No file system has it.
pub const SHIPPED: &str = "shipped:";

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

with_defaults! {
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
        pub scale: f32 = 1.0,
        /// Vertical repetitions per horizontal one, above 0.
        pub stretch: f32 = 1.0,
        /// Rotation about the centre of the texture coordinates in degrees, anticlockwise as seen.
        pub rotation_deg: f32,
        /// Offset to the right and upwards, in its width and height.
        pub offset: [f32; 2],
        /// Blend amount in [0, 1]; 0 leaves the parameter unchanged.
        pub strength: f32 = 1.0,
        /// A dark texel counts as a bright one: gloss for roughness. Of a normal map, green points downwards.
        pub inverted: bool,
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

    /// Whether green is read upside down.
    pub fn is_flipped(&self, target: TextureTarget) -> bool {
        target.is_normal() && self.inverted
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

/// Texture maps that the user assigned to a material, at most one per target.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UserTextures([Option<Box<UserTexture>>; TextureTarget::ALL.len()]);

impl UserTextures {
    /// The image for a target.
    pub fn get(&self, target: TextureTarget) -> Option<&UserTexture> {
        self.0[target as usize].as_deref()
    }

    /// The same to be changed.
    pub fn get_mut(&mut self, target: TextureTarget) -> Option<&mut UserTexture> {
        self.0[target as usize].as_deref_mut()
    }

    /// Puts an image on a target, or takes it off.
    pub fn set(&mut self, target: TextureTarget, texture: Option<UserTexture>) {
        self.0[target as usize] = texture.map(Box::new);
    }

    pub fn iter(&self) -> impl Iterator<Item = (TextureTarget, &UserTexture)> {
        let targets = TextureTarget::ALL.iter();
        targets.filter_map(|&target| Some((target, self.get(target)?)))
    }

    /// All of them, to be changed.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut UserTexture> {
        self.0.iter_mut().flatten().map(|texture| &mut **texture)
    }

    /// Their files, without the maps that are part of the program.
    pub fn files(&self) -> impl Iterator<Item = &PathBuf> {
        let files = self.iter().map(|(_, texture)| &texture.file);
        files.filter(|file| !file.starts_with(SHIPPED))
    }

    /// Changes the names of their files.
    pub fn map_files(&mut self, map: impl Fn(&Path) -> PathBuf) {
        let files = self.iter_mut().map(|texture| &mut texture.file);
        for file in files.filter(|file| !file.starts_with(SHIPPED)) {
            *file = map(file);
        }
    }
}
