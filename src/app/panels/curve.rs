//! The D(ξ) curve of the geometric lobe: looked at, and drawn by dragging points.

use egui::{Key, Modifiers, Pos2, Ui};
use egui_plot::{Line, Plot, PlotPoint, PlotPoints, PlotUi, Points};

use super::Panel;
use crate::app::desk::Desk;
use crate::app::kit::charts::{rounded_up, short, still};
use crate::app::kit::icons::{self, Icon};
use crate::app::kit::theme;
use crate::app::kit::widgets::{self, Name, NumberStyle};
use crate::document::custom_curve::{CustomCurve, DISTANCE_MAX, DISTANCE_MIN, POINTS_MAX, XI_STEP_MIN};
use crate::optics::curve::{Curve, curve_density, curve_distance, curve_distance_max};

/// How near the pointer must be to a point to take it, points.
const REACH: f32 = 12.0;
/// Steps of a drawn line.
const STEPS: usize = 240;
/// Points that a named curve becomes when it is edited.
const POINTS: usize = 11;
/// Steps of the line along which those points are spread.
const FINE_STEPS: usize = 1000;
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
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
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
        let table = if material.curve.has_table() {
            material.custom_curve.table()
        } else {
            Vec::new()
        };
        let mut points: Vec<[f64; 2]> = material
            .custom_curve
            .points()
            .iter()
            .map(|point| point.map(f64::from))
            .collect();
        let is_custom = material.curve.has_table();
        if self.left != material.custom_curve {
            // Something else changed it, such as undo during a drag: which points there are now, the drag does not know.
            (self.dragged, self.selected) = (None, None);
        }
        quantile_plot(ui, self, material.curve, &table, is_custom.then_some(&mut points));
        // A curve of another kind may come with a model.
        widgets::comes_and_goes(ui, |ui| {
            if is_custom {
                selected_point(ui, self, &mut points);
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
fn head(ui: &mut Ui, desk: &mut Desk<'_>, material: &mut crate::document::MaterialSettings) {
    let name = Name {
        full: "Curve shape",
        label: "Curve",
        symbol: "D(ξ)",
        help: material.curve.help(),
    };
    if widgets::row(ui, name, |ui| {
        widgets::choice(ui, "curve shape", &mut material.curve, &widgets::choices())
    })
    .changed
    {
        desk.edits.note("Specular curve", "specular.curve");
    }
    ui.horizontal(|ui| {
        widgets::note(ui, format!("D = {}", material.curve.formula()));
        if !material.curve.has_table() {
            widgets::at_right(ui, |ui| {
                let button = ui
                    .button("Edit as custom")
                    .on_hover_text("Makes a curve of your own that begins as this one");
                if button.clicked() {
                    material.custom_curve = from_named(material.curve);
                    material.curve = Curve::Custom;
                    desk.edits.note("Edit the curve", "");
                }
            });
        }
    });
}

/// A custom curve through points of a named one, spread evenly along its line as the plot shows it: denser where it is
/// steep.
fn from_named(curve: Curve) -> CustomCurve {
    let distance = |xi: f64| curve_distance(curve, &[], xi.min(1.0 - 1e-3)).clamp(0.0, f64::from(DISTANCE_MAX));
    let fine: Vec<[f64; 2]> = (0..=FINE_STEPS)
        .map(|i| i as f64 / FINE_STEPS as f64)
        .map(|xi| [xi, distance(xi)])
        .collect();
    let top = distance(1.0);
    let mut lengths = vec![0.0];
    for pair in fine.windows(2) {
        let step = (pair[1][0] - pair[0][0]).hypot((pair[1][1] - pair[0][1]) / top);
        lengths.push(lengths[lengths.len() - 1] + step);
    }
    let at = |i: usize| {
        let length = lengths[FINE_STEPS] * i as f64 / (POINTS - 1) as f64;
        fine[lengths.partition_point(|l| *l < length).min(FINE_STEPS)].map(|x| x as f32)
    };
    CustomCurve::try_from((0..POINTS).map(at).collect::<Vec<_>>()).unwrap_or_default()
}

fn plot<'a>(id: &str, label: &'a str, height: f32) -> Plot<'a> {
    still(id, height, [short, short]).x_axis_label(label)
}

fn plot_height(ui: &Ui) -> f32 {
    (0.62 * ui.available_width()).clamp(120.0, 260.0)
}

/// D over ξ; the points of a custom curve are dragged, double-clicked into being and away.
fn quantile_plot(ui: &mut Ui, state: &mut CurvePanel, curve: Curve, table: &[f32], points: Option<&mut Vec<[f64; 2]>>) {
    let accent = theme::accent(ui.visuals().dark_mode);
    let line: Vec<[f64; 2]> = (0..=STEPS)
        .map(|i| i as f64 / STEPS as f64)
        .map(|xi| [xi, curve_distance(curve, table, xi.min(1.0 - 1e-7))])
        .filter(|[_, distance]| *distance <= curve.traits().plotted_max)
        .collect();
    let top = curve_distance_max::<f64>(curve, table).min(curve.traits().plotted_max);
    let is_drawn_on = state.dragged.is_some();
    let shown = plot("quantile", "ξ: share of the samples", plot_height(ui))
        .include_x(0.0)
        .include_x(1.0)
        .include_y(0.0)
        .include_y(rounded_up(top))
        .show(ui, |plot_ui| {
            plot_ui.line(Line::new("D(ξ)", PlotPoints::from(line)).color(accent).width(2.0));
            if let Some(points) = points {
                edit(plot_ui, state, points);
                draw_points(plot_ui, state, points, accent);
            }
        });
    let response = shown.response.accessible_name("The curve D over ξ");
    if is_drawn_on {
        // The help would lie over what is being drawn.
        return;
    }
    // Beside the plot: at the pointer it would lie over what is looked at.
    response.on_hover_ui(|ui| {
        ui.label("The share ξ of the samples stays within the distance D of the mirror direction.");
        if curve.has_table() {
            widgets::note(
                ui,
                "Drag points (ctrl: in steps). Double-click adds or removes a point.",
            );
        }
    });
}

fn draw_points(plot_ui: &mut PlotUi<'_>, state: &CurvePanel, points: &[[f64; 2]], color: egui::Color32) {
    plot_ui.points(
        Points::new("points", PlotPoints::from(points.to_vec()))
            .radius(4.5)
            .color(color),
    );
    if let Some(point) = state.selected.and_then(|index| points.get(index)) {
        let white = plot_ui.ctx().global_style().visuals.strong_text_color();
        plot_ui.points(
            Points::new("selected", PlotPoints::from(vec![*point]))
                .radius(5.5)
                .color(white),
        );
    }
}

fn edit(plot_ui: &PlotUi<'_>, state: &mut CurvePanel, points: &mut Vec<[f64; 2]>) {
    let response = plot_ui.response();
    let Some(pointer) = response.interact_pointer_pos() else {
        state.dragged = None;
        return;
    };
    let near = |points: &[[f64; 2]], place: Pos2| {
        let distance = |point: &[f64; 2]| {
            plot_ui
                .screen_from_plot(PlotPoint::new(point[0], point[1]))
                .distance(place)
        };
        let nearest = (0..points.len()).min_by(|a, b| distance(&points[*a]).total_cmp(&distance(&points[*b])));
        nearest.filter(|index| distance(&points[*index]) <= REACH)
    };
    let at = plot_ui.plot_from_screen(pointer);
    if response.double_clicked() {
        match near(points, pointer) {
            Some(index) if index > 0 && index + 1 < points.len() => {
                points.remove(index);
                state.selected = None;
            }
            Some(_) => {}
            None => insert(points, [at.x, at.y], state),
        }
        state.dragged = None;
        return;
    }
    if response.drag_started() || response.clicked() {
        // Where the button went down, not where the drag was noticed.
        let pressed = plot_ui.ctx().input(|input| input.pointer.press_origin());
        state.dragged = near(points, pressed.unwrap_or(pointer));
        state.selected = state.dragged.or(state.selected.filter(|_| !response.clicked()));
    }
    if response.dragged()
        && let Some(index) = state.dragged
    {
        let snaps = plot_ui
            .ctx()
            .input(|input| input.modifiers.contains(Modifiers::COMMAND));
        let snapped = |x: f64| if snaps { (x / SNAP).round() * SNAP } else { x };
        place(points, index, [snapped(at.x), snapped(at.y)]);
    }
    if response.drag_stopped() {
        state.dragged = None;
    }
}

/// Moves a point as far as its neighbours let it; the ends keep their ξ.
fn place(points: &mut [[f64; 2]], index: usize, to: [f64; 2]) {
    let step = f64::from(XI_STEP_MIN);
    let last = points.len() - 1;
    let below = if index == 0 {
        None
    } else {
        points.get(index - 1).copied()
    };
    let above = points.get(index + 1).copied();
    let low = [below.map_or(0.0, |p| p[0] + step), below.map_or(0.0, |p| p[1])];
    let high = [
        above.map_or(1.0, |p| p[0] - step),
        above.map_or(f64::from(DISTANCE_MAX), |p| p[1]),
    ];
    if index != 0 && index != last && low[0] <= high[0] {
        points[index][0] = to[0].clamp(low[0], high[0]);
    }
    let least = if index == last {
        low[1].max(f64::from(DISTANCE_MIN))
    } else {
        low[1]
    };
    points[index][1] = to[1].clamp(least, high[1].max(least));
}

fn insert(points: &mut Vec<[f64; 2]>, point: [f64; 2], state: &mut CurvePanel) {
    let index = points.partition_point(|[xi, _]| *xi < point[0]);
    let step = f64::from(XI_STEP_MIN);
    let is_inside = index > 0 && index < points.len();
    if !is_inside || points.len() >= POINTS_MAX || points[index][0] - points[index - 1][0] < 2.0 * step {
        return;
    }
    points.insert(index, [points[index][0] - step, points[index][1]]);
    place(points, index, point);
    state.selected = Some(index);
}

/// The selected point in numbers.
fn selected_point(ui: &mut Ui, state: &mut CurvePanel, points: &mut Vec<[f64; 2]>) {
    let Some(index) = state.selected.filter(|index| *index < points.len()) else {
        widgets::note(
            ui,
            "Click a point to see its numbers; double-click adds and removes points.",
        );
        return;
    };
    let mut point = points[index];
    let mut is_removed = false;
    let is_end = index == 0 || index + 1 == points.len();
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
        if !is_end && icons::button(ui, Icon::Close, "Remove point", "Removes this point (delete)").clicked() {
            is_removed = true;
        }
    });
    let deletes = ui.memory(|memory| memory.focused().is_none()) && ui.input(|input| input.key_pressed(Key::Delete));
    if is_removed || (deletes && !is_end) {
        points.remove(index);
        state.selected = None;
    } else if point != points[index] {
        place(points, index, point);
    }
}

