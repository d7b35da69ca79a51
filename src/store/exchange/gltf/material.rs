//! Materials of glTF with their extensions.

use serde_json::{Map, Value as Json, json};

use crate::{
    document::{MaterialSettings, parameter},
    import::{FileParameter, GLTF_PARAMETERS, gltf_from_widths},
    optics::{layer::fuzz::sheen_of_fuzz, target::TARGETS},
    scene::{AlphaMode, TextureRef, texture::TextureTarget as On},
    store::exchange::{carried, surface::Surface},
};

/// The extension of stretched highlights.
pub const ANISOTROPY: &str = "KHR_materials_anisotropy";

/// The extension of materials that shine and do nothing else.
pub const UNLIT: &str = "KHR_materials_unlit";

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
    /// Whether its emission is multiplied by vertex colours, as the format has it of unlit materials alone.
    pub is_unlit: bool,
}

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
    let mean = textures.roughness_mean.unwrap_or(1.0).max(0.001);
    let is_refracting = surface.transmission_weight * (1.0 - surface.metalness) > 0.0;
    let shown = numbers_of_format(material, surface, mean, radius);
    let [r, g, b] = shown.base_color;
    let mut json = json!({
        "name": surface.name,
        "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, surface.opacity] },
    });
    for rows in GLTF_PARAMETERS.chunk_by(|a, b| part(a) == part(b)) {
        let numbers = rows
            .iter()
            .filter(|row| row.keys()[0] != "base.color")
            .filter_map(|row| {
                let default = row.default_value()?;
                let value = parameter(row.keys()[0]).ok()?.rgb(&shown)?;
                Some((row, default, value.map(|x| x * row.per)))
            });
        let numbers: Vec<_> = numbers.collect();
        // A layer without weight is left out, as is what has its defaults.
        let is_written = match numbers.first() {
            Some((row, _, value)) if row.default == "0" => value[0] != 0.0,
            _ => numbers.iter().any(|(_, default, value)| value != default),
        };
        if is_written && (part(&rows[0]) != COAT || surface.coat_on_base) {
            for (row, _, value) in numbers {
                put(
                    &mut json,
                    row.place,
                    if row.is_list() { json!(value) } else { value[0].into() },
                );
            }
        }
    }
    if surface.fuzz_weight > 0.0 && textures.of[On::Fuzz as usize].is_none() {
        // For readers without the draft. It has no texture of its weight: it would be everywhere.
        let mut sheen = json!({
            "sheenColorFactor": surface.fuzz_color.map(|x| x * surface.fuzz_weight),
            "sheenRoughnessFactor": sheen_of_fuzz(surface.fuzz_roughness),
        });
        if let Some(texture) = &textures.of[On::FuzzColor as usize] {
            sheen["sheenColorTexture"] = texture.clone();
        }
        put(&mut json, SHEEN, sheen);
    }
    if json.pointer(COAT).is_some() {
        let widths = gltf_from_widths(surface.coat_roughness, surface.coat_anisotropy);
        put(
            &mut json,
            "/extensions/KHR_materials_coat/coatRoughnessFactor",
            widths.roughness.into(),
        );
    }
    if is_refracting {
        let place = "/extensions/KHR_materials_volume/thicknessFactor";
        put(&mut json, place, (radius as f32).into());
    }
    for row in GLTF_PARAMETERS
        .iter()
        .filter(|row| row.example.starts_with('{') && part(row) != SHEEN)
    {
        let [key, strength] = row.keys();
        let texture = On::of_key(key, "_texture").and_then(|target| textures.of[target as usize].clone());
        let has_weight = key == "specular.weight_texture" && surface.specular_weight > 0.0;
        let is_there = !part(row).starts_with("/extensions") || json.pointer(part(row)).is_some() || has_weight;
        let Some(mut texture) = texture.filter(|_| is_there) else {
            continue;
        };
        if let Ok(Some([strength, ..])) = parameter(strength).map(|strength| strength.rgb(material))
            && strength != 1.0
        {
            texture["scale"] = strength.into();
        }
        put(&mut json, row.place, texture);
    }
    let film = "/extensions/KHR_materials_iridescence";
    if textures.of[On::FilmThickness as usize].is_some() && json.pointer(film).is_some() {
        let thinnest = 1e3 * surface.film_thickness * textures.thinnest;
        put(
            &mut json,
            &format!("{film}/iridescenceThicknessMinimum"),
            thinnest.into(),
        );
    }
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
    let (strength, [r, g, b]) = surface.strength_and_color();
    if textures.is_unlit && strength <= 1.0 && only_shines(surface) {
        let texture = json["emissiveTexture"].take();
        json["pbrMetallicRoughness"] =
            json!({ "baseColorFactor": [strength * r, strength * g, strength * b, surface.opacity] });
        if !texture.is_null() {
            json["pbrMetallicRoughness"]["baseColorTexture"] = texture;
        }
        for key in ["emissiveTexture", "emissiveFactor"] {
            json.as_object_mut().and_then(|json| json.remove(key));
        }
        json["extensions"] = json!({ UNLIT: {} });
    }
    json["extras"] = json!({ carried::MARK: carried::json(material) });
    json
}

