//! Built-in shapes other than the teapot: surfaces of revolution with analytic normals, and the plane.

use std::f64::consts::TAU;

use glam::{DQuat, DVec2, DVec3, Vec2, dvec2};

use super::mesh::Mesh;

/// The unit sphere around the origin, poles at ±Y, in `around` × `down` cells; u runs around from +Z over +X, v from
/// the upper pole to the lower. Slot 0.
pub fn sphere(around: u32, down: u32) -> Mesh {
    let mut profile = Profile::start(dvec2(0.0, 1.0));
    profile.arc(DVec2::ZERO, 1.0, 90.0, -90.0, down);
    profile.revolve(around, 0)
}

/// The square [−1, 1]² in the plane y = 0, facing +Y; u runs along +X, v along +Z. Slot 0.
pub fn plane() -> Mesh {
    square(DVec3::ZERO, 1.0, 1.0, 0)
}

/// A horizontal square around `center` that faces +Y, of two triangles; (u, v) run from −`uv_half_side` to
/// `uv_half_side` about ½ along +X and +Z.
pub(super) fn square(center: DVec3, half_side: f64, uv_half_side: f32, slot: u32) -> Mesh {
    rectangle(center, half_side * DVec3::X, half_side * DVec3::Z, uv_half_side, slot)
}

/// A flat shape around a place, with half its sides as vectors. It faces `half_v` × `half_u`.
struct Flat {
    center: DVec3,
    half_u: DVec3,
    half_v: DVec3,
    mesh: Mesh,
}

impl Flat {
    fn new(center: DVec3, half_u: DVec3, half_v: DVec3) -> Self {
        let mesh = Mesh::default();
        Self {
            center,
            half_u,
            half_v,
            mesh,
        }
    }

    /// Adds a vertex at a place in half sides; its texture coordinates run from −`uv_half_side` to `uv_half_side` about ½.
    fn push(&mut self, at: DVec2, uv_half_side: f32) -> u32 {
        let normal = self.half_v.cross(self.half_u).normalize_or(DVec3::Y).as_vec3();
        let tangent = self.half_u.normalize_or(DVec3::X).as_vec3().extend(1.0);
        let uv = (at.as_vec2() * uv_half_side + 1.0) * 0.5;
        self.mesh.push_vertex(
            self.center + at.x * self.half_u + at.y * self.half_v,
            normal,
            uv,
            tangent,
        )
    }
}

