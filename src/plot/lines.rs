//! Line plots over two axes, or around a point.

use super::{
    axes::{number, round_step},
    drawing::{CENTER, Colors, Drawing, Figure, LEFT, PALETTE, Point, TOP},
    lobe_view::{LinePlot, Series},
};

/// Width without the legend.
const WIDTH: f64 = 860.0;
/// About the width of a letter of a legend.
pub const LETTER: f64 = 7.4;
/// Where a polar plot's rays begin, and its radius.
const FOOT: Point = [0.5 * WIDTH, 480.0];
const RADIUS: f64 = 380.0;

impl Figure for LinePlot {
    fn drawing(&self, colors: &'static Colors) -> Drawing {
        let names = self.series.iter().map(|series| self.label(series));
        let longest = names.map(|name| name.chars().count()).max().unwrap_or(0);
        let height = if self.is_polar { 530.0 } else { 560.0 };
        let mut drawing = Drawing::new([WIDTH + 62.0 + LETTER * longest as f64, height], colors);
        let title = match self.view_angle_deg() {
            Some(angle) => format!("{}, view {angle}°", self.title),
            None => self.title.clone(),
        };
        if self.is_polar {
            draw_polar(self, &title, &mut drawing);
        } else {
            let corners = [[82.0, 52.0], [WIDTH - 16.0, 498.0]];
            let frame = drawing.framed(&title, [&self.x, &self.y], [10.0, 8.0], corners);
            for (series, dash) in dashes(&self.series) {
                drawing.dashed(
                    series.points.iter().map(|place| frame.at(*place)),
                    color(series),
                    2.2,
                    dash,
                );
            }
        }
        for ((series, dash), row) in dashes(&self.series).zip(0..) {
            let y = 64.0 + 24.0 * f64::from(row);
            drawing.dashed([WIDTH + 4.0, WIDTH + 30.0].map(|x| [x, y]), color(series), 2.2, dash);
            drawing.text(self.label(series), [WIDTH + 38.0, y], 15.0, LEFT);
        }
        drawing
    }
}

/// The series; those of a group after its first are dashed.
fn dashes(series: &[Series]) -> impl Iterator<Item = (&Series, f64)> {
    let groups = series.chunk_by(|a, b| a.group == b.group);
    groups.flat_map(|group| group.iter().zip(std::iter::once(0.0).chain(std::iter::repeat(7.0))))
}

fn color(series: &Series) -> plotters::style::RGBColor {
    PALETTE[series.group % PALETTE.len()]
}

fn draw_polar(plot: &LinePlot, title: &str, drawing: &mut Drawing) {
    let (ink, faint) = (drawing.colors.ink, drawing.colors.faint);
    let reach = plot.y.range[1].max(1e-9);
    let at = |[x, y]: Point| [FOOT[0] + RADIUS * x / reach, FOOT[1] - RADIUS * y / reach];
    let ray = |angle_deg: f64, radius: f64| {
        let (sine, cosine) = angle_deg.to_radians().sin_cos();
        at([radius * sine, radius * cosine])
    };
    drawing.text(title, [FOOT[0], 28.0], 22.0, CENTER);
    let step = round_step(reach, 5.0);
    let circles = (1..).map(|i| step * f64::from(i)).take_while(|radius| *radius <= reach);
    for radius in circles.clone().chain([reach]) {
        drawing.line((-90..=90).map(|angle| ray(f64::from(angle), radius)), faint, 1.0);
    }
    for radius in circles {
        drawing.text(number(radius), at([radius, 0.0]).map(|x| x + 5.0), 13.0, TOP);
    }
    for angle_deg in [-60.0, -30.0, 0.0, 30.0, 60.0_f64] {
        drawing.line([ray(0.0, 0.0), ray(angle_deg, reach)], faint, 1.0);
        drawing.text(
            format!("{}°", angle_deg.abs()),
            ray(angle_deg, 1.035 * reach),
            13.0,
            CENTER,
        );
    }
    drawing.line([at([-reach, 0.0]), at([reach, 0.0])], ink, 1.5);
    for (series, dash) in dashes(&plot.series) {
        drawing.dashed(series.polar_points(&plot.y).map(at), color(series), 2.2, dash);
        if let Some(angle_deg) = series.view_angle_deg {
            let [x, y] = ray(-angle_deg, 0.98 * reach);
            drawing.dashed([ray(0.0, 0.0), [x, y]], ink, 1.2, 3.0);
            drawing.text("view", [x - 34.0, y], 13.0, LEFT);
        }
    }
    drawing.text(plot.y.label.as_str(), [FOOT[0], 502.0], 15.0, TOP);
}
