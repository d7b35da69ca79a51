//! Line plots of lobes in the window: the data that the command line writes as files.

use egui::{Color32, Ui};
use egui_plot::{Line, LineStyle, PlotPoints};

use crate::app::kit::charts::{short, still};
use crate::plot::lobe_view::{Axis, LinePlot, Series};
use crate::plot::series_color;

/// Where a value lies on an axis.
fn place(axis: &Axis, value: f64) -> f64 {
    if axis.is_logarithmic {
        value.max(axis.range[0]).log10()
    } else {
        value
    }
}

/// Height of a line plot of this width, points.
pub(super) fn plot_height(width: f32) -> f32 {
    (0.8 * width).clamp(160.0, 420.0)
}

/// Shows a line plot over the width there is.
pub(super) fn line_plot(ui: &mut Ui, id: &str, plot: &LinePlot) {
    let width = ui.available_width();
    let upwards: fn(f64) -> String = if plot.y.is_logarithmic {
        |y| short(10.0_f64.powf(y))
    } else {
        short
    };
    let mut shown = still(id, plot_height(width), [short, upwards]).x_axis_label(if plot.is_polar {
        plot.y.label.clone()
    } else {
        plot.x.label.clone()
    });
    let [top, bottom] = [plot.y.range[1], plot.y.range[0]].map(|value| place(&plot.y, value));
    shown = if plot.is_polar {
        shown
            .data_aspect(1.0)
            .include_y(0.0)
            .include_y(top)
            .include_x(-top)
            .include_x(top)
    } else {
        let [first, last] = plot.x.range;
        shown.include_y(bottom).include_y(top).include_x(first).include_x(last)
    };
    let response = shown.show(ui, |plot_ui| {
        for (is_first, series) in series(plot) {
            let style = if is_first {
                LineStyle::Solid
            } else {
                LineStyle::dashed_dense()
            };
            plot_ui.line(
                Line::new(plot.label(series), PlotPoints::from(points(plot, series)))
                    .color(color(series.group))
                    .width(2.0)
                    .style(style),
            );
        }
    });
    response.response.accessible_name(plot.title.clone());
    key(ui, plot);
}

/// The series, and whether each is the first of its group, which is solid; the others are dashed.
fn series(plot: &LinePlot) -> impl Iterator<Item = (bool, &Series)> {
    plot.series
        .chunk_by(|a, b| a.group == b.group)
        .flat_map(|group| group.iter().enumerate().map(|(rank, series)| (rank == 0, series)))
}

/// What the lines are, below the plot: over it they would hide narrow lobes.
fn key(ui: &mut Ui, plot: &LinePlot) {
    if !plot.is_polar {
        ui.weak(&plot.y.label);
    }
    for (is_first, series) in series(plot) {
        ui.horizontal(|ui| {
            let (rect, _) = ui.allocate_exact_size(egui::vec2(22.0, 12.0), egui::Sense::hover());
            let stroke = egui::Stroke::new(2.5, color(series.group));
            let ends = [rect.left_center(), rect.right_center()];
            if is_first {
                ui.painter().line_segment(ends, stroke);
            } else {
                ui.painter().extend(egui::Shape::dashed_line(&ends, stroke, 4.0, 4.0));
            }
            ui.add(egui::Label::new(plot.label(series)).truncate());
        });
    }
}

fn points(plot: &LinePlot, series: &Series) -> Vec<[f64; 2]> {
    if plot.is_polar {
        return series.polar_points().collect();
    }
    let on_axes = |[x, y]: &[f64; 2]| [place(&plot.x, *x), place(&plot.y, *y)];
    series.points.iter().map(on_axes).collect()
}

fn color(group: usize) -> Color32 {
    let [r, g, b] = series_color(group);
    Color32::from_rgb(r, g, b)
}
