//! Lobes as bodies, shaded, seen from the side and a little from above.

use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::figure::{
    Area, Backend, Figure, NAME, Outcome, PALETTE, Style, TITLE, font, number, panel_grid, px, stroke, titled,
};
use crate::optics::vector::{Vec3, vec3};
use crate::plot::lobe_view::{Solid, SolidPlot};

/// Width and height of a panel without its name, pixels, and what of the projection it shows, in the same proportion.
const PANEL: (u32, u32) = (440, 312);
const RANGE: [[f64; 2]; 2] = [[-1.1, 1.1], [-0.48, 1.08]];
/// Where the eye is: turned out of the plane of incidence's side view, and above the surface.
const EYE_AZIMUTH_DEG: f64 = -68.0;
const EYE_ELEVATION_DEG: f64 = 22.0;
/// Share of light that reaches faces turned away.
const AMBIENT: f64 = 0.35;

/// A chart in plain coordinates.
type Chart<'a, DB> = ChartContext<'a, DB, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// An orthographic view.
struct Eye {
    right: Vec3<f64>,
    up: Vec3<f64>,
    towards: Vec3<f64>,
}

impl Eye {
    fn new() -> Self {
        let (azimuth_rad, elevation_rad) = (EYE_AZIMUTH_DEG.to_radians(), EYE_ELEVATION_DEG.to_radians());
        let flat = vec3(azimuth_rad.cos(), azimuth_rad.sin(), 0.0);
        let towards = flat * elevation_rad.cos() + vec3(0.0, 0.0, elevation_rad.sin());
        let right = vec3(-azimuth_rad.sin(), azimuth_rad.cos(), 0.0);
        Self {
            right,
            up: towards.cross(right),
            towards,
        }
    }

    fn project(&self, place: Vec3<f64>) -> (f64, f64) {
        (self.right.dot(place), self.up.dot(place))
    }
}

/// A face as it is drawn.
struct Face {
    corners: [(f64, f64); 4],
    /// Distance towards the eye.
    depth: f64,
    brightness: f64,
}

impl Figure for SolidPlot {
    fn size(&self) -> (u32, u32) {
        let (rows, columns) = panel_grid(self.solids.len());
        (columns as u32 * PANEL.0, rows as u32 * (PANEL.1 + NAME) + TITLE)
    }

    fn draw<DB: Backend>(&self, root: &Area<DB>, style: Style) -> Outcome {
        let (rows, columns) = panel_grid(self.solids.len());
        let rest = titled(root, &self.title, 22.0, TITLE, style)?;
        for (i, (solid, area)) in self.solids.iter().zip(rest.split_evenly((rows, columns))).enumerate() {
            draw_solid(solid, PALETTE[i % PALETTE.len()], &area, style)?;
        }
        Ok(())
    }
}

fn draw_solid<DB: Backend>(solid: &Solid, color: RGBColor, area: &Area<DB>, style: Style) -> Outcome {
    let eye = Eye::new();
    let top = solid.largest().max(1e-12);
    let name = format!(
        "{}, view {}°, radius {} in 1/sr",
        solid.lobe,
        solid.view_angle_deg,
        number(three_digits(top))
    );
    let below = titled(area, &name, 16.0, NAME, style)?;
    let [x, y] = RANGE.map(|[low, high]| low..high);
    let mut chart = ChartBuilder::on(&below).build_cartesian_2d(x, y)?;
    draw_surface(&mut chart, &eye, style)?;
    let angle_rad = solid.view_angle_deg.to_radians();
    let view = vec3(-angle_rad.sin(), 0.0, angle_rad.cos());
    // What lies behind the body first.
    draw_direction(&mut chart, &eye, view, "view", style)?;
    draw_direction(&mut chart, &eye, vec3(0.0, 0.0, 1.0), "n", style)?;
    draw_direction(&mut chart, &eye, vec3(-view.x, 0.0, view.z), "r", style)?;
    for face in faces(solid, top, &eye) {
        let shade = |channel: u8| {
            (f64::from(channel) * face.brightness + 255.0 * 0.25 * face.brightness.powi(4)).min(255.0) as u8
        };
        let shaded = RGBColor(shade(color.0), shade(color.1), shade(color.2));
        chart.draw_series([Polygon::new(face.corners.to_vec(), shaded.filled())])?;
        // Closes the seams between faces.
        let outline = [
            face.corners[0],
            face.corners[1],
            face.corners[2],
            face.corners[3],
            face.corners[0],
        ];
        chart.draw_series([PathElement::new(outline, shaded.stroke_width(1))])?;
    }
    Ok(())
}

