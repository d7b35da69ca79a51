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

/// The table's lines: variant, name, label, values, the target whose texture of a model it shares (itself with most),
/// help.
macro_rules! targets {
    ($($variant:ident, $name:literal, $label:literal, $values:expr, $home:ident, $help:literal;)*) => {
        named! {
            /// Material parameter of a texture map.
            TextureTarget {
                $($variant, $name, $label, $help;)*
            }
        }

        /// How many there are.
        pub const TARGETS: usize = TextureTarget::ALL.len();

        /// Values and home of each target.
        const TRAITS: &[(TextureValues, TextureTarget)] = &[$(($values, TextureTarget::$home)),*];
    };
}

use TextureValues::{Color, Number, Vector};

targets! {
    BaseColor, "base-color", "Base colour", Color, BaseColor, "Multiplies the base colour.";
    Roughness, "roughness", "Roughness", Number(1), Roughness, "Multiplies the roughness; its values are meant for GGX, as those of most textures are.";
    Metalness, "metalness", "Metalness", Number(2), Roughness, "Multiplies the metalness.";
    Normal, "normal", "Normal", Vector, Normal, "Bends the normal.";
    Opacity, "opacity", "Opacity", Number(3), BaseColor, "Multiplies the opacity.";
    Emission, "emission", "Emission", Color, Emission, "Multiplies the emission.";
    Coat, "coat", "Coat", Number(0), Coat, "Multiplies the weight of the coat.";
    CoatRoughness, "coat-roughness", "Coat roughness", Number(1), CoatRoughness, "Multiplies the coat's roughness, that of GGX, which is then its lobe.";
    CoatColor, "coat-color", "Coat colour", Color, CoatColor, "Multiplies the colour of the coat.";
    CoatNormal, "coat-normal", "Coat normal", Vector, CoatNormal, "Bends the normal of the coat.";
    Film, "film", "Thin film", Number(0), Film, "Multiplies the weight of the thin film.";
    FilmThickness, "film-thickness", "Film thickness", Number(1), FilmThickness, "Multiplies the thickness of the thin film.";
    Fuzz, "fuzz", "Fuzz", Number(0), Fuzz, "Multiplies the weight of the fuzz.";
    FuzzColor, "fuzz-color", "Fuzz colour", Color, FuzzColor, "Multiplies the colour of the fuzz.";
    FuzzRoughness, "fuzz-roughness", "Fuzz roughness", Number(3), FuzzRoughness, "Multiplies the roughness of the fuzz.";
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
