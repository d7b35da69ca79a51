//! Fate of each keyword of a `.mtl` library: the table in docs/FORMATS.md, from which the import report is made.

use super::lines::{Material, numbers};
use crate::{
    file_parameter::{FileParameter, Goes},
    file_parameters,
    scene::report::{Fate, ImportReport},
};

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
    "map_d" PICTURE => to "geometry.opacity_texture": "the alpha of its image if it has one, else its grey";
    "map_Pr" PICTURE => to "specular.roughness_texture";
    "map_Pm" PICTURE => to "base.metalness_texture";
    "norm" PICTURE => to "geometry.normal_texture";
    "bump" PICTURE => to "geometry.normal_texture": "also `map_bump`; heights are ignored";
    "map_Ka" PICTURE => nowhere "a texture given by map_Ka";
    "map_Ks" PICTURE => nowhere "a texture given by map_Ks";
    "map_Ns" PICTURE => nowhere "a texture given by map_Ns";
    "map_Ps" PICTURE => nowhere "a texture given by map_Ps";
    "map_Pc" PICTURE => nowhere "a texture given by map_Pc";
    "map_Pcr" PICTURE => nowhere "a texture given by map_Pcr";
    "disp" PICTURE => nowhere "a displacement (disp)";
    "decal" PICTURE => nowhere "a decal";
    "refl" PICTURE => nowhere "a reflection map (refl)";
} };

/// Illumination models that are shown as they are, or nearly: 2 is a highlight; 3, 5 and 8 reflect the scene besides.
const SHOWN: [f32; 6] = [0.0, 1.0, 2.0, 3.0, 5.0, 8.0];

/// Reports a material's parameters that the table ignores or does not have, and values out of range.
pub fn report_unread(material: &Material, report: &mut ImportReport) {
    let mut note = |fate, what: String| report.note(fate, what, &material.name);
    for (key, text) in &material.lines {
        let Some(row) = MTL_PARAMETERS.iter().find(|row| row.place == key) else {
            note(Fate::Ignored, format!("{key} of a .mtl material"));
            continue;
        };
        let numbers = numbers(text);
        match (row.goes, row.range) {
            (Nowhere(what), _) if numbers.is_empty() || numbers != self::numbers(row.default) => {
                note(Fate::Ignored, what.to_owned());
            }
            (To(_), _) if numbers.is_empty() && row.example != PICTURE => {
                note(
                    Fate::Ignored,
                    format!("{key} {text} of a .mtl material, which is no number"),
                );
            }
            (To(_), Some([least, most])) if numbers.iter().any(|x| !(least..=most).contains(x)) => {
                note(Fate::Approximated, format!("{key} beyond {least} to {most}"));
            }
            _ => {}
        }
    }
    if material.color("Ks").is_some_and(|color| color != [0.0; 3]) {
        note(
            Fate::Approximated,
            "a colour of reflections (Ks), as the index has it".to_owned(),
        );
    }
    if let Some(model) = material.number("illum").filter(|model| !SHOWN.contains(model)) {
        note(Fate::Approximated, format!("illumination model {model}, as 2"));
    }
}
