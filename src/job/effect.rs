//! The effects (features) that an engine can simulate, and the decision about each.

use std::{fmt, str::FromStr};

/// Value of a constant that each material decides.
pub const ANY: u32 = u32::MAX;

/// An override constant of the pipelines, generated into the shader module `scene/plan`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Constant {
    /// Name in WGSL.
    pub name: &'static str,
    /// Value in the über-shader: 1 for a flag, [`ANY`] for one of several.
    pub general: u32,
}

macro_rules! general {
    (flag) => {
        1
    };
    (choice) => {
        ANY
    };
}

macro_rules! effects {
    ($($effect:ident $name:literal $($kind:ident $constant:literal)?;)*) => {
        /// An effect that costs time and that not every scene needs. `document::effect` describes each: its meaning, the
        /// scenes that need it, and how it is switched off.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum EffectId {
            $($effect,)*
        }

        impl EffectId {
            /// Every effect, in the order of the plan's table.
            pub const ALL: &[Self] = &[$(Self::$effect),*];

            /// Name on the command line, in files and reports.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$effect => $name,)*
                }
            }

            /// Constant that switches its code in the shaders; `None` without such code.
            pub const fn constant(self) -> Option<Constant> {
                match self {
                    $($(Self::$effect => Some(Constant { name: $constant, general: general!($kind) }),)?)*
                    #[allow(unreachable_patterns, reason = "every effect might have code of its own")]
                    _ => None,
                }
            }
        }
    };
}

effects! {
    Environment "environment";
    LightSampling "light-sampling" flag "PLAN_LIGHT_SAMPLING";
    AreaLights "area-lights";
    Spot "spot" flag "PLAN_SPOT";
    Emission "emission" flag "PLAN_EMISSION";
    EmitterSampling "emitter-sampling" flag "PLAN_EMITTER_SAMPLING";
    Background "background";
    Ground "ground";
    ShadowCatcher "shadow-catcher" flag "PLAN_SHADOW_CATCHER";
    Interreflection "interreflection" flag "PLAN_INTERREFLECTION";
    ShadowTerminator "shadow-terminator" flag "PLAN_SHADOW_TERMINATOR";
    Base "base" flag "PLAN_BASE";
    DiffuseRoughness "diffuse-roughness" flag "PLAN_DIFFUSE_ROUGHNESS";
    Specular "specular" flag "PLAN_SPECULAR";
    Lobe "lobe" choice "PLAN_LOBE";
    Curve "curve" choice "PLAN_CURVE";
    Anisotropy "anisotropy" flag "PLAN_ANISOTROPY";
    Horizon "horizon" choice "PLAN_HORIZON";
    Fresnel "fresnel" choice "PLAN_FRESNEL";
    EdgeTint "edge-tint" flag "PLAN_EDGE_TINT";
    MultipleScattering "multiple-scattering" flag "PLAN_MULTIPLE_SCATTERING";
    Fuzz "fuzz" flag "PLAN_FUZZ";
    Coat "coat" flag "PLAN_COAT";
    CoatGgx "coat-ggx" flag "PLAN_COAT_GGX";
    CoatDarkening "coat-darkening" flag "PLAN_COAT_DARKENING";
    CoatAbsorption "coat-absorption" flag "PLAN_COAT_ABSORPTION";
    ThinFilm "thin-film" flag "PLAN_THIN_FILM";
    FilmBands "film-bands" flag "PLAN_FILM_BANDS";
    Transmission "transmission" flag "PLAN_TRANSMISSION";
    Absorption "absorption" flag "PLAN_ABSORPTION";
    ColorTexture "color-texture" flag "PLAN_COLOR_TEXTURES";
    RoughnessTexture "roughness-texture" flag "PLAN_ROUGHNESS_TEXTURES";
    RoughTables "rough-tables" flag "PLAN_ROUGH_TABLES";
    NormalMap "normal-map" flag "PLAN_NORMAL_MAPS";
    EmissionTexture "emission-texture" flag "PLAN_EMISSION_TEXTURES";
    VertexColors "vertex-colors" flag "PLAN_VERTEX_COLORS";
    CoatTexture "coat-texture" flag "PLAN_COAT_TEXTURES";
    CoatNormalMap "coat-normal-map" flag "PLAN_COAT_NORMALS";
    FilmTexture "film-texture" flag "PLAN_FILM_TEXTURES";
    FuzzTexture "fuzz-texture" flag "PLAN_FUZZ_TEXTURES";
    BoxProjection "box-projection" flag "PLAN_BOX_PROJECTION";
    Alpha "alpha" flag "PLAN_ALPHA";
    DepthOfField "depth-of-field" flag "PLAN_LENS";
    FireflyClamp "firefly-clamp" flag "PLAN_FIREFLY_CLAMP";
    AdaptiveSampling "adaptive-sampling";
    Guides "guides" flag "PLAN_GUIDES";
    LightGroups "light-groups" flag "PLAN_LIGHT_GROUPS";
    Denoising "denoising";
}

impl EffectId {
    /// True for an effect without which nothing could be rendered.
    pub const fn is_needed(self) -> bool {
        matches!(
            self,
            Self::Interreflection
                | Self::Lobe
                | Self::Curve
                | Self::Horizon
                | Self::Fresnel
                | Self::RoughTables
                | Self::Guides
        )
    }
}

impl fmt::Display for EffectId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for EffectId {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let named = Self::ALL.iter().copied().find(|effect| effect.name() == name);
        named.ok_or_else(|| format!("no effect is called {name}"))
    }
}

/// A decision about an effect, with its reason.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Decision {
    /// True if simulated.
    pub is_on: bool,
    /// The value of its constant.
    pub value: u32,
    pub reason: String,
}

impl Decision {
    /// Simulated.
    pub fn on(reason: impl Into<String>) -> Self {
        Self::which(1, reason)
    }

    /// Left out.
    pub fn off(reason: impl Into<String>) -> Self {
        Self {
            is_on: false,
            ..Self::which(0, reason)
        }
    }

    /// Simulated, with a constant of this value.
    pub fn which(value: u32, reason: impl Into<String>) -> Self {
        Self {
            is_on: true,
            value,
            reason: reason.into(),
        }
    }

    pub fn when(is_on: bool, reason: impl Into<String>) -> Self {
        if is_on { Self::on(reason) } else { Self::off(reason) }
    }
}
