//! Conversion of cube maps to latitude-longitude maps: crosses, strips of six faces, six files in a folder.
//!
//! Faces are numbered as in OpenGL, +X, −X, +Y, −Y, +Z, −Z. OpenGL's cube is left-handed. Like other programs with a
//! right-handed world we mirror x, so that +Z is ahead and the face of +X to its right.

use std::path::{Path, PathBuf};

use super::decoded::{Picture, Source, io};
use super::error::EnvironmentError;
use crate::endings::is_picture;
use crate::scene::environment::{MAX_HEIGHT, environment_direction};

/// Positions of the faces in a horizontal cross, in faces from the top left.
const HORIZONTAL_CROSS: [[u32; 2]; 6] = [[2, 1], [0, 1], [1, 0], [1, 2], [1, 1], [3, 1]];
/// The same for a vertical cross, whose last face is upside down.
const VERTICAL_CROSS: [[u32; 2]; 6] = [[2, 1], [0, 1], [1, 0], [1, 2], [1, 1], [1, 3]];
/// Ends of the names of six files in the order of the faces.
const NAMES: [[&str; 6]; 3] = [
    ["px", "nx", "py", "ny", "pz", "nz"],
    ["posx", "negx", "posy", "negy", "posz", "negz"],
    ["right", "left", "top", "bottom", "front", "back"],
];
/// Tolerance for differences among the corners of a cross.
const CORNER_TOLERANCE: f32 = 0.01;

/// Layout or orientation of a cube's faces.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Axes {
    /// OpenGL's, turned to our world.
    OpenGl,
    /// OpenEXR's: a right-handed world, each face seen from within.
    OpenExr,
}

/// A cube: faces in one image, or in one each.
struct Cube<'a> {
    pictures: Vec<&'a Picture>,
    /// Top left of each face in its image.
    corners: [[u32; 2]; 6],
    side: u32,
    axes: Axes,
    /// True if the last face is upside down.
    is_last_turned: bool,
}

/// Converts an image with the layout of a cube map: a cross (with empty corners) or a strip of six faces. Returns any other
/// image unchanged.
pub(super) fn unfolded(picture: Picture) -> Picture {
    let (width, height) = (picture.width, picture.height);
    let axes = if picture.is_cube { Axes::OpenExr } else { Axes::OpenGl };
    let strip = |step: [u32; 2]| [0, 1, 2, 3, 4, 5].map(|face| step.map(|side| face * side));
    let (side, corners, is_last_turned) = if width == 6 * height {
        (height, strip([height, 0]), false)
    } else if height == 6 * width {
        (width, strip([0, width]), false)
    } else if 3 * width == 4 * height && width.is_multiple_of(4) {
        (width / 4, HORIZONTAL_CROSS, false)
    } else if 4 * width == 3 * height && width.is_multiple_of(3) {
        (width / 3, VERTICAL_CROSS, true)
    } else {
        return picture;
    };
    let is_cross = corners == HORIZONTAL_CROSS || corners == VERTICAL_CROSS;
    let corners = if is_cross {
        corners.map(|corner| corner.map(|place| place * side))
    } else {
        corners
    };
    if is_cross && !has_empty_corners(&picture, side, &corners) {
        return picture;
    }
    let cube = Cube {
        pictures: vec![&picture],
        corners,
        side,
        axes,
        is_last_turned,
    };
    let mut unfolded = cube.lat_long();
    unfolded.warnings = picture.warnings;
    unfolded
}

