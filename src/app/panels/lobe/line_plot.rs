//! Line plots of lobes in the window: the data that the command line writes as files.

use egui_plot::{LineStyle, Plot};

use super::*;
use crate::{
    kit::charts::{height, line, powers, short, still},
    plot::lobe_view::{Axis, Series},
    plot::series_color,
};

/// Powers of ten that a logarithmic polar plot shows, at least.
const POLAR_POWERS: f64 = 4.0;
/// Values at which a polar plot may be cut off.
const CUTS: [f64; 2] = [0.001, 1e9];

/// Where a value lies on an axis.
fn place(axis: &Axis, value: f64) -> f64 {
    if axis.is_logarithmic {
        value.max(axis.range[0]).log10()
    } else {
        value
    }
}

/// Height of a line plot, points.
pub fn plot_height(ui: &Ui) -> f32 {
    height(ui, 0.8, 230.0)
}

/// How the radii of a polar plot are shown: a narrow lobe is a needle otherwise.
#[derive(Default)]
pub struct Radii {
    is_logarithmic: bool,
    /// The largest value that is shown; `None` for the lobes' own.
    cut: Option<f64>,
}

impl Radii {
    /// The axis of a plot's radii.
    fn axis(&self, plot: &LinePlot) -> Axis {
        let top = self.cut.unwrap_or(plot.y.range[1]).max(CUTS[0]);
        let low = 10.0_f64.powf(top.log10().ceil() - POLAR_POWERS);
        Axis {
            range: [if self.is_logarithmic { low } else { 0.0 }, top],
            is_logarithmic: self.is_logarithmic,
            ..plot.y.clone()
        }
    }

    /// The rows that change it.
    pub fn rows(&mut self, ui: &mut Ui, plot: &LinePlot) {
        let help = "Radii count powers of ten: the foot of a narrow lobe is seen beside its peak.";
        let name = ["Logarithmic radius", "Logarithmic", help];
        widgets::value_row(ui, name, &mut self.is_logarithmic, false, |ui, is_on| {
            ui.checkbox(is_on, "")
        });
        let top = plot.y.range[1].clamp(CUTS[0], CUTS[1]);
        let style = NumberStyle::plain(CUTS[0]..=CUTS[1], " 1/sr", 0.01 * self.cut.unwrap_or(top), 3);
        let help = "What is larger is cut off there. Follows the lobes' peak until it is changed.";
        let name = ["Radius up to", "Shown up to", help];
        widgets::value_row(ui, name, &mut self.cut, None, |ui, cut| {
            widgets::number_following(ui, cut, top, &style)
        });
        widgets::comes_and_goes(ui, |ui| {
            if self.cut.is_some_and(|cut| cut < plot.highest()) {
                let peak = short(plot.highest());
                widgets::note(ui, format!("The peak is {peak} 1/sr; the rest is cut off."));
            }
        });
    }
}

/// Shows a line plot over the width there is; radii of a polar one as `radii` says.
pub fn line_plot(ui: &mut Ui, id: &str, plot: &LinePlot, radii: &Radii) {
    let height = plot_height(ui);
    let (shown, caption, lines): (_, _, Vec<Vec<[f64; 2]>>) = if plot.is_polar {
        let axis = radii.axis(plot);
        let [low, high] = axis.range.map(short);
        let lines = plot.series.iter().map(|series| series.polar_points(&axis).collect());
        let caption = format!("{}: {low} to {high}", axis.label);
        (polar(id, height, &axis), caption, lines.collect())
    } else {
        let on_axes = |[x, y]: &[f64; 2]| [place(&plot.x, *x), place(&plot.y, *y)];
        let lines = plot
            .series
            .iter()
            .map(|series| series.points.iter().map(on_axes).collect());
        (cartesian(id, height, plot), plot.y.label.clone(), lines.collect())
    };
    let response = shown.show(ui, |plot_ui| {
        for ((is_first, series), points) in series(plot).zip(lines) {
            let style = if is_first {
                LineStyle::Solid
            } else {
                LineStyle::dashed_dense()
            };
            let color = widgets::rgb(series_color(series.group));
            plot_ui.line(line(plot.label(series), points, color, 2.0).style(style));
        }
    });
    response.response.accessible_name(plot.title.clone());
    ui.weak(caption);
    key(ui, plot);
}

/// An empty plot around a point.
fn polar<'a>(id: &str, height: f32, axis: &Axis) -> Plot<'a> {
    let (low, is_logarithmic) = (axis.range[0], axis.is_logarithmic);
    let in_words = move |radius: f64| match is_logarithmic {
        true => short(low * 10.0_f64.powf(radius.abs())),
        false => short(radius.abs()),
    };
    let top = axis.radius(axis.range[1]);
    let shown = over(id, height, [in_words, in_words], [-top, top], [0.0, top])
        .x_axis_label(axis.label.clone())
        .data_aspect(1.0);
    match is_logarithmic {
        true => shown.x_grid_spacer(powers).y_grid_spacer(powers),
        false => shown,
    }
}

/// An empty plot over two axes.
fn cartesian<'a>(id: &str, height: f32, plot: &LinePlot) -> Plot<'a> {
    let is_logarithmic = [false, plot.y.is_logarithmic];
    let in_words = is_logarithmic.map(|is_logarithmic| {
        move |value: f64| match is_logarithmic {
            true => short(10.0_f64.powf(value)),
            false => short(value),
        }
    });
    let upwards = plot.y.range.map(|value| place(&plot.y, value));
    over(id, height, in_words, plot.x.range, upwards).x_axis_label(plot.x.label.clone())
}

/// A plot that spans two ranges at least.
fn over<'a>(
    id: &str,
    height: f32,
    in_words: [impl Fn(f64) -> String + Clone + 'a; 2],
    [left, right]: [f64; 2],
    [bottom, top]: [f64; 2],
) -> Plot<'a> {
    still(id, height, in_words)
        .include_x(left)
        .include_x(right)
        .include_y(bottom)
        .include_y(top)
}

/// The series, and whether each is the first of its group, which is solid; the others are dashed.
fn series(plot: &LinePlot) -> impl Iterator<Item = (bool, &Series)> {
    plot.series
        .chunk_by(|a, b| a.group == b.group)
        .flat_map(|group| group.iter().enumerate().map(|(rank, series)| (rank == 0, series)))
}

/// What the lines are, below the plot: over it they would hide narrow lobes.
fn key(ui: &mut Ui, plot: &LinePlot) {
    for (is_first, series) in series(plot) {
        ui.horizontal(|ui| {
            let (rect, _) = ui.allocate_exact_size(vec2(22.0, 12.0), Sense::hover());
            let stroke = Stroke::new(2.5, widgets::rgb(series_color(series.group)));
            let ends = [rect.left_center(), rect.right_center()];
            if is_first {
                ui.painter().line_segment(ends, stroke);
            } else {
                ui.painter().extend(Shape::dashed_line(&ends, stroke, 4.0, 4.0));
            }
            widgets::line(ui, plot.label(series));
        });
    }
}
