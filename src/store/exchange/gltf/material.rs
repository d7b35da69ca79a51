//! Materials of glTF with their extensions.

use serde_json::{Map, Value as Json, json};

use crate::document::MaterialSettings;
use crate::import::gltf_from_widths;
use crate::optics::layer::fuzz::sheen_of_fuzz;
use crate::optics::target::TARGETS;
use crate::scene::texture::TextureTarget as On;
use crate::scene::{AlphaMode, TextureRef};
use crate::store::exchange::carried;
use crate::store::exchange::surface::Surface;

/// The extension of stretched highlights.
pub const ANISOTROPY: &str = "KHR_materials_anisotropy";
/// The extension of coats.
const CLEARCOAT: &str = "KHR_materials_clearcoat";
/// The draft of OpenPBR's coat.
const COAT: &str = "KHR_materials_coat";

/// The draft of OpenPBR's fuzz.
const FUZZ: &str = "KHR_materials_fuzz";
/// The extension that stands for it where the draft is not read.
const SHEEN: &str = "KHR_materials_sheen";

/// The extension of thin films.
const IRIDESCENCE: &str = "KHR_materials_iridescence";

/// What a slot's material looks up, as references to textures.
#[derive(Clone, Debug, Default)]
pub struct SlotTextures {
    /// By target; that of the base colour has the opacity, that of the roughness the metalness.
    pub of: [Option<Json>; TARGETS],
    /// The film's least thickness over its largest, where a texture varies it.
    pub thinnest: f32,
    /// The mean of the roughness that a texture varies.
    pub roughness_mean: Option<f32>,
    /// What the texture's opacity means, where it is looked up.
    pub alpha: Option<(AlphaMode, f32)>,
    pub is_double_sided: bool,
}

/// Where the textures of extensions stand.
const TEXTURES: &[(&str, &str, On)] = &[
    (CLEARCOAT, "clearcoatTexture", On::Coat),
    (CLEARCOAT, "clearcoatRoughnessTexture", On::CoatRoughness),
    (CLEARCOAT, "clearcoatNormalTexture", On::CoatNormal),
    (COAT, "coatTexture", On::Coat),
    (COAT, "coatRoughnessTexture", On::CoatRoughness),
    (COAT, "coatColorTexture", On::CoatColor),
    (COAT, "coatNormalTexture", On::CoatNormal),
    (FUZZ, "fuzzTexture", On::Fuzz),
    (FUZZ, "fuzzColorTexture", On::FuzzColor),
    (FUZZ, "fuzzRoughnessTexture", On::FuzzRoughness),
    (SHEEN, "sheenColorTexture", On::FuzzColor),
    (IRIDESCENCE, "iridescenceTexture", On::Film),
    (IRIDESCENCE, "iridescenceThicknessTexture", On::FilmThickness),
];

/// A reference to a texture with the place that it has on the mesh.
pub fn texture_info(index: usize, place: &TextureRef) -> Json {
    let mut info = json!({ "index": index });
    if place.uv_set > 0 {
        info["texCoord"] = place.uv_set.into();
    }
    let [a, b, offset_u, c, d, offset_v] = place.texture_from_mesh_uv;
    if [a, b, offset_u, c, d, offset_v] != [1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        // Offset, rotation, scale: the columns are (cos, −sin) and (sin, cos), scaled.
        let rotation = (-c).atan2(a);
        let (sin, cos) = rotation.sin_cos();
        info["extensions"]["KHR_texture_transform"] = json!({
            "offset": [offset_u, offset_v],
            "rotation": rotation,
            "scale": [a * cos - c * sin, b * sin + d * cos],
        });
    }
    info
}

/// A material; `radius` is what lengths inside are counted in.
pub fn material_json(material: &MaterialSettings, surface: &Surface, textures: &SlotTextures, radius: f64) -> Json {
    let mean = textures.roughness_mean.unwrap_or(1.0).max(1e-3);
    let widths = gltf_from_widths(surface.roughness * mean, surface.anisotropy);
    let transmission = surface.transmission_weight * (1.0 - surface.metalness);
    let absorbs = transmission > 0.0 && surface.transmission_depth > 0.0;
    let [r, g, b] = match (transmission > 0.5, absorbs) {
        // What is refracted has the base colour there.
        (true, true) => [1.0; 3],
        (true, false) => surface.transmission_color,
        _ => surface.base_color,
    };
    let mut pbr = json!({
        "baseColorFactor": [r, g, b, surface.opacity],
        "metallicFactor": surface.metalness,
        "roughnessFactor": if surface.anisotropy == 0.0 { surface.roughness } else { widths.roughness / mean },
    });
    let mut json = json!({ "name": surface.name });
    let has = |target| textures.of[target as usize].is_some();
    let put = |to: &mut Json, key: &str, target, strength: f32| {
        if let Some(texture) = &textures.of[target as usize] {
            to[key] = texture.clone();
            if strength != 1.0 {
                to[key]["scale"] = strength.into();
            }
        }
    };
    put(&mut pbr, "baseColorTexture", On::BaseColor, 1.0);
    put(&mut pbr, "metallicRoughnessTexture", On::Roughness, 1.0);
    put(&mut json, "normalTexture", On::Normal, material.normal_strength);
    put(&mut json, "emissiveTexture", On::Emission, 1.0);
    json["pbrMetallicRoughness"] = pbr;
    match textures.alpha {
        Some((AlphaMode::Mask, cutoff)) => {
            json["alphaMode"] = "MASK".into();
            json["alphaCutoff"] = cutoff.into();
        }
        Some((AlphaMode::Blend, _)) => json["alphaMode"] = "BLEND".into(),
        _ if surface.opacity < 1.0 => json["alphaMode"] = "BLEND".into(),
        _ => {}
    }
    if textures.is_double_sided {
        json["doubleSided"] = true.into();
    }
    let mut extensions = extensions(surface, transmission, absorbs, radius, &mut json);
    if has(On::Fuzz) {
        // A sheen has no texture of its weight: it would be everywhere.
        extensions.remove(SHEEN);
    }
    for (extension, key, target) in TEXTURES {
        let strength = if *target == On::CoatNormal {
            material.coat_normal_strength
        } else {
            1.0
        };
        if let Some(to) = extensions.get_mut(*extension) {
            put(to, key, *target, strength);
        }
    }
    if let Some(film) = extensions.get_mut(IRIDESCENCE).filter(|_| has(On::FilmThickness)) {
        let thinnest = 1e3 * surface.film_thickness * textures.thinnest;
        film["iridescenceThicknessMinimum"] = thinnest.into();
    }
    if surface.anisotropy != 0.0 {
        let (_, rotation_deg) = surface.ratio_and_rotation();
        let anisotropy = json!({
            "anisotropyStrength": widths.stretch,
            "anisotropyRotation": rotation_deg.to_radians(),
        });
        extensions.insert(ANISOTROPY.to_owned(), anisotropy);
    }
    if !extensions.is_empty() {
        json["extensions"] = Json::Object(extensions);
    }
    json["extras"] = json!({ carried::MARK: carried::json(material) });
    json
}

