//! USD as text: each material with a UsdPreviewSurface for any reader of USD, and MaterialX's OpenPBR for what reads that.

#[cfg(feature = "usd")]
mod stage;

use std::{collections::HashMap, fmt::Write as _, path::Path};

use super::{
    ExchangeError, ReadOptions, Subject, Written, carried,
    materialx::{Node, OPEN_PBR, PREVIEW_SURFACE, Worth},
    report::Entry,
    shown,
    surface::Takes,
    textures::{Files, carry},
    xml::identifier,
};
use crate::document::MaterialSettings;

pub fn write(subject: &Subject, path: &Path) -> Result<Written, ExchangeError> {
    let (mut taken, mut reports, mut files) = (HashMap::new(), Vec::new(), Files::of(path));
    let mut text = "#usda 1.0\n(\n    defaultPrim = \"Materials\"\n    metersPerUnit = 1\n    upAxis = \"Y\"\n)\n\n\
                        def Scope \"Materials\"\n{\n"
        .to_owned();
    for material in &subject.materials {
        let (surface, mut report) = shown(material, &Takes::OPEN_PBR);
        let preview = "UsdPreviewSurface, beside OpenPBR";
        let detail = "without anisotropy, refraction, tints and the coat's index";
        report.entries.push(Entry::approximated(preview, detail, None));
        let has_place = |target| OPEN_PBR.takes(target);
        let textures = carry(material, &mut report, (has_place, true), |_, texture| {
            files.copy(&texture.file)
        });
        let name = identifier(&material.name, &mut taken);
        let place = format!("/Materials/{name}");
        let nodes = [(PREVIEW_SURFACE, "Preview"), (OPEN_PBR, "OpenPbr")]
            .into_iter()
            .flat_map(|(form, name)| form.nodes(&surface, name, &textures));
        let shaders: String = nodes.map(|node| shader(&node, &place)).collect();
        let (mark, exact, label) = (carried::MARK, quoted(&carried::line(material)), quoted(&surface.name));
        let _ = write!(
            text,
            "    def Material \"{name}\" (
        customData = {{
            string {mark} = {exact}
        }}
    )
    {{
        uniform string ui:displayName = {label}
        token outputs:surface.connect = <{place}/Preview.outputs:surface>
        token outputs:mtlx:surface.connect = <{place}/OpenPbr.outputs:out>

{shaders}    }}

"
        );
        reports.push(report);
    }
    text += "}\n";
    Ok(Written {
        beside: files.contents,
        ..Written::text(text, reports)
    })
}

/// Says that the program was built without.
#[cfg(not(feature = "usd"))]
pub fn read(path: &Path, _options: ReadOptions) -> Result<Subject, ExchangeError> {
    Err(ExchangeError::Unsuitable {
        path: path.to_owned(),
        reason: "this program was built without USD (the feature `usd`)".to_owned(),
    })
}

#[cfg(feature = "usd")]
pub fn read(path: &Path, options: ReadOptions) -> Result<Subject, ExchangeError> {
    let bytes = crate::store::file::read(path)?;
    let (mut subject, mut refused) = (Subject::default(), Vec::new());
    for material in materials(path, bytes, &options)? {
        match read_material(material, path, &options) {
            Ok(Some((material, losses))) => {
                subject.materials.push(material);
                subject.losses.push(losses);
            }
            Ok(None) => {}
            Err(ExchangeError::NoMaterial { reason, .. }) => refused.push(reason),
            Err(error) => return Err(error),
        }
    }
    match subject.losses.first_mut() {
        Some(losses) => losses.extend(refused.into_iter().map(|reason| Entry::dropped("a material", reason))),
        None => {
            refused.push("it has no UsdPreviewSurface and no surface of MaterialX".to_owned());
            return Err(ExchangeError::NoMaterial {
                path: path.to_owned(),
                reason: refused.swap_remove(0),
            });
        }
    }
    Ok(subject)
}

/// The exact parameters of a material, and a document of MaterialX with what that lacks.
#[cfg(feature = "usd")]
type Found = (Option<MaterialSettings>, Option<(String, Vec<Entry>)>);

#[cfg(feature = "usd")]
fn materials(path: &Path, bytes: Vec<u8>, options: &ReadOptions) -> Result<Vec<Found>, ExchangeError> {
    let found = |stage: &_| {
        let materials = stage::materials(stage).into_iter();
        let read = materials.map(|material| {
            let exact = stage::exact(&material);
            let document = stage::document(&material, exact.as_ref());
            (exact, document)
        });
        read.collect()
    };
    let found = crate::import::usd::with_stage(path, bytes, &options.loading, found);
    found.map_err(|reason| wrong(path, reason))
}

#[cfg(feature = "usd")]
fn wrong(path: &Path, reason: String) -> ExchangeError {
    ExchangeError::Contents {
        path: path.to_owned(),
        format: "USD",
        reason,
    }
}

/// What its surface shows, or the exact parameters where that is what they show or there is none.
#[cfg(feature = "usd")]
fn read_material(
    (exact, document): Found,
    path: &Path,
    options: &ReadOptions,
) -> Result<Option<(MaterialSettings, Vec<Entry>)>, ExchangeError> {
    let Some((text, lost)) = document else {
        return Ok(exact.map(|exact| (exact, Vec::new())));
    };
    let document = super::xml::parse(&text).map_err(|reason| wrong(path, reason))?;
    let mut shown = super::materialx::read_document(path, &document, lost, options.clone())?;
    Ok(shown.materials.pop().zip(shown.losses.pop()))
}

/// Text in quotation marks.
fn quoted(text: &str) -> String {
    format!(
        "\"{}\"",
        text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n")
    )
}

/// A node as a shader of the material at `place`.
fn shader(node: &Node, place: &str) -> String {
    let Node { name, kind, output, .. } = node;
    let [of, result] = [type_of(output[0]), output[1]];
    let id = match *kind {
        "UsdPrimvarReader" => "UsdPrimvarReader_float2".to_owned(),
        kind if kind.starts_with("Usd") => kind.to_owned(),
        // By what it takes.
        "extract" => format!("ND_extract_{}", node.inputs[0].1),
        "normalmap" => "ND_normalmap_float".to_owned(),
        kind => format!("ND_{kind}_{}", output[0]),
    };
    let mut text = format!("        def Shader \"{name}\"\n        {{\n            uniform token info:id = \"{id}\"\n");
    for (name, of, worth) in &node.inputs {
        let kind = type_of(of);
        let _ = match worth {
            Worth::Of(node, output) => writeln!(
                text,
                "            {kind} inputs:{name}.connect = <{place}/{node}.outputs:{output}>"
            ),
            Worth::File(file, space) => {
                let space = match *space {
                    "srgb_texture" => " (colorSpace = \"srgb_texture\")",
                    _ => "",
                };
                writeln!(text, "            {kind} inputs:{name} = @./{file}@{space}")
            }
            Worth::Value(value) => {
                let value = match kind {
                    "string" | "token" => quoted(value),
                    _ if value.contains(',') => format!("({value})"),
                    _ => value.clone(),
                };
                writeln!(text, "            {kind} inputs:{name} = {value}")
            }
        };
    }
    let _ = write!(text, "            {of} outputs:{result}\n        }}\n\n");
    text
}

/// USD's name of a type of MaterialX.
fn type_of(kind: &str) -> &str {
    match kind {
        "color3" => "color3f",
        "color4" => "color4f",
        "vector2" => "float2",
        "vector3" => "float3",
        "integer" => "int",
        "filename" => "asset",
        "surfaceshader" => "token",
        kind => kind,
    }
}