/// A triangle in the rectangle around `center`, as [`rectangle`] has it: its base is at the end of `half_v`.
pub(super) fn triangle(center: DVec3, half_u: DVec3, half_v: DVec3, slot: u32) -> Mesh {
    let mut flat = Flat::new(center, half_u, half_v);
    let corners = [(0.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].map(|(u, v)| flat.push(dvec2(u, v), 1.0));
    flat.mesh.push_triangle(corners, slot);
    flat.mesh
}

/// Corners of the polygon that approximates an ellipse.
const ELLIPSE_CORNERS: u32 = 64;

/// An ellipse around `center` with half its axes as vectors, as a polygon of the same area. It faces `half_v` × `half_u`.
pub(super) fn ellipse(center: DVec3, half_u: DVec3, half_v: DVec3, slot: u32) -> Mesh {
    let mut flat = Flat::new(center, half_u, half_v);
    let step_rad = TAU / f64::from(ELLIPSE_CORNERS);
    let grown = (step_rad / step_rad.sin()).sqrt();
    let middle = flat.push(DVec2::ZERO, 1.0);
    let place = |corner: u32| grown * DVec2::from_angle(step_rad * f64::from(corner));
    let rim: Vec<u32> = (0..ELLIPSE_CORNERS)
        .map(|corner| flat.push(place(corner), 1.0))
        .collect();
    for (index, corner) in rim.iter().enumerate() {
        flat.mesh
            .push_triangle([middle, rim[(index + 1) % rim.len()], *corner], slot);
    }
    flat.mesh
}

/// Times that each face of an icosahedron is cut into four: seen from anywhere the ball is the same to 0.3 %.
const BALL_CUTS: usize = 2;

/// A ball that faces outwards: a polyhedron that is seen as large, in the mean over all directions, as a sphere of this
/// radius. Of a convex body that mean is a quarter of its surface (Cauchy 1841).
pub(super) fn ball(center: DVec3, radius: f64, slot: u32) -> Mesh {
    let mut faces = icosahedron();
    for _ in 0..BALL_CUTS {
        faces = faces.iter().flat_map(cut_on_sphere).collect();
    }
    let area: f64 = faces.iter().map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum();
    let grown = radius * (2.0 * TAU / area).sqrt();
    let mut mesh = Mesh::default();
    for face in faces {
        let corners = face.map(|normal| {
            let tangent = normal.any_orthonormal_vector().as_vec3().extend(1.0);
            mesh.push_vertex(center + grown * normal, normal.as_vec3(), Vec2::splat(0.5), tangent)
        });
        mesh.push_triangle(corners, slot);
    }
    mesh
}

/// The faces of a regular icosahedron in the unit sphere, anticlockwise seen from outside.
fn icosahedron() -> Vec<[DVec3; 3]> {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let corner = |axis: usize, a: f64, b: f64| {
        let mut place = [0.0; 3];
        (place[axis], place[(axis + 1) % 3]) = (a, b * golden);
        DVec3::from_array(place).normalize()
    };
    let signs = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
    let corners: Vec<DVec3> = (0..3).flat_map(|axis| signs.map(|(a, b)| corner(axis, a, b))).collect();
    // Neighbours are 63° apart, the next ones 117°.
    let are_near = |a: usize, b: usize| corners[a].dot(corners[b]) > 0.0;
    let mut faces = Vec::new();
    for a in 0..corners.len() {
        for b in (a + 1..corners.len()).filter(|&b| are_near(a, b)) {
            for c in (b + 1..corners.len()).filter(|&c| are_near(a, c) && are_near(b, c)) {
                let [a, b, c] = [a, b, c].map(|corner| corners[corner]);
                faces.push(if a.dot(b.cross(c)) > 0.0 { [a, b, c] } else { [a, c, b] });
            }
        }
    }
    faces
}

/// A triangle between places of the unit sphere as four of them.
fn cut_on_sphere(&[a, b, c]: &[DVec3; 3]) -> [[DVec3; 3]; 4] {
    let [ab, bc, ca] = [a + b, b + c, c + a].map(DVec3::normalize);
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}

/// A rectangle around `center` of two triangles, with half its sides as vectors: u runs along `half_u`, v along
/// `half_v`, both from −`uv_half_side` to `uv_half_side` about ½. It faces `half_v` × `half_u`.
pub fn rectangle(center: DVec3, half_u: DVec3, half_v: DVec3, uv_half_side: f32, slot: u32) -> Mesh {
    let mut flat = Flat::new(center, half_u, half_v);
    let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)];
    let [a, b, c, d] = corners.map(|(u, v)| flat.push(dvec2(u, v), uv_half_side));
    flat.mesh.push_triangle([a, b, c], slot);
    flat.mesh.push_triangle([a, c, d], slot);
    flat.mesh
}

/// Cells around each part of the shader ball.
const BALL_AROUND: u32 = 144;

/// A hollow ball of radius 1, split by a tilted inset band through which its core is seen (slot 0, the two shells),
/// with the core and the stand that it hovers on (slot 1). It stands on y = 0. Every part is closed and keeps clear of
/// the others, so that transparent materials work too.
pub fn shaderball() -> Mesh {
    let center = DVec3::new(0.0, 1.12, 0.0);
    let tilt = DQuat::from_rotation_z(-0.2) * DQuat::from_rotation_x(0.38);
    let mut ball = upper_shell().revolve(BALL_AROUND, 0);
    ball.append(lower_shell().revolve(BALL_AROUND, 0));
    let mut core = Profile::start(dvec2(0.0, CORE));
    core.arc(DVec2::ZERO, CORE, 90.0, -90.0, 48);
    ball.append(core.revolve(BALL_AROUND, 1));
    for (position, (normal, tangent)) in ball
        .positions
        .iter_mut()
        .zip(ball.normals.iter_mut().zip(&mut ball.tangents))
    {
        *position = center + tilt * *position;
        *normal = tilt.as_quat() * *normal;
        *tangent = (tilt.as_quat() * tangent.truncate()).extend(tangent.w);
    }
    ball.append(stand(dvec2(0.0, center.y)).revolve(BALL_AROUND, 1));
    ball
}

