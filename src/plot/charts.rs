//! Charts of studies: points with names, and bars.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::figure::{
    Area, Backend, Figure, Outcome, PALETTE, Style, TITLE, font, number, px, round_step, stroke, titled,
};
use super::lines::{LETTER, framed};
use crate::plot::lobe_view::Axis;

/// Points with names, the best of them joined by a line.
#[derive(Clone, Debug, PartialEq)]
pub struct PointPlot {
    pub title: String,
    pub x: Axis,
    pub y: Axis,
    /// The points.
    pub points: Vec<NamedPoint>,
}

/// A point of a [`PointPlot`].
#[derive(Clone, Debug, PartialEq)]
pub struct NamedPoint {
    /// What stands beside it.
    pub name: String,
    pub place: [f64; 2],
    /// How far y may be off: lower and upper end.
    pub y_range: [f64; 2],
    /// Whether it is one of the best.
    pub is_best: bool,
}

/// Bars beside names.
#[derive(Clone, Debug, PartialEq)]
pub struct BarPlot {
    pub title: String,
    /// What the bars' lengths mean, with the unit.
    pub label: String,
    /// The names with their values.
    pub bars: Vec<(String, f64)>,
}

/// Width and height of a chart of points.
const POINTS_SIZE: (u32, u32) = (900, 580);
/// Height of a point's name, and what it needs besides its letters.
const NAME_HEIGHT: f64 = 18.0;
const NAME_MARGIN: f64 = 40.0;
/// Width of bars and of their names, height of a bar, and of what lies between names.
const BARS_WIDTH: u32 = 900;
const NAMES_WIDTH: f64 = 230.0;
const BAR_HEIGHT: f64 = 14.0;
const BAR_GAP: f64 = 8.0;
/// Room at the right for the longest bar's number.
const NUMBERS_WIDTH: f64 = 90.0;

impl Figure for PointPlot {
    fn size(&self) -> (u32, u32) {
        POINTS_SIZE
    }

    fn draw<DB: Backend>(&self, root: &Area<DB>, style: Style) -> Outcome {
        let longest = self.points.iter().map(|point| point.name.chars().count()).max();
        let names_width = NAME_MARGIN + LETTER * longest.unwrap_or(0) as f64;
        let mut chart = framed(root, &self.title, [&self.x, &self.y], [76.0, names_width], style)?;
        let at = |point: &NamedPoint, y: f64| (point.place[0], y);
        let mut best: Vec<_> = self.points.iter().filter(|point| point.is_best).collect();
        best.sort_by(|a, b| a.place[0].total_cmp(&b.place[0]));
        let front = best.iter().map(|point| at(point, point.place[1]));
        chart.draw_series(LineSeries::new(front, stroke(PALETTE[0], 1.5, style)))?;
        for point in &self.points {
            let color = point.color();
            let ends = point.y_range.map(|y| at(point, y));
            chart.draw_series([PathElement::new(ends.to_vec(), stroke(color, 1.0, style))])?;
            let center = at(point, point.place[1]);
            chart.draw_series([Circle::new(center, px(4.0, style), color.filled())])?;
        }
        let place_px = |point: &NamedPoint| chart.backend_coord(&at(point, point.place[1]));
        let places: Vec<_> = self.points.iter().map(place_px).collect();
        let (across, down) = chart.plotting_area().get_pixel_range();
        self.draw_names(root, &places, [across.end, down.end], style)
    }
}

impl NamedPoint {
    fn color(&self) -> RGBColor {
        if self.is_best { PALETTE[0] } else { PALETTE[6] }
    }
}

impl PointPlot {
    /// The names in a column beside the plot, each joined to its point: points may lie on top of each other.
    fn draw_names<DB: Backend>(
        &self,
        root: &Area<DB>,
        places: &[(i32, i32)],
        [right, bottom]: [i32; 2],
        style: Style,
    ) -> Outcome {
        let mut order: Vec<usize> = (0..places.len()).collect();
        // Of points at the same height the leftmost has its name on top, so that no two lines cross.
        order.sort_by_key(|&index| (places[index].1, places[index].0));
        let heights: Vec<i32> = order.iter().map(|&index| places[index].1).collect();
        let heights = spread(&heights, px(NAME_HEIGHT, style), bottom);
        let label = font(13.0, style).pos(Pos::new(HPos::Left, VPos::Center));
        for (index, height) in order.into_iter().zip(heights) {
            let point = &self.points[index];
            let ends = [places[index], (right + px(14.0, style), height)];
            root.draw(&PathElement::new(
                ends,
                point.color().mix(0.35).stroke_width(px(1.0, style).max(1) as u32),
            ))?;
            let color = &point.color();
            root.draw(&Text::new(
                point.name.clone(),
                (right + px(18.0, style), height),
                label.color(color),
            ))?;
        }
        Ok(())
    }
}

/// Heights in ascending order moved so that each is `gap` below the one before, none below `bottom`.
fn spread(heights: &[i32], gap: i32, bottom: i32) -> Vec<i32> {
    let mut spread = heights.to_vec();
    for index in 1..spread.len() {
        spread[index] = spread[index].max(spread[index - 1] + gap);
    }
    let mut lowest = bottom;
    for height in spread.iter_mut().rev() {
        *height = (*height).min(lowest);
        lowest = *height - gap;
    }
    spread
}

impl BarPlot {
    fn bottom(&self) -> f64 {
        (BAR_HEIGHT + BAR_GAP) * self.bars.len() as f64
    }

