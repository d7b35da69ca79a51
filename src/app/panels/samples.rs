//! What the renderer draws: the samples of the selected material's lobe, out of the engine's own function.

use egui_plot::{Bar, BarChart, Legend};

use super::*;
use crate::{
    job::scatter::ScatterRequest,
    kit::charts::{height, line, short, still},
    kit::words::short_number,
    matching::lobe_of_material,
    named::named,
    optics::lobe::{Horizon, model::LobeModel},
    optics::vector::Vec3,
    render::EngineChoice,
    render::samples::{SampleAnswer, SampleQuery, SampleReport, answers},
    services::beside::Beside,
};

/// The plot of angles goes on beyond its ends by this share, so that its labels stay within it.
const ANGLE_MARGIN: f64 = 0.07;

named! {
    /// From where the samples are looked at.
    #[derive(Default)]
    Look {
        #[default]
        Mirror, "mirror", "Along mirror direction", "From the mirror direction, as in the paper's Fig. 1; the circle has the radius of the roughness.";
        Above, "above", "Above", "Down the normal: the circle is the horizon.";
        Side, "side", "Side", "Across the plane of incidence: the line is the surface.";
        Angle, "angle", "Angle", "How often each angle α to the mirror direction is drawn, as in the paper's Fig. 3.";
    }
}

/// Numbers of samples to choose from.
const COUNTS: [(u32, &str, &str); 4] = [
    (2_000, "2 k", ""),
    (20_000, "20 k", ""),
    (200_000, "200 k", ""),
    (1_000_000, "1 M", ""),
];

/// The samples that the engine draws of the lobe, as a cloud or against the angle.
#[derive(Default)]
pub struct SamplesPanel {
    worker: Beside<SampleQuery, SampleAnswer>,
    count: Option<u32>,
    look: Look,
    compare: bool,
    drawn: Option<Drawn>,
}

/// The points as an image, and of what.
struct Drawn {
    report: Arc<SampleReport>,
    look: (Look, usize, Color32),
    reach: f32,
    texture: TextureHandle,
}

impl Panel for SamplesPanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk) {
        let Some(query) = query(self, desk) else {
            widgets::note(ui, "The engine is being opened.");
            return;
        };
        controls(ui, desk, self);
        let state = self;
        let answer = state.worker.ask(ui.ctx(), "samples", query, answers());
        widgets::comes_and_goes(ui, |ui| widgets::failure(ui, state.worker.failure()));
        match answer {
            None if state.worker.is_busy() => {
                ui.add(Spinner::new());
            }
            None => {}
            Some(Err(why)) => widgets::failure(ui, why),
            Some(Ok(report)) => {
                if state.look == Look::Angle {
                    angle_plot(ui, &report);
                } else {
                    cloud(ui, state, &report);
                }
                numbers(ui, &report);
            }
        }
    }
}

/// What the plots are of: the selected material's specular lobe.
fn query(state: &SamplesPanel, desk: &Desk) -> Option<SampleQuery> {
    let engine = desk.snapshot.engine.as_ref()?;
    let material = desk.material();
    let mut model = LobeModel {
        rotation_rad: 0.0,
        ..lobe_of_material(&material)
    };
    if !model.lobe.is_anisotropic() {
        model.anisotropy = 0.0;
    }
    let request = ScatterRequest {
        model,
        view_angle_deg: desk.shared.view_angle_deg,
        count: state.count.unwrap_or(COUNTS[1].0),
        seed: desk.document.render.seed,
    };
    Some(SampleQuery {
        engine: engine.kind.into(),
        request,
        compare: state.look == Look::Angle && state.compare,
    })
}

