//! PLY files: places, normals, colours, texture coordinates and textures, faces of any number of corners, strips.
//!
//! The reader is our own: the crate ply-rs-bw reads neither lists of −1 nor all numbers of C, and forgets comments.

mod rows;

use std::path::Path;

use glam::{DVec3, Vec2, Vec4};

use self::rows::{Element, Property, Row, Rows};
use crate::{
    files::Files,
    maps::Maps,
    model_error::ModelError,
    optics::{tone::linear_from_srgb, vector::vec3},
    polygon::Polygons,
    scene::{
        Cancelled, Filter, Loading, Model, ModelOptions, Slot, TextureRef, Wrap,
        mesh::Mesh,
        report::{Fate, ImportReport},
        texture::TextureTarget,
    },
};

/// Numbers of vertices and faces by all their names: place, normal, texture coordinates, colour.
const NUMBERS: [&[&str]; 12] = [
    &["x"],
    &["y"],
    &["z"],
    &["nx"],
    &["ny"],
    &["nz"],
    &["u", "s", "texture_u"],
    &["v", "t", "texture_v"],
    &["red", "diffuse_red", "r"],
    &["green", "diffuse_green", "g"],
    &["blue", "diffuse_blue", "b"],
    &["alpha", "diffuse_alpha", "a"],
];
/// The first of a colour.
const RED: usize = 8;
/// Lists of faces.
const CORNERS: &[&str] = &["vertex_indices", "vertex_index"];
const WEDGES: &[&str] = &["texcoord"];
/// The texture of a face.
const TEXTURE: &[&str] = &["texnumber"];
/// Rows between two looks at whether the import is cancelled.
const ROWS: u64 = 1 << 14;
/// Texture coordinates as they are.
const IDENTITY: [f32; 6] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

/// Why reading ends early.
enum End {
    Cancelled(Cancelled),
    Damaged(String),
}

/// Loads the contents of a PLY file.
pub fn load(path: &Path, files: &Files, bytes: &[u8], options: &ModelOptions) -> Result<Model, ModelError> {
    let loading = &files.import.loading;
    let invalid = |reason: String| ModelError::invalid(path, reason);
    let (elements, names, mut rows) = rows::header(bytes).map_err(invalid)?;
    let mut model = Model::default();
    let (mut mesh, mut faces) = (Mesh::default(), Faces::default());
    for element in &elements {
        let read = match element.name.as_str() {
            "vertex" => read_vertices(element, &mut rows, &mut mesh, loading, &mut model.report),
            "face" => faces.read(element, false, &mut rows, loading, &mut model.report),
            "tristrips" => faces.read(element, true, &mut rows, loading, &mut model.report),
            name => {
                let what = format!("elements called {name}");
                model.report.count(Fate::Ignored, what, "", element.rows as usize);
                each_row(element, &mut rows, loading, |_| Ok(()))
            }
        };
        read.map_err(|end| match end {
            End::Cancelled(cancelled) => cancelled.into(),
            End::Damaged(reason) => invalid(reason),
        })?;
    }
    loading.step("normals and tangents")?;
    faces.finish(&mut mesh, loading, &mut model.report);
    let has_uvs = mesh.uvs.iter().any(|uv| *uv != Vec2::ZERO);
    let mut maps = Maps::new(files, options);
    for name in &names {
        let slot = textured(&mut maps, name, has_uvs, &mut model.report);
        model.slots.push(slot);
    }
    model.textures = maps.finish(&mut model.slots);
    if names.is_empty() {
        model.slots.push(Slot::clay());
    }
    if !mesh.colors.is_empty() && names.is_empty() {
        model.slots[0].color_by_vertices();
        model.report.note(Fate::Used, "vertex colours", "");
    } else if !mesh.colors.is_empty() {
        mesh.colors.clear();
        model.report.note(Fate::Ignored, "vertex colours under a texture", "");
    }
    let last = model.slots.len() as u32 - 1;
    mesh.slots.iter_mut().for_each(|slot| *slot = last.min(*slot));
    model.report.note(Fate::Used, "meshes", "");
    model.mesh = mesh;
    Ok(model)
}

/// Clay with a texture file, grey where that is missing.
fn textured(maps: &mut Maps<'_>, name: &str, has_uvs: bool, report: &mut ImportReport) -> Slot {
    let mut slot = Slot::clay();
    if !has_uvs {
        report.note(Fate::Ignored, "a texture without coordinates", name);
    } else if let Some(texture) = maps.image(&[name], None, true, report) {
        slot.set("base.color", 1.0);
        *slot.texture_mut(TextureTarget::BaseColor) = Some(TextureRef {
            texture,
            uv_set: 0,
            texture_from_mesh_uv: IDENTITY,
            wrap: [Wrap::Repeat; 2],
            filter: Filter::Linear,
        });
    }
    slot
}

