//! The selected material's lobe as slices, bodies, maps and curves, beside another lobe or a measured material, to which
//! it can be matched.

mod line_plot;
mod matching;

use std::sync::Arc;

use egui::{ColorImage, TextureHandle, TextureOptions, Ui};

use line_plot::{Radii, line_plot, plot_height};
use matching::MatchState;

use super::Panel;
use crate::app::desk::Desk;
use crate::app::kit::widgets::{self, Name, NumberStyle};
use crate::app::services::beside::started;
use crate::matching::lobe_of_material;
use crate::optics::curve::Curve;
use crate::optics::lobe::Lobe;
use crate::optics::lobe::model::LobeModel;
use crate::plot::lobe_view::{LinePlot, LobeView, MapPlot, SolidPlot, ViewKind, lobe_view};
use crate::plot::lobe_view_picture;
use crate::render::background::Background;

/// Images are drawn this much larger than they are shown on a screen of one pixel a point.
const ZOOM: f64 = 1.5;

/// Opacity of a figure while its successor is being computed.
const OLD_OPACITY: f32 = 0.5;

/// What the lobe is compared with.
#[derive(Clone, Debug, Default, PartialEq)]
enum Other {
    #[default]
    Nothing,
    Lobe(Lobe),
    Measured,
}

/// The selected material's lobe, beside another one.
#[derive(Default)]
pub struct LobePanel {
    worker: Option<Background<Query, Arc<Answer>>>,
    asked: Option<Query>,
    kind: Option<ViewKind>,
    other: Other,
    other_roughness: Option<f32>,
    radii: Radii,
    pictures: Vec<TextureHandle>,
    pictured: Option<Arc<Answer>>,
    matching: MatchState,
}

#[derive(Clone, PartialEq)]
struct Query {
    kind: ViewKind,
    lobes: Vec<LobeModel>,
    view_angle_deg: f64,
    is_dark: bool,
}

/// What came of a query.
struct Answer {
    query: Query,
    shown: Drawn,
}

impl Query {
    /// Whether what is shown of one of them goes by the other's name as well: the same view of the same lobes, whose widths
    /// may differ.
    fn is_named_like(&self, other: &Self) -> bool {
        let names = |query: &Self| query.lobes.iter().map(|lobe| lobe.lobe).collect::<Vec<_>>();
        self.kind == other.kind && self.is_dark == other.is_dark && names(self) == names(other)
    }
}

enum Drawn {
    Lines(LinePlot),
    Pictures(Vec<ColorImage>),
}

impl Panel for LobePanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        let kind = self.kind.unwrap_or(ViewKind::Polar);
        controls(ui, desk, self, kind);
        let material = lobe_of_material(&desk.material());
        if !material.has_density() {
            widgets::note(ui, "A mirror has no lobe: give the material some roughness.");
            return;
        }
        if !kind.shows(material.lobe) {
            widgets::note(
                ui,
                "Only the geometric lobe has a distance D: choose it as the material's lobe, or another view.",
            );
            return;
        }
        let other = other_lobe(self, desk);
        let view_angle_deg = f64::from(desk.shared.lobe_plots.view_angle_deg);
        let query = Query {
            kind,
            lobes: [Some(material), other.clone()].into_iter().flatten().collect(),
            view_angle_deg,
            is_dark: ui.visuals().dark_mode,
        };
        widgets::comes_and_goes(ui, |ui| view(ui, self, query));
        if self.other != Other::Nothing {
            ui.add_space(crate::app::kit::theme::GAP);
            let target = match self.other {
                Other::Measured => desk.shared.lobe_plots.measured.clone().map(matching::Source::File),
                _ => other.map(matching::Source::Lobe),
            };
            matching::show(ui, desk, &mut self.matching, target);
        }
    }
}

/// The lobe compared with, where there is one.
fn other_lobe(panel: &LobePanel, desk: &Desk<'_>) -> Option<LobeModel> {
    let Other::Lobe(lobe) = panel.other else {
        return None;
    };
    let roughness = panel.other_roughness.unwrap_or(desk.material().roughness);
    let model = LobeModel::new(lobe, f64::from((roughness * 1e3).round()) / 1e3, Curve::Smooth);
    model.has_density().then_some(model)
}

