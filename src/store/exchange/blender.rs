//! A Python script that makes the material in Blender, by its Principled BSDF.

use std::path::Path;

use serde_json::Value as Json;

use super::{
    ExchangeError, Subject, Written, carried, shown,
    surface::Surface,
    surface::Takes,
    textures::{Carried, Files, carry, mapping},
};
use crate::scene::texture::TextureTarget::{self, *};

/// The inputs that textures go to.
const TEXTURED: &[(TextureTarget, &str)] = &[
    (BaseColor, "Base Color"),
    (Metalness, "Metallic"),
    (Roughness, "Roughness"),
    (Opacity, "Alpha"),
    (Specular, "Specular IOR Level"),
    (Transmission, "Transmission Weight"),
    (Coat, "Coat Weight"),
    (CoatRoughness, "Coat Roughness"),
    (CoatColor, "Coat Tint"),
    (Fuzz, "Sheen Weight"),
    (FuzzRoughness, "Sheen Roughness"),
    (FuzzColor, "Sheen Tint"),
    (Emission, "Emission Color"),
    (FilmThickness, "Thin Film Thickness"),
    (Normal, "Normal"),
    (CoatNormal, "Coat Normal"),
];

const TAKES: Takes = Takes {
    widths: Surface::disney_widths,
    lacks: [
        Takes::OPEN_PBR.lacks[0],
        "transmission.depth coat.anisotropy coat.on_base coat.darkening thin_film.weight specular.on_metal",
    ],
    ..Takes::OPEN_PBR
};

pub fn write(subject: &Subject, path: &Path) -> Result<Written, ExchangeError> {
    let mut text = HEAD.to_owned();
    let (mut reports, mut files) = (Vec::new(), Files::of(path));
    for material in &subject.materials {
        let (surface, mut report) = shown(material, &TAKES);
        let has_place = |target| TEXTURED.iter().any(|(other, _)| *other == target);
        let textures = carry(material, &mut report, (has_place, false), |_, texture| {
            files.copy(&texture.file)
        });
        text += &format!("\n# {}\n", carried::comment(material));
        text += &call(&surface, &textures, &carried::line(material));
        reports.push(report);
    }
    Ok(Written {
        beside: files.contents,
        ..Written::text(text, reports)
    })
}

const HEAD: &str = r#"# Materials of Glossmith for Blender: Text Editor > Open > Run Script. The new materials are in the list of materials.
# Their textures lie beside this file.
import math
import os

import bpy


def glossmith_image(file):
    texts = [bpy.path.abspath(text.filepath) for text in bpy.data.texts if text.filepath]
    folders = [os.path.dirname(path) for path in texts + [globals().get("__file__", ""), bpy.data.filepath]]
    places = [os.path.join(folder, file) for folder in folders]
    return bpy.data.images.load(next((place for place in places if os.path.isfile(place)), file))


def glossmith_texture(tree, shader, key, file, space, channel, location, rotation_deg, scale, factor, offset):
    nodes, links = tree.nodes, tree.links
    image, mapping = nodes.new("ShaderNodeTexImage"), nodes.new("ShaderNodeMapping")
    image.image = glossmith_image(file)
    image.image.colorspace_settings.name = space
    # Of a texture, as the node calls it: coordinates are moved, turned, divided.
    mapping.vector_type = "TEXTURE"
    mapping.inputs["Location"].default_value = (*location, 0.0)
    mapping.inputs["Rotation"].default_value = (0.0, 0.0, math.radians(rotation_deg))
    mapping.inputs["Scale"].default_value = (*scale, 1.0)
    links.new(nodes.new("ShaderNodeTexCoord").outputs["UV"], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], image.inputs["Vector"])
    value = image.outputs["Alpha" if channel == "Alpha" else "Color"]
    if channel in ("Red", "Green", "Blue"):
        separate = nodes.new("ShaderNodeSeparateColor")
        links.new(value, separate.inputs["Color"])
        value = separate.outputs[channel]
    if (factor, offset) != ((1.0, 1.0, 1.0), (0.0, 0.0, 0.0)):
        affine = nodes.new("ShaderNodeVectorMath")
        affine.operation = "MULTIPLY_ADD"
        links.new(value, affine.inputs[0])
        affine.inputs[1].default_value, affine.inputs[2].default_value = factor, offset
        value = affine.outputs["Vector"]
    if "Normal" in key:
        normal = nodes.new("ShaderNodeNormalMap")
        links.new(value, normal.inputs["Color"])
        value = normal.outputs["Normal"]
    links.new(value, shader.inputs[key])


