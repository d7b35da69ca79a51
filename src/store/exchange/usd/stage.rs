//! Materials of a USD stage as documents of MaterialX, by whose tables they are read.

use std::{collections::BTreeSet, fmt::Write as _};

use crate::{
    document::MaterialSettings,
    import::usd::{
        End, end, kind,
        openusd::{
            sdf::Value,
            tf::Token,
            usd::{Attribute, Prim, PrimPredicate, Stage},
        },
        text_of,
    },
    named::joined,
    store::exchange::{carried, materialx::SurfaceKind, report::Entry, xml::escaped},
};

/// Outputs of a material that name its surface. The first that is known is read.
const SURFACES: [&str; 2] = ["outputs:surface", "outputs:mtlx:surface"];

pub fn materials(stage: &Stage) -> Vec<Prim> {
    let mut found = Vec::new();
    let walked = stage.traverse(PrimPredicate::DEFAULT_PROXIES, |path| {
        found.push(stage.prim(path.clone()))
    });
    found.retain(|prim| walked.is_ok() && kind(prim) == "Material");
    found
}

/// The exact parameters, where a material carries them.
pub fn exact(material: &Prim) -> Option<MaterialSettings> {
    let Value::Dictionary(data) = material.custom_data().ok()?? else {
        return None;
    };
    let Value::String(text) = data.get(carried::MARK)? else {
        return None;
    };
    // The crate leaves a text's backslashes where the file is text itself.
    carried::from_text(text)
        .or_else(|| carried::from_text(&serde_json::from_str::<String>(&format!("\"{text}\"")).ok()?))
}

/// The node that a shader is in MaterialX, and the type of its output.
fn node(shader: &Prim) -> (String, &'static str) {
    let id = text_of(&shader.attribute("info:id")).unwrap_or_default();
    let Some(definition) = id.strip_prefix("ND_") else {
        let kind = id.split_once("_float").map_or(&id[..], |(kind, _)| kind);
        return (kind.to_owned(), "");
    };
    let parts: Vec<&str> = definition.split('_').collect();
    let type_of = |part: &&str| TYPES.split(' ').find(|kind| part.starts_with(kind));
    let is_name = |part: &&&str| type_of(part).is_none() && part.parse::<u32>().is_err();
    let named = joined(parts.iter().take_while(is_name), "_");
    let kind = parts.iter().rev().find_map(type_of);
    (named, kind.unwrap_or_default())
}

/// Types by which names of MaterialX's definitions end.
const TYPES: &str = "float color3 color4 vector2 vector3 vector4 integer boolean string filename matrix33 matrix44 surfaceshader \
                     displacementshader volumeshader material BSDF EDF";

/// The shaders below a prim.
fn shaders_below(prim: &Prim, found: &mut Vec<Prim>) {
    for child in prim.children().unwrap_or_default() {
        shaders_below(&child, found);
        if kind(&child) == "Shader" {
            found.push(child);
        }
    }
}