/// Reads the rows of an element. One without properties has none: only its count would end the reading.
fn each_row(
    element: &Element,
    rows: &mut Rows<'_>,
    loading: &Loading,
    mut take: impl FnMut(&Row) -> Result<(), String>,
) -> Result<(), End> {
    let mut row = Row::default();
    let count = if element.properties.is_empty() { 0 } else { element.rows };
    for number in 0..count {
        if number % ROWS == 0 {
            loading.check().map_err(End::Cancelled)?;
        }
        let read = rows.read(&element.properties, &mut row).and_then(|()| take(&row));
        let name = &element.name;
        read.map_err(|reason| End::Damaged(format!("its {name} {number}: {reason}")))?;
    }
    Ok(())
}

/// Places of the properties that are used, by their names; the others are reported.
struct Columns<'a> {
    properties: &'a [Property],
    numbers: [Option<usize>; 12],
}

impl<'a> Columns<'a> {
    /// Of an element that has these besides its numbers from `first` on.
    fn of(element: &'a Element, first: usize, others: &[&[&str]], report: &mut ImportReport) -> Self {
        let properties = &element.properties;
        let mut columns = Self {
            properties,
            numbers: [None; 12],
        };
        for (number, names) in NUMBERS.iter().enumerate().skip(first) {
            columns.numbers[number] = columns.find(names, false);
        }
        for (place, property) in properties.iter().enumerate() {
            let is_other = others.iter().any(|names| names.contains(&property.name.as_str()));
            if !is_other && !columns.numbers.contains(&Some(place)) {
                let what = format!("the property {} of each {}", property.name, element.name);
                report.note(Fate::Ignored, what, "");
            }
        }
        columns
    }

    fn find(&self, names: &[&str], is_list: bool) -> Option<usize> {
        let is_it = |property: &Property| names.contains(&property.name.as_str()) && property.is_list() == is_list;
        self.properties.iter().position(is_it)
    }

    fn has(&self, numbers: std::ops::Range<usize>) -> bool {
        self.numbers[numbers].iter().all(Option::is_some)
    }

    /// A number of a row, codes as shares; 0 if it is not there.
    fn number(&self, row: &Row, number: usize) -> f64 {
        let per = |place: usize| {
            if number < RED {
                1.0
            } else {
                self.properties[place].white()
            }
        };
        self.numbers[number].map_or(0.0, |place| row.of(place)[0] / per(place))
    }

    fn vector<const N: usize>(&self, row: &Row, first: usize) -> [f64; N] {
        std::array::from_fn(|axis| self.number(row, first + axis))
    }

    /// Linear colour of sRGB.
    fn color(&self, row: &Row) -> [f32; 4] {
        let [r, g, b] = self.vector(row, RED).map(|x| x as f32);
        let [r, g, b] = linear_from_srgb(vec3(r, g, b)).to_f64().map(|x| x as f32);
        [r, g, b, 1.0]
    }
}

/// Says that the opacity of colours is not shown: many programs write 0 and mean 1.
fn note_alpha(is_clear: bool, report: &mut ImportReport) {
    if is_clear {
        report.note(Fate::Ignored, "the alpha of colours", "");
    }
}

/// Texture coordinates with v downwards.
fn downwards([u, v]: [f64; 2]) -> Vec2 {
    Vec2::new(u as f32, 1.0 - v as f32)
}

fn read_vertices(
    element: &Element,
    rows: &mut Rows<'_>,
    mesh: &mut Mesh,
    loading: &Loading,
    report: &mut ImportReport,
) -> Result<(), End> {
    let columns = Columns::of(element, 0, &[], report);
    let (has_normals, has_uvs, has_colors) = (columns.has(3..6), columns.has(6..8), columns.has(RED..RED + 3));
    let mut is_clear = false;
    each_row(element, rows, loading, |row| {
        mesh.positions.push(DVec3::from_array(columns.vector(row, 0)));
        if has_normals {
            mesh.normals.push(DVec3::from_array(columns.vector(row, 3)).as_vec3());
        }
        let uv = if has_uvs {
            downwards(columns.vector(row, 6))
        } else {
            Vec2::ZERO
        };
        mesh.uvs.push(uv);
        if has_colors {
            mesh.colors.push(columns.color(row));
            is_clear |= columns.has(11..12) && columns.number(row, 11) < 1.0;
        }
        Ok(())
    })?;
    note_alpha(is_clear, report);
    Ok(())
}

/// Faces and strips, which may come before their vertices.
#[derive(Default)]
struct Faces {
    faces: Vec<Face>,
    /// Vertices at the corners of all faces.
    corners: Vec<u32>,
    /// Texture coordinates at each corner, if any face has some.
    wedges: Vec<Vec2>,
    has_colors: bool,
}

struct Face {
    /// Where its corners end.
    end: usize,
    color: [f32; 4],
    texture: u32,
    is_strip: bool,
}

