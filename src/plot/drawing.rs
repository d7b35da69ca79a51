//! A drawing: a list of shapes in points, painted as SVG or as pixels.

use std::{error::Error, io::Cursor, path::Path, path::PathBuf, sync::Once};

use image::RgbImage;
use plotters::prelude::*;
use plotters::{
    coord::Shift,
    element::DashedPathElement,
    style::{
        FontStyle, register_font,
        text_anchor::{HPos, Pos, VPos},
    },
};

/// A place, from the top left.
pub type Point = [f64; 2];

/// Okabe's and Ito's colours, which colour-blind people tell apart.
pub const PALETTE: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(70, 70, 70),
];

pub struct Colors {
    pub paper: RGBColor,
    pub ink: RGBColor,
    pub faint: RGBColor,
    pub shade: RGBColor,
}

static LIGHT: Colors = Colors {
    paper: WHITE,
    ink: RGBColor(50, 50, 55),
    faint: RGBColor(222, 222, 226),
    shade: RGBColor(243, 243, 246),
};
static DARK: Colors = Colors {
    paper: RGBColor(36, 36, 36),
    ink: RGBColor(205, 205, 205),
    faint: RGBColor(74, 74, 74),
    shade: RGBColor(48, 48, 48),
};

/// Heights of a figure's title and of a panel's name.
pub const TITLE: f64 = 50.0;
pub const NAME: f64 = 30.0;

/// Pixels are drawn so much finer and then averaged: plotters' lines have hard edges.
const OVERSAMPLING: f64 = 2.0;

/// Which part of a text its place is.
pub const LEFT: Pos = Pos {
    h_pos: HPos::Left,
    v_pos: VPos::Center,
};
pub const RIGHT: Pos = Pos {
    h_pos: HPos::Right,
    v_pos: VPos::Center,
};
pub const CENTER: Pos = Pos {
    h_pos: HPos::Center,
    v_pos: VPos::Center,
};
pub const TOP: Pos = Pos {
    h_pos: HPos::Center,
    v_pos: VPos::Top,
};

enum Shape {
    Line {
        points: Vec<Point>,
        color: RGBAColor,
        width: f64,
        dash: f64,
    },
    Area {
        points: Vec<Point>,
        color: RGBColor,
    },
    Dots {
        centers: Vec<Point>,
        radius: f64,
        color: RGBAColor,
    },
    Text {
        text: String,
        place: Point,
        size: f64,
        pos: Pos,
        color: RGBColor,
        turn: FontTransform,
    },
    Picture {
        place: Point,
        picture: RgbImage,
    },
}

/// What can be drawn.
pub trait Figure {
    fn drawing(&self, colors: &'static Colors) -> Drawing;
}

pub struct Drawing {
    pub size: Point,
    pub colors: &'static Colors,
    shapes: Vec<Shape>,
}

/// A plot could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("{path}: the plot could not be drawn: {reason}")]
pub struct PlotError {
    path: PathBuf,
    reason: String,
}

/// A figure as the contents of a file: SVG where its name ends so, else PNG.
pub fn plot_file(path: &Path, figure: &impl Figure) -> Result<Vec<u8>, PlotError> {
    let drawing = figure.drawing(&LIGHT);
    let is_svg = path
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("svg"));
    let drawn = if is_svg { drawing.svg() } else { drawing.png() };
    drawn.map_err(|error| PlotError {
        path: path.to_owned(),
        reason: error.to_string(),
    })
}

/// A figure in the window.
pub fn plot_picture(figure: &impl Figure, zoom: f64, is_dark: bool) -> Option<RgbImage> {
    figure.drawing(if is_dark { &DARK } else { &LIGHT }).picture(zoom).ok()
}

impl Drawing {
    pub fn new(size: Point, colors: &'static Colors) -> Self {
        Self {
            size,
            colors,
            shapes: Vec::new(),
        }
    }

    pub fn line(&mut self, points: impl IntoIterator<Item = Point>, color: impl Into<RGBAColor>, width: f64) {
        self.dashed(points, color, width, 0.0);
    }

    /// A line of dashes of this length; without any where it is 0.
    pub fn dashed(
        &mut self,
        points: impl IntoIterator<Item = Point>,
        color: impl Into<RGBAColor>,
        width: f64,
        dash: f64,
    ) {
        let (points, color) = (points.into_iter().collect(), color.into());
        self.shapes.push(Shape::Line {
            points,
            color,
            width,
            dash,
        });
    }

    pub fn area(&mut self, points: impl IntoIterator<Item = Point>, color: RGBColor) {
        self.shapes.push(Shape::Area {
            points: points.into_iter().collect(),
            color,
        });
    }

    pub fn rectangle(&mut self, [left, top]: Point, [right, bottom]: Point, color: RGBColor) {
        self.area([[left, top], [right, top], [right, bottom], [left, bottom]], color);
    }

    pub fn dots(&mut self, centers: Vec<Point>, radius: f64, color: impl Into<RGBAColor>) {
        self.shapes.push(Shape::Dots {
            centers,
            radius,
            color: color.into(),
        });
    }

    pub fn text(&mut self, text: impl Into<String>, place: Point, size: f64, pos: Pos) {
        self.text_in(self.colors.ink, text, place, size, pos);
    }