fn extensions(surface: &Surface, transmission: f32, absorbs: bool, radius: f64, json: &mut Json) -> Map<String, Json> {
    let mut all = Map::new();
    let (strongest, emission) = surface.strength_and_color();
    if strongest > 0.0 {
        json["emissiveFactor"] = json!(emission);
        if strongest != 1.0 {
            all.insert(
                "KHR_materials_emissive_strength".to_owned(),
                json!({ "emissiveStrength": strongest }),
            );
        }
    }
    if surface.ior != 1.5 {
        all.insert("KHR_materials_ior".to_owned(), json!({ "ior": surface.ior }));
    }
    if surface.specular_weight != 1.0 || surface.specular_color != [1.0; 3] {
        let specular = json!({
            "specularFactor": surface.specular_weight,
            "specularColorFactor": surface.specular_color,
        });
        all.insert("KHR_materials_specular".to_owned(), specular);
    }
    if surface.diffuse_roughness > 0.0 {
        all.insert(
            "KHR_materials_diffuse_roughness".to_owned(),
            json!({ "diffuseRoughnessFactor": surface.diffuse_roughness }),
        );
    }
    if surface.coat_weight > 0.0 {
        let coat = json!({
            "clearcoatFactor": surface.coat_weight,
            "clearcoatRoughnessFactor": surface.coat_roughness,
        });
        all.insert(CLEARCOAT.to_owned(), coat);
        if surface.coat_on_base {
            // Readers without the draft take the other.
            let widths = gltf_from_widths(surface.coat_roughness, surface.coat_anisotropy);
            let draft = json!({
                "coatFactor": surface.coat_weight,
                "coatRoughnessFactor": widths.roughness,
                "coatIor": surface.coat_ior,
                "coatColorFactor": surface.coat_color,
                "coatDarkeningFactor": surface.coat_darkening,
                "coatAnisotropyStrength": widths.stretch,
            });
            all.insert(COAT.to_owned(), draft);
        }
    }
    if surface.fuzz_weight > 0.0 {
        all.insert(
            FUZZ.to_owned(),
            json!({
                "fuzzFactor": surface.fuzz_weight,
                "fuzzColorFactor": surface.fuzz_color,
                "fuzzRoughnessFactor": surface.fuzz_roughness,
            }),
        );
        // Readers without the draft take the other.
        all.insert(
            SHEEN.to_owned(),
            json!({
                "sheenColorFactor": surface.fuzz_color.map(|x| x * surface.fuzz_weight),
                "sheenRoughnessFactor": sheen_of_fuzz(surface.fuzz_roughness),
            }),
        );
    }
    if surface.film_weight > 0.0 {
        let film = json!({
            "iridescenceFactor": surface.film_weight,
            "iridescenceIor": surface.film_ior,
            "iridescenceThicknessMaximum": 1e3 * surface.film_thickness,
        });
        all.insert(IRIDESCENCE.to_owned(), film);
    }
    if transmission > 0.0 {
        all.insert(
            "KHR_materials_transmission".to_owned(),
            json!({ "transmissionFactor": surface.transmission_weight }),
        );
        let mut volume = json!({ "thicknessFactor": radius as f32 });
        if absorbs {
            volume["attenuationDistance"] = ((f64::from(surface.transmission_depth) * radius) as f32).into();
            volume["attenuationColor"] = json!(surface.transmission_color);
        }
        all.insert("KHR_materials_volume".to_owned(), volume);
    }
    all
}

/// The names of the extensions that materials have.
pub fn extensions_used(materials: &[Json]) -> Vec<Json> {
    let mut names: Vec<String> = Vec::new();
    fn collect(json: &Json, names: &mut Vec<String>) {
        match json {
            Json::Object(object) => {
                for (key, value) in object.iter().filter(|(key, _)| *key != "extras") {
                    if key == "extensions" {
                        names.extend(value.as_object().into_iter().flat_map(Map::keys).cloned());
                    }
                    collect(value, names);
                }
            }
            Json::Array(list) => list.iter().for_each(|value| collect(value, names)),
            _ => {}
        }
    }
    materials.iter().for_each(|material| collect(material, &mut names));
    names.sort();
    names.dedup();
    names.into_iter().map(Json::from).collect()
}