/// Converts six files in a folder, called `px`, `nx`, … or `right`, `left`, … at the ends of their names, to a
/// latitude-longitude map; `decode` reads one.
pub(super) fn read_folder(
    source: Source<'_>,
    decode: impl Fn(Source<'_>) -> Result<Picture, EnvironmentError>,
) -> Result<Picture, EnvironmentError> {
    let path = source.path;
    let files: Vec<PathBuf> = io(path, std::fs::read_dir(path))?
        .flatten()
        .map(|entry| entry.path())
        .filter(|file| is_picture(file))
        .collect();
    let faces = faces(&files).ok_or_else(|| EnvironmentError::NoFaces { path: path.to_owned() })?;
    let pictures: Vec<Picture> = faces
        .iter()
        .map(|face| {
            let name = face.file_name().unwrap_or_default().to_string_lossy();
            source.loading.step(format!("reading {name}"))?;
            decode(Source { path: face, ..source })
        })
        .collect::<Result<_, _>>()?;
    let side = pictures
        .iter()
        .map(|face| face.width.min(face.height))
        .min()
        .unwrap_or(0);
    let cube = Cube {
        pictures: pictures.iter().collect(),
        corners: [[0; 2]; 6],
        side,
        axes: Axes::OpenGl,
        is_last_turned: false,
    };
    let mut unfolded = cube.lat_long();
    if pictures.iter().any(|face| [face.width, face.height] != [side; 2]) {
        let text = "The six faces are not squares of one size; what they share is used.";
        unfolded.warnings.push(text.to_owned());
    }
    Ok(unfolded)
}

/// Whether files are the six faces of a cube, by their names.
pub fn are_faces(files: &[PathBuf]) -> bool {
    faces(files).is_some()
}

/// The files that are the faces of a cube, by the ends of their names.
fn faces(files: &[PathBuf]) -> Option<Vec<&PathBuf>> {
    let ends_in = |file: &Path, name: &str| {
        let stem = file.file_stem().unwrap_or_default().to_string_lossy().to_lowercase();
        let before = stem.strip_suffix(name);
        before.is_some_and(|before| !before.ends_with(|last: char| last.is_alphanumeric()))
    };
    NAMES.iter().find_map(|names| {
        let found: Vec<&PathBuf> = names
            .iter()
            .filter_map(|name| files.iter().find(|file| ends_in(file, name)))
            .collect();
        (found.len() == names.len()).then_some(found)
    })
}

/// Whether the part of an image outside the faces has one colour.
fn has_empty_corners(picture: &Picture, side: u32, corners: &[[u32; 2]; 6]) -> bool {
    let is_covered = |column: u32, row: u32| corners.contains(&[column / side * side, row / side * side]);
    let mut empty = (0..picture.height)
        .flat_map(|row| (0..picture.width).map(move |column| (column, row)))
        .filter(|&(column, row)| !is_covered(column, row))
        .map(|(column, row)| picture.texels[(row * picture.width + column) as usize]);
    let Some(first) = empty.next() else { return false };
    empty.all(|texel| (0..3).all(|channel| (texel[channel] - first[channel]).abs() <= CORNER_TOLERANCE))
}

impl Cube<'_> {
    /// The whole sphere, as many texels around as the four faces have.
    fn lat_long(&self) -> Picture {
        let height = (2 * self.side).clamp(1, MAX_HEIGHT);
        let width = 2 * height;
        let direction = |column: u32, row: u32| {
            environment_direction([
                (f64::from(column) + 0.5) / f64::from(width),
                (f64::from(row) + 0.5) / f64::from(height),
            ])
        };
        let texels = (0..height)
            .flat_map(|row| (0..width).map(move |column| direction(column, row)))
            .map(|d| self.radiance([d.x, d.y, d.z]));
        Picture {
            width,
            height,
            texels: texels.collect(),
            warnings: Vec::new(),
            is_cube: false,
        }
    }

    /// Radiance from a direction, bilinear within the face that it hits.
    fn radiance(&self, direction: [f64; 3]) -> [f32; 4] {
        let (face, place) = match self.axes {
            Axes::OpenGl => opengl_place([-direction[0], direction[1], direction[2]]),
            Axes::OpenExr => openexr_place(direction),
        };
        let place = if face == 5 && self.is_last_turned {
            place.map(|p| 1.0 - p)
        } else {
            place
        };
        let last = f64::from(self.side.saturating_sub(1));
        let [x, y] = place.map(|p| (p * f64::from(self.side) - 0.5).clamp(0.0, last));
        let texel = |x: f64, y: f64| self.texel(face, x as u32, y as u32);
        let mix = |a: [f32; 4], b: [f32; 4], t: f64| {
            let t = t as f32;
            [0, 1, 2, 3].map(|channel| a[channel] + t * (b[channel] - a[channel]))
        };
        let (right, below) = ((x + 1.0).min(last), (y + 1.0).min(last));
        let upper = mix(texel(x, y), texel(right, y), x.fract());
        let lower = mix(texel(x, below), texel(right, below), x.fract());
        mix(upper, lower, y.fract())
    }

    fn texel(&self, face: usize, x: u32, y: u32) -> [f32; 4] {
        let picture = self.pictures[face.min(self.pictures.len() - 1)];
        let [left, top] = self.corners[face];
        picture.texels[((top + y) * picture.width + left + x) as usize]
    }
}

/// The axis along which a direction goes farthest, and whether it does so forwards.
fn major_axis(d: [f64; 3]) -> (usize, bool) {
    let [x, y, z] = d.map(f64::abs);
    let axis = if x >= y && x >= z {
        0
    } else if y >= z {
        1
    } else {
        2
    };
    (axis, d[axis] > 0.0)
}

/// The face that a direction hits and the position on it, in [0, 1]² from the top left (OpenGL specification, table of
/// cube-map faces).
fn opengl_place(d: [f64; 3]) -> (usize, [f64; 2]) {
    let [x, y, z] = d;
    let (axis, is_positive) = major_axis(d);
    let (s, t) = match (axis, is_positive) {
        (0, true) => (-z, -y),
        (0, false) => (z, -y),
        (1, true) => (x, z),
        (1, false) => (x, -z),
        (_, true) => (x, -y),
        (_, false) => (-x, -y),
    };
    let face = 2 * axis + usize::from(!is_positive);
    (face, [s, t].map(|place| 0.5 + 0.5 * place / d[axis].abs()))
}

/// The same for OpenEXR's cubes (OpenEXR, `ImfEnvmap`, `CubeMap::pixelPosition`).
fn openexr_place(d: [f64; 3]) -> (usize, [f64; 2]) {
    let [x, y, z] = d;
    let (axis, is_positive) = major_axis(d);
    let (s, t) = match (axis, is_positive) {
        (0, true) => (z, -y),
        (0, false) => (-z, -y),
        (1, true) => (x, -z),
        (1, false) => (x, z),
        (_, true) => (-x, -y),
        (_, false) => (x, -y),
    };
    let face = 2 * axis + usize::from(!is_positive);
    (face, [s, t].map(|place| 0.5 + 0.5 * place / d[axis].abs()))
}
