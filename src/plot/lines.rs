//! Line plots, over an axis or around a point.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::figure::{Area, Backend, Figure, Outcome, PALETTE, Style, font, number, px, round_step, stroke};
use super::scale::Scale;
use crate::plot::lobe_view::{Axis, LinePlot, Series};

/// A chart over two axes.
type Chart<'a, DB> = ChartContext<'a, DB, Cartesian2d<Scale, Scale>>;

/// Width and height of the plot itself, and of a legend's entry.
const SIZE: (u32, u32) = (860, 560);
const ENTRY_HEIGHT: f64 = 24.0;
/// Width of a letter on average, and of what a legend needs besides letters.
pub(super) const LETTER: f64 = 7.4;
const LEGEND_MARGIN: f64 = 62.0;

impl Figure for LinePlot {
    fn size(&self) -> (u32, u32) {
        (SIZE.0 + legend_width(self), if self.is_polar { 530 } else { SIZE.1 })
    }

    fn draw<DB: Backend>(&self, root: &Area<DB>, style: Style) -> Outcome {
        let (area, legend) = root.split_horizontally(px(f64::from(SIZE.0), style));
        if self.is_polar {
            draw_polar(self, &area, style)?;
        } else {
            draw_cartesian(self, &area, style)?;
        }
        draw_legend(self, &legend, style)
    }
}

fn legend_width(plot: &LinePlot) -> u32 {
    let longest = plot
        .series
        .iter()
        .map(|series| plot.label(series).chars().count())
        .max();
    (LEGEND_MARGIN + LETTER * longest.unwrap_or(0) as f64) as u32
}

/// The plot's title, with the view's angle where there is one.
fn title(plot: &LinePlot) -> String {
    plot.view_angle_deg()
        .map_or_else(|| plot.title.clone(), |angle| format!("{}, view {angle}°", plot.title))
}

/// A chart with its title and axes; beside it there is room for the labels of the vertical axis, and at the right.
pub(super) fn framed<'a, DB: Backend>(
    root: &Area<DB>,
    title: &str,
    axes: [&'a Axis; 2],
    [labels_width, margin_right]: [f64; 2],
    style: Style,
) -> Result<Chart<'a, DB>, DrawingAreaErrorKind<DB::ErrorType>> {
    let mut chart = ChartBuilder::on(root)
        .caption(title, font(22.0, style))
        .margin(px(16.0, style))
        .margin_right(px(margin_right, style))
        .x_label_area_size(px(46.0, style))
        .y_label_area_size(px(labels_width, style))
        .build_cartesian_2d(Scale::new(axes[0], 10.0), Scale::new(axes[1], 8.0))?;
    chart
        .configure_mesh()
        .bold_line_style(stroke(style.faint, 1.0, style))
        .axis_style(stroke(style.ink, 1.0, style))
        .label_style(font(14.0, style))
        .axis_desc_style(font(15.0, style))
        .x_label_formatter(&|value| number(*value))
        .y_label_formatter(&|value| number(*value))
        .x_desc(&axes[0].label)
        .y_desc(&axes[1].label)
        .draw()?;
    Ok(chart)
}

fn draw_cartesian<DB: Backend>(plot: &LinePlot, root: &Area<DB>, style: Style) -> Outcome {
    let mut chart = framed(root, &title(plot), [&plot.x, &plot.y], [66.0, 16.0], style)?;
    for (series, rank) in ranked(&plot.series) {
        let points = series.points.iter().map(|[x, y]| (*x, *y));
        draw_series(&mut chart, series, rank, points, style)?;
    }
    Ok(())
}

/// Each series with its rank in its group.
fn ranked(series: &[Series]) -> impl Iterator<Item = (&Series, usize)> {
    series
        .chunk_by(|a, b| a.group == b.group)
        .flat_map(|group| group.iter().zip(0..))
}

/// The line of a series.
fn line_style(series: &Series, style: Style) -> ShapeStyle {
    stroke(PALETTE[series.group % PALETTE.len()], 2.2, style)
}

/// A line; those after the first of a group dashed.
fn draw_series<DB: Backend>(
    chart: &mut Chart<'_, DB>,
    series: &Series,
    rank: usize,
    points: impl Iterator<Item = (f64, f64)>,
    style: Style,
) -> Outcome {
    let line = line_style(series, style);
    if rank == 0 {
        chart.draw_series(LineSeries::new(points, line))?;
    } else {
        let points: Vec<_> = points.collect();
        chart.draw_series(DashedLineSeries::new(points, px(7.0, style), px(5.0, style), line))?;
    }
    Ok(())
}

