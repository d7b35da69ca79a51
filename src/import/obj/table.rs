//! Fate of each keyword of a `.mtl` library: the table in docs/FORMATS.md, from which the import report is made.

use tobj::Material;

use crate::file_parameter::{FileParameter, Goes};
use crate::scene::report::{Fate, ImportReport};

use Goes::{Nowhere, To};

const fn row(place: &'static str, default: &'static str, example: &'static str, goes: Goes) -> FileParameter {
    FileParameter::new(place, default, example, goes)
}

/// Example of a texture file.
const PICTURE: &str = "picture.png";

/// Every keyword of a material that the format and its additions have.
pub const MTL_PARAMETERS: &[FileParameter] = &[
    row("Kd", "0.6 0.6 0.6", "0.5 0.25 0", To("base.color")).within(0.0, 1.0),
    row("Ks", "0 0 0", "0.5 0.25 0", To("specular.weight")).with_note("what is not black reflects as `Ni` says"),
    row("Ke", "0 0 0", "0.5 0.25 0", To("emission.color, emission.strength")).within(0.0, 1e6),
    row(
        "Ka",
        "0 0 0",
        "0.5 0.25 0",
        Nowhere("ambient light (Ka), which path tracing needs none of"),
    ),
    row("Ns", "0", "200", To("specular.roughness")).with_note("Blinn-Phong's exponent, as the lobe that is chosen"),
    row("Ni", "1.5", "1.25", To("specular.ior"))
        .within(1.0, 4.0)
        .with_note("below 1 as 1.5"),
    row("d", "1", "0.5", To("geometry.opacity")).within(0.0, 1.0),
    row("Tr", "0", "0.5", To("geometry.opacity"))
        .within(0.0, 1.0)
        .with_note("where there is no `d`"),
    row(
        "Tf",
        "1 1 1",
        "0.5 0.25 0",
        Nowhere("the colour of what passes through (Tf)"),
    ),
    row("illum", "2", "1", To("specular.weight"))
        .with_note("0 and 1 reflect nothing; 2, 3, 5 and 8 are as 2, others are reported"),
    row("sharpness", "60", "100", Nowhere("the sharpness of a reflection map")),
    row("Pr", "", "0.25", To("specular.roughness")).within(0.0, 1.0),
    row("Pm", "0", "0.25", To("base.metalness")).within(0.0, 1.0),
    row("Pc", "0", "0.25", To("coat.weight")).within(0.0, 1.0),
    row("Pcr", "0", "0.25", To("coat.roughness")).within(0.0, 1.0).of("Pc"),
    row("Ps", "0", "0.25", Nowhere("a sheen (Ps)")),
    row("aniso", "0", "0.25", Nowhere("a stretched highlight (aniso)")),
    row(
        "anisor",
        "0",
        "0.25",
        Nowhere("the turn of a stretched highlight (anisor)"),
    ),
    row("map_Kd", "", PICTURE, To("base.color_texture")),
    row("map_Ke", "", PICTURE, To("emission.color_texture")),
    row("map_d", "", PICTURE, To("geometry.opacity_texture"))
        .with_note("the alpha of `map_Kd`; another texture is ignored"),
    row("norm", "", PICTURE, To("geometry.normal_texture")),
    row("bump", "", PICTURE, To("geometry.normal_texture")).with_note("also `map_bump`; heights are ignored"),
    row("map_Ka", "", PICTURE, Nowhere("a texture given by map_Ka")),
    row("map_Ks", "", PICTURE, Nowhere("a texture given by map_Ks")),
    row("map_Ns", "", PICTURE, Nowhere("a texture given by map_Ns")),
    row("map_Pr", "", PICTURE, Nowhere("a texture given by map_Pr")),
    row("map_Pm", "", PICTURE, Nowhere("a texture given by map_Pm")),
    row("map_Ps", "", PICTURE, Nowhere("a texture given by map_Ps")),
    row("map_Pc", "", PICTURE, Nowhere("a texture given by map_Pc")),
    row("map_Pcr", "", PICTURE, Nowhere("a texture given by map_Pcr")),
    row("disp", "", PICTURE, Nowhere("a displacement (disp)")),
    row("decal", "", PICTURE, Nowhere("a decal")),
    row("refl", "", PICTURE, Nowhere("a reflection map (refl)")),
];

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
