//! Charts of studies, of pictures and of samples.

use image::RgbImage;
use plotters::style::{Color, RGBColor};

use super::{
    axes::short,
    drawing::{Colors, Drawing, Figure, LEFT, PALETTE, Point, RIGHT, TITLE, circle},
    lines::LETTER,
    lobe_view::Axis,
};
use crate::job::scatter::{ScatterCloud, ScatterRequest};
use crate::optics::vector::Vec3;

/// Points with names, such as techniques by time and bias.
#[derive(Clone, Debug, PartialEq)]
pub struct PointPlot {
    pub title: String,
    pub x: Axis,
    pub y: Axis,
    pub points: Vec<NamedPoint>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct NamedPoint {
    pub name: String,
    pub place: [f64; 2],
    /// The band of its second coordinate.
    pub y_range: [f64; 2],
    /// On the line that joins the best ones.
    pub is_best: bool,
}

/// Bars that begin at 0.
#[derive(Clone, Debug, PartialEq)]
pub struct BarPlot {
    pub title: String,
    pub label: String,
    pub bars: Vec<(String, f64)>,
}

/// Distance of names that would be over each other.
const NAME_HEIGHT: f64 = 18.0;
const BAR_HEIGHT: f64 = 22.0;

impl Figure for PointPlot {
    fn drawing(&self, colors: &'static Colors) -> Drawing {
        let mut drawing = Drawing::new([900.0, 580.0], colors);
        let longest = self.points.iter().map(|point| point.name.chars().count()).max();
        let [right, bottom] = [860.0 - LETTER * longest.unwrap_or(0) as f64, 518.0];
        let corners = [[92.0, 52.0], [right, bottom]];
        let frame = drawing.framed(&self.title, [&self.x, &self.y], [10.0, 8.0], corners);
        let mut best: Vec<_> = self.points.iter().filter(|point| point.is_best).collect();
        best.sort_by(|a, b| a.place[0].total_cmp(&b.place[0]));
        drawing.line(best.iter().map(|point| frame.at(point.place)), PALETTE[0], 1.5);
        let mut points: Vec<_> = self.points.iter().map(|point| (frame.at(point.place), point)).collect();
        points.sort_by(|([ax, ay], _), ([bx, by], _)| ay.total_cmp(by).then(ax.total_cmp(bx)));
        let heights: Vec<f64> = points.iter().map(|([_, y], _)| *y).collect();
        for (([x, y], point), height) in points.into_iter().zip(spread(heights, NAME_HEIGHT, bottom)) {
            let color = if point.is_best { PALETTE[0] } else { PALETTE[6] };
            drawing.line(point.y_range.map(|y| frame.at([point.place[0], y])), color, 1.0);
            drawing.dots(vec![[x, y]], 4.0, color);
            drawing.line([[x, y], [right + 14.0, height]], color.mix(0.35), 1.0);
            drawing.text_in(color, point.name.as_str(), [right + 18.0, height], 13.0, LEFT);
        }
        drawing
    }
}

/// Rising heights, moved apart and up where they would be too near or too low.
fn spread(mut heights: Vec<f64>, gap: f64, bottom: f64) -> Vec<f64> {
    for index in 1..heights.len() {
        heights[index] = heights[index].max(heights[index - 1] + gap);
    }
    let mut lowest = bottom;
    for height in heights.iter_mut().rev() {
        *height = height.min(lowest);
        lowest = *height - gap;
    }
    heights
}

impl Figure for BarPlot {
    fn drawing(&self, colors: &'static Colors) -> Drawing {
        let count = self.bars.len() as f64;
        let bottom = TITLE + BAR_HEIGHT * count;
        let mut drawing = Drawing::new([900.0, bottom + 54.0], colors);
        let values = self.bars.iter().map(|(_, value)| *value).filter(|x| x.is_finite());
        let [low, high] = values.fold([0.0_f64; 2], |[low, high], x| [low.min(x), high.max(x)]);
        let high = if low == high { 1.0 } else { high };
        let axes = [&Axis::linear(&self.label, [low, high]), &Axis::linear("", [count, 0.0])];
        let frame = drawing.framed(&self.title, axes, [6.0, 0.0], [[230.0, TITLE], [810.0, bottom]]);
        for (row, (name, value)) in (0..).zip(&self.bars) {
            let y = TITLE + BAR_HEIGHT * (f64::from(row) + 0.5);
            drawing.text(name.as_str(), [222.0, y], 14.0, RIGHT);
            if value.is_finite() {
                let [start, end] = [value.min(0.0), value.max(0.0)].map(|value| frame.at([value, 0.0])[0]);
                drawing.rectangle([start, y - 6.0], [end, y + 6.0], PALETTE[0]);
                drawing.text(short(*value), [end + 5.0, y], 12.0, LEFT);
            }
        }
        drawing
    }
}

/// Pictures of one size with their names.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureSheet {
    pub title: String,
    pub pictures: Vec<(String, RgbImage)>,
}

