//! The D(ξ) curve of the geometric lobe: looked at, and drawn by dragging points.

use egui_plot::{Plot, PlotUi, Points};

use super::*;
use crate::{
    document::custom_curve::{CustomCurve, DISTANCE_MAX, DISTANCE_MIN, POINTS_MAX, XI_STEP_MIN},
    kit::charts::{HEIGHT_MIN, height, line, nearest, rounded_up, short, still},
    kit::widgets::Name,
    optics::curve::{Curve, curve_density, curve_distance, curve_distance_max},
};

/// Steps of a drawn line.
const STEPS: usize = 240;
/// Points that a named curve becomes when it is edited.
const POINTS: usize = 33;
/// Steps of the line along which those points are spread.
const FINE_STEPS: usize = 1000;
/// Height of the rows around both plots, points.
const ROWS: f32 = 150.0;
/// What ctrl snaps to.
const SNAP: f64 = 0.05;

/// The geometric lobe's curve, to look at and to draw.
#[derive(Default)]
pub struct CurvePanel {
    dragged: Option<usize>,
    selected: Option<usize>,
    /// The curve as this panel left it.
    left: CustomCurve,
}

impl Panel for CurvePanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk) {
        let before = desk.material();
        if !before.lobe.has_curves() {
            widgets::note(
                ui,
                "Only the geometric lobe has a curve: choose it in the material panel.",
            );
            return;
        }
        let mut material = before.clone();
        head(ui, desk, &mut material);
        // Only now: the head may just have made the curve a custom one, which is looked up in its table.
        let is_custom = material.curve.has_table();
        let table = if is_custom {
            material.custom_curve.table()
        } else {
            Vec::new()
        };
        let drawn = material.custom_curve.points();
        let mut points: Vec<[f64; 2]> = drawn.iter().map(|point| point.map(f64::from)).collect();
        if self.left != material.custom_curve {
            // Something else changed it, such as undo during a drag: which points there are now, the drag does not know.
            (self.dragged, self.selected) = (None, None);
        }
        self.quantile_plot(ui, material.curve, &table, is_custom.then_some(&mut points));
        // A curve of another kind may come with a model.
        widgets::comes_and_goes(ui, |ui| {
            if is_custom {
                self.selected_point(ui, &mut points);
                let drawn = points.iter().map(|point| point.map(|x| x as f32)).collect::<Vec<_>>();
                if drawn != material.custom_curve.points()
                    && let Ok(curve) = CustomCurve::try_from(drawn)
                {
                    material.custom_curve = curve;
                    desk.edits.note("Draw the curve", "custom curve");
                }
            }
        });
        self.left.clone_from(&material.custom_curve);
        distance_plot(ui, material.curve, &table);
        horizon(ui, material.roughness, curve_distance_max(material.curve, &table));
        if material != before {
            desk.set_material(material);
        }
    }
}

/// Which curve, and the way from a named one to one's own.
fn head(ui: &mut Ui, desk: &mut Desk, material: &mut crate::document::MaterialSettings) {
    let name = Name {
        full: "Curve shape",
        label: "Curve",
        symbol: "D(ξ)",
        help: material.curve.help(),
    };
    let is_other = widgets::row(ui, name, |ui| {
        widgets::choice(ui, "curve shape", &mut material.curve, &widgets::choices())
    });
    if is_other {
        desk.edits.note("Specular curve", "specular.curve");
    }
    ui.horizontal(|ui| {
        widgets::note(ui, format!("D = {}", material.curve.formula()));
        if !material.curve.has_table() {
            widgets::at_right(ui, |ui| {
                let help = "Makes a curve of your own that begins as this one";
                if widgets::pressed(ui, "Edit as custom", help) {
                    material.custom_curve = from_named(material.curve);
                    material.curve = Curve::Custom;
                    desk.edits.did("Edit the curve");
                }
            });
        }
    });
}

/// A custom curve through points of a named one, spread evenly along its line as the plot shows it: denser where it is
/// steep.
fn from_named(curve: Curve) -> CustomCurve {
    let distance = |xi: f64| curve_distance(curve, &[], xi.min(1.0 - 0.001)).clamp(0.0, f64::from(DISTANCE_MAX));
    let fine: Vec<[f64; 2]> = shares(FINE_STEPS).map(|xi| [xi, distance(xi)]).collect();
    let top = distance(1.0);
    let mut lengths = vec![0.0];
    for pair in fine.windows(2) {
        let step = (pair[1][0] - pair[0][0]).hypot((pair[1][1] - pair[0][1]) / top);
        lengths.push(lengths[lengths.len() - 1] + step);
    }
    let at = |share: f64| {
        let length = lengths[FINE_STEPS] * share;
        fine[lengths.partition_point(|l| *l < length).min(FINE_STEPS)].map(|x| x as f32)
    };
    let mut points: Vec<[f32; 2]> = shares(POINTS - 1).map(at).collect();
    let end = points[POINTS - 1];
    // Where the curve is steep they would lie one over the other.
    points.dedup_by(|next, last| next[0] - last[0] < 2.0 * XI_STEP_MIN);
    points.last_mut().into_iter().for_each(|last| *last = end);
    CustomCurve::try_from(points).unwrap_or_default()
}

