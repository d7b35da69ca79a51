//! MaterialX 1.39: surfaces of OpenPBR, or Autodesk's Standard Surface.

mod artistic;
mod graph;
mod images;
mod include;
mod inputs;
mod read;
mod spaces;
mod surfaces;
mod table;
mod textures;
mod units;

use std::{collections::HashMap, path::Path};

pub use self::surfaces::{SURFACES, SurfaceKind};
pub(super) use self::{
    read::{is_near, read, read_document},
    surfaces::{as_open_pbr, written},
    table::OPEN_PBR,
};

use self::{read::normal_target, read::target_of, surfaces::as_standard_surface, textures::Files, textures::Nodes};
use super::{
    ExchangeError, Subject, Written, carried, shown,
    surface::{Surface, Takes},
    xml::{HEAD, element, escaped, identifier, numbers},
};
use crate::import::FileParameter;

/// The attribute of a material that has the exact parameters.
pub(super) const CARRIER: &str = carried::MARK;
const STANDARD: Takes = Takes {
    widths: standard_widths,
    lacks: [
        Takes::OPEN_PBR.lacks[0],
        "fuzz.weight thin_film.weight coat.on_base coat.darkening specular.weight_in_index specular.on_metal",
    ],
    ..Takes::OPEN_PBR
};

/// A document with Standard Surface in OpenPBR's place where `is_standard`.
pub fn write(subject: &Subject, path: &Path, is_standard: bool) -> Result<Written, ExchangeError> {
    let (mut taken, mut reports, mut text) = (HashMap::new(), Vec::new(), String::new());
    let mut files = Files::of(path);
    for material in &subject.materials {
        let takes = if is_standard { STANDARD } else { Takes::OPEN_PBR };
        let (surface, mut report) = shown(material, &takes);
        let name = identifier(&material.name, &mut taken);
        let shader = identifier(&format!("{name}_surface"), &mut taken);
        let rows = if is_standard {
            table::STANDARD_SURFACE
        } else {
            table::OPEN_PBR
        };
        let nodes = Nodes::of(material, (&shader, rows), &mut files, &mut report);
        text += &surface_node(&surface, &shader, is_standard, nodes);
        text += &element(
            &format!(
                "surfacematerial name=\"{name}\" type=\"material\" uiname=\"{}\" {CARRIER}=\"{}\"",
                escaped(&material.name),
                escaped(&carried::line(material))
            ),
            &format!("<input name=\"surfaceshader\" type=\"surfaceshader\" nodename=\"{shader}\" />"),
        );
        reports.push(report);
    }
    let root = element("materialx version=\"1.39\" colorspace=\"lin_rec709\"", &text);
    Ok(Written {
        beside: files.contents,
        ..Written::text(format!("{HEAD}{root}"), reports)
    })
}

fn surface_node(surface: &Surface, name: &str, is_standard: bool, mut nodes: Nodes) -> String {
    let (kind, rows, shown) = if is_standard {
        (
            "standard_surface",
            table::STANDARD_SURFACE,
            as_standard_surface(surface),
        )
    } else {
        ("open_pbr_surface", table::OPEN_PBR, as_open_pbr(surface))
    };
    let input = |(row, value): (&FileParameter, [f32; 3])| {
        let (kind, value) = if row.is_list() {
            ("color3", numbers(&value))
        } else {
            ("float", value[0].to_string())
        };
        let connection = nodes.connection(target_of(row), kind, &value);
        let worth = connection.unwrap_or_else(|| format!("value=\"{value}\""));
        format!("<input name=\"{}\" type=\"{kind}\" {worth} />\n", row.place)
    };
    // The sheen of Standard Surface is another one.
    let has_place = |(row, _): &(&FileParameter, [f32; 3])| !row.place.starts_with("sheen");
    let mut inputs: String = written(rows, &shown).filter(has_place).map(input).collect();
    for row in rows {
        if let Some(normal) = normal_target(row.place).and_then(|target| nodes.normal(target)) {
            inputs += &format!(
                "<input name=\"{}\" type=\"vector3\" nodename=\"{normal}\" />\n",
                row.place
            );
        }
    }
    let (_, rotation_deg) = surface.ratio_and_rotation();
    let mut graph = nodes.text;
    if !is_standard && surface.anisotropy != 0.0 && rotation_deg != 0.0 {
        inputs += &format!(
            "<input name=\"geometry_tangent\" type=\"vector3\" nodegraph=\"{name}_tangent\" output=\"out\" />\n"
        );
        let turned = TURNED_TANGENT.replace("TURN", &rotation_deg.to_string());
        graph += &element(&format!("nodegraph name=\"{name}_tangent\""), &turned);
    }
    let surface = element(&format!("{kind} name=\"{name}\" type=\"surfaceshader\""), &inputs);
    surface + &graph
}
/// The tangent turned about the normal, where the highlight is stretched in another direction.
const TURNED_TANGENT: &str = r#"<tangent name="along" type="vector3">
  <input name="space" type="string" value="world" />
</tangent>
<normal name="normal" type="vector3">
  <input name="space" type="string" value="world" />
</normal>
<rotate3d name="turned" type="vector3">
  <input name="in" type="vector3" nodename="along" />
  <input name="amount" type="float" value="TURN" />
  <input name="axis" type="vector3" nodename="normal" />
</rotate3d>
<output name="out" type="vector3" nodename="turned" />"#;

/// The widths of Standard Surface: none is wider than 1.
fn standard_widths(surface: &Surface) -> [f32; 2] {
    surface.widths().map(|alpha| alpha.min(1.0))
}
