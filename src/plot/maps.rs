//! Colour maps of the hemisphere.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::figure::{Area, Backend, Figure, NAME, Outcome, Style, TITLE, font, number, panel_grid, px, stroke, titled};
use crate::plot::lobe_view::{DiscMap, MapPlot};

/// Side of a panel without its name and width of the scale's strip, pixels.
const PANEL: u32 = 410;
const STRIP: u32 = 110;
/// Colours of the scale from low to high, evenly spaced: dark to light at any colour vision (viridis: van der Walt and
/// Smith 2015, CC0).
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
/// Steps of colour: neighbours of the same step are drawn at once.
const STEPS: f64 = 96.0;

/// The colour at a place in [0, 1] of the scale that maps are drawn with: sRGB.
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
    fn size(&self) -> (u32, u32) {
        let (rows, columns) = panel_grid(self.maps.len());
        (columns as u32 * PANEL + STRIP, rows as u32 * (PANEL + NAME) + TITLE)
    }

    fn draw<DB: Backend>(&self, root: &Area<DB>, style: Style) -> Outcome {
        let (rows, columns) = panel_grid(self.maps.len());
        let rest = titled(root, &format!("{} in 1/sr", self.title), 22.0, TITLE, style)?;
        let (panels, strip) = rest.split_horizontally(px(f64::from(columns as u32 * PANEL), style));
        for (map, area) in self.maps.iter().zip(panels.split_evenly((rows, columns))) {
            draw_map(self, map, &area, style)?;
        }
        draw_strip(self, &strip, style)
    }
}

impl MapPlot {
    /// Place on the scale, in whole steps.
    fn step(&self, value: f64) -> f64 {
        let [low, high] = self.range.map(f64::ln);
        let place = (value.max(self.range[0]).ln() - low) / (high - low);
        (place.clamp(0.0, 1.0) * STEPS).round() / STEPS
    }
}

fn draw_map<DB: Backend>(plot: &MapPlot, map: &DiscMap, area: &Area<DB>, style: Style) -> Outcome {
    let name = format!("{}, view {}°", map.lobe, map.view_angle_deg);
    let disc = titled(area, &name, 16.0, NAME, style)?;
    let mut chart = ChartBuilder::on(&disc)
        .margin(px(6.0, style))
        .build_cartesian_2d(-1.03..1.03, -1.03..1.03)?;
    for row in 0..map.size {
        chart.draw_series(runs(plot, map, row))?;
    }
    let circle = |radius: f64| {
        (0..=120)
            .map(move |i| (f64::from(i) * 3.0_f64).to_radians())
            .map(move |phi| (radius * phi.cos(), radius * phi.sin()))
    };
    // Hides the pixels' corners.
    chart.draw_series(LineSeries::new(circle(1.0), stroke(style.ink, 2.5, style)))?;
    for theta_deg in [30.0_f64, 60.0] {
        let radius = distance_from_centre(theta_deg.to_radians());
        chart.draw_series(LineSeries::new(
            circle(radius),
            WHITE.mix(0.45).stroke_width(px(1.0, style) as u32),
        ))?;
        let label = Text::new(
            format!("{theta_deg}°"),
            (px(3.0, style), px(-14.0, style)),
            font(12.0, style).color(&WHITE),
        );
        chart.draw_series([EmptyElement::at((0.0, -radius)) + label])?;
    }
    let at = distance_from_centre(map.view_angle_deg.to_radians());
    let (mark, ring) = (stroke(WHITE, 1.5, style), stroke(WHITE, 1.5, style));
    chart.draw_series([Circle::new((-at, 0.0), px(5.0, style), ring)])?;
    chart.draw_series([Cross::new((at, 0.0), px(5.0, style), mark)])?;
    Ok(())
}

/// Distance of a direction from the disc's centre.
fn distance_from_centre(theta_rad: f64) -> f64 {
    std::f64::consts::SQRT_2 * (0.5 * theta_rad).sin()
}

/// The rectangles of a row, pixels of one colour taken together.
fn runs(plot: &MapPlot, map: &DiscMap, row: usize) -> Vec<Rectangle<(f64, f64)>> {
    let place = |i: usize| 2.0 * i as f64 / map.size as f64 - 1.0;
    let steps: Vec<Option<f64>> = map.values[row * map.size..(row + 1) * map.size]
        .iter()
        .map(|value| (!value.is_nan()).then(|| plot.step(*value)))
        .collect();
    let mut column = 0;
    let mut rectangles = Vec::new();
    for run in steps.chunk_by(|a, b| a == b) {
        if let Some(step) = run[0] {
            // A little larger than the pixels, so that no seams show.
            let corners = [
                (place(column), -place(row)),
                (place(column + run.len()) + 0.002, -place(row + 1) - 0.002),
            ];
            rectangles.push(Rectangle::new(corners, color(step).filled()));
        }
        column += run.len();
    }
    rectangles
}

/// The scale: a strip of its colours with a number at each decade; what the marks mean.
fn draw_strip<DB: Backend>(plot: &MapPlot, area: &Area<DB>, style: Style) -> Outcome {
    let height = f64::from(area.dim_in_pixel().1) / style.scale;
    let (top, bottom) = (24.0, height - 90.0);
    let at = |x: f64, y: f64| (px(x, style), px(y, style));
    let y_of = |place: f64| bottom + (top - bottom) * place;
    for i in 0..STEPS as usize {
        let (low, high) = (i as f64 / STEPS, (i + 1) as f64 / STEPS);
        area.draw(&Rectangle::new(
            [at(8.0, y_of(high)), at(26.0, y_of(low))],
            color(high).filled(),
        ))?;
    }
    let [low, high] = plot.range.map(f64::log10);
    for decade in low.ceil() as i32..=high.floor() as i32 {
        let y = y_of((f64::from(decade) - low) / (high - low));
        let label = font(13.0, style).pos(Pos::new(HPos::Left, VPos::Center));
        area.draw(&PathElement::new(
            [at(26.0, y), at(31.0, y)],
            stroke(style.ink, 1.0, style),
        ))?;
        area.draw(&Text::new(number(10.0_f64.powi(decade)), at(35.0, y), label))?;
    }
    let [view, mirror] = [height - 48.0, height - 26.0];
    area.draw(&Circle::new(
        at(16.0, view),
        px(5.0, style),
        stroke(style.ink, 1.5, style),
    ))?;
    area.draw(&Cross::new(
        at(16.0, mirror),
        px(5.0, style),
        stroke(style.ink, 1.5, style),
    ))?;
    for (text, y) in [("view", view), ("mirror", mirror)] {
        let label = font(13.0, style).pos(Pos::new(HPos::Left, VPos::Center));
        area.draw(&Text::new(text, at(30.0, y), label))?;
    }
    Ok(())
}
