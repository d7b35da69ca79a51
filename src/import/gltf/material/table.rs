//! Fate of each glTF material parameter: the table in docs/FORMATS.md, from which the import report is made.

use serde_json::Value as Json;

use super::numbers;
use crate::{
    file_parameter::{FileParameter, Goes},
    file_parameters,
    scene::Slot,
    scene::report::{Fate, ImportReport},
};

const RADIANS_PER_DEGREE: f32 = std::f32::consts::PI / 180.0;
/// A reference to a texture.
const TEXTURE: &str = r#"{"index": 0}"#;

/// Every parameter of a glTF material that the format and its extensions have, by its JSON pointer. One with a default is read and
/// written as it stands here.
pub const GLTF_PARAMETERS: &[FileParameter] = file_parameters! {
    "/" {
        "name" r#""other""# => to "name";
        "emissiveFactor" = "[0, 0, 0]" "[0.5, 0.25, 0]" => to "emission.color";
        "emissiveTexture" TEXTURE => to "emission.color_texture";
        "normalTexture" r#"{"index": 0, "scale": 0.5}"# => to "geometry.normal_texture, geometry.normal_strength": "a scale beyond ±10";
        "occlusionTexture" TEXTURE => nowhere "an occlusion texture, which path tracing needs none of";
        "alphaMode" r#""BLEND""# => to "geometry.opacity_texture";
        "alphaCutoff" "0.25" => to "the model's slot";
        "doubleSided" "true" => to "the model's slot": "every surface has two sides; open ones of one side are reported";
    }
    "/pbrMetallicRoughness/" {
        "baseColorFactor" = "[1, 1, 1, 1]" "[0.5, 0.25, 0, 0.5]" => to "base.color, geometry.opacity";
        "baseColorTexture" TEXTURE => to "base.color_texture";
        "metallicFactor" = "1" "0.25" => to "base.metalness";
        "roughnessFactor" = "1" "0.25" => to "specular.roughness": "matched to the lobe that is chosen; above 0.7 GGX";
        "metallicRoughnessTexture" TEXTURE => to "specular.roughness_texture";
    }
    "/extensions/KHR_materials_emissive_strength/" {
        "emissiveStrength" = "1" "3" => to "emission.strength";
    }
    "/extensions/KHR_materials_ior/" {
        "ior" = "1.5" "1.25" => to "specular.ior": "from 1 to 4; above, or 0, which is infinite, as a metal with the specular colour";
    }
    "/extensions/KHR_materials_specular/" {
        "specularFactor" = "1" "0.25" => to "specular.weight, without metals";
        "specularTexture" TEXTURE => to "specular.weight_texture";
        "specularColorFactor" = "[1, 1, 1]" "[2, 0.5, 0.25]" => to "specular.color, without metals": "at most 1 in what transmits";
        "specularColorTexture" TEXTURE => to "specular.color": "by its mean";
    }
    "/extensions/KHR_materials_clearcoat/" {
        "clearcoatFactor" = "0" "0.25" => to "coat.weight";
        "clearcoatTexture" TEXTURE => to "coat.weight_texture";
        "clearcoatRoughnessFactor" = "0" "0.25" => to "coat.roughness": "matched to the geometric lobe";
        "clearcoatRoughnessTexture" TEXTURE => to "coat.roughness_texture";
        "clearcoatNormalTexture" r#"{"index": 0, "scale": 0.5}"# => to "coat.normal_texture, coat.normal_strength": "a scale beyond ±10";
    }
    "/extensions/KHR_materials_coat/" {
        "coatFactor" = "0" "0.25" => to "coat.weight": "a draft; in the place of KHR_materials_clearcoat";
        "coatTexture" TEXTURE => to "coat.weight_texture";
        "coatRoughnessFactor" = "0" "0.25" => to "coat.roughness": "matched to the geometric lobe";
        "coatRoughnessTexture" TEXTURE => to "coat.roughness_texture";
        "coatNormalTexture" TEXTURE => to "coat.normal_texture, coat.normal_strength";
        "coatIor" = "1.5" "1.25" => to "coat.ior": "from 1 to 4";
        "coatColorFactor" = "[1, 1, 1]" "[0.5, 0.25, 0.125]" => to "coat.color";
        "coatColorTexture" TEXTURE => to "coat.color_texture";
        "coatDarkeningFactor" = "1" "0.25" => to "coat.darkening";
        "coatAnisotropyStrength" = "0" "0.25" => to "coat.anisotropy, coat.roughness";
        "coatAnisotropyRotation" "0.25" => nowhere "a turn of the coat's highlight, which lies along the tangent";
        "coatAnisotropyTexture" TEXTURE => nowhere "a texture of the coat's anisotropy";
    }
    "/extensions/KHR_materials_diffuse_roughness/" {
        "diffuseRoughnessFactor" = "0" "0.25" => to "base.diffuse_roughness": "a draft";
        "diffuseRoughnessTexture" TEXTURE => nowhere "a texture of the diffuse roughness";
    }
    "/extensions/KHR_materials_transmission/" {
        "transmissionFactor" = "0" "0.25" => to "transmission.weight";
        "transmissionTexture" TEXTURE => to "transmission.weight_texture";
    }
    "/extensions/KHR_materials_volume/" {
        "thicknessFactor" "0" => to "nothing, solids are as thick as they are": "0 is a thin wall, which bends nothing";
        "thicknessTexture" TEXTURE => nowhere "a thickness texture: solids are as thick as they are";
        "attenuationDistance" = "0" "0.25" => to "transmission.depth";
        "attenuationColor" = "[1, 1, 1]" "[0.5, 0.25, 0.125]" => to "transmission.color";
    }
    "/extensions/KHR_materials_anisotropy/" {
        "anisotropyStrength" = "0" "0.25" => to "specular.anisotropy, specular.roughness": "stretched at most 19 : 1";
        "anisotropyRotation" = "0" / RADIANS_PER_DEGREE "0.25" => to "specular.rotation";
        "anisotropyTexture" TEXTURE => to "specular.anisotropy, specular.rotation": "by its mean, with the strength that this has";
    }
    "/extensions/" {
        "KHR_materials_unlit" "{}" => to "emission.color, emission.strength": "shines with its colour";
    }
    "/extensions/KHR_materials_pbrSpecularGlossiness/" {
        "diffuseFactor" "[0.5, 0.25, 0, 1]" => to "base.color, geometry.opacity": "converted";
        "diffuseTexture" TEXTURE => to "base.color_texture": "converted texel by texel";
        "specularFactor" "[0.5, 0.25, 0.5]" => to "base.color, base.metalness": "converted; below 4 %, specular.color";
        "glossinessFactor" "0.25" => to "specular.roughness": "converted";
        "specularGlossinessTexture" TEXTURE => to "specular.roughness_texture": "converted texel by texel";
    }
    "/extensions/KHR_materials_sheen/" {
        "sheenColorFactor" "[0.5, 0.25, 0]" => to "fuzz.weight, fuzz.color": "as fuzz of about its albedo";
        "sheenColorTexture" TEXTURE => to "fuzz.weight_texture, fuzz.color_texture": "converted texel by texel";
        "sheenRoughnessFactor" "0.25" => to "fuzz.roughness": "as fuzz of about its albedo";
        "sheenRoughnessTexture" TEXTURE => to "fuzz.roughness_texture": "converted texel by texel";
    }
    "/extensions/KHR_materials_fuzz/" {
        "fuzzFactor" = "0" "0.25" => to "fuzz.weight": "a draft";
        "fuzzTexture" TEXTURE => to "fuzz.weight_texture";
        "fuzzColorFactor" = "[1, 1, 1]" "[0.5, 0.25, 0]" => to "fuzz.color": "a draft";
        "fuzzColorTexture" TEXTURE => to "fuzz.color_texture";
        "fuzzRoughnessFactor" = "0.5" "0.25" => to "fuzz.roughness": "a draft";
        "fuzzRoughnessTexture" TEXTURE => to "fuzz.roughness_texture";
    }
    "/extensions/KHR_materials_iridescence/" {
        "iridescenceFactor" = "0" "0.25" => to "thin_film.weight";
        "iridescenceTexture" TEXTURE => to "thin_film.weight_texture";
        "iridescenceIor" = "1.3" "1.5" => to "thin_film.ior": "from 1 to 3";
        "iridescenceThicknessMinimum" "50" => to "thin_film.thickness_texture": "where its texture is black";
        "iridescenceThicknessMaximum" = "400" / 1000.0 "500" => to "thin_film.thickness": "at most 10 µm";
        "iridescenceThicknessTexture" TEXTURE => to "thin_film.thickness_texture";
    }
    "/extensions/KHR_materials_dispersion/" {
        "dispersion" "0.25" => kept "transmission.dispersion";
    }
    "/extensions/KHR_materials_diffuse_transmission/" {
        "diffuseTransmissionFactor" "0.25" => kept "diffuse_transmission.weight";
        "diffuseTransmissionTexture" TEXTURE => kept "": "ignored";
        "diffuseTransmissionColorFactor" "[0.5, 0.25, 0]" => kept "diffuse_transmission.color";
        "diffuseTransmissionColorTexture" TEXTURE => kept "": "ignored";
    }
};

