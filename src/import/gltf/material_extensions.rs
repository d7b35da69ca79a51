//! The material extensions that the gltf crate does not know, as their JSON has them.

use gltf::json::extensions::texture::TextureTransform;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value as Json, json};

/// A texture as an extension refers to it.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct TextureInfo {
    pub index: usize,
    #[serde(default)]
    pub tex_coord: u32,
    #[serde(default)]
    extensions: TextureExtensions,
}

#[derive(Clone, Debug, Default, Deserialize)]
struct TextureExtensions {
    #[serde(rename = "KHR_texture_transform")]
    transform: Option<TextureTransform>,
}

impl TextureInfo {
    /// Texture, set of coordinates and transform.
    pub(super) fn reference(&self) -> (usize, u32, Option<TextureTransform>) {
        (self.index, self.tex_coord, self.extensions.transform.clone())
    }
}

/// A reference to a normal texture.
#[derive(Debug, Deserialize)]
pub(super) struct NormalInfo {
    #[serde(flatten)]
    pub info: TextureInfo,
    #[serde(default = "whole")]
    pub scale: f32,
}

fn whole() -> f32 {
    1.0
}

/// KHR_materials_clearcoat.
#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Clearcoat {
    pub clearcoat_factor: f32,
    pub clearcoat_texture: Option<TextureInfo>,
    pub clearcoat_roughness_factor: f32,
    pub clearcoat_roughness_texture: Option<TextureInfo>,
    pub clearcoat_normal_texture: Option<NormalInfo>,
}

/// The draft KHR_materials_coat.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Coat {
    pub coat_factor: f32,
    pub coat_texture: Option<TextureInfo>,
    pub coat_roughness_factor: f32,
    pub coat_roughness_texture: Option<TextureInfo>,
    pub coat_normal_texture: Option<NormalInfo>,
    pub coat_ior: f32,
    pub coat_color_factor: [f32; 3],
    pub coat_color_texture: Option<TextureInfo>,
    pub coat_darkening_factor: f32,
    pub coat_anisotropy_strength: f32,
    /// The coat changes what lies below it.
    #[serde(skip)]
    pub is_on_base: bool,
}

impl Default for Coat {
    fn default() -> Self {
        Self {
            coat_factor: 0.0,
            coat_texture: None,
            coat_roughness_factor: 0.0,
            coat_roughness_texture: None,
            coat_normal_texture: None,
            coat_ior: 1.5,
            coat_color_factor: [1.0; 3],
            coat_color_texture: None,
            coat_darkening_factor: 1.0,
            coat_anisotropy_strength: 0.0,
            is_on_base: true,
        }
    }
}

/// A clearcoat is a coat that leaves what lies below it as it is.
impl From<Clearcoat> for Coat {
    fn from(clear: Clearcoat) -> Self {
        Self {
            coat_factor: clear.clearcoat_factor,
            coat_texture: clear.clearcoat_texture,
            coat_roughness_factor: clear.clearcoat_roughness_factor,
            coat_roughness_texture: clear.clearcoat_roughness_texture,
            coat_normal_texture: clear.clearcoat_normal_texture,
            coat_darkening_factor: 0.0,
            is_on_base: false,
            ..Self::default()
        }
    }
}

/// The coat of a material; the draft takes precedence.
pub(super) fn coat(material: &Json) -> Option<Coat> {
    let draft = extension::<Coat>(material, "KHR_materials_coat");
    draft.or_else(|| extension::<Clearcoat>(material, "KHR_materials_clearcoat").map(Coat::from))
}

/// KHR_materials_iridescence; thicknesses in nm.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Iridescence {
    pub iridescence_factor: f32,
    pub iridescence_texture: Option<TextureInfo>,
    pub iridescence_ior: f32,
    pub iridescence_thickness_minimum: f32,
    pub iridescence_thickness_maximum: f32,
    pub iridescence_thickness_texture: Option<TextureInfo>,
}

impl Default for Iridescence {
    fn default() -> Self {
        Self {
            iridescence_factor: 0.0,
            iridescence_texture: None,
            iridescence_ior: 1.3,
            iridescence_thickness_minimum: 100.0,
            iridescence_thickness_maximum: 400.0,
            iridescence_thickness_texture: None,
        }
    }
}

/// KHR_materials_sheen.
#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Sheen {
    pub sheen_color_factor: [f32; 3],
    pub sheen_color_texture: Option<TextureInfo>,
    pub sheen_roughness_factor: f32,
    pub sheen_roughness_texture: Option<TextureInfo>,
}

/// The draft KHR_materials_fuzz.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Fuzz {
    pub fuzz_factor: f32,
    pub fuzz_texture: Option<TextureInfo>,
    pub fuzz_color_factor: [f32; 3],
    pub fuzz_color_texture: Option<TextureInfo>,
    pub fuzz_roughness_factor: f32,
    pub fuzz_roughness_texture: Option<TextureInfo>,
}

impl Default for Fuzz {
    fn default() -> Self {
        Self {
            fuzz_factor: 0.0,
            fuzz_texture: None,
            fuzz_color_factor: [1.0; 3],
            fuzz_color_texture: None,
            fuzz_roughness_factor: 0.5,
            fuzz_roughness_texture: None,
        }
    }
}

/// KHR_materials_specular.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Specular {
    pub specular_factor: f32,
    pub specular_texture: Option<TextureInfo>,
    pub specular_color_factor: [f32; 3],
    pub specular_color_texture: Option<TextureInfo>,
}