/// The names beside the plot.
fn draw_legend<DB: Backend>(plot: &LinePlot, area: &Area<DB>, style: Style) -> Outcome {
    for ((series, rank), row) in ranked(&plot.series).zip(0..) {
        let y = 64.0 + ENTRY_HEIGHT * f64::from(row);
        let at = |x: f64| (px(x, style), px(y, style));
        let dashes: &[[f64; 2]] = if rank == 0 {
            &[[4.0, 30.0]]
        } else {
            &[[4.0, 13.0], [19.0, 28.0]]
        };
        for [from, to] in dashes {
            area.draw(&PathElement::new([at(*from), at(*to)], line_style(series, style)))?;
        }
        let label = font(15.0, style).pos(Pos::new(HPos::Left, VPos::Center));
        area.draw(&Text::new(plot.label(series), at(38.0), label))?;
    }
    Ok(())
}

fn draw_polar<DB: Backend>(plot: &LinePlot, root: &Area<DB>, style: Style) -> Outcome {
    let reach = plot.y.range[1].max(1e-9);
    // Room for the angles outside the outermost circle; both axes have the same scale.
    let outer = 1.09 * reach;
    let mut chart = ChartBuilder::on(root)
        .caption(title(plot), font(22.0, style))
        .margin(px(16.0, style))
        .x_label_area_size(px(34.0, style))
        .build_cartesian_2d(Scale::bare([-outer, outer]), Scale::bare([0.0, outer]))?;
    draw_polar_net(&mut chart, reach, style)?;
    for (series, rank) in ranked(&plot.series) {
        let points: Vec<(f64, f64)> = series.polar_points(&plot.y).map(|[x, y]| (x, y)).collect();
        draw_series(&mut chart, series, rank, points.into_iter(), style)?;
        if let Some(angle_deg) = series.view_angle_deg {
            draw_view(&mut chart, angle_deg, reach, style)?;
        }
    }
    let caption = Text::new(
        plot.y.label.clone(),
        (root.dim_in_pixel().0 as i32 / 2, px(502.0, style)),
        centred(15.0, style),
    );
    root.draw(&caption)?;
    Ok(())
}

/// Circles of equal value and rays of equal angle.
fn draw_polar_net<DB: Backend>(chart: &mut Chart<'_, DB>, reach: f64, style: Style) -> Outcome {
    let ray = |angle_deg: f64, radius: f64| {
        (
            radius * angle_deg.to_radians().sin(),
            radius * angle_deg.to_radians().cos(),
        )
    };
    let arc = |radius: f64| (-90..=90).map(move |angle| ray(f64::from(angle), radius));
    let step = round_step(reach, 5.0);
    let circles = (1..).map(|i| step * f64::from(i)).take_while(|radius| *radius <= reach);
    for radius in circles {
        chart.draw_series(LineSeries::new(arc(radius), stroke(style.faint, 1.0, style)))?;
        let at = (radius, 0.0);
        let label = EmptyElement::at(at) + Text::new(number(radius), (0, px(5.0, style)), centred(13.0, style));
        chart.draw_series([label])?;
    }
    for angle_deg in [-60.0, -30.0, 0.0, 30.0, 60.0] {
        let line = [(0.0, 0.0), ray(angle_deg, reach)];
        chart.draw_series(LineSeries::new(line, stroke(style.faint, 1.0, style)))?;
        let label = Text::new(
            format!("{}°", angle_deg.abs()),
            (0, px(-8.0, style)),
            centred(13.0, style),
        );
        chart.draw_series([EmptyElement::at(ray(angle_deg, 1.035 * reach)) + label])?;
    }
    chart.draw_series(LineSeries::new(arc(reach), stroke(style.faint, 1.0, style)))?;
    chart.draw_series(LineSeries::new(
        [(-reach, 0.0), (reach, 0.0)],
        stroke(style.ink, 1.5, style),
    ))?;
    Ok(())
}

/// Where the view comes from, as a dashed ray.
fn draw_view<DB: Backend>(chart: &mut Chart<'_, DB>, angle_deg: f64, reach: f64, style: Style) -> Outcome {
    let angle_rad = angle_deg.to_radians();
    let end = (-0.98 * reach * angle_rad.sin(), 0.98 * reach * angle_rad.cos());
    let line = stroke(style.ink, 1.2, style);
    chart.draw_series(DashedLineSeries::new(
        [(0.0, 0.0), end],
        px(3.0, style),
        px(4.0, style),
        line,
    ))?;
    let label = Text::new("view", (px(-34.0, style), px(-4.0, style)), font(13.0, style));
    chart.draw_series([EmptyElement::at(end) + label])?;
    Ok(())
}

/// The font, centred on its place.
fn centred(size: f64, style: Style) -> TextStyle<'static> {
    font(size, style).pos(Pos::new(HPos::Center, VPos::Top))
}