/// The density of D and its cumulative distribution.
fn distance_plot(ui: &mut Ui, curve: Curve, table: &[f32]) {
    let visuals = ui.visuals().clone();
    let top = curve_distance_max::<f64>(curve, table).min(curve.traits().plotted_max);
    let density: Vec<[f64; 2]> = (1..=STEPS)
        .map(|i| top * (i as f64 - 0.5) / STEPS as f64)
        .map(|distance| [distance, curve_density(curve, table, distance)])
        .collect();
    let cumulative: Vec<[f64; 2]> = (0..=STEPS)
        .map(|i| i as f64 / STEPS as f64)
        .map(|xi| [curve_distance(curve, table, xi.min(1.0 - 1e-7)).min(top), xi])
        .collect();
    let highest = density.iter().map(|[_, f]| *f).fold(1.0, f64::max).min(6.0);
    let shown = plot("distance", "D: distance from the mirror direction", plot_height(ui))
        .include_x(0.0)
        .include_x(rounded_up(top))
        .include_y(0.0)
        .include_y(rounded_up(highest))
        .default_y_bounds(0.0, 1.06 * rounded_up(highest))
        .legend(egui_plot::Legend::default())
        .show(ui, |plot_ui| {
            let grey = visuals.weak_text_color();
            plot_ui.line(
                Line::new("density", PlotPoints::from(density))
                    .color(theme::accent(visuals.dark_mode))
                    .width(2.0),
            );
            plot_ui.line(
                Line::new("cumulative", PlotPoints::from(cumulative))
                    .color(grey)
                    .width(1.5),
            );
        });
    shown.response.accessible_name("The density of the distance D");
}

/// Where samples begin to fall below the surface.
fn horizon(ui: &mut Ui, roughness: f32, distance_max: f64) {
    let reach = f64::from(roughness) * distance_max;
    let text = if reach <= 0.0 {
        "No sample falls below the surface: this is a mirror.".to_owned()
    } else if reach >= 1.0 {
        "Samples fall below the surface at every viewing angle.".to_owned()
    } else {
        format!(
            "Samples fall below the surface for views beyond {:.0}° from the normal.",
            reach.acos().to_degrees()
        )
    };
    ui.add_space(4.0);
    ui.add(egui::Label::new(egui::RichText::new(text).weak()).wrap());
}
