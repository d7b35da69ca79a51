//! USD as text: each material with a UsdPreviewSurface for any reader of USD, and MaterialX's OpenPBR for what reads that.

mod read;

use std::collections::HashMap;
use std::fmt::Write as _;
use std::path::Path;

use super::materialx::{OPEN_PBR, as_open_pbr, written};
use super::report::Entry;
use super::surface::{Surface, Takes};
use super::xml::{identifier, numbers};
use super::{ExchangeError, ReadOptions, Subject, Written, carried, shown};
use crate::document::MaterialSettings;
use crate::import::FileParameter;

pub fn write(subject: &Subject, _path: &Path) -> Result<Written, ExchangeError> {
    let (mut taken, mut reports) = (HashMap::new(), Vec::new());
    let mut text = "#usda 1.0\n(\n    defaultPrim = \"Materials\"\n    metersPerUnit = 1\n    upAxis = \"Y\"\n)\n\n\
                        def Scope \"Materials\"\n{\n"
        .to_owned();
    for material in &subject.materials {
        let (surface, mut report) = shown(material, &Takes::OPEN_PBR);
        report.entries.splice(0..0, surface.rotation_loss());
        let preview = "UsdPreviewSurface, beside OpenPBR";
        let detail = "without anisotropy, refraction, tints and the coat's index";
        report.entries.push(Entry::approximated(preview, detail, None));
        let name = identifier(&material.name, &mut taken);
        text += &prim(&surface, &name, &carried::line(material));
        reports.push(report);
    }
    text += "}\n";
    Ok(Written::text(text, reports))
}

pub fn read(path: &Path, options: ReadOptions) -> Result<Subject, ExchangeError> {
    let bytes = crate::store::file::read(path)?;
    let shown_by = |material: &MaterialSettings| {
        let inputs = preview(&Surface::of(material).0).into_iter();
        let name = |typed: &str| typed.split_once(' ').map_or(typed, |(_, name)| name).to_owned();
        inputs.map(|(typed, value)| (name(typed), value)).collect()
    };
    let found = read::materials(&String::from_utf8_lossy(&bytes)).into_iter();
    let (materials, losses): (Vec<_>, _) = found
        .filter_map(|read| read.material(options.lobe, options.is_plain, shown_by))
        .unzip();
    if materials.is_empty() {
        return Err(ExchangeError::NoMaterial {
            path: path.to_owned(),
            reason: "it has no UsdPreviewSurface".to_owned(),
        });
    }
    Ok(Subject {
        materials,
        losses,
        ..Subject::default()
    })
}

/// Text in quotation marks.
fn quoted(text: &str) -> String {
    format!(
        "\"{}\"",
        text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n")
    )
}

/// The text that begins here, in whichever of USD's quotation marks.
fn unquoted(text: &str) -> Option<String> {
    let marks = ["\"\"\"", "'''", "\"", "'"];
    let mark = marks.into_iter().find(|mark| text.starts_with(mark))?;
    let mut rest = &text[mark.len()..];
    let mut inner = String::new();
    while !rest.starts_with(mark) {
        let mut letters = rest.chars();
        match letters.next()? {
            '\\' => inner.push(match letters.next()? {
                'n' => '\n',
                't' => '\t',
                other => other,
            }),
            letter => inner.push(letter),
        }
        rest = letters.as_str();
    }
    Some(inner)
}

fn prim(surface: &Surface, name: &str, exact: &str) -> String {
    let (mark, exact, label) = (carried::MARK, quoted(exact), quoted(&surface.name));
    let preview = shader(
        "Preview",
        "UsdPreviewSurface",
        "token outputs:surface",
        &preview(surface),
    );
    let id = "ND_open_pbr_surface_surfaceshader";
    let open_pbr = shader("OpenPbr", id, "token outputs:out", &open_pbr(surface));
    format!(
        "    def Material \"{name}\" (
        customData = {{
            string {mark} = {exact}
        }}
    )
    {{
        uniform string ui:displayName = {label}
        token outputs:surface.connect = </Materials/{name}/Preview.outputs:surface>
        token outputs:mtlx:surface.connect = </Materials/{name}/OpenPbr.outputs:out>

{preview}{open_pbr}    }}

"
    )
}

fn shader(name: &str, id: &str, output: &str, inputs: &[(impl AsRef<str>, String)]) -> String {
    let mut text = format!("        def Shader \"{name}\"\n        {{\n            uniform token info:id = \"{id}\"\n");
    for (input, value) in inputs {
        let (kind, input) = input.as_ref().split_once(' ').unwrap_or(("float", input.as_ref()));
        let _ = writeln!(text, "            {kind} inputs:{input} = {value}");
    }
    let _ = write!(text, "            {output}\n        }}\n\n");
    text
}

fn color(value: [f32; 3]) -> String {
    format!("({})", numbers(&value))
}

fn preview(surface: &Surface) -> Vec<(&'static str, String)> {
    // Refraction is thin there: what opacity does not stop is seen behind.
    let opacity = surface.opacity * (1.0 - surface.transmission_weight * (1.0 - surface.metalness));
    vec![
        ("color3f diffuseColor", color(surface.base_color)),
        ("color3f emissiveColor", color(surface.emission())),
        ("int useSpecularWorkflow", "0".to_owned()),
        ("float metallic", surface.metalness.to_string()),
        ("float roughness", surface.roughness.to_string()),
        ("float clearcoat", surface.coat_weight.to_string()),
        ("float clearcoatRoughness", surface.coat_roughness.to_string()),
        ("float opacity", opacity.to_string()),
        ("float ior", surface.ior.to_string()),
    ]
}

fn open_pbr(surface: &Surface) -> Vec<(String, String)> {
    let typed = |(row, value): (&FileParameter, [f32; 3])| {
        if row.is_list() {
            (format!("color3f {}", row.place), color(value))
        } else {
            (format!("float {}", row.place), value[0].to_string())
        }
    };
    written(OPEN_PBR, &as_open_pbr(surface)).map(typed).collect()
}
