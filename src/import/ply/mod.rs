//! PLY files, of text or bytes in either order, by the ply-rs crate: places, normals, colours, texture coordinates, and
//! faces of any number of corners.

use std::io::{BufRead, BufReader};
use std::path::Path;

use glam::{DVec3, Vec2, Vec3, Vec4};
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{Encoding, Header, Property, PropertyAccess, PropertyAccessResult};

use crate::model_error::ModelError;
use crate::optics::tone::linear_from_srgb;
use crate::optics::vector::vec3;
use crate::scene::mesh::Mesh;
use crate::scene::report::{Fate, ImportReport};
use crate::scene::{Loading, Model, Slot};

#[derive(Clone, Copy)]
struct Vertex {
    position: [f64; 3],
    normal: Option<[f32; 3]>,
    uv: Option<[f32; 2]>,
    /// sRGB codes in [0, 1], and opacity.
    color: Option<[f32; 4]>,
}

/// Stores one of several numbers that arrive one by one.
fn put<const N: usize>(values: &mut Option<[f32; N]>, place: usize, value: f32, others: f32) {
    values.get_or_insert([others; N])[place] = value;
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self {
            position: [0.0; 3],
            normal: None,
            uv: None,
            color: None,
        }
    }

    fn set_property(&mut self, key: &str, property: Property) -> PropertyAccessResult {
        let Some(value) = property.to_f32_lossy() else {
            return PropertyAccessResult::Ignored;
        };
        let code = match property {
            Property::UChar(code) => f32::from(code) / 255.0,
            Property::UShort(code) => f32::from(code) / 65535.0,
            _ => value,
        };
        let exact = if let Property::Double(exact) = property {
            exact
        } else {
            f64::from(value)
        };
        match key {
            "x" => self.position[0] = exact,
            "y" => self.position[1] = exact,
            "z" => self.position[2] = exact,
            "nx" => put(&mut self.normal, 0, value, 0.0),
            "ny" => put(&mut self.normal, 1, value, 0.0),
            "nz" => put(&mut self.normal, 2, value, 0.0),
            "u" | "s" | "texture_u" => put(&mut self.uv, 0, value, 0.0),
            "v" | "t" | "texture_v" => put(&mut self.uv, 1, value, 0.0),
            "red" | "diffuse_red" | "r" => put(&mut self.color, 0, code, 1.0),
            "green" | "diffuse_green" | "g" => put(&mut self.color, 1, code, 1.0),
            "blue" | "diffuse_blue" | "b" => put(&mut self.color, 2, code, 1.0),
            "alpha" => put(&mut self.color, 3, code, 1.0),
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

struct Face(Vec<u32>);

impl PropertyAccess for Face {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn set_property(&mut self, key: &str, property: Property) -> PropertyAccessResult {
        match (key, property.to_u32_list()) {
            ("vertex_indices" | "vertex_index", Some(corners)) => self.0 = corners,
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

/// Data that is read and ignored.
struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}

/// Loads the contents of a PLY file.
pub(super) fn load(path: &Path, bytes: &[u8], loading: &Loading) -> Result<Model, ModelError> {
    let invalid = |reason: String| ModelError::invalid(path, reason.replace('\n', " "));
    let read_header = |reader: &mut Reader<_>| {
        let read = Parser::<Vertex>::new().read_header(reader);
        read.map_err(|error| invalid(error.to_string()))
    };
    let mut report = ImportReport::default();
    let mut reader = Reader::new(BufReader::new(loading.watched(bytes)));
    let header = read_header(&mut reader)?;
    let mut read = elements(&mut reader, &header, &mut report);
    loading.check()?;
    if read.is_err() && header.encoding == Encoding::Ascii {
        report = ImportReport::default();
        let text = with_plain_numbers(bytes);
        let mut reader = Reader::new(BufReader::new(loading.watched(text.as_bytes())));
        read_header(&mut reader)?;
        read = elements(&mut reader, &header, &mut report);
        loading.check()?;
    }
    let (vertices, faces) = read.map_err(invalid)?;
    let mut slot = Slot::clay();
    loading.step("normals and tangents")?;
    let mesh = assemble(&vertices, &faces, &mut report, loading);
    if !mesh.colors.is_empty() {
        slot.color_by_vertices();
        report.note(Fate::Used, "vertex colours", "");
    }
    report.note(Fate::Used, "meshes", "");
    Ok(Model {
        mesh,
        slots: vec![slot],
        report,
        ..Model::default()
    })
}

/// A text file with its numbers as the crate reads them, which knows neither `1.` nor `.5` nor `nan`.
fn with_plain_numbers(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes);
    let (header, body) = text.split_once("end_header").unwrap_or_default();
    let plain = |word: &str| match word.parse::<f64>() {
        Ok(number) if !number.is_finite() => "1e999".to_owned(),
        Ok(number) if word.parse::<i64>().is_err() => format!("{number:e}"),
        _ => word.to_owned(),
    };
    let lines = body.lines();
    let lines = lines.map(|line| line.split_whitespace().map(plain).collect::<Vec<_>>().join(" "));
    format!("{header}end_header{}\n", lines.collect::<Vec<_>>().join("\n"))
}

/// Vertices and faces of a file after its header, or how it breaks the format.
fn elements<R: BufRead>(
    reader: &mut Reader<R>,
    header: &Header,
    report: &mut ImportReport,
) -> Result<(Vec<Vertex>, Vec<Face>), String> {
    let (vertex, face, skipped) = (Parser::<Vertex>::new(), Parser::<Face>::new(), Parser::<Skipped>::new());
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for element in header.elements.values() {
        if element.properties.is_empty() && header.encoding != Encoding::Ascii {
            // Empty elements take no bytes, so that only their count would end the reading.
            let what = format!("elements called {}, which are empty", element.name);
            report.count(Fate::Ignored, what, "", element.count);
            continue;
        }
        let read = match element.name.as_str() {
            "vertex" => vertex
                .read_payload_for_element(reader, element, header)
                .map(|read| vertices = read),
            "face" => face
                .read_payload_for_element(reader, element, header)
                .map(|read| faces = read),
            name => {
                report.count(Fate::Ignored, format!("elements called {name}"), "", element.count);
                skipped.read_payload_for_element(reader, element, header).map(drop)
            }
        };
        read.map_err(|error| error.to_string())?;
    }
    Ok((vertices, faces))
}

/// Triangles of vertices and faces.
fn assemble(vertices: &[Vertex], faces: &[Face], report: &mut ImportReport, loading: &Loading) -> Mesh {
    let is_there = |face: &&Face| face.0.iter().all(|&corner| (corner as usize) < vertices.len());
    let usable: Vec<&Face> = faces.iter().filter(is_there).collect();
    report.count(
        Fate::Ignored,
        "faces whose vertices are not there",
        "",
        faces.len() - usable.len(),
    );
    // A fan: right for convex faces, which nearly all are.
    let fan = |face: &&Face| {
        let corners = &face.0;
        (2..corners.len())
            .map(|last| [corners[0], corners[last - 1], corners[last]])
            .collect::<Vec<_>>()
    };
    let triangles: Vec<[u32; 3]> = usable.iter().flat_map(fan).collect();
    let has_normals = vertices.iter().all(|vertex| vertex.normal.is_some());
    let mut mesh = Mesh {
        positions: vertices
            .iter()
            .map(|vertex| DVec3::from_array(vertex.position))
            .collect(),
        normals: vertices
            .iter()
            .map(|vertex| Vec3::from_array(vertex.normal.unwrap_or_default()))
            .collect(),
        uvs: vertices
            .iter()
            .map(|vertex| vertex.uv.map_or(Vec2::ZERO, |[u, v]| Vec2::new(u, 1.0 - v)))
            .collect(),
        tangents: vec![Vec4::W; vertices.len()],
        slots: vec![0; triangles.len()],
        triangles,
        ..Mesh::default()
    };
    if vertices.iter().any(|vertex| vertex.color.is_some()) {
        mesh.colors = vertices
            .iter()
            .map(|vertex| linear_color(vertex.color.unwrap_or([1.0; 4])))
            .collect();
    }
    if !has_normals {
        mesh.smooth_normals(loading);
    }
    mesh.repair_normals();
    mesh.make_tangents([1.0, 0.0, 0.0, 0.0, 1.0, 0.0], false, loading);
    mesh
}

fn linear_color([r, g, b, a]: [f32; 4]) -> [f32; 4] {
    let [r, g, b] = linear_from_srgb(vec3(r, g, b)).to_f64().map(|x| x as f32);
    [r, g, b, a]
}