impl Faces {
    fn read(
        &mut self,
        element: &Element,
        is_strip: bool,
        rows: &mut Rows<'_>,
        loading: &Loading,
        report: &mut ImportReport,
    ) -> Result<(), End> {
        let columns = Columns::of(element, RED, &[CORNERS, WEDGES, TEXTURE], report);
        let [list, wedges] = [CORNERS, WEDGES].map(|names| columns.find(names, true));
        let texture = columns.find(TEXTURE, false);
        let has_colors = columns.has(RED..RED + 3);
        self.has_colors |= has_colors;
        let mut is_clear = false;
        each_row(element, rows, loading, |row| {
            let corners = list.map_or(&[][..], |list| row.of(list));
            if corners.iter().any(|corner| corner.fract() != 0.0) {
                return Err("a corner is no whole number".to_owned());
            }
            is_clear |= has_colors && columns.has(11..12) && columns.number(row, 11) < 1.0;
            // Between strips is −1.
            for part in corners.split(|corner| is_strip && *corner < 0.0) {
                let of_vertex = |corner: &f64| if *corner < 0.0 { u32::MAX } else { *corner as u32 };
                self.corners.extend(part.iter().map(of_vertex));
                self.faces.push(Face {
                    end: self.corners.len(),
                    color: if has_colors { columns.color(row) } else { [1.0; 4] },
                    texture: texture.map_or(0, |texture| row.of(texture)[0] as u32),
                    is_strip,
                });
            }
            let own = wedges.map_or(&[][..], |wedges| row.of(wedges).as_chunks::<2>().0);
            if !own.is_empty() && own.len() == corners.len() {
                self.wedges.resize(self.corners.len() - own.len(), Vec2::ZERO);
                self.wedges.extend(own.iter().copied().map(downwards));
            }
            Ok(())
        })?;
        note_alpha(is_clear, report);
        Ok(())
    }

    /// Puts the triangles into a mesh that has its vertices.
    fn finish(mut self, mesh: &mut Mesh, loading: &Loading, report: &mut ImportReport) {
        let (mut triangles, mut colors) = (Vec::new(), Vec::new());
        let (mut polygons, mut start, mut lost) = (Polygons::new(), 0, 0);
        for face in loading.while_wanted(0..self.faces.len()).map(|face| &self.faces[face]) {
            let own = &self.corners[start..face.end];
            let places = own.iter().map(|vertex| mesh.positions.get(*vertex as usize).copied());
            if let Some(places) = places.collect::<Option<Vec<DVec3>>>() {
                let strip = |first: u32| [first, first + 1 + first % 2, first + 2 - first % 2];
                let strip = (0..(places.len() as u32).saturating_sub(2)).map(strip);
                let cut: &[[u32; 3]] = match face.is_strip {
                    true => &strip.collect::<Vec<_>>(),
                    false => polygons.cut(&places),
                };
                triangles.extend(cut.iter().map(|triangle| triangle.map(|corner| start as u32 + corner)));
                mesh.slots.resize(triangles.len(), face.texture);
            } else {
                lost += 1;
            }
            if self.has_colors {
                colors.resize(face.end, face.color);
            }
            start = face.end;
        }
        polygons.report(report);
        report.count(Fate::Ignored, "faces whose vertices are not there", "", lost);
        let of_vertices = |triangle: &[u32; 3]| triangle.map(|corner| self.corners[corner as usize]);
        mesh.triangles = triangles.iter().map(of_vertices).collect();
        // A second element of vertices may have others than the first.
        let count = mesh.positions.len();
        if mesh.normals.len() != count {
            mesh.smooth_normals(loading);
        }
        mesh.repair_normals();
        if mesh.colors.len() != count {
            mesh.colors.clear();
        }
        if self.has_colors && !mesh.colors.is_empty() {
            report.note(Fate::Ignored, "colours of faces beside those of vertices", "");
        }
        if !self.wedges.is_empty() || self.has_colors {
            // Vertices of their own for each face.
            let corners = &self.corners;
            mesh.positions = at_corners(&mesh.positions, corners);
            mesh.normals = at_corners(&mesh.normals, corners);
            if mesh.colors.is_empty() && self.has_colors {
                colors.resize(corners.len(), [1.0; 4]);
                mesh.colors = colors;
            } else {
                mesh.colors = at_corners(&mesh.colors, corners);
            }
            if self.wedges.is_empty() {
                mesh.uvs = at_corners(&mesh.uvs, corners);
            } else {
                self.wedges.resize(corners.len(), Vec2::ZERO);
                mesh.uvs = self.wedges;
            }
            mesh.triangles = triangles;
        }
        mesh.tangents = vec![Vec4::W; mesh.positions.len()];
        mesh.make_tangents(IDENTITY, false, loading);
    }
}

/// Values of vertices at corners; any where the vertex is not there, which is in no triangle. None of none.
fn at_corners<T: Copy + Default>(values: &[T], corners: &[u32]) -> Vec<T> {
    let of_corner = |vertex: &u32| values.get(*vertex as usize).copied().unwrap_or_default();
    corners.iter().filter(|_| !values.is_empty()).map(of_corner).collect()
}
