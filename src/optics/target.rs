//! What a texture can vary: one line each, which slots, packed textures, files and the window loop over.

use super::material::Material;
use crate::named::named;
use crate::optics::prelude::*;

/// What the values of a texture are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextureValues {
    Color,
    /// Numbers, in this channel of a model's texture.
    Number(usize),
    /// Directions in tangent space.
    Vector,
}

/// The table's lines, grouped by the constant of plans that has them looked up: variant, name, label, the key of the parameter
/// that it multiplies, values, the target whose texture of a model it shares (itself with most), the fields of the material that
/// it multiplies where a surface is shaded (those of normals and opacity are looked up apart), help.
macro_rules! targets {
    ($($group:ident $plan:literal {
        $($variant:ident, $name:literal, $label:literal, $key:literal, $values:expr, $home:ident, [$($field:ident)*], $help:literal;)*
    })*) => {
        named! {
            /// Material parameter of a texture map.
            TextureTarget {
                $($($variant, $name, $label, $help;)*)*
            }
        }

        /// How many there are.
        pub const TARGETS: usize = TextureTarget::ALL.len();

        /// Of each target: values, home, key of an image of the user's, fields.
        const TRAITS: &[(TextureValues, TextureTarget, &str, &[&str])] =
            &[$($(($values, TextureTarget::$home, concat!($key, "_map"), &[$(stringify!($field)),*])),*),*];

        impl TextureTarget {
            $(pub const $group: &[Self] = &[$(Self::$variant),*];)*

            /// The targets by the constant of plans that has them looked up.
            pub const PLANS: &[(&str, &[Self])] = &[$(($plan, Self::$group)),*];
        }

        impl<T: Real> Material<T> {
            /// Multiplies the parameters of a target by a texture's value: linear RGB, and alpha.
            #[inline(always)]
            pub fn multiply(&mut self, target: TextureTarget, color: Vec3<T>, alpha: T) {
                let factor = match target.values() {
                    Number(channel) => Vec3::splat([color.x, color.y, color.z, alpha][channel]),
                    Color | Vector => color,
                };
                match target {
                    $($(TextureTarget::$variant => {
                        $(self.$field.multiply(factor);)*
                    })*)*
                }
            }
        }
    };
}

/// A field of a material that textures multiply.
trait Multiplied<T> {
    fn multiply(&mut self, factor: Vec3<T>);
}

impl<T: Real> Multiplied<T> for Vec3<T> {
    #[inline(always)]
    fn multiply(&mut self, factor: Self) {
        *self = *self * factor;
    }
}

impl<T: Real> Multiplied<T> for T {
    #[inline(always)]
    fn multiply(&mut self, factor: Vec3<T>) {
        *self = *self * factor.x;
    }
}

use TextureValues::{Color, Number, Vector};

targets! {
    OF_COLOR "PLAN_COLOR_TEXTURES" {
        BaseColor, "base-color", "Base colour", "base.color", Color, BaseColor, [base_color transmission_tint], "Multiplies the base colour.";
    }
    OF_ROUGHNESS "PLAN_ROUGHNESS_TEXTURES" {
        Roughness, "roughness", "Roughness", "specular.roughness", Number(1), Roughness, [ggx_roughness], "Multiplies the roughness; its values are meant for GGX, as those of most textures are.";
        Metalness, "metalness", "Metalness", "base.metalness", Number(2), Roughness, [metalness], "Multiplies the metalness.";
        Specular, "specular", "Specular weight", "specular.weight", Number(3), Specular, [specular_weight], "Multiplies the weight of the reflection, at every angle.";
        Transmission, "transmission", "Transmission", "transmission.weight", Number(0), Transmission, [transmission_weight], "Multiplies the weight of what goes through.";
    }
    OF_NORMAL "PLAN_NORMAL_MAPS" {
        Normal, "normal", "Normal", "geometry.normal", Vector, Normal, [], "Bends the normal.";
    }
    OF_OPACITY "PLAN_ALPHA" {
        Opacity, "opacity", "Opacity", "geometry.opacity", Number(3), BaseColor, [], "Multiplies the opacity.";
    }
    OF_EMISSION "PLAN_EMISSION_TEXTURES" {
        Emission, "emission", "Emission", "emission.color", Color, Emission, [emission], "Multiplies the emission.";
    }
    OF_COAT "PLAN_COAT_TEXTURES" {
        Coat, "coat", "Coat", "coat.weight", Number(0), Coat, [coat_weight], "Multiplies the weight of the coat.";
        CoatRoughness, "coat-roughness", "Coat roughness", "coat.roughness", Number(1), CoatRoughness, [coat_roughness], "Multiplies the coat's roughness, that of GGX, which is then its lobe.";
        CoatColor, "coat-color", "Coat colour", "coat.color", Color, CoatColor, [coat_color], "Multiplies the colour of the coat.";
    }
    OF_COAT_NORMAL "PLAN_COAT_NORMALS" {
        CoatNormal, "coat-normal", "Coat normal", "coat.normal", Vector, CoatNormal, [], "Bends the normal of the coat.";
    }
    OF_FILM "PLAN_FILM_TEXTURES" {
        Film, "film", "Thin film", "thin_film.weight", Number(0), Film, [film_weight], "Multiplies the weight of the thin film.";
        FilmThickness, "film-thickness", "Film thickness", "thin_film.thickness", Number(1), FilmThickness, [film_path], "Multiplies the thickness of the thin film.";
    }
    OF_FUZZ "PLAN_FUZZ_TEXTURES" {
        Fuzz, "fuzz", "Fuzz", "fuzz.weight", Number(0), Fuzz, [fuzz_weight], "Multiplies the weight of the fuzz.";
        FuzzColor, "fuzz-color", "Fuzz colour", "fuzz.color", Color, FuzzColor, [fuzz_color], "Multiplies the colour of the fuzz.";
        FuzzRoughness, "fuzz-roughness", "Fuzz roughness", "fuzz.roughness", Number(3), FuzzRoughness, [fuzz_roughness], "Multiplies the roughness of the fuzz.";
    }
}

impl TextureTarget {
    /// What the texture's values are.
    pub const fn values(self) -> TextureValues {
        TRAITS[self as usize].0
    }

    /// The target whose texture of a model it shares; itself where it has one of its own.
    pub const fn home(self) -> Self {
        TRAITS[self as usize].1
    }

    /// The fields of a material that it multiplies where a surface is shaded.
    pub const fn fields(self) -> &'static [&'static str] {
        TRAITS[self as usize].3
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
