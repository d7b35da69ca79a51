//! A material as it is edited.

use std::ops::{Index, IndexMut};

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value as Json};

use super::CustomCurve;
use crate::{
    named::{named, with_defaults},
    optics::{
        curve::Curve,
        fresnel::{Fresnel, METALS, Metal},
        lobe::{Horizon, Lobe},
        target::{TARGETS, TextureTarget},
        thin_film::has_film,
    },
    scene::texture::UserTextures,
};

/// The metal of new materials, in [`METALS`].
const ALUMINIUM: usize = 3;
/// The largest tint of a reflection: Schlick's reflectance at normal incidence may be tinted up to 1.
pub const SPECULAR_COLOR_MAX: f32 = 1000.0;
/// The largest thickness of a thin film in µm: beyond it colours of neighbouring orders mix to grey.
pub const FILM_THICKNESS_MAX: f32 = 10.0;

with_defaults! {
    /// A material as it is edited; at first a grey metal with the geometric lobe. Ranges, labels and meanings of the fields: [`super::PARAMETERS`].
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(try_from = "Map<String, Json>", into = "Map<String, Json>")]
    pub struct MaterialSettings {
        /// Name in lists and files.
        pub name: String = "Plain".to_owned(),
        /// Factor of the base colour, in [0, 1].
        pub base_weight: f32 = 1.0,
        /// Linear RGB in [0, 1].
        pub base_color: [f32; 3] = [0.8; 3],
        /// Roughness of the diffuse base, in [0, 1].
        pub diffuse_roughness: f32,
        /// In [0, 1].
        pub metalness: f32 = 1.0,
        /// In [0, 1].
        pub specular_weight: f32 = 1.0,
        /// The weight scales a dielectric's reflectance head-on through its index, as in OpenPBR; else at every angle.
        pub specular_in_index: bool,
        /// Weight and tint of the reflection are a metal's too; else only the dielectric's, as in glTF.
        pub specular_on_metal: bool = true,
        pub lobe: Lobe = Lobe::Geometric,
        /// GGX gets back the light that single scattering between its facets loses.
        pub multiple_scattering: bool = true,
        /// In [0, 1].
        pub roughness: f32 = 0.3,
        /// In [−1, 1].
        pub anisotropy: f32,
        /// Turn of the tangent, degrees.
        pub rotation_deg: f32,
        /// The geometric lobe's curve.
        pub curve: Curve = Curve::Smooth,
        /// The curve where `curve` is custom.
        pub custom_curve: CustomCurve,
        /// What happens below the surface.
        pub horizon: Horizon = Horizon::Mirror,
        pub fresnel: Fresnel = Fresnel::Schlick,
        /// The dielectric's index of refraction, in [1, 4].
        pub ior: f32 = 1.5,
        /// Tint of the reflection, linear RGB in [0, [`SPECULAR_COLOR_MAX`]]. What would reflect more than all reflects all.
        pub specular_color: [f32; 3] = [1.0; 3],
        /// What a metal's reflection is multiplied by near 82 degrees, linear RGB in [0, 1].
        pub edge_tint: [f32; 3] = [1.0; 3],
        /// Where `eta` and `k` come from.
        pub conductor: Conductor = Conductor::Metal(ALUMINIUM),
        /// Real part of the conductor's index of refraction at about 650, 550 and 450 nm, in [0, 20].
        pub eta: [f32; 3] = METALS[ALUMINIUM].eta.map(|x| x as f32),
        /// Imaginary part, in [0, 20].
        pub k: [f32; 3] = METALS[ALUMINIUM].k.map(|x| x as f32),
        /// Share of the surface that has a coat, in [0, 1].
        pub coat_weight: f32,
        /// In [0, 1].
        pub coat_roughness: f32 = 0.1,
        /// The coat's index of refraction, in [1, 4].
        pub coat_ior: f32 = 1.5,
        /// What the coat leaves of the light that crosses it twice, linear RGB in [0, 1].
        pub coat_color: [f32; 3] = [1.0; 3],
        /// The lobe of the coat.
        pub coat_lobe: CoatLobe = CoatLobe::Geometric,
        /// Stretch of the coat's lobe in [−1, 1].
        pub coat_anisotropy: f32,
        /// The coat changes what lies below it by its index, its roughness and the way of light through it.
        pub coat_on_base: bool = true,
        /// How much of the darkening by the coat shows, in [0, 1].
        pub coat_darkening: f32 = 1.0,
        /// Scales the slopes of the coat's normal texture, in [−10, 10].
        pub coat_normal_strength: f32 = 1.0,
        /// Share of the surface that has fuzz, in [0, 1].
        pub fuzz_weight: f32,
        /// Tint of the fuzz, linear RGB in [0, 1].
        pub fuzz_color: [f32; 3] = [1.0; 3],
        /// In [0, 1].
        pub fuzz_roughness: f32 = 0.5,
        /// Share of the surface that has a thin film, in [0, 1].
        pub film_weight: f32,
        /// Thickness of the thin film in µm, in [0, [`FILM_THICKNESS_MAX`]].
        pub film_thickness: f32 = 0.5,
        /// The thin film's index of refraction, in [1, 3].
        pub film_ior: f32 = 1.4,
        /// Whether a thick film is shown by bands of wavelengths.
        pub film_bands: bool = true,
        /// Share of the base that refracts, in [0, 1].
        pub transmission_weight: f32,
        /// Linear RGB in [0, 1]: tint at each refraction, or what is left of white after `transmission_depth`.
        pub transmission_color: [f32; 3] = [1.0; 3],
        /// In bounding radii of the model; 0 where nothing is absorbed inside.
        pub transmission_depth: f32,
        /// Added to `roughness` for the refraction, in [−1, 1].
        pub transmission_roughness: f32,
        /// Linear RGB in [0, 1].
        pub emission_color: [f32; 3] = [1.0; 3],
        /// Emitted radiance is `emission_color` times this.
        pub emission_strength: f32,
        /// Share of light that the surface stops, in [0, 1].
        pub opacity: f32 = 1.0,
        /// Scales the slopes of the normal texture, in [−10, 10].
        pub normal_strength: f32 = 1.0,
        /// Which textures are looked up.
        pub textures: TextureUse,
        /// Textures that the user assigned, instead of the slot's.
        pub user_textures: UserTextures,
        /// What the file's "material" had that this version does not know.
        pub extra: Map<String, Json>,
        /// What the file had beside it.
        pub file_extra: Map<String, Json>,
    }
}