/// A bowl of radius 1 on a foot that stands on y = 0, open at the top, with a rounded lip.
pub(super) fn bowl(slot: u32) -> Mesh {
    let (outer, wall, foot) = (1.0, 0.06, 0.12);
    let center = dvec2(0.0, outer + foot);
    // The lip is a half circle between the outside and the inside of a hemisphere cut at this elevation.
    let lip_deg = -12.0;
    let lip = center + polar(outer - 0.5 * wall, lip_deg);
    let mut profile = Profile::start(center - dvec2(0.0, outer - wall));
    profile.arc(center, outer - wall, -90.0, lip_deg, 32);
    profile.arc(lip, 0.5 * wall, lip_deg + 180.0, lip_deg, 8);
    profile.arc(center, outer, lip_deg, -66.0, 24);
    profile.line(dvec2((center + polar(outer, -66.0)).x, 0.0), 2);
    profile.line(DVec2::ZERO, 4);
    profile.revolve(BOWL_AROUND, slot)
}

/// Cells around the bowl.
const BOWL_AROUND: u32 = 112;

const CORE: f64 = 0.8;
const SHELL_INSIDE: f64 = 0.84;
const EDGE: f64 = 0.025;
/// The band's edges as degrees above the ball's equator.
const BAND_DEG: [f64; 2] = [-7.0, 11.0];

/// The place at a distance from the origin, `elevation_deg` above the horizontal.
fn polar(distance: f64, elevation_deg: f64) -> DVec2 {
    distance * DVec2::from_angle(elevation_deg.to_radians())
}

/// Degrees between a wall that points to the centre and the centre of an edge's rounding, `distance` from the centre.
fn edge_offset_deg(distance: f64) -> f64 {
    (EDGE / distance).asin().to_degrees()
}

/// From the top over the outside, the wall of the band and the inside back to the axis.
fn upper_shell() -> Profile {
    let wall = BAND_DEG[1];
    let outer = wall + edge_offset_deg(1.0 - EDGE);
    let inner = wall + edge_offset_deg(SHELL_INSIDE + EDGE);
    let mut profile = Profile::start(dvec2(0.0, 1.0));
    profile.arc(DVec2::ZERO, 1.0, 90.0, outer, 36);
    profile.arc(polar(1.0 - EDGE, outer), EDGE, outer, wall - 90.0, 8);
    profile.line(
        polar(
            (SHELL_INSIDE + EDGE) * edge_offset_deg(SHELL_INSIDE + EDGE).to_radians().cos(),
            wall,
        ),
        1,
    );
    profile.arc(polar(SHELL_INSIDE + EDGE, inner), EDGE, wall - 90.0, inner - 180.0, 8);
    profile.arc(DVec2::ZERO, SHELL_INSIDE, inner, 90.0, 24);
    profile
}

/// From the axis over the inside, the wall of the band and the outside to the lowest point.
fn lower_shell() -> Profile {
    let wall = BAND_DEG[0];
    let outer = wall - edge_offset_deg(1.0 - EDGE);
    let inner = wall - edge_offset_deg(SHELL_INSIDE + EDGE);
    let mut profile = Profile::start(dvec2(0.0, -SHELL_INSIDE));
    profile.arc(DVec2::ZERO, SHELL_INSIDE, -90.0, inner, 24);
    profile.arc(polar(SHELL_INSIDE + EDGE, inner), EDGE, inner + 180.0, wall + 90.0, 8);
    profile.line(
        polar((1.0 - EDGE) * edge_offset_deg(1.0 - EDGE).to_radians().cos(), wall),
        1,
    );
    profile.arc(polar(1.0 - EDGE, outer), EDGE, wall + 90.0, outer, 8);
    profile.arc(DVec2::ZERO, 1.0, outer, -90.0, 36);
    profile
}