def glossmith_material(name, inputs, textures, rotation_deg, exact):
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
    for key, texture in textures.items():
        if key in shader.inputs:
            glossmith_texture(material.node_tree, shader, key, *texture)
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

/// Numbers as Python's tuple.
fn tuple(values: &[f32]) -> String {
    let values = values.iter().map(|x| format!("{:?}", x + 0.0));
    format!("({})", crate::named::joined(values, ", "))
}

fn call(surface: &Surface, textures: &[Carried<'_, String>], exact: &str) -> String {
    let (_, rotation_deg) = surface.ratio_and_rotation();
    let (strongest, emitted) = surface.strength_and_color();
    let mut base = surface.base_color;
    if surface.transmission_weight >= 0.5 && surface.metalness < 0.5 {
        // What is refracted has the base colour there, once a passage.
        base = surface.transmission_color.map(f32::sqrt);
    }
    let mut inputs = vec![
        ("Base Color", base.to_vec()),
        ("Metallic", vec![surface.metalness]),
        ("Roughness", vec![surface.roughness]),
        ("IOR", vec![surface.ior]),
        ("Alpha", vec![surface.opacity]),
        // 0.5 leaves the reflectance of the index as it is.
        ("Specular IOR Level", vec![0.5 * surface.specular_weight]),
        ("Specular Tint", surface.tint().to_vec()),
        ("Anisotropic", vec![surface.disney_anisotropy()]),
        ("Transmission Weight", vec![surface.transmission_weight]),
        ("Coat Weight", vec![surface.coat_weight]),
        ("Coat Roughness", vec![surface.coat_roughness]),
        ("Coat IOR", vec![surface.coat_ior]),
        ("Coat Tint", surface.coat_color.to_vec()),
        // Blender's sheen of fibres is the same model.
        ("Sheen Weight", vec![surface.fuzz_weight]),
        ("Sheen Roughness", vec![surface.fuzz_roughness]),
        ("Sheen Tint", surface.fuzz_color.to_vec()),
        ("Emission Color", emitted.to_vec()),
        ("Emission Strength", vec![strongest]),
    ];
    if surface.diffuse_roughness > 0.0 {
        // Blender has it since 4.3.
        inputs.push(("Diffuse Roughness", vec![surface.diffuse_roughness]));
    }
    if surface.film_weight > 0.0 {
        // And this since 4.2, in nm.
        inputs.push(("Thin Film Thickness", vec![1e3 * surface.film_thickness]));
        inputs.push(("Thin Film IOR", vec![surface.film_ior]));
    }
    let line = |(key, value): &(&str, Vec<f32>)| {
        let value = match value[..] {
            [x] => x.to_string(),
            _ => tuple(&[&value[..], &[1.0]].concat()),
        };
        format!("        \"{key}\": {value},\n")
    };
    let lines: String = inputs.iter().map(line).collect();
    let textured = textures.iter().filter_map(|texture| {
        let (_, key) = TEXTURED.iter().find(|(target, _)| *target == texture.target)?;
        let value = inputs.iter().find(|(other, _)| other == key);
        let value = value.map_or([1.0; 3], |(_, value)| [0, 1, 2].map(|i| value[i % value.len()]));
        Some(format!("        \"{key}\": {},\n", image(texture, value)))
    });
    let turn = if surface.anisotropy == 0.0 { 0.0 } else { rotation_deg };
    format!(
        "glossmith_material(\n    {},\n    {{\n{lines}    }},\n    {{\n{}    }},\n    {turn},\n    {},\n)\n",
        python(&surface.name),
        textured.collect::<String>(),
        python(exact)
    )
}

/// A texture that is multiplied by a value: what the script's function takes of it.
fn image(texture: &Carried<'_, String>, value: [f32; 3]) -> String {
    let space = ["Non-Color", "sRGB"][usize::from(texture.texture.is_srgb(texture.target))];
    let channel = match texture.target.is_number() {
        true => ["Red", "Green", "Blue", "Alpha"][texture.channel],
        false => "Color",
    };
    let location = mapping(texture.texture).inverse().translation.as_vec2();
    let [factor, offset] = texture
        .affine(texture.steepness)
        .map(|by| [0, 1, 2].map(|i| by[i] * value[i]));
    let along = texture.texture.scale.recip();
    format!(
        "({}, \"{space}\", \"{channel}\", {}, {:?}, {}, {}, {})",
        python(&texture.made),
        tuple(&location.to_array()),
        texture.texture.rotation_deg,
        tuple(&[along, along / texture.texture.stretch]),
        tuple(&factor),
        tuple(&offset)
    )
}
