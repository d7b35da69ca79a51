//! USD as text: each material with a UsdPreviewSurface for any reader of USD, and MaterialX's OpenPBR for what reads that.

#[cfg(feature = "usd")]
mod stage;

use std::{collections::HashMap, fmt::Write as _, path::Path};

use super::{
    ExchangeError, ReadOptions, Subject, Written, carried,
    materialx::{self, OPEN_PBR, as_open_pbr, written},
    report::Entry,
    shown,
    surface::{Surface, Takes},
    xml::{self, identifier, numbers},
};
use crate::{document::MaterialSettings, import::FileParameter};

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
type Found = (Option<MaterialSettings>, Option<(String, Vec<Entry>)>);

#[cfg(feature = "usd")]
fn materials(path: &Path, bytes: Vec<u8>, options: &ReadOptions) -> Result<Vec<Found>, ExchangeError> {
    let found = |stage: &_| {
        let materials = stage::materials(stage).into_iter();
        let read = materials.map(|material| (stage::exact(&material), stage::document(&material)));
        read.collect()
    };
    let found = crate::import::usd::with_stage(path, bytes, &options.loading, found);
    found.map_err(|reason| wrong(path, reason))
}

fn wrong(path: &Path, reason: String) -> ExchangeError {
    ExchangeError::Contents {
        path: path.to_owned(),
        format: "USD",
        reason,
    }
}

/// The exact parameters where they are there and show what the surface shows; else what that shows.
#[cfg(feature = "usd")]
fn read_material(
    (exact, document): Found,
    path: &Path,
    options: &ReadOptions,
) -> Result<Option<(MaterialSettings, Vec<Entry>)>, ExchangeError> {
    let Some((text, mut losses)) = document else {
        return Ok(exact.map(|exact| (exact, Vec::new())));
    };
    let exact = exact.filter(|_| !options.is_plain);
    let document = xml::parse(&text).map_err(|reason| wrong(path, reason))?;
    let plain = ReadOptions {
        is_plain: true,
        ..options.clone()
    };
    let mut shown = materialx::read_document(path, &document, plain.clone())?;
    losses.extend(shown.losses.pop().unwrap_or_default());
    let Some(shown) = shown.materials.pop() else {
        return Ok(None);
    };
    if let Some(exact) = exact {
        let written = write(&Subject::of(exact.clone()), path)?;
        let ours = materials(path, written.bytes, &plain)?.into_iter().next();
        let ours = ours.and_then(|ours| read_material(ours, path, &plain).ok()?);
        if ours.is_some_and(|(ours, _)| materialx::is_near(&ours, &shown)) {
            return Ok(Some((exact, Vec::new())));
        }
        let why = "the file was changed since it was exported";
        losses.insert(0, Entry::dropped("the exact parameters", why));
    }
    Ok(Some((shown, losses)))
}

/// Text in quotation marks.
fn quoted(text: &str) -> String {
    format!(
        "\"{}\"",
        text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n")
    )
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