/// A cup around the unit ball at `ball`, a hollow throat and a disc on y = 0.
fn stand(ball: DVec2) -> Profile {
    let (cup, lip_deg, lip, top) = (1.012, -60.0, 0.02, 0.06);
    let lip_center = ball + polar(cup + lip, lip_deg);
    let throat = lip_center.y - top;
    let mut profile = Profile::start(ball - dvec2(0.0, cup));
    profile.arc(ball, cup, -90.0, lip_deg, 10);
    profile.arc(lip_center, lip, lip_deg + 180.0, 0.0, 10);
    profile.arc(lip_center + dvec2(lip + throat, 0.0), throat, 180.0, 270.0, 16);
    profile.line(dvec2(0.93, top), 2);
    profile.arc(dvec2(0.93, top - 0.02), 0.02, 90.0, 0.0, 8);
    profile.line(dvec2(0.95, 0.012), 1);
    profile.arc(dvec2(0.938, 0.012), 0.012, 0.0, -90.0, 6);
    profile.line(DVec2::ZERO, 6);
    profile
}

/// A profile curve in the half plane (distance from the axis, height), revolved about the Y axis. The outside is left of its
/// direction. Pieces that meet at an angle make a crease.
pub struct Profile {
    points: Vec<ProfilePoint>,
    end: DVec2,
}

#[derive(Clone, Copy)]
struct ProfilePoint {
    place: DVec2,
    normal: DVec2,
}

impl Profile {
    pub fn start(place: DVec2) -> Self {
        Self {
            points: Vec::new(),
            end: place,
        }
    }

    /// An arc around `center` from the curve's current end, in `steps` steps. Falling angles put the circle's outside on the
    /// surface's outside, growing ones its inside.
    pub fn arc(&mut self, center: DVec2, radius: f64, from_deg: f64, to_deg: f64, steps: u32) {
        let side = if to_deg < from_deg { 1.0 } else { -1.0 };
        for step in 0..=steps {
            let direction = polar(
                1.0,
                from_deg + (to_deg - from_deg) * (f64::from(step) / f64::from(steps)),
            );
            self.push(step, center + radius * direction, side * direction);
        }
    }

    /// A straight piece to `place` in `steps` steps.
    pub fn line(&mut self, place: DVec2, steps: u32) {
        let from = self.end;
        let normal = (place - from).perp().normalize();
        for step in 0..=steps {
            self.push(step, from.lerp(place, f64::from(step) / f64::from(steps)), normal);
        }
    }

    /// Step 0 of a piece has exactly the end position of the last piece, so that no crack opens. It is skipped if the normal
    /// is unchanged.
    fn push(&mut self, step: u32, place: DVec2, normal: DVec2) {
        let place = if place.x.abs() < 1e-12 {
            dvec2(0.0, place.y)
        } else {
            place
        };
        let place = if step == 0 { self.end } else { place };
        let continues = self
            .points
            .last()
            .is_some_and(|last| last.normal.dot(normal) > 1.0 - 1e-9);
        if step > 0 || !continues {
            self.points.push(ProfilePoint { place, normal });
        }
        self.end = place;
    }

    /// The surface in `around` cells about the axis; u runs around from +Z over +X, v along the curve by length.
    pub fn revolve(&self, around: u32, slot: u32) -> Mesh {
        let mut mesh = Mesh::default();
        let mut lengths = vec![0.0];
        for pair in self.points.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + pair[0].place.distance(pair[1].place));
        }
        let total = lengths[lengths.len() - 1];
        for (point, length) in self.points.iter().zip(&lengths) {
            for j in 0..=around {
                // The last column is the first again, to the bit.
                let (sin, cos) = (TAU * f64::from(j % around) / f64::from(around)).sin_cos();
                let turn = |v: DVec2| DVec3::new(v.x * sin, v.y, v.x * cos);
                let uv = dvec2(f64::from(j) / f64::from(around), length / total).as_vec2();
                let tangent = DVec3::new(cos, 0.0, -sin).as_vec3().extend(1.0);
                mesh.push_vertex(turn(point.place), turn(point.normal).as_vec3(), uv, tangent);
            }
        }
        let side = around + 1;
        for i in 0..self.points.len() as u32 - 1 {
            for j in 0..around {
                let (a, b, c, d) = (
                    i * side + j,
                    (i + 1) * side + j,
                    (i + 1) * side + j + 1,
                    i * side + j + 1,
                );
                mesh.push_triangle([a, b, c], slot);
                mesh.push_triangle([a, c, d], slot);
            }
        }
        mesh
    }
}
