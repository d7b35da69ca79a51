//! Views of lobes as data: what the editor and the command line draw, and what goes into CSV files.

mod compute;

use std::fmt::Write as _;

pub use compute::{lobe_view, slice_angles_deg};

use crate::{named::named, optics::lobe::Lobe, optics::vector::Vec3};

named! {
    /// What of a lobe is shown.
    ViewKind {
        Polar, "polar", "Polar slice", "How much is reflected into each direction of the plane of incidence, the cosine included.";
        Solid, "3d", "Lobe in space", "The same over all directions, as a body.";
        Hemisphere, "hemisphere", "Density over the hemisphere", "The density of the samples per steradian, the hemisphere seen from above, areas kept.";
        Albedo, "albedo", "Albedo", "The share of the light that is reflected at all, against the angle of the view.";
        Reciprocity, "reciprocity", "Reciprocity error", "How far the reflectance changes when light and view change places, against the angle of the view.";
        Horizon, "horizon", "Below the horizon", "The share of the samples below the surface before the policy deals with them, against the angle of the view.";
        Distance, "distance", "Density of the distance", "How the geometric lobe's samples lie around the mirror direction: the density of D, which its curve D(ξ) is the quantile function of.";
    }
}

impl ViewKind {
    /// True where the angle of the view is the horizontal axis.
    pub fn is_against_angle(self) -> bool {
        matches!(self, ViewKind::Albedo | ViewKind::Reciprocity | ViewKind::Horizon)
    }

    /// True where it depends on the view at all.
    pub fn is_of_view(self) -> bool {
        self != ViewKind::Distance
    }

    /// Whether there is anything of a lobe to be seen.
    pub fn shows(self, lobe: Lobe) -> bool {
        self != ViewKind::Distance || lobe.has_curves()
    }

    /// View angles in degrees where none are given.
    pub fn view_angles_deg(self) -> Vec<f64> {
        if self.is_against_angle() {
            (0..45).map(|i| 2.0 * f64::from(i)).chain([89.0]).collect()
        } else {
            vec![45.0]
        }
    }
}

/// A view, ready to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum LobeView {
    Lines(LinePlot),
    /// Colour maps of the hemisphere.
    Maps(MapPlot),
    Solids(SolidPlot),
}

#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What it measures, with the unit.
    pub label: String,
    /// First and last value.
    pub range: [f64; 2],
    /// Values are shown by their logarithm.
    pub is_logarithmic: bool,
}

impl Axis {
    pub fn linear(label: &str, range: [f64; 2]) -> Self {
        Self {
            label: label.to_owned(),
            range,
            is_logarithmic: false,
        }
    }

    /// A logarithmic axis around the positive ones of these values.
    pub fn logarithmic(label: &str, values: impl Iterator<Item = f64>) -> Self {
        let ends = |[low, high]: [f64; 2], x: f64| [low.min(x), high.max(x)];
        let [low, high] = values.filter(|x| *x > 0.0).fold([f64::INFINITY, 1e-9], ends);
        Self {
            label: label.to_owned(),
            range: [0.75 * low.min(high), 1.35 * high],
            is_logarithmic: true,
        }
    }

    /// The radius of a value around a point: counted from the first value, in powers of ten where it is logarithmic. What
    /// is beyond the ends is at them.
    pub fn radius(&self, value: f64) -> f64 {
        let [first, last] = self.range;
        let value = value.clamp(first, last.max(first));
        if self.is_logarithmic {
            (value / first).log10()
        } else {
            value - first
        }
    }
}

/// Lines over one axis.
#[derive(Clone, Debug, PartialEq)]
pub struct LinePlot {
    pub title: String,
    /// Horizontal axis, or the angle.
    pub x: Axis,
    /// Vertical axis, or the radius.
    pub y: Axis,
    /// True where x is an angle from the vertical in degrees (positive to the right) and y the distance from the origin.
    pub is_polar: bool,
    /// Name of the column that holds x.
    pub x_column: &'static str,
    pub series: Vec<Series>,
}

impl LinePlot {
    /// A plot of lobes' values from 0 up.
    pub fn of_lobes(title: String, x: Axis, label: &str, x_column: &'static str, series: Vec<Series>) -> Self {
        let mut plot = Self {
            title,
            x,
            y: Axis::linear(label, [0.0; 2]),
            is_polar: false,
            x_column,
            series,
        };
        let top = plot.highest();
        plot.y.range[1] = if top > 1e-6 { 1.05 * top } else { 1.0 };
        plot
    }

    /// A series' name in the legend: no more than distinguishes it from the others.
    pub fn label(&self, series: &Series) -> String {
        let mut label = series.lobe.clone();
        if let Some(angle_deg) = series.view_angle_deg
            && self.view_angle_deg().is_none()
        {
            let _ = write!(label, ", view {angle_deg}°");
        }
        if self.series.iter().any(|other| other.quantity != series.quantity) {
            let _ = write!(label, ", {}", series.quantity);
        }
        label
    }

    /// The largest value of any line.
    pub fn highest(&self) -> f64 {
        let values = self.series.iter().flat_map(|series| &series.points);
        values.map(|[_, y]| *y).fold(0.0, f64::max)
    }

    /// The angle of the view, if it is the same for all.
    pub fn view_angle_deg(&self) -> Option<f64> {
        let first = self.series.first()?.view_angle_deg?;
        let is_same = |series: &Series| series.view_angle_deg == Some(first);
        self.series.iter().all(is_same).then_some(first)
    }
}

