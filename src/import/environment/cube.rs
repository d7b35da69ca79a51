//! Conversion of cube maps to latitude-longitude maps: crosses, strips of six faces, six files in a folder.
//!
//! Faces are numbered as in OpenGL, +X, −X, +Y, −Y, +Z, −Z. OpenGL's cube is left-handed. Like other programs with a
//! right-handed world we mirror x, so that +Z is ahead and the face of +X to its right.

use std::path::{Path, PathBuf};

use super::{canvas::Picture, canvas::Source, error::EnvironmentError};
use crate::endings::is_picture;
use crate::scene::environment::{MAX_HEIGHT, texel_direction};

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

/// A cube whose faces are in one image.
struct Cube<'a> {
    picture: &'a Picture,
    /// Top left of each face.
    corners: [[u32; 2]; 6],
    side: u32,
    /// True if the last face is upside down.
    is_last_turned: bool,
}

/// Converts an image with the layout of a cube map: a cross (with empty corners) or a strip of six faces. Returns any other
/// image unchanged.
pub fn unfolded(picture: Picture) -> Picture {
    let (width, height) = (picture.width, picture.height);
    let faces = [0, 1, 2, 3, 4, 5];
    // Side and top left of each face in sides, and whether the image is a cross.
    let (side, places, is_cross) = if width == 6 * height {
        (height, faces.map(|face| [face, 0]), false)
    } else if height == 6 * width {
        (width, faces.map(|face| [0, face]), false)
    } else if 3 * width == 4 * height && width.is_multiple_of(4) {
        (width / 4, HORIZONTAL_CROSS, true)
    } else if 4 * width == 3 * height && width.is_multiple_of(3) {
        (width / 3, VERTICAL_CROSS, true)
    } else {
        return picture;
    };
    let corners = places.map(|place| place.map(|sides| sides * side));
    if is_cross && !has_empty_corners(&picture, side, &corners) {
        return picture;
    }
    let is_last_turned = places == VERTICAL_CROSS;
    let cube = Cube {
        picture: &picture,
        corners,
        side,
        is_last_turned,
    };
    let mut unfolded = cube.lat_long();
    unfolded.warnings = picture.warnings;
    unfolded
}

/// Six files in a folder, called `px`, `nx`, … or `right`, `left`, … at the ends of their names, as an upright strip;
/// `decode` reads one.
pub fn read_folder(
    source: Source<'_>,
    decode: impl Fn(Source<'_>) -> Result<Picture, EnvironmentError>,
) -> Result<Picture, EnvironmentError> {
    let files = source
        .io(std::fs::read_dir(source.path))?
        .flatten()
        .map(|entry| entry.path());
    let files: Vec<PathBuf> = files.filter(|file| is_picture(file)).collect();
    let faces = faces(&files).ok_or_else(|| {
        EnvironmentError::Refused(format!(
            "the environment {} is a folder without six images whose names end in px, nx, py, ny, pz, nz (or right, left, \
             top, bottom, front, back): name a file in it",
            source.path.display()
        ))
    })?;
    let mut strip = Picture::new(0, 0, Vec::new());
    for path in faces {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        source.loading.step(format!("reading {name}"))?;
        let face = Source { path, ..source };
        let picture = decode(face)?;
        if picture.width != picture.height || ![0, picture.width].contains(&strip.width) {
            return Err(face.refused("is no square as large as the other faces of its cube: save all six in one size"));
        }
        strip.width = picture.width;
        strip.height += picture.height;
        strip.texels.extend(picture.texels);
    }
    Ok(strip)
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
        let places = (0..height).flat_map(|row| (0..width).map(move |column| [column, row]));
        let texels = places.map(|place| self.radiance(texel_direction(place, [width, height]).to_f64()));
        Picture::new(width, height, texels.collect())
    }

    /// Radiance from a direction, bilinear within the face that it hits.
    fn radiance(&self, direction: [f64; 3]) -> [f32; 4] {
        let [x, y, z] = direction;
        let (face, place) = match self.picture.is_cube {
            // A right-handed world, each face seen from within.
            true => openexr_place(direction),
            false => opengl_place([-x, y, z]),
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
            [0, 1, 2, 3].map(|channel| a[channel] + t as f32 * (b[channel] - a[channel]))
        };
        let (right, below) = ((x + 1.0).min(last), (y + 1.0).min(last));
        let upper = mix(texel(x, y), texel(right, y), x.fract());
        let lower = mix(texel(x, below), texel(right, below), x.fract());
        mix(upper, lower, y.fract())
    }

    fn texel(&self, face: usize, x: u32, y: u32) -> [f32; 4] {
        let [left, top] = self.corners[face];
        self.picture.texels[((top + y) * self.picture.width + left + x) as usize]
    }
}

/// The face that a direction hits and the position on it, in [0, 1]² from the top left (OpenGL specification, table of
/// cube-map faces).
fn opengl_place(d: [f64; 3]) -> (usize, [f64; 2]) {
    let [x, y, z] = d;
    let sizes = d.map(f64::abs);
    let axis = match sizes {
        [x, y, z] if x >= y && x >= z => 0,
        [_, y, z] if y >= z => 1,
        _ => 2,
    };
    let is_positive = d[axis] > 0.0;
    let (s, t) = match (axis, is_positive) {
        (0, true) => (-z, -y),
        (0, false) => (z, -y),
        (1, true) => (x, z),
        (1, false) => (x, -z),
        (_, true) => (x, -y),
        (_, false) => (-x, -y),
    };
    let face = 2 * axis + usize::from(!is_positive);
    (face, [s, t].map(|place| 0.5 + 0.5 * place / sizes[axis]))
}

/// The same for OpenEXR's cubes (OpenEXR, `ImfEnvmap`, `CubeMap::pixelPosition`): mirrored in z, the faces stay where they are.
fn openexr_place([x, y, z]: [f64; 3]) -> (usize, [f64; 2]) {
    let (face, place) = opengl_place([x, y, -z]);
    (if face < 4 { face } else { 9 - face }, place)
}
