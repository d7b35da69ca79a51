//! Plots as files and in the window: each figure draws the same list of shapes for all.

mod axes;
mod charts;
mod drawing;
mod lines;
pub mod lobe_view;
mod maps;
mod solids;

pub use axes::{number, short};
pub use charts::{BarPlot, NamedPoint, PictureSheet, PointPlot, ScatterPlot};
pub use drawing::{Figure, PlotError, plot_file, plot_picture};
pub use maps::scale_color;

use drawing::{Colors, Drawing, PALETTE};
use lobe_view::LobeView;

/// The colour of a group of series.
pub fn series_color(group: usize) -> [u8; 3] {
    let color = PALETTE[group % PALETTE.len()];
    [color.0, color.1, color.2]
}

impl Figure for LobeView {
    fn drawing(&self, colors: &'static Colors) -> Drawing {
        match self {
            LobeView::Lines(plot) => plot.drawing(colors),
            LobeView::Maps(plot) => plot.drawing(colors),
            LobeView::Solids(plot) => plot.drawing(colors),
        }
    }
}
