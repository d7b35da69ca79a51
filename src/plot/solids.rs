//! Lobes as bodies over the surface, shaded.

use plotters::style::RGBColor;

use super::{
    axes::short,
    drawing::{CENTER, Colors, Drawing, Figure, LEFT, NAME, PALETTE, Point, circle, paneled},
    lobe_view::{Solid, SolidPlot},
};
use crate::optics::vector::{Vec3, vec3};

const PANEL: Point = [440.0, 312.0];
/// Where the middle of the surface is in a panel, and the length of 1.
const MIDDLE: Point = [220.0, 216.0];
const UNIT: f64 = 200.0;
const EYE_AZIMUTH_DEG: f64 = -68.0;
const EYE_ELEVATION_DEG: f64 = 22.0;
const AMBIENT: f64 = 0.35;

/// A view from afar at a panel.
struct Eye {
    right: Vec3<f64>,
    up: Vec3<f64>,
    towards: Vec3<f64>,
    middle: Point,
}

impl Eye {
    fn new(middle: Point) -> Self {
        let (sine, cosine) = EYE_AZIMUTH_DEG.to_radians().sin_cos();
        let (height, flat) = EYE_ELEVATION_DEG.to_radians().sin_cos();
        let towards = vec3(cosine * flat, sine * flat, height);
        let right = vec3(-sine, cosine, 0.0);
        Self {
            right,
            up: towards.cross(right),
            towards,
            middle,
        }
    }

    fn project(&self, place: Vec3<f64>) -> Point {
        let [x, y] = self.middle;
        [x + UNIT * self.right.dot(place), y - UNIT * self.up.dot(place)]
    }
}

struct Face {
    corners: [Point; 4],
    depth: f64,
    brightness: f64,
}

impl Figure for SolidPlot {
    fn drawing(&self, colors: &'static Colors) -> Drawing {
        let (mut drawing, corners) = paneled(&self.title, self.solids.len(), PANEL, colors);
        for ((index, solid), corner) in self.solids.iter().enumerate().zip(corners) {
            draw_solid(solid, PALETTE[index % PALETTE.len()], corner, &mut drawing);
        }
        drawing
    }
}

fn draw_solid(solid: &Solid, color: RGBColor, [left, top]: Point, drawing: &mut Drawing) {
    let eye = Eye::new([left + MIDDLE[0], top + NAME + MIDDLE[1]]);
    let largest = solid.largest().max(1e-12);
    let (name, angle) = (&solid.lobe, solid.view_angle_deg);
    let name = format!("{name}, view {angle}°, radius {} in 1/sr", short(largest));
    drawing.text(name, [left + 0.5 * PANEL[0], top + 0.5 * NAME], 16.0, CENTER);
    let (ink, faint, shade) = (drawing.colors.ink, drawing.colors.faint, drawing.colors.shade);
    let around = |radius: f64| circle([0.0; 2], radius).map(|[x, y]| eye.project(vec3(x, y, 0.0)));
    drawing.area(around(1.0), shade);
    for radius in [1.0 / 3.0, 2.0 / 3.0, 1.0] {
        drawing.line(around(radius), faint, 1.0);
    }
    drawing.line([-1.0, 1.0].map(|x| eye.project(vec3(x, 0.0, 0.0))), faint, 1.0);
    let (sine, cosine) = angle.to_radians().sin_cos();
    for (x, z, name) in [(-sine, cosine, "view"), (0.0, 1.0, "n"), (sine, cosine, "r")] {
        let [x, y] = eye.project(vec3(x, 0.0, z));
        drawing.dashed([eye.middle, [x, y]], ink, 1.2, 4.0);
        drawing.text(name, [x + 5.0, y - 5.0], 14.0, LEFT);
    }
    for Face {
        corners, brightness, ..
    } in faces(solid, largest, &eye)
    {
        let lit = |channel: u8| (f64::from(channel) * brightness + 255.0 * 0.25 * brightness.powi(4)).min(255.0) as u8;
        let lit = RGBColor(lit(color.0), lit(color.1), lit(color.2));
        drawing.area(corners, lit);
        // The edges: no gap shines through.
        drawing.line(corners.into_iter().chain([corners[0]]), lit, 0.5);
    }
}

/// The faces from the farthest to the nearest.
fn faces(solid: &Solid, top: f64, eye: &Eye) -> Vec<Face> {
    let light = (eye.towards + eye.up * 0.9 + eye.right * -0.7).normalize();
    let place = |(direction, value): &(Vec3<f64>, f64)| *direction * (value / top);
    let mut faces = Vec::new();
    let Some(first) = solid.rings.first() else {
        return faces;
    };
    let count = first.len();
    let middle = first.iter().map(place).fold(Vec3::ZERO, |sum, corner| sum + corner) / count as f64;
    let mut inner = vec![middle; count];
    let ends = solid.rings.iter().map(|ring| ring.iter().map(place).collect());
    for outer in ends.chain([vec![Vec3::ZERO; count]]) {
        for i in 0..count {
            let next = (i + 1) % count;
            let corners = [inner[i], outer[i], outer[next], inner[next]];
            faces.extend(face(corners, light, eye));
        }
        inner = outer;
    }
    faces.sort_by(|a, b| a.depth.total_cmp(&b.depth));
    faces
}

fn face(corners: [Vec3<f64>; 4], light: Vec3<f64>, eye: &Eye) -> Option<Face> {
    let normal = (corners[2] - corners[0]).cross(corners[3] - corners[1]);
    let length = normal.length();
    if length < 1e-12 {
        return None;
    }
    let normal = normal / length;
    let normal = if normal.dot(eye.towards) < 0.0 { -normal } else { normal };
    let middle = (corners[0] + corners[1] + corners[2] + corners[3]) / 4.0;
    Some(Face {
        corners: corners.map(|corner| eye.project(corner)),
        depth: eye.towards.dot(middle),
        brightness: AMBIENT + (1.0 - AMBIENT) * normal.dot(light).max(0.0),
    })
}