/// A material as a document of MaterialX with the exact parameters, and what of it is not read; none if it has no surface.
pub fn document(material: &Prim, exact: Option<&MaterialSettings>) -> Option<(String, Vec<Entry>)> {
    let of_output = |output: &&str| match end(material.attribute(*output))? {
        End::Node(shader, _) => Some(shader),
        End::Value(_) => None,
    };
    let is_known = |shader: &Prim| SurfaceKind::named(&node(shader).0).is_some();
    let mut all: Vec<Prim> = SURFACES.iter().filter_map(of_output).collect();
    let mut below = Vec::new();
    shaders_below(material, &mut below);
    all.extend(below.into_iter().filter(is_known));
    let surface = all.iter().find(|shader| is_known(shader)).or(all.first())?;
    let other = all
        .iter()
        .find(|other| is_known(other) && other.path() != surface.path());
    let dropped = |shader: &Prim| Entry::dropped(node(shader).0, format!("the material's {} is read", node(surface).0));
    let losses = other.map(dropped).into_iter().collect();
    let (mut nodes, mut next, mut known) = (String::new(), vec![surface.clone()], BTreeSet::new());
    while let Some(shader) = next.pop() {
        if known.insert(shader.path().to_string()) {
            nodes += &element(&shader, &mut next);
        }
    }
    let name = material.path().name().unwrap_or_default();
    let label = text_of(&material.attribute("ui:displayName"));
    let (name, label) = (escaped(name), escaped(label.as_deref().unwrap_or(name)));
    let exact = exact.map(|exact| format!(" {}=\"{}\"", carried::MARK, escaped(&carried::line(exact))));
    let exact = exact.unwrap_or_default();
    let text = format!(
        "<materialx version=\"1.39\" colorspace=\"lin_rec709\">{nodes}<surfacematerial name=\"{name}\" type=\"material\" \
         uiname=\"{label}\"{exact}><input name=\"surfaceshader\" type=\"surfaceshader\" nodename=\"{}\"/></surfacematerial></materialx>",
        escaped(surface.path().as_str())
    );
    Some((text, losses))
}

/// A shader as a node, with those that it is connected to added to `next`.
fn element(shader: &Prim, next: &mut Vec<Prim>) -> String {
    let (node, kind) = node(shader);
    let is_name = node.starts_with(|c: char| c.is_ascii_alphabetic())
        && node.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let node = if is_name { &node } else { "unknown" };
    let kind = match SurfaceKind::named(node) {
        Some(_) => "surfaceshader",
        None => kind,
    };
    let mut text = format!("<{node} name=\"{}\" type=\"{kind}\">", escaped(shader.path().as_str()));
    for property in shader.property_names().unwrap_or_default() {
        let Some(name) = property.strip_prefix("inputs:") else {
            continue;
        };
        let worth = match end(shader.attribute(property.clone())) {
            Some(End::Node(source, output)) => {
                let path = escaped(source.path().as_str());
                next.push(source);
                format!("nodename=\"{path}\" output=\"{}\"", escaped(&output))
            }
            Some(End::Value(attribute)) => match value(&attribute) {
                Some(value) => value,
                None => continue,
            },
            None => "nodename=\"\"".to_owned(),
        };
        let _ = write!(text, "<input name=\"{}\" {worth}/>", escaped(name));
    }
    if node == "UsdUVTexture" && !text.contains("<input name=\"sourceColorSpace\"") {
        text += "<input name=\"sourceColorSpace\" value=\"auto\"/>";
    }
    format!("{text}</{node}>")
}

/// A value as the attributes of an input.
fn value(attribute: &Attribute) -> Option<String> {
    let numbers = |value: Value| match value {
        Value::Bool(x) => Some(x.to_string()),
        Value::Vec2f(v) => Some(format!("{}, {}", v.x, v.y)),
        value => {
            let number = || value.clone().cast::<f64>().map(|x| vec![x]);
            let four = || value.clone().cast::<[f64; 4]>().map(Vec::from);
            let three = value.clone().cast::<[f64; 3]>().map(Vec::from);
            let found = three.or_else(|_| four()).or_else(|_| number()).ok()?;
            Some(joined(found.into_iter().map(|x| x as f32), ", "))
        }
    };
    let plain = text_of(attribute).or_else(|| numbers(attribute.get::<Value>().ok()??))?;
    let kind = attribute.type_name().ok().flatten().unwrap_or_default();
    let kind = kind.trim_end_matches(['f', 'h', 'd']);
    let kind = if kind.starts_with("color") { kind } else { "" };
    let space = attribute.get_metadata::<Token>("colorSpace").ok().flatten();
    let space = space.map_or_else(String::new, |space| format!(" colorspace=\"{}\"", escaped(&space)));
    Some(format!("type=\"{kind}\" value=\"{}\"{space}", escaped(&plain)))
}