fn controls(ui: &mut Ui, desk: &mut Desk, state: &mut SamplesPanel) {
    ui.horizontal_wrapped(|ui| {
        for &look in Look::ALL {
            let label = ui.selectable_label(state.look == look, look.label());
            if label.on_hover_text(look.help()).clicked() {
                state.look = look;
            }
        }
    });
    desk.view_angle_row(ui);
    let mut count = state.count.unwrap_or(COUNTS[1].0);
    let name = ["Samples drawn", "Samples", "How many are drawn for the plot."];
    widgets::row(ui, name, |ui| widgets::choice(ui, "sample count", &mut count, &COUNTS));
    state.count = Some(count);
    if state.look == Look::Angle {
        let help = "Looks for the roughness at which Phong and GGX come closest, by the total variation distance.";
        let name = ["Compare lobes", "Phong and GGX", help];
        widgets::row(ui, name, |ui| ui.checkbox(&mut state.compare, ""));
    }
    ui.add_space(4.0);
}

fn mirror(report: &SampleReport) -> Vec3<f32> {
    Vec3::from_f32(report.query.request.middle().to_f32())
}

/// Where the samples lie in a view, in [−1, 1]² (x to the right, y up).
fn projected(report: &SampleReport, look: Look) -> impl Iterator<Item = [f32; 2]> {
    let mirror = mirror(report);
    let samples = report.cloud.samples.iter();
    samples.map(move |&[x, y, z, _]| match look {
        Look::Above => [x, y],
        Look::Side => [x, z],
        // To the right: away from the normal, in the plane of incidence.
        Look::Mirror | Look::Angle => [mirror.z * x - mirror.x * z, y],
    })
}

fn cloud(ui: &mut Ui, state: &mut SamplesPanel, report: &Arc<SampleReport>) {
    let side = height(ui, 1.0, 250.0);
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(side), Sense::hover());
    widgets::describe(&response, Role::Image, "The samples");
    ui.painter().rect_filled(rect, 3.0, ui.visuals().extreme_bg_color);
    let pixels = (side * ui.ctx().pixels_per_point()) as usize;
    let look = (state.look, pixels, theme::accent(ui));
    let is_current = |drawn: &mut Drawn| Arc::ptr_eq(&drawn.report, report) && drawn.look == look;
    let drawn = state.drawn.take_if(is_current).unwrap_or_else(|| {
        let reach = reach(report, state.look);
        let image = splat(report, look, reach);
        Drawn {
            report: report.clone(),
            look,
            reach,
            texture: ui.ctx().load_texture("samples", image, TextureOptions::LINEAR),
        }
    });
    Image::new(&drawn.texture).paint_at(ui, rect);
    marks(ui, rect, state.drawn.insert(drawn));
}

/// Half of what a view spans.
fn reach(report: &SampleReport, look: Look) -> f32 {
    if look != Look::Mirror {
        return 1.08;
    }
    let extents = projected(report, look).map(|[x, y]| x.abs().max(y.abs()));
    (1.08 * extents.fold(0.02, f32::max)).min(1.08)
}

/// The points as an image whose opacity grows with their number.
fn splat(report: &SampleReport, (look, side, color): (Look, usize, Color32), reach: f32) -> ColorImage {
    let mut counts = vec![0_u32; side * side];
    for [x, y] in projected(report, look) {
        let place = |t: f32| ((0.5 + 0.5 * t / reach) * side as f32).floor();
        let (column, row) = (place(x), place(-y));
        if column.min(row) >= 0.0 && column.max(row) < side as f32 {
            counts[row as usize * side + column as usize] += 1;
        }
    }
    // A lone point is seen among few and does not drown many.
    let lone = (6000.0 / report.cloud.samples.len().max(1) as f32).clamp(0.03, 0.9);
    let opacity = |count: u32| 1.0 - (1.0 - lone).powi(count.min(10_000) as i32);
    let pixels = counts.into_iter().map(|count| color.gamma_multiply(opacity(count)));
    ColorImage::new([side, side], pixels.collect())
}