/// Whether the part of a material in which a parameter stands is there, and is read: the draft of a coat goes before a clearcoat.
pub fn is_read(row: &FileParameter, material: &Json) -> bool {
    let (part, _) = row.place.rsplit_once('/').unwrap_or_default();
    let is_replaced = part.ends_with("clearcoat") && material.pointer("/extensions/KHR_materials_coat").is_some();
    material.pointer(part).is_some() && !is_replaced
}

/// Keys of a material file for unsupported parameters.
pub fn kept_keys() -> impl Iterator<Item = &'static str> {
    let kept = GLTF_PARAMETERS.iter().filter_map(|row| match row.goes {
        Goes::Kept(key) => Some(key),
        _ => None,
    });
    kept.filter(|key| !key.is_empty())
}

/// Keeps the parameters of the extensions that are not shown, where they have a weight.
pub fn keep(material: &Json, read: &mut Slot, report: &mut ImportReport) {
    for (extension, weight) in [
        ("dispersion", "dispersion"),
        ("diffuse_transmission", "diffuseTransmissionFactor"),
    ] {
        let place = format!("/extensions/KHR_materials_{extension}");
        let weight = material.pointer(&place).and_then(|all| numbers(&all[weight]));
        if weight.is_none_or(|weight| weight == [0.0; 3]) {
            continue;
        }
        let mut note = |what: &str| report.note(Fate::Ignored, what, &read.name);
        let what = extension.replace('_', " ");
        note(&format!("{what}, which is not shown, but kept in the material"));
        for row in GLTF_PARAMETERS.iter().filter(|row| row.place.starts_with(&place)) {
            match (row.goes, material.pointer(row.place)) {
                (Goes::Kept(""), Some(_)) => note("textures of what is not shown"),
                (Goes::Kept(key), Some(value)) if numbers(value).is_some() => {
                    read.kept.insert(key.to_owned(), value.clone());
                }
                _ => {}
            }
        }
    }
}

/// Reports a material's parameters that the table ignores or does not have. Extensions that the file `declares` are reported
/// with the file.
pub fn report_unread(material: &Json, declared: &[String], name: &str, report: &mut ImportReport) {
    let members = |value: &Json| value.as_object().cloned().unwrap_or_default();
    let mut left = vec![(String::new(), members(material))];
    while let Some((place, all)) = left.pop() {
        for (key, value) in all.into_iter().filter(|(key, _)| key != "extras") {
            let at = format!("{place}/{key}");
            let within = format!("{at}/");
            if let Some(known) = GLTF_PARAMETERS.iter().find(|known| known.place == at) {
                if let Goes::Nowhere(what) = known.goes {
                    report.note(Fate::Ignored, what, name);
                }
            } else if GLTF_PARAMETERS.iter().any(|known| known.place.starts_with(&within)) {
                left.push((at, members(&value)));
            } else if place != "/extensions" || !declared.contains(&key) {
                report.note(
                    Fate::Ignored,
                    format!("{key}, which is no parameter of materials"),
                    name,
                );
            }
        }
    }
}