    /// The largest and the smallest value, 0 at least among them.
    fn reach(&self) -> [f64; 2] {
        let values = self.bars.iter().map(|(_, value)| *value).filter(|x| x.is_finite());
        let reach = values.fold([0.0_f64; 2], |[low, high], x| [low.min(x), high.max(x)]);
        if reach == [0.0; 2] { [0.0, 1.0] } else { reach }
    }
}

impl Figure for BarPlot {
    fn size(&self) -> (u32, u32) {
        (BARS_WIDTH, TITLE + self.bottom() as u32 + 40)
    }

    fn draw<DB: Backend>(&self, root: &Area<DB>, style: Style) -> Outcome {
        let area = titled(root, &self.title, 22.0, TITLE, style)?;
        let [low, high] = self.reach();
        let width = f64::from(BARS_WIDTH) - NAMES_WIDTH - NUMBERS_WIDTH;
        let across = |value: f64| NAMES_WIDTH + width * (value - low) / (high - low);
        let bottom = self.bottom();
        let at = |x: f64, y: f64| (px(x, style), px(y, style));
        let step = round_step(high - low, 6.0);
        let marks = (0..=12)
            .map(|i| (low / step).ceil() * step + step * f64::from(i))
            .take_while(|x| *x <= high);
        for mark in marks {
            let line = [at(across(mark), 0.0), at(across(mark), bottom)];
            area.draw(&PathElement::new(line, stroke(style.faint, 1.0, style)))?;
            let label = font(13.0, style).pos(Pos::new(HPos::Center, VPos::Top));
            area.draw(&Text::new(number(mark), at(across(mark), bottom + 2.0), label))?;
        }
        for (row, (name, value)) in self.bars.iter().enumerate() {
            let middle = (row as f64 + 0.5) * (BAR_HEIGHT + BAR_GAP);
            let label = font(14.0, style).pos(Pos::new(HPos::Right, VPos::Center));
            area.draw(&Text::new(name.clone(), at(NAMES_WIDTH - 8.0, middle), label))?;
            if value.is_finite() {
                let ends = [across(value.min(0.0)), across(value.max(0.0))];
                let half = 0.5 * BAR_HEIGHT - 1.0;
                let bar = [at(ends[0], middle - half), at(ends[1], middle + half)];
                area.draw(&Rectangle::new(bar, PALETTE[0].filled()))?;
                let label = font(12.0, style).pos(Pos::new(HPos::Left, VPos::Center));
                area.draw(&Text::new(three_digits(*value), at(ends[1] + 5.0, middle), label))?;
            }
        }
        let label = font(14.0, style).pos(Pos::new(HPos::Left, VPos::Center));
        area.draw(&Text::new(self.label.clone(), at(NAMES_WIDTH, bottom + 26.0), label))?;
        Ok(())
    }
}

/// A number with three digits.
fn three_digits(value: f64) -> String {
    let size = value.abs();
    let decimals = if size > 0.0 {
        (2.0 - size.log10().floor()).clamp(0.0, 6.0) as usize
    } else {
        0
    };
    format!("{value:.decimals$}")
}

/// Images in rows, each with its name under it.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureSheet {
    pub title: String,
    /// Images of the same size, red, green and blue of 8 bits a pixel.
    pub pictures: Vec<(String, image::RgbImage)>,
}

/// Images in a row.
const PICTURES_ACROSS: u32 = 4;
const MARGIN: u32 = 12;
const CAPTION: u32 = 26;
/// Width below which captions overlap.
const PICTURE_WIDTH_MIN: u32 = 190;

impl PictureSheet {
    /// Width and height of an image's place.
    fn cell(&self) -> (u32, u32) {
        let size = self
            .pictures
            .first()
            .map_or((1, 1), |(_, picture)| picture.dimensions());
        (size.0.max(PICTURE_WIDTH_MIN) + MARGIN, size.1 + CAPTION + MARGIN)
    }
}

impl Figure for PictureSheet {
    fn size(&self) -> (u32, u32) {
        let count = self.pictures.len().max(1) as u32;
        let (width, height) = self.cell();
        let across = count.min(PICTURES_ACROSS);
        (
            width * across + MARGIN,
            TITLE + height * count.div_ceil(PICTURES_ACROSS),
        )
    }

    fn draw<DB: Backend>(&self, root: &Area<DB>, style: Style) -> Outcome {
        let area = titled(root, &self.title, 20.0, TITLE, style)?;
        let (width, height) = self.cell();
        for (index, (name, picture)) in (0..).zip(&self.pictures) {
            let corner = [
                MARGIN + index % PICTURES_ACROSS * width,
                index / PICTURES_ACROSS * height,
            ];
            let [x, y] = corner.map(|length| px(f64::from(length), style));
            let size = [picture.width(), picture.height()].map(|side| px(f64::from(side), style).max(1) as u32);
            let filter = image::imageops::FilterType::Nearest;
            let drawn = image::imageops::resize(picture, size[0], size[1], filter);
            if let Some(bitmap) = BitMapElement::with_owned_buffer((x, y), (size[0], size[1]), drawn.into_raw()) {
                area.draw(&bitmap)?;
            }
            let label = font(14.0, style).pos(Pos::new(HPos::Left, VPos::Top));
            area.draw(&Text::new(
                name.clone(),
                (x, y + size[1] as i32 + px(3.0, style)),
                label,
            ))?;
        }
        Ok(())
    }
}
