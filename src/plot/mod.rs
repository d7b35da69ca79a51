//! Charts as values, and as files: PNG and SVG by plotters, with the fonts that the window uses.

mod charts;
mod figure;
mod lines;
pub mod lobe_view;
mod maps;
mod scale;
mod solids;

pub use charts::{BarPlot, NamedPoint, PictureSheet, PointPlot};
pub(crate) use figure::number;
pub use maps::scale_color;

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Once;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};

use figure::Style;
use lobe_view::{LinePlot, LobeView};

use crate::job::scatter::{ScatterCloud, ScatterRequest};
use crate::optics::vector::Vec3;

/// A plot that can't be drawn.
#[derive(Debug, thiserror::Error)]
#[error("{}: the plot could not be drawn: {reason}", path.display())]
pub struct PlotError {
    path: PathBuf,
    reason: String,
}

impl PlotError {
    fn of(path: &Path, error: &dyn std::error::Error) -> Self {
        Self {
            path: path.to_owned(),
            reason: error.to_string(),
        }
    }
}

/// Makes the font known under the name that plots use. plotters without system fonts has none of its own.
fn register_fonts() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // Fails only for broken font data; labels are left out then.
        let _ = register_font("sans-serif", FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT);
    });
}

/// Colour of the lines of a group in sRGB: the same in files and in the window.
pub fn series_color(group: usize) -> [u8; 3] {
    let RGBColor(r, g, b) = figure::PALETTE[group % figure::PALETTE.len()];
    [r, g, b]
}

/// The contents of a view's file: .svg, or else .png.
pub fn lobe_view_file(path: &Path, view: &LobeView) -> Result<Vec<u8>, PlotError> {
    match view {
        LobeView::Lines(plot) => line_plot_file(path, plot),
        LobeView::Maps(plot) => figure::contents(path, plot),
        LobeView::Solids(plot) => figure::contents(path, plot),
    }
}

/// A view of lobes as an image for the screen: every length `zoom` times as large as in a file, dark on white or
/// light on a dark grey. `None` where the figure can't be drawn.
pub fn lobe_view_picture(view: &LobeView, zoom: f64, is_dark: bool) -> Option<image::RgbImage> {
    let style = if is_dark { Style::dark(zoom) } else { Style::light(zoom) };
    let drawn = match view {
        LobeView::Lines(plot) => figure::picture(plot, style),
        LobeView::Maps(plot) => figure::picture(plot, style),
        LobeView::Solids(plot) => figure::picture(plot, style),
    };
    drawn.ok()
}

/// A line plot as the contents of a file: .svg, or else .png.
pub fn line_plot_file(path: &Path, plot: &LinePlot) -> Result<Vec<u8>, PlotError> {
    figure::contents(path, plot)
}

/// Points with names as the contents of a file: .svg, or else .png.
pub fn point_plot_file(path: &Path, plot: &PointPlot) -> Result<Vec<u8>, PlotError> {
    figure::contents(path, plot)
}

/// Bars as the contents of a file: .svg, or else .png.
pub fn bar_plot_file(path: &Path, plot: &BarPlot) -> Result<Vec<u8>, PlotError> {
    figure::contents(path, plot)
}

/// Images in rows as .png, into a file that is open.
pub fn write_picture_sheet(file: &mut (impl io::Write + io::Seek), sheet: &PictureSheet) -> io::Result<()> {
    let picture = figure::picture(sheet, Style::light(1.0)).map_err(|error| io::Error::other(error.to_string()))?;
    picture
        .write_to(file, image::ImageFormat::Png)
        .map_err(io::Error::other)
}

/// The samples seen from the lobe's middle, as in the paper's Fig. 1: the plane's horizontal axis lies in the plane of
/// incidence (to the right: away from the normal), the circle has the radius of the lobe's roughness.
pub fn scatter_png(path: &Path, request: &ScatterRequest, cloud: &ScatterCloud) -> Result<Vec<u8>, PlotError> {
    register_fonts();
    let picture = figure::drawn((800, 810), |root| draw_scatter(root, request, cloud));
    let drawn = picture.and_then(|picture| figure::png(&picture));
    drawn.map_err(|error| PlotError::of(path, &*error))
}

fn draw_scatter(
    root: &DrawingArea<BitMapBackend<'_>, Shift>,
    request: &ScatterRequest,
    cloud: &ScatterCloud,
) -> figure::Outcome {
    // The lobe's middle and the axis across it that points away from the normal on its side; the other one is y.
    let [x, _, z] = request.middle().to_f32();
    let across: Vec3<f32> = Vec3::from_f32([z.abs(), 0.0, -x * z.signum()]);
    let points = cloud
        .samples
        .iter()
        .map(|&[x, y, z, _]| (across.dot(Vec3::from_f32([x, y, z])), y));
    let reach = points.clone().map(|(x, y)| x.abs().max(y.abs())).fold(0.01, f32::max) * 1.05;
    root.fill(&WHITE)?;
    let model = &request.model;
    let mut lobe = model.lobe.label().to_owned();
    if model.lobe.has_curves() {
        lobe += &format!(", {}", model.curve.label().to_lowercase());
    }
    let refracted = if model.eta == 0.0 {
        String::new()
    } else {
        format!(", index {}", model.eta)
    };
    let caption = format!(
        "{lobe}, roughness {}, view {}°{refracted}",
        model.roughness, request.view_angle_deg
    );
    let mut chart = ChartBuilder::on(root)
        .caption(caption, ("sans-serif", 26))
        .margin(14)
        .x_label_area_size(34)
        .y_label_area_size(54)
        .build_cartesian_2d(-reach..reach, -reach..reach)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .label_style(("sans-serif", 16))
        .draw()?;
    // Fainter the more there are, so that the density shows.
    let opacity = (4000.0 / cloud.samples.len().max(1) as f64).clamp(0.04, 0.8);
    let dot = RGBColor(20, 90, 170).mix(opacity).filled();
    chart.draw_series(points.map(|point| Circle::new(point, 1, dot)))?;
    if model.lobe.has_curves() {
        let roughness = model.roughness as f32;
        let circle = (0..=180).map(|i| (i as f32 * 2.0).to_radians());
        let circle = circle.map(|phi_rad| (roughness * phi_rad.cos(), roughness * phi_rad.sin()));
        chart.draw_series(LineSeries::new(circle, RGBColor(220, 90, 30).mix(0.7)))?;
    }
    root.present()?;
    Ok(())
}
