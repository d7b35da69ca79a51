//! Fate of each keyword of a `.mtl` library: the table in docs/FORMATS.md, from which the import report is made.

use tobj::Material;

use crate::file_parameter::{FileParameter, Goes};
use crate::file_parameters;
use crate::scene::report::{Fate, ImportReport};

use Goes::{Nowhere, To};

/// Example of a texture file.
const PICTURE: &str = "picture.png";

/// Every keyword of a material that the format and its additions have.
pub const MTL_PARAMETERS: &[FileParameter] = file_parameters! { "" {
    "Kd" = "0.6 0.6 0.6" "0.5 0.25 0" => share "base.color";
    "Ks" = "0 0 0" "0.5 0.25 0" => to "specular.weight": "what is not black reflects as `Ni` says";
    "Ke" = "0 0 0" "0.5 0.25 0" => to "emission.color, emission.strength" in 0.0..1e6;
    "Ka" = "0 0 0" "0.5 0.25 0" => nowhere "ambient light (Ka), which path tracing needs none of";
    "Ns" = "0" "200" => to "specular.roughness": "Blinn-Phong's exponent, as the lobe that is chosen";
    "Ni" = "1.5" "1.25" => to "specular.ior": "below 1 as 1.5" in 1.0..4.0;
    "d" = "1" "0.5" => share "geometry.opacity";
    "Tr" = "0" "0.5" => share "geometry.opacity": "where there is no `d`";
    "Tf" = "1 1 1" "0.5 0.25 0" => nowhere "the colour of what passes through (Tf)";
    "illum" = "2" "1" => to "specular.weight": "0 and 1 reflect nothing; 2, 3, 5 and 8 are as 2, others are reported";
    "sharpness" = "60" "100" => nowhere "the sharpness of a reflection map";
    "Pr" "0.25" => share "specular.roughness";
    "Pm" = "0" "0.25" => share "base.metalness";
    "Pc" = "0" "0.25" => share "coat.weight";
    "Pcr" = "0" "0.25" => share "coat.roughness" of "Pc";
    "Ps" = "0" "0.25" => nowhere "a sheen (Ps)";
    "aniso" = "0" "0.25" => nowhere "a stretched highlight (aniso)";
    "anisor" = "0" "0.25" => nowhere "the turn of a stretched highlight (anisor)";
    "map_Kd" PICTURE => to "base.color_texture";
    "map_Ke" PICTURE => to "emission.color_texture";
    "map_d" PICTURE => to "geometry.opacity_texture": "the alpha of `map_Kd`; another texture is ignored";
    "norm" PICTURE => to "geometry.normal_texture";
    "bump" PICTURE => to "geometry.normal_texture": "also `map_bump`; heights are ignored";
    "map_Ka" PICTURE => nowhere "a texture given by map_Ka";
    "map_Ks" PICTURE => nowhere "a texture given by map_Ks";
    "map_Ns" PICTURE => nowhere "a texture given by map_Ns";
    "map_Pr" PICTURE => nowhere "a texture given by map_Pr";
    "map_Pm" PICTURE => nowhere "a texture given by map_Pm";
    "map_Ps" PICTURE => nowhere "a texture given by map_Ps";
    "map_Pc" PICTURE => nowhere "a texture given by map_Pc";
    "map_Pcr" PICTURE => nowhere "a texture given by map_Pcr";
    "disp" PICTURE => nowhere "a displacement (disp)";
    "decal" PICTURE => nowhere "a decal";
    "refl" PICTURE => nowhere "a reflection map (refl)";
} };

/// Illumination models that are shown as they are, or nearly: 2 is a highlight; 3, 5 and 8 reflect the scene besides.
const SHOWN: [u8; 6] = [0, 1, 2, 3, 5, 8];

/// Reports a material's parameters that the table ignores or does not have, and values out of range.
pub(super) fn report_unread(material: &Material, report: &mut ImportReport) {
    let mut note = |fate, what: String| report.note(fate, what, &material.name);
    for (key, text) in keywords(material) {
        let Some(row) = MTL_PARAMETERS.iter().find(|row| row.place == key) else {
            if !matches!(key, "map_bump" | "map_Bump") {
                note(Fate::Ignored, format!("{key} of a .mtl material"));
            }
            continue;
        };
        let numbers = numbers(&text);
        match (row.goes, row.range) {
            (Nowhere(what), _) if numbers.is_empty() || numbers != self::numbers(row.default) => {
                note(Fate::Ignored, what.to_owned());
            }
            (To(_), Some(_)) if numbers.is_empty() => {
                note(Fate::Ignored, format!("{key} of a .mtl material, which is no number"));
            }
            (To(_), Some([least, most])) if numbers.iter().any(|x| !(least..=most).contains(x)) => {
                note(Fate::Approximated, format!("{key} beyond {least} to {most}"));
            }
            _ => {}
        }
    }
    if material.specular.is_some_and(|color| color != [0.0; 3]) {
        note(
            Fate::Approximated,
            "a colour of reflections (Ks), as the index has it".to_owned(),
        );
    }
    if let Some(model) = material.illumination_model.filter(|model| !SHOWN.contains(model)) {
        note(Fate::Approximated, format!("illumination model {model}, as 2"));
    }
}

/// Keywords of a material with their text.
fn keywords(material: &Material) -> Vec<(&str, String)> {
    let color = |color: Option<[f32; 3]>| color.map(|[r, g, b]| format!("{r} {g} {b}"));
    let number = |number: Option<f32>| number.map(|x| x.to_string());
    let known = [
        ("Ka", color(material.ambient)),
        ("Kd", color(material.diffuse)),
        ("Ke", color(material.emissive)),
        ("Ni", number(material.optical_density)),
        ("d", number(material.dissolve)),
        ("map_Ka", material.ambient_texture.clone()),
        ("map_Ks", material.specular_texture.clone()),
        ("map_Ns", material.shininess_texture.clone()),
    ];
    let mut others: Vec<_> = material.unknown_param.iter().collect();
    others.sort_unstable();
    let known = known.into_iter().filter_map(|(key, text)| Some((key, text?)));
    known
        .chain(others.into_iter().map(|(key, text)| (key.as_str(), text.clone())))
        .collect()
}

fn numbers(text: &str) -> Vec<f32> {
    text.split_whitespace().map_while(|word| word.parse().ok()).collect()
}
