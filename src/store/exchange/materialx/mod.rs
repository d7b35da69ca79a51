//! MaterialX 1.39: surfaces of OpenPBR, or Autodesk's Standard Surface.

mod artistic;
mod graph;
mod images;
mod include;
mod inputs;
mod network;
mod read;
mod spaces;
mod surfaces;
mod table;
mod units;

use std::{collections::HashMap, path::Path};

pub use self::surfaces::{SURFACES, SurfaceKind};
pub use self::{
    network::{Node, OPEN_PBR, PREVIEW_SURFACE, Worth},
    read::{read, read_document},
};

use self::network::STANDARD_SURFACE;
use super::{
    ExchangeError, Subject, Written, carried, shown,
    surface::{Surface, Takes},
    textures::{Files, carry},
    xml::{HEAD, element, escaped, identifier},
};

/// The attribute of a material that has the exact parameters.
pub const CARRIER: &str = carried::MARK;
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
    let (form, takes) = if is_standard {
        (STANDARD_SURFACE, STANDARD)
    } else {
        (OPEN_PBR, Takes::OPEN_PBR)
    };
    for material in &subject.materials {
        let (surface, mut report) = shown(material, &takes);
        let name = identifier(&material.name, &mut taken);
        let shader = identifier(&format!("{name}_surface"), &mut taken);
        let has_place = |target| form.takes(target);
        let textures = carry(material, &mut report, (has_place, true), |_, texture| {
            files.copy(&texture.file)
        });
        text.extend(form.nodes(&surface, &shader, &textures).iter().map(Node::element));
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

/// The widths of Standard Surface: none is wider than 1.
fn standard_widths(surface: &Surface) -> [f32; 2] {
    surface.widths().map(|alpha| alpha.min(1.0))
}
