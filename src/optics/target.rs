//! What a texture can vary: one line each, which slots, packed textures, files and the window loop over.

use crate::named::named;

/// What the values of a texture are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextureValues {
    Color,
    /// Numbers, in this channel of a model's texture.
    Number(usize),
    /// Directions in tangent space.
    Vector,
}

/// The table's lines: variant, name, label, the key of the parameter that it multiplies, values, the target whose texture of a
/// model it shares (itself with most), help.
macro_rules! targets {
    ($($variant:ident, $name:literal, $label:literal, $key:literal, $values:expr, $home:ident, $help:literal;)*) => {
        named! {
            /// Material parameter of a texture map.
            TextureTarget {
                $($variant, $name, $label, $help;)*
            }
        }

        /// How many there are.
        pub const TARGETS: usize = TextureTarget::ALL.len();

        /// Of each target: values, home, key of an image of the user's.
        const TRAITS: &[(TextureValues, TextureTarget, &str)] =
            &[$(($values, TextureTarget::$home, concat!($key, "_map"))),*];
    };
}

use TextureValues::{Color, Number, Vector};

targets! {
    BaseColor, "base-color", "Base colour", "base.color", Color, BaseColor, "Multiplies the base colour.";
    Roughness, "roughness", "Roughness", "specular.roughness", Number(1), Roughness, "Multiplies the roughness; its values are meant for GGX, as those of most textures are.";
    Metalness, "metalness", "Metalness", "base.metalness", Number(2), Roughness, "Multiplies the metalness.";
    Normal, "normal", "Normal", "geometry.normal", Vector, Normal, "Bends the normal.";
    Opacity, "opacity", "Opacity", "geometry.opacity", Number(3), BaseColor, "Multiplies the opacity.";
    Emission, "emission", "Emission", "emission.color", Color, Emission, "Multiplies the emission.";
    Coat, "coat", "Coat", "coat.weight", Number(0), Coat, "Multiplies the weight of the coat.";
    CoatRoughness, "coat-roughness", "Coat roughness", "coat.roughness", Number(1), CoatRoughness, "Multiplies the coat's roughness, that of GGX, which is then its lobe.";
    CoatColor, "coat-color", "Coat colour", "coat.color", Color, CoatColor, "Multiplies the colour of the coat.";
    CoatNormal, "coat-normal", "Coat normal", "coat.normal", Vector, CoatNormal, "Bends the normal of the coat.";
    Film, "film", "Thin film", "thin_film.weight", Number(0), Film, "Multiplies the weight of the thin film.";
    FilmThickness, "film-thickness", "Film thickness", "thin_film.thickness", Number(1), FilmThickness, "Multiplies the thickness of the thin film.";
    Fuzz, "fuzz", "Fuzz", "fuzz.weight", Number(0), Fuzz, "Multiplies the weight of the fuzz.";
    FuzzColor, "fuzz-color", "Fuzz colour", "fuzz.color", Color, FuzzColor, "Multiplies the colour of the fuzz.";
    FuzzRoughness, "fuzz-roughness", "Fuzz roughness", "fuzz.roughness", Number(3), FuzzRoughness, "Multiplies the roughness of the fuzz.";
}

impl TextureTarget {
    /// Those of the coat, but for its normal.
    pub const OF_COAT: &[Self] = &[Self::Coat, Self::CoatRoughness, Self::CoatColor];
    /// Those of the thin film.
    pub const OF_FILM: &[Self] = &[Self::Film, Self::FilmThickness];
    /// Those of the fuzz.
    pub const OF_FUZZ: &[Self] = &[Self::Fuzz, Self::FuzzColor, Self::FuzzRoughness];

    /// What the texture's values are.
    pub const fn values(self) -> TextureValues {
        TRAITS[self as usize].0
    }

    /// The target whose texture of a model it shares; itself where it has one of its own.
    pub const fn home(self) -> Self {
        TRAITS[self as usize].1
    }

    /// The key of a target's image in a material's file, and on the command line before that of a parameter:
    /// `base.color_map.rotation`.
    pub const fn map_key(self) -> &'static str {
        TRAITS[self as usize].2
    }

    /// The target of this parameter, behind whose key an ending is written: `_map` of images, `_texture` of switches.
    pub fn of_key(key: &str, ending: &str) -> Option<Self> {
        let parameter = key.strip_suffix(ending)?;
        let is_it = |target: &&Self| target.map_key().strip_suffix("_map") == Some(parameter);
        Self::ALL.iter().find(is_it).copied()
    }

    /// True for a colour, false for a scalar or a normal.
    pub fn is_color(self) -> bool {
        self.values() == Color
    }

    /// True for a scalar.
    pub fn is_number(self) -> bool {
        matches!(self.values(), Number(_))
    }

    /// True for a normal.
    pub fn is_normal(self) -> bool {
        self.values() == Vector
    }
}