impl Default for Specular {
    fn default() -> Self {
        Self {
            specular_factor: 1.0,
            specular_texture: None,
            specular_color_factor: [1.0; 3],
            specular_color_texture: None,
        }
    }
}

/// KHR_materials_anisotropy.
#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Anisotropy {
    pub anisotropy_strength: f32,
    pub anisotropy_rotation: f32,
    pub anisotropy_texture: Option<TextureInfo>,
}

/// The draft KHR_materials_diffuse_roughness.
#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct DiffuseRoughness {
    pub diffuse_roughness_factor: f32,
}

/// KHR_materials_transmission.
#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Transmission {
    pub transmission_texture: Option<TextureInfo>,
}

/// KHR_materials_volume.
#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Volume {
    pub thickness_factor: f32,
}

/// KHR_materials_pbrSpecularGlossiness.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct SpecularGlossiness {
    pub diffuse_factor: [f32; 4],
    pub diffuse_texture: Option<TextureInfo>,
    pub specular_factor: [f32; 3],
    pub glossiness_factor: f32,
    pub specular_glossiness_texture: Option<TextureInfo>,
}

impl Default for SpecularGlossiness {
    fn default() -> Self {
        Self {
            diffuse_factor: [1.0; 4],
            diffuse_texture: None,
            specular_factor: [1.0; 3],
            glossiness_factor: 1.0,
            specular_glossiness_texture: None,
        }
    }
}

/// An extension of a material; `None` if absent or invalid.
pub(super) fn extension<T: DeserializeOwned>(material: &Json, name: &str) -> Option<T> {
    T::deserialize(material.get("extensions")?.get(name)?).ok()
}

/// Extensions of a material that [`extension`] cannot read.
pub(super) fn unreadable(material: &Json) -> impl Iterator<Item = &'static str> {
    fn is_unreadable<T: DeserializeOwned>(material: &Json, name: &str) -> bool {
        let is_there = material.get("extensions").is_some_and(|all| all.get(name).is_some());
        is_there && extension::<T>(material, name).is_none()
    }
    type Check = fn(&Json, &str) -> bool;
    let checks: [(&'static str, Check); 11] = [
        ("KHR_materials_coat", is_unreadable::<Coat>),
        ("KHR_materials_clearcoat", is_unreadable::<Clearcoat>),
        ("KHR_materials_iridescence", is_unreadable::<Iridescence>),
        ("KHR_materials_sheen", is_unreadable::<Sheen>),
        ("KHR_materials_fuzz", is_unreadable::<Fuzz>),
        ("KHR_materials_specular", is_unreadable::<Specular>),
        ("KHR_materials_anisotropy", is_unreadable::<Anisotropy>),
        ("KHR_materials_diffuse_roughness", is_unreadable::<DiffuseRoughness>),
        ("KHR_materials_transmission", is_unreadable::<Transmission>),
        ("KHR_materials_volume", is_unreadable::<Volume>),
        (
            "KHR_materials_pbrSpecularGlossiness",
            is_unreadable::<SpecularGlossiness>,
        ),
    ];
    let unreadable = checks.into_iter().filter(|(name, check)| check(material, name));
    unreadable.map(|(name, _)| name).collect::<Vec<_>>().into_iter()
}

/// A number or list of an extension, and the key under which a material keeps it.
struct KeptExtension {
    extension: &'static str,
    /// Weight parameter of the extension.
    weight: &'static str,
    values: &'static [(&'static str, &'static str)],
    /// Name in the report.
    what: &'static str,
}

/// Extensions that are not supported yet.
const KEPT: [KeptExtension; 2] = [
    KeptExtension {
        extension: "KHR_materials_dispersion",
        weight: "dispersion",
        values: &[("dispersion", "transmission.dispersion")],
        what: "dispersion",
    },
    KeptExtension {
        extension: "KHR_materials_diffuse_transmission",
        weight: "diffuseTransmissionFactor",
        values: &[
            ("diffuseTransmissionFactor", "diffuse_transmission.weight"),
            ("diffuseTransmissionColorFactor", "diffuse_transmission.color"),
        ],
        what: "diffuse transmission",
    },
];

/// Keys of a material file for unsupported parameters.
pub fn kept_keys() -> impl Iterator<Item = &'static str> {
    KEPT.iter().flat_map(|kept| kept.values.iter().map(|(_, key)| *key))
}

/// Unsupported parameters of a material: values under the keys of a material file, and their names.
pub(super) fn kept(material: &Json) -> (Map<String, Json>, Vec<&'static str>) {
    let (mut values, mut names) = (Map::new(), Vec::new());
    for kept in &KEPT {
        let Some(extension) = material.get("extensions").and_then(|all| all.get(kept.extension)) else {
            continue;
        };
        let has_texture = extension
            .as_object()
            .is_some_and(|all| all.keys().any(|key| key.ends_with("Texture")));
        let weight = extension.get(kept.weight).unwrap_or(&Json::Null);
        if *weight == Json::Null || [json!(0), json!(0.0), json!([0, 0, 0]), json!([0.0, 0.0, 0.0])].contains(weight) {
            continue;
        }
        let is_plain =
            |value: &&Json| value.is_number() || value.as_array().is_some_and(|list| list.iter().all(Json::is_number));
        for (of_file, key) in kept.values {
            if let Some(value) = extension.get(*of_file).filter(is_plain) {
                values.insert((*key).to_owned(), value.clone());
            }
        }
        names.push(kept.what);
        if has_texture {
            names.push("textures of what is not shown");
        }
    }
    (values, names)
}
