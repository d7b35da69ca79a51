//! Fate of each glTF material parameter: the table in docs/FORMATS.md, from which the import report is made.

use serde_json::Value as Json;

use crate::file_parameter::{FileParameter, Goes};
use crate::scene::report::{Fate, ImportReport};

/// A reference to a texture.
const TEXTURE: &str = r#"{"index": 0}"#;

macro_rules! table {
    ($($prefix:literal { $($key:literal $example:expr => $goes:ident $to:literal $note:literal;)* })*) => {
        &[$($(FileParameter::new(concat!($prefix, $key), "", $example, Goes::$goes($to)).with_note($note),)*)*]
    };
}

/// Every parameter of a glTF material that the format and its extensions have, by its JSON pointer.
pub const GLTF_PARAMETERS: &[FileParameter] = table! {
    "/" {
        "name" r#""other""# => To "name" "";
        "emissiveFactor" "[0.5, 0.25, 0]" => To "emission.color" "";
        "emissiveTexture" TEXTURE => To "emission.color_texture" "";
        "normalTexture" r#"{"index": 0, "scale": 0.5}"# => To "geometry.normal_texture, geometry.normal_strength" "a scale beyond ±10";
        "occlusionTexture" TEXTURE => Nowhere "an occlusion texture, which path tracing needs none of" "";
        "alphaMode" r#""BLEND""# => To "geometry.opacity_texture" "";
        "alphaCutoff" "0.25" => To "the model's slot" "";
        "doubleSided" "true" => To "the model's slot" "every surface has two sides; open ones of one side are reported";
    }
    "/pbrMetallicRoughness/" {
        "baseColorFactor" "[0.5, 0.25, 0, 0.5]" => To "base.color, geometry.opacity" "";
        "baseColorTexture" TEXTURE => To "base.color_texture" "";
        "metallicFactor" "0.25" => To "base.metalness" "";
        "roughnessFactor" "0.25" => To "specular.roughness" "matched to the lobe that is chosen; above 0.7 GGX";
        "metallicRoughnessTexture" TEXTURE => To "specular.roughness_texture" "";
    }
    "/extensions/KHR_materials_emissive_strength/" {
        "emissiveStrength" "3" => To "emission.strength" "";
    }
    "/extensions/KHR_materials_ior/" {
        "ior" "1.25" => To "specular.ior" "from 1 to 4; 0 is taken as 4";
    }
    "/extensions/KHR_materials_specular/" {
        "specularFactor" "0.25" => To "specular.weight, without metals" "";
        "specularTexture" TEXTURE => To "specular.weight" "by its mean";
        "specularColorFactor" "[2, 0.5, 0.25]" => To "specular.color, without metals" "at most 1 in what transmits";
        "specularColorTexture" TEXTURE => To "specular.color" "by its mean";
    }
    "/extensions/KHR_materials_clearcoat/" {
        "clearcoatFactor" "0.25" => To "coat.weight" "";
        "clearcoatTexture" TEXTURE => To "coat.weight_texture" "";
        "clearcoatRoughnessFactor" "0.25" => To "coat.roughness" "matched to the geometric lobe";
        "clearcoatRoughnessTexture" TEXTURE => To "coat.roughness_texture" "";
        "clearcoatNormalTexture" r#"{"index": 0, "scale": 0.5}"# => To "coat.normal_texture, coat.normal_strength" "a scale beyond ±10";
    }
    "/extensions/KHR_materials_coat/" {
        "coatFactor" "0.25" => To "coat.weight" "a draft; in the place of KHR_materials_clearcoat";
        "coatTexture" TEXTURE => To "coat.weight_texture" "";
        "coatRoughnessFactor" "0.25" => To "coat.roughness" "matched to the geometric lobe";
        "coatRoughnessTexture" TEXTURE => To "coat.roughness_texture" "";
        "coatNormalTexture" TEXTURE => To "coat.normal_texture, coat.normal_strength" "";
        "coatIor" "1.25" => To "coat.ior" "from 1 to 4";
        "coatColorFactor" "[0.5, 0.25, 0.125]" => To "coat.color" "";
        "coatColorTexture" TEXTURE => To "coat.color_texture" "";
        "coatDarkeningFactor" "0.25" => To "coat.darkening" "";
        "coatAnisotropyStrength" "0.25" => To "coat.anisotropy, coat.roughness" "";
        "coatAnisotropyRotation" "0.25" => Nowhere "a turn of the coat's highlight, which lies along the tangent" "";
        "coatAnisotropyTexture" TEXTURE => Nowhere "a texture of the coat's anisotropy" "";
    }
    "/extensions/KHR_materials_diffuse_roughness/" {
        "diffuseRoughnessFactor" "0.25" => To "base.diffuse_roughness" "a draft";
        "diffuseRoughnessTexture" TEXTURE => Nowhere "a texture of the diffuse roughness" "";
    }
    "/extensions/KHR_materials_transmission/" {
        "transmissionFactor" "0.25" => To "transmission.weight" "";
        "transmissionTexture" TEXTURE => To "transmission.weight" "by its mean";
    }
    "/extensions/KHR_materials_volume/" {
        "thicknessFactor" "0" => To "nothing, solids are as thick as they are" "0 is a thin wall, which bends nothing";
        "thicknessTexture" TEXTURE => Nowhere "a thickness texture: solids are as thick as they are" "";
        "attenuationDistance" "0.25" => To "transmission.depth" "";
        "attenuationColor" "[0.5, 0.25, 0.125]" => To "transmission.color" "";
    }
    "/extensions/KHR_materials_anisotropy/" {
        "anisotropyStrength" "0.25" => To "specular.anisotropy, specular.roughness" "stretched at most 19 : 1";
        "anisotropyRotation" "0.25" => To "specular.rotation" "";
        "anisotropyTexture" TEXTURE => To "specular.anisotropy, specular.rotation" "by its mean, with the strength that this has";
    }
    "/extensions/" {
        "KHR_materials_unlit" "{}" => To "emission.color, emission.strength" "shines with its colour";
    }
    "/extensions/KHR_materials_pbrSpecularGlossiness/" {
        "diffuseFactor" "[0.5, 0.25, 0, 1]" => To "base.color, geometry.opacity" "converted";
        "diffuseTexture" TEXTURE => To "base.color_texture" "converted texel by texel";
        "specularFactor" "[0.5, 0.25, 0.5]" => To "base.color, base.metalness" "converted; below 4 %, specular.color";
        "glossinessFactor" "0.25" => To "specular.roughness" "converted";
        "specularGlossinessTexture" TEXTURE => To "specular.roughness_texture" "converted texel by texel";
    }
    "/extensions/KHR_materials_sheen/" {
        "sheenColorFactor" "[0.5, 0.25, 0]" => To "fuzz.weight, fuzz.color" "as fuzz of about its albedo";
        "sheenColorTexture" TEXTURE => To "fuzz.weight_texture, fuzz.color_texture" "converted texel by texel";
        "sheenRoughnessFactor" "0.25" => To "fuzz.roughness" "as fuzz of about its albedo";
        "sheenRoughnessTexture" TEXTURE => To "fuzz.roughness_texture" "converted texel by texel";
    }
    "/extensions/KHR_materials_fuzz/" {
        "fuzzFactor" "0.25" => To "fuzz.weight" "a draft";
        "fuzzTexture" TEXTURE => To "fuzz.weight_texture" "";
        "fuzzColorFactor" "[0.5, 0.25, 0]" => To "fuzz.color" "a draft";
        "fuzzColorTexture" TEXTURE => To "fuzz.color_texture" "";
        "fuzzRoughnessFactor" "0.25" => To "fuzz.roughness" "a draft";
        "fuzzRoughnessTexture" TEXTURE => To "fuzz.roughness_texture" "";
    }
    "/extensions/KHR_materials_iridescence/" {
        "iridescenceFactor" "0.25" => To "thin_film.weight" "";
        "iridescenceTexture" TEXTURE => To "thin_film.weight_texture" "";
        "iridescenceIor" "1.5" => To "thin_film.ior" "from 1 to 3";
        "iridescenceThicknessMinimum" "50" => To "thin_film.thickness_texture" "where its texture is black";
        "iridescenceThicknessMaximum" "500" => To "thin_film.thickness" "at most 10 µm";
        "iridescenceThicknessTexture" TEXTURE => To "thin_film.thickness_texture" "";
    }
    "/extensions/KHR_materials_dispersion/" {
        "dispersion" "0.25" => Kept "transmission.dispersion" "";
    }
    "/extensions/KHR_materials_diffuse_transmission/" {
        "diffuseTransmissionFactor" "0.25" => Kept "diffuse_transmission.weight" "";
        "diffuseTransmissionTexture" TEXTURE => Kept "" "ignored";
        "diffuseTransmissionColorFactor" "[0.5, 0.25, 0]" => Kept "diffuse_transmission.color" "";
        "diffuseTransmissionColorTexture" TEXTURE => Kept "" "ignored";
    }
};

/// Reports a material's parameters that the table ignores or does not have. Extensions that the file `declares` are reported
/// with the file.
pub(super) fn report_unread(material: &Json, declared: &[String], name: &str, report: &mut ImportReport) {
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