/// A line.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    pub lobe: String,
    /// Angle of the view in degrees; `None` where x is that angle.
    pub view_angle_deg: Option<f64>,
    /// Name of the column that holds y.
    pub quantity: &'static str,
    /// Lines of the same group have the same colour, those after the first dashes.
    pub group: usize,
    /// (x, y).
    pub points: Vec<[f64; 2]>,
}

impl Series {
    /// The points of a polar plot as (right, up), with radii along an axis.
    pub fn polar_points<'a>(&'a self, radii: &'a Axis) -> impl Iterator<Item = [f64; 2]> + 'a {
        self.points.iter().map(|[angle_deg, value]| {
            let (angle_rad, radius) = (angle_deg.to_radians(), radii.radius(*value));
            [radius * angle_rad.sin(), radius * angle_rad.cos()]
        })
    }
}

/// Colour maps with one scale.
#[derive(Clone, Debug, PartialEq)]
pub struct MapPlot {
    pub title: String,
    /// The scale's ends, to be shown logarithmically.
    pub range: [f64; 2],
    pub maps: Vec<DiscMap>,
}

/// A function of the hemisphere's directions on a square grid of pixels, seen from above with the mirror direction to
/// the right, by Lambert's projection, which keeps areas: the distance from the centre is √2 sin(θ/2).
#[derive(Clone, Debug, PartialEq)]
pub struct DiscMap {
    pub lobe: String,
    /// Angle of the view, degrees.
    pub view_angle_deg: f64,
    /// Pixels along a side.
    pub size: usize,
    /// Density per steradian, row by row from the top; NaN outside the disc.
    pub values: Vec<f64>,
}

impl DiscMap {
    /// The direction of a pixel, `None` outside the disc.
    pub fn direction(size: usize, column: usize, row: usize) -> Option<Vec3<f64>> {
        let place = |i: usize| (2.0 * i as f64 + 1.0) / size as f64 - 1.0;
        let (x, y) = (place(column), -place(row));
        let square = x * x + y * y;
        // sin θ/ρ = 2 cos(θ/2)/√2.
        let scale = (2.0 - square).max(0.0).sqrt();
        (square < 1.0).then_some(Vec3 {
            x: x * scale,
            y: y * scale,
            z: 1.0 - square,
        })
    }
}

/// Bodies, each drawn to its own scale.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidPlot {
    pub title: String,
    pub solids: Vec<Solid>,
}

impl Solid {
    /// The largest value: the scale that it is drawn to.
    pub fn largest(&self) -> f64 {
        self.rings.iter().flatten().map(|(_, value)| *value).fold(0.0, f64::max)
    }
}

/// A lobe as a body: each direction as far from the origin as much is reflected there.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    pub lobe: String,
    /// Angle of the view, degrees.
    pub view_angle_deg: f64,
    /// Rings about the mirror direction from the inside out, all of the same length: unit direction and value. Neighbours
    /// in a ring and from ring to ring are corners of the body's faces.
    pub rings: Vec<Vec<(Vec3<f64>, f64)>>,
}

impl LobeView {
    /// The numbers as comma-separated values, to the digits of an f32: a line of column names, then a row a point.
    pub fn csv(&self) -> String {
        let mut text = String::new();
        // Writing to a String never fails.
        let _ = match self {
            LobeView::Lines(plot) => lines_csv(plot, &mut text),
            LobeView::Maps(plot) => {
                let rows = plot.maps.iter().flat_map(|map| {
                    let values = map.values.iter().enumerate();
                    values.filter_map(|(pixel, value)| {
                        let direction = DiscMap::direction(map.size, pixel % map.size, pixel / map.size)?;
                        Some((map.lobe.as_str(), map.view_angle_deg, direction, *value))
                    })
                });
                directions_csv("density", rows, &mut text)
            }
            LobeView::Solids(plot) => {
                let rows = plot.solids.iter().flat_map(|solid| {
                    let values = solid.rings.iter().flatten();
                    values.map(|(direction, value)| (solid.lobe.as_str(), solid.view_angle_deg, *direction, *value))
                });
                directions_csv("value", rows, &mut text)
            }
        };
        text
    }
}

/// A name as a field: in quotation marks, since names may have commas.
fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}

fn lines_csv(plot: &LinePlot, text: &mut String) -> std::fmt::Result {
    let of_first = plot.series.iter().filter(|series| series.group == 0);
    let quantities: Vec<&str> = of_first.map(|series| series.quantity).collect();
    let has_angle = plot.series.iter().any(|series| series.view_angle_deg.is_some());
    let angle_column = if has_angle { ",view_angle_deg" } else { "" };
    writeln!(text, "lobe{angle_column},{},{}", plot.x_column, quantities.join(","))?;
    // The series of a group have the same x.
    for group in plot.series.chunk_by(|a, b| a.group == b.group) {
        for (row, [x, _]) in group[0].points.iter().enumerate() {
            write!(text, "{}", quoted(&group[0].lobe))?;
            if let Some(angle_deg) = group[0].view_angle_deg {
                write!(text, ",{angle_deg}")?;
            }
            write!(text, ",{}", *x as f32)?;
            for series in group {
                write!(text, ",{}", series.points[row][1] as f32)?;
            }
            writeln!(text)?;
        }
    }
    Ok(())
}

/// Values by direction.
fn directions_csv<'a>(
    quantity: &str,
    rows: impl Iterator<Item = (&'a str, f64, Vec3<f64>, f64)>,
    text: &mut String,
) -> std::fmt::Result {
    writeln!(text, "lobe,view_angle_deg,x,y,z,{quantity}")?;
    for (lobe, angle_deg, direction, value) in rows {
        let [x, y, z] = direction.to_f32();
        writeln!(text, "{},{angle_deg},{x},{y},{z},{}", quoted(lobe), value as f32)?;
    }
    Ok(())
}