    pub fn text_in(&mut self, color: RGBColor, text: impl Into<String>, place: Point, size: f64, pos: Pos) {
        let (text, turn) = (text.into(), FontTransform::None);
        self.shapes.push(Shape::Text {
            text,
            place,
            size,
            pos,
            color,
            turn,
        });
    }

    /// A text that is read upwards.
    pub fn upright_text(&mut self, text: &str, place: Point, size: f64) {
        let (text, color, turn) = (text.to_owned(), self.colors.ink, FontTransform::Rotate270);
        self.shapes.push(Shape::Text {
            text,
            place,
            size,
            pos: CENTER,
            color,
            turn,
        });
    }

    pub fn picture_at(&mut self, place: Point, picture: &RgbImage) {
        self.shapes.push(Shape::Picture {
            place,
            picture: picture.clone(),
        });
    }

    fn svg(&self) -> Result<Vec<u8>, Box<dyn Error>> {
        let mut text = String::new();
        let [width, height] = self.size.map(|side| side as u32);
        self.paint(
            SVGBackend::with_string(&mut text, (width, height)).into_drawing_area(),
            1.0,
        )?;
        Ok(text.into_bytes())
    }

    fn png(&self) -> Result<Vec<u8>, Box<dyn Error>> {
        let mut file = Cursor::new(Vec::new());
        self.picture(1.0)?.write_to(&mut file, image::ImageFormat::Png)?;
        Ok(file.into_inner())
    }

    fn picture(&self, zoom: f64) -> Result<RgbImage, Box<dyn Error>> {
        let pixels = |scale: f64| self.size.map(|side| (side * scale).round() as u32);
        let scale = zoom * OVERSAMPLING;
        let [width, height] = pixels(scale);
        let mut picture = RgbImage::new(width, height);
        self.paint(
            BitMapBackend::with_buffer(&mut picture, (width, height)).into_drawing_area(),
            scale,
        )?;
        let [width, height] = pixels(zoom);
        Ok(image::imageops::resize(
            &picture,
            width,
            height,
            image::imageops::FilterType::Triangle,
        ))
    }

    fn paint<DB>(&self, paper: DrawingArea<DB, Shift>, scale: f64) -> Result<(), Box<dyn Error>>
    where
        DB: DrawingBackend<ErrorType: 'static>,
    {
        register_fonts();
        let px = |length: f64| (length * scale).round() as i32;
        let at = |[x, y]: &Point| (px(*x), px(*y));
        let all = |points: &[Point]| points.iter().map(at).collect::<Vec<_>>();
        paper.fill(&self.colors.paper)?;
        for shape in &self.shapes {
            match shape {
                Shape::Line {
                    points,
                    color,
                    width,
                    dash,
                } => {
                    let stroke = color.stroke_width(px(*width).max(1) as u32);
                    match *dash {
                        0.0 => paper.draw(&PathElement::new(all(points), stroke))?,
                        dash => paper.draw(&DashedPathElement::new(all(points), px(dash), px(dash), stroke))?,
                    }
                }
                Shape::Area { points, color } => paper.draw(&Polygon::new(all(points), color.filled()))?,
                Shape::Dots { centers, radius, color } => {
                    for center in centers {
                        paper.draw(&Circle::new(at(center), px(*radius), color.filled()))?;
                    }
                }
                Shape::Text {
                    text,
                    place,
                    size,
                    pos,
                    color,
                    turn,
                } => {
                    let font = ("sans-serif", size * scale).into_font().transform(turn.clone());
                    let style = TextStyle::from(font).color(color).pos(*pos);
                    paper.draw(&Text::new(text.as_str(), at(place), style))?;
                }
                Shape::Picture { place, picture } => {
                    let [width, height] =
                        [picture.width(), picture.height()].map(|side| px(f64::from(side)).max(1) as u32);
                    let filter = image::imageops::FilterType::Nearest;
                    let pixels = image::imageops::resize(picture, width, height, filter).into_raw();
                    if let Some(bitmap) = BitMapElement::with_owned_buffer(at(place), (width, height), pixels) {
                        paper.draw(&bitmap)?;
                    }
                }
            }
        }
        Ok(paper.present()?)
    }
}

/// A circle around a place.
pub fn circle([x, y]: Point, radius: f64) -> impl Iterator<Item = Point> {
    let angles = (0..=120).map(|i| (f64::from(i) * 3.0).to_radians());
    angles.map(move |phi_rad| [x + radius * phi_rad.cos(), y + radius * phi_rad.sin()])
}

/// A drawing with a title over so many panels of a size, each below room for its name, and the panels' corners.
pub fn paneled(title: &str, count: usize, [width, height]: Point, colors: &'static Colors) -> (Drawing, Vec<Point>) {
    let columns = match count {
        0..=3 => count.max(1),
        4 => 2,
        _ => 3,
    };
    let [across, down] = [columns, count.div_ceil(columns)].map(|count| count as f64);
    let height = height + NAME;
    let mut drawing = Drawing::new([width * across, TITLE + height * down], colors);
    drawing.text(title, [0.5 * drawing.size[0], 0.5 * TITLE], 22.0, CENTER);
    let corner = |index: usize| {
        [
            width * (index % columns) as f64,
            TITLE + height * (index / columns) as f64,
        ]
    };
    (drawing, (0..count).map(corner).collect())
}

/// Plotters knows no font of its own.
fn register_fonts() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let _ = register_font("sans-serif", FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT);
    });
}
