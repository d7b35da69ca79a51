//! MaterialX 1.39: surfaces of OpenPBR, or Autodesk's Standard Surface.

mod artistic;
mod bake;
mod graph;
mod images;
mod include;
mod inputs;
mod read;
mod strict;
mod surfaces;
mod table;

use std::collections::HashMap;
use std::path::Path;

pub(super) use self::inputs::Inputs;
pub use self::surfaces::{SURFACES, SurfaceKind};

use self::artistic::edge_color;
use super::carried;
use super::open_pbr::{Value, inputs};
use super::surface::{Surface, Takes};
use super::xml::{Element, identifier, numbers};
use super::{ExchangeError, Format, ReadOptions, Subject, Written, shown};

/// Documents of MaterialX.
pub struct MaterialX {
    /// Standard Surface in OpenPBR's place.
    pub is_standard: bool,
}

/// The attribute of a material that has the exact parameters.
pub(super) const CARRIER: &str = carried::MARK;
const STANDARD: Takes = Takes {
    widths: standard_widths,
    lacks: [
        Takes::OPEN_PBR.lacks[0],
        &[
            "fuzz.weight",
            "thin_film.weight",
            "coat.on_base",
            "coat.darkening",
            "specular.weight_in_index",
            "specular.on_metal",
        ],
    ],
    ..Takes::OPEN_PBR
};

impl Format for MaterialX {
    fn write(&self, subject: &Subject, _path: &Path) -> Result<Written, ExchangeError> {
        let mut root = Element::new("materialx")
            .with("version", "1.39")
            .with("colorspace", "lin_rec709");
        let (mut taken, mut reports) = (HashMap::new(), Vec::new());
        for material in &subject.materials {
            let takes = if self.is_standard { STANDARD } else { Takes::OPEN_PBR };
            let (surface, report) = shown(material, &takes);
            let name = identifier(&material.name, &mut taken);
            let shader = identifier(&format!("{name}_surface"), &mut taken);
            if self.is_standard {
                root.push(standard_surface(&surface, &shader));
            } else {
                let turned = turned_tangent(&surface, &shader);
                root.push(open_pbr(&surface, &shader, turned.is_some()));
                turned.into_iter().for_each(|graph| root.push(graph));
            }
            let place = Element::new("input")
                .with("name", "surfaceshader")
                .with("type", "surfaceshader")
                .with("nodename", shader);
            root.push(
                Element::new("surfacematerial")
                    .with("name", name)
                    .with("type", "material")
                    .with("uiname", material.name.clone())
                    .with(CARRIER, carried::line(material))
                    .child(place),
            );
            reports.push(report);
        }
        Ok(Written::text(root.document(None), reports))
    }

    fn read(&self, path: &Path, options: ReadOptions) -> Result<Subject, ExchangeError> {
        read::read(path, options)
    }
}

fn input(name: &'static str, kind: &'static str, value: String) -> Element {
    Element::new("input")
        .with("name", name)
        .with("type", kind)
        .with("value", value)
}

pub(super) fn number(name: &'static str, value: f32) -> Element {
    input(name, "float", value.to_string())
}

pub(super) fn color(name: &'static str, value: [f32; 3]) -> Element {
    input(name, "color3", numbers(&value))
}

fn node(kind: &'static str, name: &str) -> Element {
    Element::new(kind).with("name", name).with("type", "surfaceshader")
}

/// The widths of Standard Surface: none is wider than 1.
fn standard_widths(surface: &Surface) -> [f32; 2] {
    surface.widths().map(|alpha| alpha.min(1.0))
}

fn open_pbr(surface: &Surface, name: &str, is_turned: bool) -> Element {
    let mut node = node("open_pbr_surface", name);
    for (name, value) in inputs(surface) {
        node.push(match value {
            Value::Number(x) => number(name, x),
            Value::Color(value) => color(name, value),
        });
    }
    if is_turned {
        node.push(
            Element::new("input")
                .with("name", "geometry_tangent")
                .with("type", "vector3")
                .with("nodegraph", format!("{name}_tangent"))
                .with("output", "out"),
        );
    }
    node
}

/// The tangent turned about the normal, where the highlight is stretched in another direction.
fn turned_tangent(surface: &Surface, name: &str) -> Option<Element> {
    let (_, rotation_deg) = surface.ratio_and_rotation();
    if surface.anisotropy == 0.0 || rotation_deg == 0.0 {
        return None;
    }
    let vector = |kind: &'static str, name: &str| Element::new(kind).with("name", name).with("type", "vector3");
    let world = || input("space", "string", "world".to_owned());
    let from = |name: &'static str, node: &'static str| {
        Element::new("input")
            .with("name", name)
            .with("type", "vector3")
            .with("nodename", node)
    };
    let turn = vector("rotate3d", "turned")
        .child(from("in", "along"))
        .child(number("amount", rotation_deg))
        .child(from("axis", "normal"));
    let output = Element::new("output")
        .with("name", "out")
        .with("type", "vector3")
        .with("nodename", "turned");
    Some(
        Element::new("nodegraph")
            .with("name", format!("{name}_tangent"))
            .child(vector("tangent", "along").child(world()))
            .child(vector("normal", "normal").child(world()))
            .child(turn)
            .child(output),
    )
}

fn standard_surface(surface: &Surface, name: &str) -> Element {
    let (ratio, rotation_deg) = surface.ratio_and_rotation();
    let (strength, emission) = surface.strength_and_color();
    // The format has a film wherever that has a thickness.
    let film_thickness_nm = match surface.film_weight > 0.0 {
        true => 1e3 * surface.film_thickness,
        false => 0.0,
    };
    node("standard_surface", name)
        .child(number("base", 1.0))
        .child(color("base_color", surface.base_color))
        .child(number("diffuse_roughness", surface.diffuse_roughness))
        .child(number("metalness", surface.metalness))
        .child(number("specular", surface.specular_weight))
        .child(color(
            "specular_color",
            if surface.metalness > 0.5 {
                edge_color(surface.base_color, surface.edge_tint)
            } else {
                surface.tint()
            },
        ))
        .child(number("specular_roughness", surface.roughness))
        .child(number("specular_IOR", surface.ior))
        .child(number("specular_anisotropy", 1.0 - ratio))
        .child(number("specular_rotation", (rotation_deg / 360.0).rem_euclid(1.0)))
        .child(number("transmission", surface.transmission_weight))
        .child(color("transmission_color", surface.transmission_color))
        .child(number("transmission_depth", surface.transmission_depth))
        .child(number("coat", surface.coat_weight))
        .child(color("coat_color", surface.coat_color))
        .child(number("coat_roughness", surface.coat_roughness))
        .child(number("coat_IOR", surface.coat_ior))
        .child(number("coat_anisotropy", 1.0 - surface.coat_ratio()))
        .child(number("thin_film_thickness", film_thickness_nm))
        .child(number("thin_film_IOR", surface.film_ior))
        .child(number("emission", strength))
        .child(color("emission_color", emission))
        .child(color("opacity", [surface.opacity; 3]))
}
