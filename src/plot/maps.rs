//! Densities over the hemisphere as discs of colours.

use plotters::style::{Color, RGBColor, WHITE};

use super::{
    axes::number,
    drawing::{CENTER, Colors, Drawing, Figure, LEFT, NAME, Point, TITLE, circle, paneled},
    lobe_view::{DiscMap, MapPlot},
};

const PANEL: f64 = 410.0;
const STRIP: f64 = 110.0;
/// Radius of a disc.
const RADIUS: f64 = 193.0;
/// Viridis, from dark to bright.
const SCALE: [[f64; 3]; 9] = [
    [68.0, 1.0, 84.0],
    [71.0, 44.0, 122.0],
    [59.0, 81.0, 139.0],
    [44.0, 113.0, 142.0],
    [33.0, 144.0, 141.0],
    [39.0, 173.0, 129.0],
    [92.0, 200.0, 99.0],
    [170.0, 220.0, 50.0],
    [253.0, 231.0, 37.0],
];
/// Colours that are told apart: neighbours of one colour are one rectangle.
const STEPS: f64 = 96.0;

/// A colour of the scale, from 0 to 1.
pub fn scale_color(place: f64) -> [u8; 3] {
    let position = place.clamp(0.0, 1.0) * (SCALE.len() - 1) as f64;
    let low = (position as usize).min(SCALE.len() - 2);
    let share = position - low as f64;
    [0, 1, 2].map(|i| (SCALE[low][i] * (1.0 - share) + SCALE[low + 1][i] * share).round() as u8)
}

fn color(place: f64) -> RGBColor {
    let [red, green, blue] = scale_color(place);
    RGBColor(red, green, blue)
}

impl Figure for MapPlot {
    fn drawing(&self, colors: &'static Colors) -> Drawing {
        let title = format!("{} in 1/sr", self.title);
        let (mut drawing, corners) = paneled(&title, self.maps.len(), [PANEL; 2], colors);
        for (map, corner) in self.maps.iter().zip(corners) {
            draw_map(self, map, corner, &mut drawing);
        }
        let left = drawing.size[0];
        drawing.size[0] += STRIP;
        draw_strip(self, left, &mut drawing);
        drawing
    }
}

impl MapPlot {
    /// The place of a value on the scale, in steps.
    fn step(&self, value: f64) -> f64 {
        let [low, high] = self.range.map(f64::ln);
        let place = (value.max(self.range[0]).ln() - low) / (high - low);
        (place.clamp(0.0, 1.0) * STEPS).round() / STEPS
    }
}

fn draw_map(plot: &MapPlot, map: &DiscMap, [left, top]: Point, drawing: &mut Drawing) {
    let center = [left + 0.5 * PANEL, top + NAME + 0.5 * PANEL];
    let name = format!("{}, view {}°", map.lobe, map.view_angle_deg);
    drawing.text(name, [center[0], top + 0.5 * NAME], 16.0, CENTER);
    let place = |column: usize, row: usize| {
        [(0, column), (1, row)].map(|(axis, i)| center[axis] + RADIUS * (2.0 * i as f64 / map.size as f64 - 1.0))
    };
    for (row, values) in map.values.chunks(map.size).enumerate() {
        let step = |value: &f64| if value.is_nan() { *value } else { plot.step(*value) };
        let steps: Vec<f64> = values.iter().map(step).collect();
        let mut column = 0;
        for run in steps.chunk_by(|a, b| a.to_bits() == b.to_bits()) {
            let next = column + run.len();
            if !run[0].is_nan() {
                // A little more, so that no gap shines through.
                drawing.rectangle(place(column, row), place(next, row + 1).map(|x| x + 0.4), color(run[0]));
            }
            column = next;
        }
    }
    drawing.line(circle(center, RADIUS), drawing.colors.ink, 2.5);
    for theta_deg in [30.0, 60.0_f64] {
        let radius = distance_from_centre(theta_deg);
        drawing.line(circle(center, radius), WHITE.mix(0.45), 1.0);
        drawing.text_in(
            WHITE,
            format!("{theta_deg}°"),
            [center[0] + 3.0, center[1] + radius - 7.0],
            12.0,
            LEFT,
        );
    }
    let at = distance_from_centre(map.view_angle_deg);
    ring_and_cross(drawing, [-at, at].map(|x| [center[0] + x, center[1]]), WHITE);
}

/// The marks of the view and of the mirror direction.
fn ring_and_cross(drawing: &mut Drawing, [ring, [x, y]]: [Point; 2], color: RGBColor) {
    drawing.line(circle(ring, 5.0), color, 1.5);
    for side in [-5.0, 5.0] {
        drawing.line([[x - side, y - 5.0], [x + side, y + 5.0]], color, 1.5);
    }
}

/// Areas are kept: Lambert's projection.
fn distance_from_centre(theta_deg: f64) -> f64 {
    RADIUS * std::f64::consts::SQRT_2 * (0.5 * theta_deg.to_radians()).sin()
}

fn draw_strip(plot: &MapPlot, left: f64, drawing: &mut Drawing) {
    let height = drawing.size[1];
    let y_of = |place: f64| height - 90.0 + (TITLE + 24.0 + 90.0 - height) * place;
    for i in 0..STEPS as usize {
        let [low, high] = [i, i + 1].map(|i| i as f64 / STEPS);
        drawing.rectangle([left + 8.0, y_of(high)], [left + 26.0, y_of(low)], color(high));
    }
    let ink = drawing.colors.ink;
    let [low, high] = plot.range.map(f64::log10);
    for decade in low.ceil() as i32..=high.floor() as i32 {
        let y = y_of((f64::from(decade) - low) / (high - low));
        drawing.line([[left + 26.0, y], [left + 31.0, y]], ink, 1.0);
        drawing.text(number(10.0_f64.powi(decade)), [left + 35.0, y], 13.0, LEFT);
    }
    let marks = [height - 48.0, height - 26.0].map(|y| [left + 16.0, y]);
    ring_and_cross(drawing, marks, ink);
    for (text, [x, y]) in std::iter::zip(["view", "mirror"], marks) {
        drawing.text(text, [x + 14.0, y], 13.0, LEFT);
    }
}
