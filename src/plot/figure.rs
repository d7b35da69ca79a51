//! What all figures share: files, fonts, colours.

use std::error::Error;
use std::io::Cursor;
use std::path::Path;

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::{PlotError, register_fonts};

/// What figures are drawn on.
pub(super) trait Backend: DrawingBackend<ErrorType: 'static> {}

impl<DB: DrawingBackend<ErrorType: 'static>> Backend for DB {}

pub(super) type Area<DB> = DrawingArea<DB, plotters::coord::Shift>;

/// What drawing may fail with.
pub(super) type Outcome = Result<(), Box<dyn Error>>;

/// Colours of lines and bodies, distinguished by people of any colour vision (Okabe and Ito 2008).
pub(super) const PALETTE: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(70, 70, 70),
];
/// What a figure is drawn with.
#[derive(Clone, Copy)]
pub(super) struct Style {
    /// Pixels that a length of 1 takes.
    pub(super) scale: f64,
    /// Behind everything.
    pub(super) paper: RGBColor,
    /// Text and axes.
    pub(super) ink: RGBColor,
    /// Lines to read values by.
    pub(super) faint: RGBColor,
    /// Areas that stand out from the paper a little.
    pub(super) shade: RGBColor,
}

impl Style {
    /// Dark on white.
    pub(super) fn light(scale: f64) -> Self {
        Self {
            scale,
            paper: WHITE,
            ink: RGBColor(50, 50, 55),
            faint: RGBColor(222, 222, 226),
            shade: RGBColor(243, 243, 246),
        }
    }

    /// Light on the dark window's grey.
    pub(super) fn dark(scale: f64) -> Self {
        Self {
            scale,
            paper: RGBColor(36, 36, 36),
            ink: RGBColor(205, 205, 205),
            faint: RGBColor(74, 74, 74),
            shade: RGBColor(48, 48, 48),
        }
    }
}

/// Heights of a figure's title and of a panel's name, pixels.
pub(super) const TITLE: u32 = 50;
pub(super) const NAME: u32 = 30;

/// Images are drawn at this many times their size and then reduced: plotters smooths no edges itself.
const OVERSAMPLING: u32 = 2;

/// A figure that can be drawn at any scale.
pub(super) trait Figure {
    /// Width and height in pixels.
    fn size(&self) -> (u32, u32);
    /// Draws it, every length `style.scale` times as large.
    fn draw<DB: Backend>(&self, root: &Area<DB>, style: Style) -> Outcome;
}

/// The contents of a figure's file: .svg, or else .png.
pub(super) fn contents(path: &Path, figure: &impl Figure) -> Result<Vec<u8>, PlotError> {
    register_fonts();
    let is_svg = path
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("svg"));
    let drawn = match is_svg {
        true => svg(figure),
        false => picture(figure, Style::light(1.0)).and_then(|picture| png(&picture)),
    };
    drawn.map_err(|error| PlotError::of(path, &*error))
}

fn svg(figure: &impl Figure) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, figure.size()).into_drawing_area();
        draw_on_paper(&root, figure, Style::light(1.0))?;
    }
    Ok(text.into_bytes())
}

/// An image as a file has it.
pub(super) fn png(picture: &image::RgbImage) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut file = Cursor::new(Vec::new());
    picture.write_to(&mut file, image::ImageFormat::Png)?;
    Ok(file.into_inner())
}

/// A figure as pixels.
pub(super) fn picture(figure: &impl Figure, style: Style) -> Result<image::RgbImage, Box<dyn Error>> {
    register_fonts();
    let size_px = |length: u32, scale: f64| (f64::from(length) * scale).round() as u32;
    let (width, height) = figure.size();
    let large_scale = style.scale * f64::from(OVERSAMPLING);
    let large = (size_px(width, large_scale), size_px(height, large_scale));
    let large_style = Style {
        scale: large_scale,
        ..style
    };
    let picture = drawn(large, |root| draw_on_paper(root, figure, large_style))?;
    let (width, height) = (size_px(width, style.scale), size_px(height, style.scale));
    Ok(image::imageops::resize(
        &picture,
        width,
        height,
        image::imageops::FilterType::Triangle,
    ))
}

/// What is drawn on so many columns and rows of black.
pub(super) fn drawn(
    size: (u32, u32),
    draw: impl FnOnce(&Area<BitMapBackend<'_>>) -> Outcome,
) -> Result<image::RgbImage, Box<dyn Error>> {
    let mut picture = image::RgbImage::new(size.0, size.1);
    let root = BitMapBackend::with_buffer(&mut picture, size).into_drawing_area();
    draw(&root)?;
    drop(root);
    Ok(picture)
}

fn draw_on_paper<DB: Backend>(root: &Area<DB>, figure: &impl Figure, style: Style) -> Outcome {
    root.fill(&style.paper)?;
    figure.draw(root, style)?;
    Ok(root.present()?)
}

/// A length in pixels at a scale.
pub(super) fn px(length: f64, style: Style) -> i32 {
    (length * style.scale).round() as i32
}

/// The font at a size in pixels.
pub(super) fn font(size: f64, style: Style) -> TextStyle<'static> {
    let mut text = TextStyle::from(("sans-serif", size * style.scale).into_font());
    text.color = style.ink.to_backend_color();
    text
}

/// A line of a colour.
pub(super) fn stroke(color: RGBColor, width: f64, style: Style) -> ShapeStyle {
    color.stroke_width((width * style.scale).round().max(1.0) as u32)
}

/// Writes a title of a size over an area, centred in `height`, and returns what is left below. Lengths in pixels.
pub(super) fn titled<DB: Backend>(
    area: &Area<DB>,
    title: &str,
    size: f64,
    height: u32,
    style: Style,
) -> Result<Area<DB>, Box<dyn Error>> {
    let (top, rest) = area.split_vertically(px(f64::from(height), style));
    let (width, height) = top.dim_in_pixel();
    let centred = font(size, style).pos(Pos::new(HPos::Center, VPos::Center));
    top.draw(&Text::new(
        title.to_owned(),
        (width as i32 / 2, height as i32 / 2),
        centred,
    ))?;
    Ok(rest)
}

/// Rows and columns that panels side by side take.
pub(super) fn panel_grid(count: usize) -> (usize, usize) {
    let columns = match count {
        0..=3 => count.max(1),
        4 => 2,
        _ => 3,
    };
    (count.div_ceil(columns), columns)
}

/// A round number not below `value`/`parts`: 1, 2 or 5 times a power of ten.
pub(super) fn round_step(value: f64, parts: f64) -> f64 {
    let rough = value / parts;
    let power = 10.0_f64.powf(rough.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0];
    power
        * steps
            .into_iter()
            .find(|step| step * power >= rough * 0.999)
            .unwrap_or(10.0)
}

/// A number as people write it: as many digits as it needs.
pub(crate) fn number(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-3..1e5).contains(&size) {
        let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
        return format!("{rounded:e}");
    }
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