/// From 0 to 1 in so many steps.
fn shares(steps: usize) -> impl Iterator<Item = f64> {
    (0..=steps).map(move |i| i as f64 / steps as f64)
}

/// A plot from 0 to these ends.
fn plot<'a>(ui: &Ui, id: &str, label: &'a str, [right, top]: [f64; 2]) -> Plot<'a> {
    // Two of them and the rows; where that is too little, one after the other fills the panel.
    let room = ui.clip_rect().height();
    let [share, rest] = match 0.5 * (room - ROWS) < HEIGHT_MIN {
        true => [f32::INFINITY, 0.5 * ROWS],
        false => [0.62, 0.5 * (room + ROWS)],
    };
    still(id, height(ui, share, rest), [short, short])
        .x_axis_label(label)
        .include_x(0.0)
        .include_x(right)
        .include_y(0.0)
        .include_y(top)
}

/// How far a curve goes, as far as that is shown.
fn shown_max(curve: Curve, table: &[f32]) -> f64 {
    curve_distance_max::<f64>(curve, table).min(curve.traits().plotted_max)
}

impl CurvePanel {
    /// D over ξ; the points of a custom curve are dragged, double-clicked into being and away.
    fn quantile_plot(&mut self, ui: &mut Ui, curve: Curve, table: &[f32], points: Option<&mut Vec<[f64; 2]>>) {
        let accent = theme::accent(ui);
        let places = shares(STEPS).map(|xi| [xi, curve_distance(curve, table, xi.min(1.0 - 1e-7))]);
        let places = places
            .filter(|[_, distance]| *distance <= curve.traits().plotted_max)
            .collect();
        let ends = [1.0, rounded_up(shown_max(curve, table))];
        let shown = plot(ui, "quantile", "ξ: share of the samples", ends).show(ui, |plot_ui| {
            plot_ui.line(line("D(ξ)", places, accent, 2.0));
            let Some(points) = points else { return };
            self.edit(plot_ui, points);
            plot_ui.points(Points::new("points", points.clone()).radius(4.5).color(accent));
            if let Some(point) = self.selected.and_then(|index| points.get(index)) {
                let white = plot_ui.ctx().global_style().visuals.strong_text_color();
                plot_ui.points(Points::new("selected", *point).radius(5.5).color(white));
            }
        });
        shown.response.accessible_name("The curve D over ξ");
    }

    fn edit(&mut self, plot_ui: &PlotUi, points: &mut Vec<[f64; 2]>) {
        let response = plot_ui.response();
        let Some(pointer) = response.interact_pointer_pos() else {
            self.dragged = None;
            return;
        };
        let near = |points: &[[f64; 2]], place: Pos2| nearest(points, plot_ui.transform(), place);
        let at = plot_ui.plot_from_screen(pointer);
        if response.double_clicked() {
            match near(points, pointer) {
                Some(index) if index > 0 && index + 1 < points.len() => {
                    points.remove(index);
                    self.selected = None;
                }
                Some(_) => {}
                None => self.selected = insert(points, [at.x, at.y]).or(self.selected),
            }
            self.dragged = None;
            return;
        }
        if response.drag_started() || response.clicked() {
            // Where the button went down, not where the drag was noticed.
            let pressed = plot_ui.ctx().input(|input| input.pointer.press_origin());
            self.dragged = near(points, pressed.unwrap_or(pointer));
            self.selected = self.dragged.or(self.selected.filter(|_| !response.clicked()));
        }
        if let Some(index) = self.dragged.filter(|_| response.dragged()) {
            let snaps = plot_ui.ctx().input(|input| input.modifiers.command);
            let snapped = |x: f64| if snaps { (x / SNAP).round() * SNAP } else { x };
            place(points, index, [at.x, at.y].map(snapped));
        }
        if response.drag_stopped() {
            self.dragged = None;
        }
    }

