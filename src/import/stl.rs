//! STL files, text or binary. They contain only triangles.
//!
//! The reader is our own: the crate stl_io takes a text for binary without a space after `solid`, and ends at the first solid.

use std::path::Path;

use glam::{DVec3, Vec2, Vec3, Vec4};

use crate::{
    files::text_or_latin_1,
    model_error::ModelError,
    polygon::Polygons,
    scene::{Loading, Model, Slot, mesh::Mesh, report::Fate, report::ImportReport},
};

/// Bytes before the triangles of a binary file, and of each: a normal, three corners, two bytes that some programs colour by.
const HEADER: usize = 84;
const TRIANGLE: usize = 50;
/// Lines between two looks at whether the import is cancelled.
const LINES: usize = 1 << 14;

/// Loads the contents of an STL file. Its Z is upwards, as in most programs that write them: it is turned to our +Y.
pub fn load(path: &Path, bytes: &[u8], loading: &Loading) -> Result<Model, ModelError> {
    let mut report = ImportReport::default();
    let read = if is_text(bytes) {
        of_text(&text_or_latin_1(bytes), loading, &mut report)?
    } else {
        of_bytes(bytes, &mut report)
    };
    loading.step("tangents")?;
    match read.breach {
        Some(breach) if read.corners.is_empty() => return Err(ModelError::invalid(path, breach)),
        // The data before the damage is shown.
        Some(breach) => {
            let what = format!("what follows a breach of the format ({breach})");
            report.note(Fate::Missing, what, "");
        }
        None => {}
    }
    let positions: Vec<DVec3> = read.corners.iter().map(|[x, y, z]| DVec3::new(*x, *z, -y)).collect();
    let count = positions.len() as u32;
    let mut mesh = Mesh {
        normals: vec![Vec3::ZERO; positions.len()],
        uvs: vec![Vec2::ZERO; positions.len()],
        tangents: vec![Vec4::W; positions.len()],
        slots: vec![0; positions.len() / 3],
        triangles: (0..count / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        positions,
        ..Mesh::default()
    };
    mesh.make_tangents([1.0, 0.0, 0.0, 0.0, 1.0, 0.0], false, loading);
    report.note(Fate::Used, "meshes", "");
    Ok(Model {
        mesh,
        slots: vec![Slot::clay()],
        report,
        ..Model::default()
    })
}

/// Corners of triangles, and where the format is broken.
#[derive(Default)]
struct Triangles {
    corners: Vec<[f64; 3]>,
    breach: Option<String>,
}

/// Triangles that a binary file says to have.
fn said(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER - 4..HEADER)?;
    Some(u32::from_le_bytes(count.try_into().ok()?) as usize)
}

/// Whether the file is text. Many binary files begin with `solid` too.
fn is_text(bytes: &[u8]) -> bool {
    if said(bytes).is_some_and(|count| HEADER + TRIANGLE * count == bytes.len()) {
        return false;
    }
    let head = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let begins = |word: &[u8]| {
        head.get(..word.len())
            .is_some_and(|first| first.eq_ignore_ascii_case(word))
    };
    (begins(b"solid") || begins(b"facet")) && !head[..head.len().min(1024)].contains(&0)
}

/// All solids of a text, whose loops may have more than three corners.
fn of_text(text: &str, loading: &Loading, report: &mut ImportReport) -> Result<Triangles, ModelError> {
    let (mut read, mut polygons) = (Triangles::default(), Polygons::new());
    let mut corners: Vec<DVec3> = Vec::new();
    for (number, line) in text.split(['\n', '\r']).enumerate() {
        if number % LINES == 0 {
            loading.check()?;
        }
        let mut words = line.split_whitespace();
        let word = words.next().unwrap_or_default();
        if word.eq_ignore_ascii_case("vertex") {
            let numbers: Vec<f64> = words.map_while(|word| word.parse().ok()).collect();
            let Some(place) = numbers.first_chunk() else {
                read.breach = Some(format!("\"{line}\" is no corner"));
                return Ok(read);
            };
            corners.push(DVec3::from_array(*place));
        } else if word.eq_ignore_ascii_case("endloop") || word.eq_ignore_ascii_case("endfacet") {
            let cut = polygons.cut(&corners);
            read.corners
                .extend(cut.iter().flatten().map(|corner| corners[*corner as usize].to_array()));
            corners.clear();
        }
    }
    polygons.report(report);
    read.breach = (!corners.is_empty()).then(|| "a facet has no end".to_owned());
    Ok(read)
}

fn of_bytes(bytes: &[u8], report: &mut ImportReport) -> Triangles {
    let Some(said) = said(bytes) else {
        return Triangles {
            corners: Vec::new(),
            breach: Some("it is neither text that begins with \"solid\" nor binary".to_owned()),
        };
    };
    let triangles = bytes[HEADER..].as_chunks::<TRIANGLE>().0;
    let used = &triangles[..said.min(triangles.len())];
    let corners = used.iter().flat_map(|triangle| {
        let numbers: [f32; 12] = bytemuck::pod_read_unaligned(&triangle[..TRIANGLE - 2]);
        [3, 6, 9].map(|first| [0, 1, 2].map(|axis| f64::from(numbers[first + axis])))
    });
    let corners = corners.collect();
    let colored = used
        .iter()
        .filter(|triangle| triangle[TRIANGLE - 2..] != [0, 0])
        .count();
    report.count(
        Fate::Ignored,
        "bytes that some programs colour triangles by",
        "",
        colored,
    );
    let breach = (used.len() < said).then(|| format!("{} of {said} triangles are there", used.len()));
    Triangles { corners, breach }
}