impl MaterialSettings {
    /// A Lambertian surface; `color` is its albedo, linear RGB in [0, 1].
    pub fn diffuse(name: &str, color: [f32; 3]) -> Self {
        Self {
            name: name.to_owned(),
            base_color: color,
            metalness: 0.0,
            specular_weight: 0.0,
            ..Self::default()
        }
    }

    /// True where it emits light.
    pub fn is_emissive(&self) -> bool {
        self.emission_strength > 0.0 && self.emission_color.iter().any(|channel| *channel > 0.0)
    }

    /// True where the specular lobe reflects anything.
    pub fn reflects(&self) -> bool {
        let is_spared_metal = self.metalness > 0.0 && !self.specular_on_metal;
        self.specular_weight > 0.0 || is_spared_metal || self.transmits()
    }

    /// Lets the coat leave what lies below it as it is, as glTF's clearcoat does and files from before OpenPBR's coat.
    pub fn keep_below_coat(&mut self) {
        (self.coat_on_base, self.coat_darkening) = (false, 0.0);
    }

    /// True if the specular weight is in a dielectric's index: of what it reflects and of what it refracts.
    pub fn has_weight_in_index(&self) -> bool {
        self.specular_in_index && matches!(self.fresnel_model(), Fresnel::Schlick | Fresnel::Dielectric)
    }

    /// True where a thin film changes the reflection.
    pub fn has_film(&self) -> bool {
        (self.reflects() || self.has_weight_in_index())
            && has_film(self.fresnel_model(), self.film_weight, self.film_thickness)
    }

    /// The Fresnel model that counts: only the exact equations know total reflection.
    pub fn fresnel_model(&self) -> Fresnel {
        if self.transmits() {
            Fresnel::Dielectric
        } else {
            self.fresnel
        }
    }

    /// True where light goes through the surface.
    pub fn transmits(&self) -> bool {
        self.transmission_weight > 0.0 && self.metalness < 1.0
    }

    /// Takes a metal's η and k over; [`Conductor::Custom`] leaves them as they are.
    pub fn set_conductor(&mut self, conductor: Conductor) {
        self.conductor = conductor;
        if let Some(metal) = conductor.metal() {
            self.eta = metal.eta.map(|x| x as f32);
            self.k = metal.k.map(|x| x as f32);
        }
    }

    /// Sets η and k. The conductor turns custom unless nothing changes.
    pub fn set_eta_and_k(&mut self, eta: [f32; 3], k: [f32; 3]) {
        if (eta, k) != (self.eta, self.k) {
            self.conductor = Conductor::Custom;
        }
        (self.eta, self.k) = (eta, k);
    }
}

named! {
    /// The lobe of a coat.
    #[derive(Default)]
    CoatLobe {
        #[default]
        Geometric, "geometric", "Geometric", "The geometric lobe with the smooth curve.";
        Ggx, "ggx", "GGX", "GGX, as other programs have it.";
    }
}

/// Which textures a material looks up: its own, and else its slot's. None, unless the material comes with the model or was
/// given one: another material that is put in its place is plain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TextureUse([bool; TARGETS]);

impl TextureUse {
    /// The place of a target's switch; roughness and metalness have one together.
    fn place(target: TextureTarget) -> usize {
        match target {
            TextureTarget::Metalness => TextureTarget::Roughness as usize,
            _ => target as usize,
        }
    }
}

impl Index<TextureTarget> for TextureUse {
    type Output = bool;
    fn index(&self, target: TextureTarget) -> &bool {
        &self.0[Self::place(target)]
    }
}

impl IndexMut<TextureTarget> for TextureUse {
    fn index_mut(&mut self, target: TextureTarget) -> &mut bool {
        &mut self.0[Self::place(target)]
    }
}

/// Where the conductor's η and k come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Conductor {
    /// Numbers of the user's own.
    #[default]
    Custom,
    /// The metal with this index in [`METALS`].
    Metal(usize),
}

impl Conductor {
    /// Every choice, in the order of the menus.
    pub fn all() -> impl Iterator<Item = Self> {
        std::iter::once(Self::Custom).chain((0..METALS.len()).map(Self::Metal))
    }

    /// The metal; `None` where the numbers are custom.
    pub fn metal(self) -> Option<&'static Metal> {
        match self {
            Self::Custom => None,
            Self::Metal(index) => METALS.get(index),
        }
    }

    /// Name in files and on the command line.
    pub fn name(self) -> &'static str {
        self.metal().map_or("custom", |metal| metal.name)
    }

    /// The metal of that name; custom where there is none.
    pub fn named(name: &str) -> Self {
        Self::all()
            .find(|conductor| conductor.name() == name)
            .unwrap_or_default()
    }
}