fn controls(ui: &mut Ui, desk: &mut Desk<'_>, panel: &mut LobePanel, mut kind: ViewKind) {
    let name = Name::new("Lobe view", "View", "What of the lobe is shown.");
    if widgets::row(ui, name, |ui| {
        widgets::choice(ui, "lobe view", &mut kind, &widgets::choices())
    })
    .changed
    {
        panel.kind = Some(kind);
    }
    if kind.is_of_view() && !kind.is_against_angle() {
        desk.view_angle_row(ui);
    }
    let mut others = vec![(Other::Nothing, "Nothing", "")];
    let lobes = Lobe::ALL.iter().filter(|lobe| lobe.has_roughness());
    others.extend(lobes.map(|lobe| (Other::Lobe(*lobe), lobe.label(), lobe.help())));
    others.push((
        Other::Measured,
        "Measured…",
        "A material of the MERL database (.binary).",
    ));
    let name = Name::new(
        "Compare the lobe",
        "Compare with",
        "What is drawn beside the material's lobe.",
    );
    let mut other = panel.other.clone();
    if widgets::row(ui, name, |ui| widgets::choice(ui, "other lobe", &mut other, &others)).changed {
        if other == Other::Measured {
            desk.act(crate::app::actions::Command::OpenMeasured);
        }
        panel.other = other;
    }
    if matches!(panel.other, Other::Lobe(_)) {
        let mut roughness = panel.other_roughness.unwrap_or(desk.material().roughness);
        let style = NumberStyle::plain(0.0..=1.0, "", 0.005, 3).with_bar([0.0, 1.0]);
        let name = Name::new(
            "Other roughness",
            "Reference roughness",
            "Follows the material's until it is changed.",
        );
        let response = widgets::row(ui, name, |ui| widgets::number(ui, &mut roughness, &style));
        if response.changed {
            panel.other_roughness = Some(roughness);
        }
        if response.reset {
            panel.other_roughness = None;
        }
    }
    ui.add_space(4.0);
}

fn view(ui: &mut Ui, state: &mut LobePanel, query: Query) {
    let worker = started(&mut state.worker, ui.ctx(), |repaint| {
        Background::spawn("lobe view", repaint, |query, responder| {
            let shown = compute(&query);
            responder.publish(Arc::new(Answer { query, shown }))
        })
    });
    let Some(worker) = worker else {
        widgets::note(ui, "Cannot start a thread to compute.");
        return;
    };
    if state.asked.as_ref() != Some(&query) {
        worker.ask(query.clone());
        state.asked = Some(query.clone());
    }
    widgets::failure(ui, worker.failure());
    let answer = worker.latest().filter(|answer| answer.query.is_named_like(&query));
    let Some(answer) = answer else {
        if worker.is_busy() {
            computing(ui);
        }
        return;
    };
    if answer.query != query && worker.is_busy() {
        // Of another width or angle, until the new one is there.
        ui.multiply_opacity(OLD_OPACITY);
    }
    match &answer.shown {
        Drawn::Lines(plot) => {
            line_plot(ui, "lobe view", plot, &state.radii);
            widgets::comes_and_goes(ui, |ui| {
                if plot.is_polar {
                    state.radii.rows(ui, plot);
                }
            });
        }
        Drawn::Pictures(images) => {
            if !state
                .pictured
                .as_ref()
                .is_some_and(|pictured| Arc::ptr_eq(pictured, &answer))
            {
                let load = |image: &ColorImage| {
                    ui.ctx()
                        .load_texture("lobe view", image.clone(), TextureOptions::LINEAR)
                };
                state.pictures = images.iter().map(load).collect();
                state.pictured = Some(answer.clone());
            }
            for texture in &state.pictures {
                ui.add(egui::Image::new(texture).max_width(ui.available_width()));
            }
        }
    }
}

/// A place as large as a chart's, until that is there: nothing of another name is shown in it.
fn computing(ui: &mut Ui) {
    let width = ui.available_width();
    let (place, response) = ui.allocate_exact_size(egui::vec2(width, plot_height(width)), egui::Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, "Computing the lobe"));
    let spinner = egui::Rect::from_center_size(place.center(), egui::Vec2::splat(24.0));
    egui::Spinner::new().paint_at(ui, spinner);
}

fn compute(query: &Query) -> Drawn {
    let angles_deg = if query.kind.is_against_angle() {
        query.kind.view_angles_deg()
    } else {
        vec![query.view_angle_deg]
    };
    // One figure a lobe, under each other, on a common scale: the panel is narrow.
    let figures: Vec<LobeView> = match lobe_view(query.kind, &query.lobes, &angles_deg) {
        LobeView::Lines(plot) => return Drawn::Lines(plot),
        LobeView::Maps(MapPlot { title, range, maps }) => maps
            .into_iter()
            .map(|map| {
                LobeView::Maps(MapPlot {
                    title: title.clone(),
                    range,
                    maps: vec![map],
                })
            })
            .collect(),
        LobeView::Solids(SolidPlot { title, solids }) => solids
            .into_iter()
            .map(|solid| {
                LobeView::Solids(SolidPlot {
                    title: title.clone(),
                    solids: vec![solid],
                })
            })
            .collect(),
    };
    let pictures = figures
        .iter()
        .filter_map(|figure| lobe_view_picture(figure, ZOOM, query.is_dark));
    let image = |picture: image::RgbImage| {
        let size = [picture.width() as usize, picture.height() as usize];
        ColorImage::from_rgb(size, picture.as_raw())
    };
    Drawn::Pictures(pictures.map(image).collect())
}