/// The parameters with the numbers that the format has for them, but for units; `mean` is that of the roughness texture.
fn numbers_of_format(material: &MaterialSettings, surface: &Surface, mean: f32, radius: f64) -> Surface {
    let transmission = surface.transmission_weight * (1.0 - surface.metalness);
    let absorbs = transmission > 0.0 && surface.transmission_depth > 0.0;
    let widths = gltf_from_widths(surface.roughness * mean, surface.anisotropy);
    let (strength, emission) = surface.strength_and_color();
    let mut shown = Surface {
        base_color: match (transmission > 0.5, absorbs) {
            // What is refracted has the base colour there.
            (true, true) => [1.0; 3],
            (true, false) => surface.transmission_color,
            _ => surface.base_color,
        },
        anisotropy: widths.stretch,
        rotation_deg: surface.ratio_and_rotation().1,
        coat_anisotropy: gltf_from_widths(surface.coat_roughness, surface.coat_anisotropy).stretch,
        transmission_depth: (f64::from(surface.transmission_depth) * radius) as f32,
        emission_color: [0.0; 3],
        emission_strength: 1.0,
        normal_strength: material.normal_strength,
        coat_normal_strength: material.coat_normal_strength,
        ..surface.clone()
    };
    if surface.anisotropy != 0.0 {
        shown.roughness = widths.roughness / mean;
    }
    if strength > 0.0 {
        (shown.emission_strength, shown.emission_color) = (strength, emission);
    }
    if transmission == 0.0 {
        shown.transmission_weight = 0.0;
    }
    if !absorbs {
        shown.transmission_depth = 0.0;
    }
    shown
}

/// Whether a surface reflects and transmits nothing.
fn only_shines(surface: &Surface) -> bool {
    let weights = [surface.specular_weight, surface.coat_weight, surface.fuzz_weight];
    surface.base_color == [0.0; 3] && surface.transmission_weight == 0.0 && weights == [0.0; 3]
}

/// The draft of OpenPBR's coat; readers without it take the clearcoat.
const COAT: &str = "/extensions/KHR_materials_coat";
/// What stands for fuzz where its draft is not read.
const SHEEN: &str = "/extensions/KHR_materials_sheen";

/// The object in which a parameter stands.
fn part(row: &FileParameter) -> &'static str {
    row.place.rsplit_once('/').map_or("", |(part, _)| part)
}

/// Puts a value where a pointer says, making the objects on the way.
fn put(json: &mut Json, place: &str, value: Json) {
    *place[1..].split('/').fold(json, |at, key| &mut at[key]) = value;
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