const PICTURES_ACROSS: usize = 4;
const MARGIN: f64 = 12.0;
/// A caption needs so much.
const PICTURE_WIDTH_MIN: u32 = 190;

impl Figure for PictureSheet {
    fn drawing(&self, colors: &'static Colors) -> Drawing {
        let (width, height) = self
            .pictures
            .first()
            .map_or((1, 1), |(_, picture)| picture.dimensions());
        let [width, height] = [
            f64::from(width.max(PICTURE_WIDTH_MIN)) + MARGIN,
            f64::from(height) + 26.0 + MARGIN,
        ];
        let count = self.pictures.len().max(1);
        let [across, down] = [count.min(PICTURES_ACROSS), count.div_ceil(PICTURES_ACROSS)].map(|count| count as f64);
        let mut drawing = Drawing::new([width * across + MARGIN, TITLE + height * down], colors);
        drawing.text(
            self.title.as_str(),
            [0.5 * drawing.size[0], 0.5 * TITLE],
            20.0,
            super::drawing::CENTER,
        );
        for (index, (name, picture)) in self.pictures.iter().enumerate() {
            let [column, row] = [index % PICTURES_ACROSS, index / PICTURES_ACROSS].map(|i| i as f64);
            let [x, y] = [MARGIN + column * width, TITLE + row * height];
            drawing.picture_at([x, y], picture);
            drawing.text(
                elided(name, width - MARGIN),
                [x, y + f64::from(picture.height()) + 11.0],
                14.0,
                LEFT,
            );
        }
        drawing
    }
}

/// A caption that fits into so many pixels: names of a batch differ at both ends.
fn elided(name: &str, width: f64) -> String {
    const OF_A_LETTER: f64 = 7.5;
    let (letters, most): (Vec<char>, _) = (name.chars().collect(), (width / OF_A_LETTER) as usize);
    if letters.len() <= most {
        return name.to_owned();
    }
    let end = most / 2;
    let part = |letters: &[char]| letters.iter().collect::<String>();
    part(&letters[..most - end - 1]) + "…" + &part(&letters[letters.len() - end..])
}

/// Samples of a lobe, seen against their middle.
pub struct ScatterPlot<'a> {
    pub request: &'a ScatterRequest,
    pub cloud: &'a ScatterCloud,
}

impl Figure for ScatterPlot<'_> {
    fn drawing(&self, colors: &'static Colors) -> Drawing {
        let [x, _, z] = self.request.middle().to_f32();
        let across: Vec3<f32> = Vec3::from_f32([z.abs(), 0.0, -x * z.signum()]);
        let samples = self.cloud.samples.iter();
        let points = samples.map(|&[x, y, z, _]| [across.dot(Vec3::from_f32([x, y, z])), y].map(f64::from));
        let reach = points.clone().map(|[x, y]| x.abs().max(y.abs())).fold(0.01, f64::max) * 1.05;
        let model = &self.request.model;
        let mut title = model.lobe.label().to_owned();
        if model.lobe.has_curves() {
            title += &format!(", {}", model.curve.label().to_lowercase());
        }
        title += &format!(", roughness {}, view {}°", model.roughness, self.request.view_angle_deg);
        if model.eta != 0.0 {
            title += &format!(", index {}", model.eta);
        }
        let mut drawing = Drawing::new([800.0, 810.0], colors);
        let axis = Axis::linear("", [-reach, reach]);
        let frame = drawing.framed(&title, [&axis, &axis], [10.0, 10.0], [[68.0, 50.0], [786.0, 762.0]]);
        let opacity = (4000.0 / self.cloud.samples.len().max(1) as f64).clamp(0.04, 0.8);
        let places: Vec<Point> = points.map(|point| frame.at(point)).collect();
        drawing.dots(places, 1.0, RGBColor(20, 90, 170).mix(opacity));
        if model.lobe.has_curves() {
            let ends = circle([0.0; 2], model.roughness).map(|place| frame.at(place));
            drawing.line(ends, RGBColor(220, 90, 30).mix(0.7), 1.0);
        }
        drawing
    }
}
