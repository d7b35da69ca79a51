//! The Utah teapot: 32 bicubic Bézier patches (M. Newell, 1975) and five that close it, tessellated with analytic
//! normals.
//!
//! The control points are in `assets/teapot-patches.txt`, z up; here +Y is up, the spout points to +X and the rim is
//! at y = 2.4. Seen from outside, (u, v) of every patch is right-handed: u runs around the axis (of pot, lid, spout or
//! handle), v along the profile.

use std::{collections::HashMap, sync::LazyLock};

use glam::{DVec3, Vec2};

use super::mesh::Mesh;
use crate::parallel;

/// Segments along each side of a patch that give about 40 000 triangles.
pub const DEFAULT_SEGMENTS: u32 = 24;

/// Cosine above which the normals of two patches at a border count as smooth.
const SMOOTH_COSINE: f64 = 0.9;

type Patch = [[DVec3; 4]; 4];

static PATCHES: LazyLock<Vec<Patch>> = LazyLock::new(|| parse(include_str!("../../assets/teapot-patches.txt")));

/// The patches of a list of control points and indices; +Y is made up.
fn parse(text: &str) -> Vec<Patch> {
    let (mut points, mut patches) = (Vec::new(), Vec::new());
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let numbers: Vec<f64> = line
            .split_whitespace()
            .filter_map(|number| number.parse().ok())
            .collect();
        match numbers[..] {
            [x, y, z] => points.push(DVec3::new(x, z, -y)),
            [..] if numbers.len() == 16 => {
                patches.push(std::array::from_fn(|i| {
                    std::array::from_fn(|j| points[numbers[4 * i + j] as usize])
                }));
            }
            _ => {}
        }
    }
    patches
}

/// The teapot with `segments` × `segments` × 2 triangles a patch (less those that shrink to a line at the two poles).
/// Neighbouring patches have the same positions and, where the surface is smooth, the same normals along their
/// borders. Texture coordinates run over [0, 1]² on every patch. Slot 0.
pub fn mesh(segments: u32) -> Mesh {
    let segments = segments.max(1);
    let grid = Grid::new(segments);
    let mut mesh = Mesh::default();
    for part in parallel::map_each(&PATCHES, |patch| grid.tessellate(patch)) {
        mesh.append(part);
    }
    smooth_borders(&mut mesh, segments);
    mesh
}

/// A cubic's four Bernstein weights and those of its derivative.
#[derive(Clone, Copy)]
struct Basis {
    value: [f64; 4],
    slope: [f64; 4],
}

impl Basis {
    fn new(t: f64) -> Self {
        let s = 1.0 - t;
        Self {
            value: [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t],
            slope: [
                -3.0 * s * s,
                3.0 * s * (s - 2.0 * t),
                3.0 * t * (2.0 * s - t),
                3.0 * t * t,
            ],
        }
    }
}

fn combine(weights: &[f64; 4], points: &[DVec3; 4]) -> DVec3 {
    weights[0] * points[0] + weights[1] * points[1] + weights[2] * points[2] + weights[3] * points[3]
}

/// The weights at the points of a regular grid over a patch.
struct Grid {
    segments: usize,
    bases: Vec<Basis>,
}

impl Grid {
    fn new(segments: u32) -> Self {
        let bases = (0..=segments)
            .map(|i| Basis::new(f64::from(i) / f64::from(segments)))
            .collect();
        Self {
            segments: segments as usize,
            bases,
        }
    }

    fn tessellate(&self, patch: &Patch) -> Mesh {
        let mut mesh = Mesh::default();
        let side = self.segments + 1;
        for i in 0..side {
            for j in 0..side {
                let (position, normal, tangent) = self.evaluate(patch, i, j);
                let uv = Vec2::new(j as f32, i as f32) / self.segments as f32;
                // v grows as the right-handed second direction does, so the bitangent of glTF is against n × t.
                mesh.push_vertex(position, normal.as_vec3(), uv, tangent.as_vec3().extend(-1.0));
            }
        }
        for i in 0..self.segments {
            for j in 0..self.segments {
                let at = |i: usize, j: usize| (i * side + j) as u32;
                let (a, b, c, d) = (at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
                mesh.push_triangle([a, b, c], 0);
                mesh.push_triangle([a, c, d], 0);
            }
        }
        mesh
    }

    /// Position, unit normal and unit tangent along u at row `i` (v) and column `j` (u).
    fn evaluate(&self, patch: &Patch, i: usize, j: usize) -> (DVec3, DVec3, DVec3) {
        let (across, along) = (self.bases[j], self.bases[i]);
        let rows_value = patch.map(|row| combine(&across.value, &row));
        let rows_slope = patch.map(|row| combine(&across.slope, &row));
        let mut du = combine(&along.value, &rows_slope);
        let mut dv = combine(&along.slope, &rows_value);
        // At a degenerate border, the direction along it is the limit from the inside.
        let mixed = combine(&along.slope, &rows_slope);
        if du.length() < 1e-9 {
            du = if i == 0 { mixed } else { -mixed };
        }
        if dv.length() < 1e-9 {
            dv = if j == 0 { mixed } else { -mixed };
        }
        (
            self.position(patch, i, j),
            du.cross(dv).normalize_or(DVec3::Y),
            du.normalize_or(DVec3::X),
        )
    }

    /// The position. On a border it is computed from the border's own control points, in an order independent of the patch,
    /// so that neighbours get the same bits.
    fn position(&self, patch: &Patch, i: usize, j: usize) -> DVec3 {
        let column = |j: usize| patch.map(|row| row[j]);
        match (i, j) {
            (0, _) => self.border(&patch[0], j),
            (_, 0) => self.border(&column(0), i),
            (i, _) if i == self.segments => self.border(&patch[3], j),
            (_, j) if j == self.segments => self.border(&column(3), i),
            _ => combine(
                &self.bases[i].value,
                &patch.map(|row| combine(&self.bases[j].value, &row)),
            ),
        }
    }

    fn border(&self, points: &[DVec3; 4], i: usize) -> DVec3 {
        let [a, b, c, d] = *points;
        if [b, c, d] == [a; 3] {
            return a; // A pole.
        }
        if (a.to_array(), b.to_array()) > (d.to_array(), c.to_array()) {
            combine(&self.bases[self.segments - i].value, &[d, c, b, a])
        } else {
            combine(&self.bases[i].value, points)
        }
    }
}

/// Gives vertices of several patches at one place one normal, unless there is a crease between them.
fn smooth_borders(mesh: &mut Mesh, segments: u32) {
    let side = segments as usize + 1;
    let mut groups: HashMap<[u64; 3], Vec<usize>> = HashMap::new();
    for vertex in 0..mesh.positions.len() {
        let (i, j) = (vertex / side % side, vertex % side);
        if i == 0 || j == 0 || i + 1 == side || j + 1 == side {
            // + 0 turns −0 into 0.
            let place = mesh.positions[vertex]
                .to_array()
                .map(|coordinate| (coordinate + 0.0).to_bits());
            groups.entry(place).or_default().push(vertex);
        }
    }
    for vertices in groups.into_values() {
        let normals: Vec<DVec3> = vertices.iter().map(|&vertex| mesh.normals[vertex].as_dvec3()).collect();
        for (&vertex, normal) in vertices.iter().zip(&normals) {
            let sum: DVec3 = normals.iter().filter(|other| other.dot(*normal) > SMOOTH_COSINE).sum();
            mesh.normals[vertex] = sum.normalize().as_vec3();
        }
    }
}