/// Circles, lines and letters over the points.
fn marks(ui: &Ui, rect: Rect, drawn: &Drawn) {
    let model = &drawn.report.query.request.model;
    let mirror = mirror(&drawn.report);
    let middle = rect.center();
    let scale = 0.5 * rect.width() / drawn.reach;
    let at = |x: f32, y: f32| middle + scale * vec2(x, -y);
    let stroke = Stroke::new(1.0, ui.visuals().weak_text_color());
    let painter = ui.painter_at(rect);
    let font = TextStyle::Small.resolve(ui.style());
    let color = ui.visuals().text_color();
    let letter = |place: Pos2, text: &str| {
        painter.circle_filled(place, 2.0, color);
        let corner = place + vec2(5.0, -5.0);
        painter.text(corner, Align2::LEFT_BOTTOM, text, font.clone(), color);
    };
    let height = match drawn.look.0 {
        Look::Mirror | Look::Angle => {
            if model.lobe.has_curves() {
                painter.circle_stroke(middle, scale * model.roughness as f32, stroke);
            }
            return letter(middle, "r");
        }
        Look::Above => {
            letter(middle, "n");
            mirror.y
        }
        Look::Side => {
            painter.hline(rect.x_range(), middle.y, stroke);
            letter(at(0.0, 1.0), "n");
            mirror.z
        }
    };
    painter.circle_stroke(middle, scale, stroke);
    letter(at(mirror.x, height), "r");
    letter(at(-mirror.x, height), "v");
}

fn angle_plot(ui: &mut Ui, report: &SampleReport) {
    let visuals = ui.visuals().clone();
    let accent = theme::accent(ui);
    // Per degree, as the axis is.
    let degrees = |[alpha_rad, density]: &[f64; 2]| [alpha_rad.to_degrees(), density.to_radians()];
    let degrees = |line: &[[f64; 2]]| line.iter().map(degrees).collect::<Vec<_>>();
    let counted = degrees(&report.angle.counted);
    let width = 180.0 / counted.len().max(1) as f64;
    let bars = counted.iter().map(|[x, y]| Bar::new(*x, *y).width(width));
    let bars = BarChart::new("drawn", bars.collect()).color(accent.gamma_multiply(0.45));
    let last = counted.iter().rfind(|[_, y]| *y > 0.0);
    let last = last.map_or(90.0, |[x, _]| (1.15 * x).clamp(5.0, 180.0));
    let margin = ANGLE_MARGIN * last;
    let shown = still("angle", height(ui, 0.8, 280.0), [short, short])
        .x_axis_label("α: angle to the mirror direction, degrees")
        .legend(Legend::default().follow_insertion_order(true))
        .include_y(0.0)
        .include_x(0.0)
        .show(ui, |plot_ui| {
            plot_ui.set_plot_bounds_x(-margin..=last + margin);
            plot_ui.bar_chart(bars);
            // Empty for a mirror: what stands below it in the legend stays where it is.
            plot_ui.line(line("density", degrees(&report.angle.analytic), accent, 2.0));
            let greys = [visuals.strong_text_color(), visuals.weak_text_color()];
            for (other, color) in report.angle.others.iter().zip(greys) {
                let name = format!("{} {:.2}", other.lobe.label(), other.nearest.roughness);
                plot_ui.line(line(name, degrees(&other.analytic), color, 1.5));
            }
        });
    shown.response.accessible_name("How often each angle is drawn");
}

fn numbers(ui: &mut Ui, report: &SampleReport) {
    ui.add_space(4.0);
    let request = &report.query.request;
    let mut text = format!("{} samples", short_number(report.cloud.samples.len() as f64));
    if report.cloud.absorbed > 0 {
        let share = f64::from(report.cloud.absorbed) / f64::from(request.count.max(1));
        text += &format!(", {:.1} % absorbed", 100.0 * share);
    }
    ui.label(text);
    let what = match request.model.horizon {
        Horizon::Mirror => "mirrored at the surface",
        Horizon::Absorb => "absorbed",
        Horizon::None => "kept",
    };
    ui.label(format!(
        "{:.2} % fall below the surface and are {what}",
        100.0 * report.below_share
    ));
    for other in &report.angle.others {
        let [roughness, apart] = [other.nearest.roughness, 100.0 * other.nearest.total_variation];
        ui.label(format!(
            "nearest {}: roughness {roughness:.3}, {apart:.1} % difference",
            other.lobe.label()
        ));
    }
    let engine = match report.query.engine {
        EngineChoice::Gpu => "Drawn by the shader's own function.",
        _ => "Drawn by the CPU engine's own function.",
    };
    widgets::note(ui, engine);
}
