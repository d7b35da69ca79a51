//! A Python script that makes the material in Blender, by its Principled BSDF.

use std::path::Path;

use serde_json::Value as Json;

use super::{ExchangeError, Subject, Written, carried, shown, surface::Surface, surface::Takes};

const TAKES: Takes = Takes {
    widths: Surface::disney_widths,
    lacks: [
        Takes::OPEN_PBR.lacks[0],
        "transmission.depth coat.anisotropy coat.on_base coat.darkening thin_film.weight specular.on_metal",
    ],
    ..Takes::OPEN_PBR
};

pub fn write(subject: &Subject, _path: &Path) -> Result<Written, ExchangeError> {
    let mut text = HEAD.to_owned();
    let mut reports = Vec::new();
    for material in &subject.materials {
        let (surface, report) = shown(material, &TAKES);
        text += &format!("\n# {}\n", carried::comment(material));
        text += &call(&surface, &carried::line(material));
        reports.push(report);
    }
    Ok(Written::text(text, reports))
}

const HEAD: &str = r#"# Materials of Glossmith for Blender: Text Editor > Open > Run Script. The new materials are in the list of materials.
import bpy


def glossmith_material(name, inputs, rotation_deg, exact):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    # By this property the material comes back to Glossmith without loss.
    material["glossmith_material"] = exact
    nodes, links = material.node_tree.nodes, material.node_tree.links
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    for key, value in inputs.items():
        if key in shader.inputs:
            shader.inputs[key].default_value = value
        else:
            print("This Blender has no input " + key)
    if rotation_deg:
        tangent = nodes.new("ShaderNodeTangent")
        tangent.direction_type = "UV_MAP"
        links.new(tangent.outputs["Tangent"], shader.inputs["Tangent"])
        shader.inputs["Anisotropic Rotation"].default_value = (rotation_deg / 360.0) % 1.0
    return material

"#;

/// Text as Python writes it: JSON's marks and escapes are Python's.
fn python(text: &str) -> String {
    Json::from(text).to_string()
}

fn call(surface: &Surface, exact: &str) -> String {
    let (_, rotation_deg) = surface.ratio_and_rotation();
    let (strongest, emitted) = surface.strength_and_color();
    let rgba = |[r, g, b]: [f32; 3]| format!("({r}, {g}, {b}, 1.0)");
    let mut base = surface.base_color;
    if surface.transmission_weight >= 0.5 && surface.metalness < 0.5 {
        // What is refracted has the base colour there, once a passage.
        base = surface.transmission_color.map(f32::sqrt);
    }
    let inputs = [
        ("Base Color", rgba(base)),
        ("Metallic", surface.metalness.to_string()),
        ("Roughness", surface.roughness.to_string()),
        ("IOR", surface.ior.to_string()),
        ("Alpha", surface.opacity.to_string()),
        // 0.5 leaves the reflectance of the index as it is.
        ("Specular IOR Level", (0.5 * surface.specular_weight).to_string()),
        ("Specular Tint", rgba(surface.tint())),
        ("Anisotropic", surface.disney_anisotropy().to_string()),
        ("Transmission Weight", surface.transmission_weight.to_string()),
        ("Coat Weight", surface.coat_weight.to_string()),
        ("Coat Roughness", surface.coat_roughness.to_string()),
        ("Coat IOR", surface.coat_ior.to_string()),
        ("Coat Tint", rgba(surface.coat_color)),
        // Blender's sheen of fibres is the same model.
        ("Sheen Weight", surface.fuzz_weight.to_string()),
        ("Sheen Roughness", surface.fuzz_roughness.to_string()),
        ("Sheen Tint", rgba(surface.fuzz_color)),
        ("Emission Color", rgba(emitted)),
        ("Emission Strength", strongest.to_string()),
    ];
    // Blender has it since 4.3.
    let of_base =
        (surface.diffuse_roughness > 0.0).then(|| ("Diffuse Roughness", surface.diffuse_roughness.to_string()));
    // And this since 4.2, in nm.
    let film = (surface.film_weight > 0.0).then(|| {
        [
            ("Thin Film Thickness", (1e3 * surface.film_thickness).to_string()),
            ("Thin Film IOR", surface.film_ior.to_string()),
        ]
    });
    let lines: Vec<String> = inputs
        .into_iter()
        .chain(of_base)
        .chain(film.into_iter().flatten())
        .map(|(key, value)| format!("        \"{key}\": {value},\n"))
        .collect();
    let turn = if surface.anisotropy == 0.0 { 0.0 } else { rotation_deg };
    format!(
        "glossmith_material(\n    {},\n    {{\n{}    }},\n    {turn},\n    {},\n)\n",
        python(&surface.name),
        lines.concat(),
        python(exact)
    )
}