/// Rounded for people.
fn three_digits(value: f64) -> f64 {
    let unit = 10.0_f64.powf(value.log10().floor() - 2.0);
    (value / unit).round() * unit
}

/// The surface: a disc with circles at a third and two thirds of the largest value.
fn draw_surface<DB: Backend>(chart: &mut Chart<'_, DB>, eye: &Eye, style: Style) -> Outcome {
    let circle = |radius: f64| {
        (0..=120)
            .map(move |i| (f64::from(i) * 3.0_f64).to_radians())
            .map(move |phi| eye.project(vec3(radius * phi.cos(), radius * phi.sin(), 0.0)))
    };
    chart.draw_series([Polygon::new(circle(1.0).collect::<Vec<_>>(), style.shade.filled())])?;
    for radius in [1.0 / 3.0, 2.0 / 3.0, 1.0] {
        chart.draw_series(LineSeries::new(circle(radius), stroke(style.faint, 1.0, style)))?;
    }
    let across = [vec3(-1.0, 0.0, 0.0), vec3(1.0, 0.0, 0.0)].map(|end| eye.project(end));
    chart.draw_series(LineSeries::new(across, stroke(style.faint, 1.0, style)))?;
    Ok(())
}

/// A direction from the surface point, named at its end.
fn draw_direction<DB: Backend>(
    chart: &mut Chart<'_, DB>,
    eye: &Eye,
    direction: Vec3<f64>,
    name: &str,
    style: Style,
) -> Outcome {
    let end = eye.project(direction);
    let line = DashedLineSeries::new(
        [(0.0, 0.0), end],
        px(4.0, style),
        px(4.0, style),
        stroke(style.ink, 1.2, style),
    );
    chart.draw_series(line)?;
    let label = Text::new(name.to_owned(), (px(5.0, style), px(-12.0, style)), font(14.0, style));
    chart.draw_series([EmptyElement::at(end) + label])?;
    Ok(())
}

/// The faces from back to front, the light over the eye's left shoulder.
fn faces(solid: &Solid, top: f64, eye: &Eye) -> Vec<Face> {
    let light = (eye.towards + eye.up * 0.9 + eye.right * -0.7).normalize();
    let place = |(direction, value): &(Vec3<f64>, f64)| *direction * (value / top);
    let mut faces = Vec::new();
    let Some(first) = solid.rings.first() else {
        return faces;
    };
    let count = first.len();
    // The innermost ring is closed by its own middle.
    let middle = first.iter().map(place).fold(Vec3::zero(), |sum, corner| sum + corner) / count as f64;
    let mut inner = vec![middle; count];
    // Past the last ring the body goes back to the surface point.
    let ends = solid.rings.iter().map(|ring| ring.iter().map(place).collect());
    for outer in ends.chain([vec![Vec3::zero(); count]]) {
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

/// `None` where the face has no area.
fn face(corners: [Vec3<f64>; 4], light: Vec3<f64>, eye: &Eye) -> Option<Face> {
    let normal = (corners[2] - corners[0]).cross(corners[3] - corners[1]);
    let length = normal.length();
    if length < 1e-12 {
        return None;
    }
    let normal = normal / length;
    // The side that the eye sees.
    let normal = if normal.dot(eye.towards) < 0.0 { -normal } else { normal };
    let middle = (corners[0] + corners[1] + corners[2] + corners[3]) / 4.0;
    Some(Face {
        corners: corners.map(|corner| eye.project(corner)),
        depth: eye.towards.dot(middle),
        brightness: AMBIENT + (1.0 - AMBIENT) * normal.dot(light).max(0.0),
    })
}