    /// The selected point in numbers.
    fn selected_point(&mut self, ui: &mut Ui, points: &mut Vec<[f64; 2]>) {
        let Some(index) = self.selected.filter(|index| *index < points.len()) else {
            let text = "Drag points (ctrl: in steps). Click one for its numbers; double-click adds and removes points.";
            return widgets::note(ui, text);
        };
        let mut point = points[index];
        let is_end = index == 0 || index + 1 == points.len();
        let keys_are_free = ui.memory(|memory| memory.focused().is_none());
        let mut is_removed = keys_are_free && ui.input(|input| input.key_pressed(Key::Delete));
        ui.horizontal(|ui| {
            ui.label(format!("Point {}", index + 1));
            let style = NumberStyle::plain(0.0..=f64::from(DISTANCE_MAX), "", 0.005, 3);
            for (value, name) in point.iter_mut().zip(["ξ", "D"]) {
                ui.label(name);
                let is_fixed = name == "ξ" && is_end;
                ui.add_enabled_ui(!is_fixed, |ui| {
                    ui.set_max_width(70.0);
                    widgets::number(ui, value, &style).accessible_name(format!("Point {name}"))
                });
            }
            if !is_end {
                let help = "Removes this point (delete)";
                is_removed |= icons::button(ui, Icon::Close, "Remove point", help).clicked();
            }
        });
        if is_removed && !is_end {
            points.remove(index);
            self.selected = None;
        } else if point != points[index] {
            place(points, index, point);
        }
    }
}

/// Moves a point as far as its neighbours let it; the ends keep their ξ.
fn place(points: &mut [[f64; 2]], index: usize, to: [f64; 2]) {
    let step = f64::from(XI_STEP_MIN);
    let below = index.checked_sub(1).map(|below| points[below]);
    let above = points.get(index + 1).copied();
    if let (Some(below), Some(above)) = (below, above)
        && below[0] + step <= above[0] - step
    {
        points[index][0] = to[0].clamp(below[0] + step, above[0] - step);
    }
    let lowest = if above.is_none() { f64::from(DISTANCE_MIN) } else { 0.0 };
    let least = below.map_or(0.0, |below| below[1]).max(lowest);
    let most = above.map_or(f64::from(DISTANCE_MAX), |above| above[1]);
    points[index][1] = to[1].clamp(least, most.max(least));
}

/// The number of a new point, where there is room for it.
fn insert(points: &mut Vec<[f64; 2]>, point: [f64; 2]) -> Option<usize> {
    let index = points.partition_point(|[xi, _]| *xi < point[0]);
    let step = f64::from(XI_STEP_MIN);
    let [right, top] = *points.get(index)?;
    let [left, _] = *points.get(index.checked_sub(1)?)?;
    if points.len() >= POINTS_MAX || right - left < 2.0 * step {
        return None;
    }
    points.insert(index, [right - step, top]);
    place(points, index, point);
    Some(index)
}

/// The density of D and its cumulative distribution.
fn distance_plot(ui: &mut Ui, curve: Curve, table: &[f32]) {
    let [accent, grey] = [theme::accent(ui), ui.visuals().weak_text_color()];
    let top = shown_max(curve, table);
    let density = |i: usize| {
        let distance = top * (i as f64 - 0.5) / STEPS as f64;
        [distance, curve_density(curve, table, distance)]
    };
    let density: Vec<[f64; 2]> = (1..=STEPS).map(density).collect();
    let cumulative = |xi: f64| [curve_distance(curve, table, xi.min(1.0 - 1e-7)).min(top), xi];
    let highest = rounded_up(density.iter().map(|[_, f]| *f).fold(1.0, f64::max).min(6.0));
    let label = "D: distance from the mirror direction";
    let shown = plot(ui, "distance", label, [rounded_up(top), highest])
        .default_y_bounds(0.0, 1.06 * highest)
        .legend(egui_plot::Legend::default())
        .show(ui, |plot_ui| {
            plot_ui.line(line("density", density, accent, 2.0));
            plot_ui.line(line("cumulative", shares(STEPS).map(cumulative).collect(), grey, 1.5));
        });
    shown.response.accessible_name("The density of the distance D");
}

/// Where samples begin to fall below the surface.
fn horizon(ui: &mut Ui, roughness: f32, distance_max: f64) {
    let reach = f64::from(roughness) * distance_max;
    ui.add_space(4.0);
    widgets::note(
        ui,
        match reach {
            r if r <= 0.0 => "No sample falls below the surface: this is a mirror.".to_owned(),
            r if r >= 1.0 => "Samples fall below the surface at every viewing angle.".to_owned(),
            r => format!(
                "Samples fall below the surface for views beyond {:.0}° from the normal.",
                r.acos().to_degrees()
            ),
        },
    );
}
