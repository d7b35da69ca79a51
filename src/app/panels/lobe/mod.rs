//! The selected material's lobe as slices, bodies, maps and curves, beside another lobe or a measured material, to which
//! it can be matched.

mod line_plot;
mod matching;

use line_plot::{Radii, line_plot, plot_height};
use matching::MatchState;

use super::*;
use crate::{
    kit::tile::rgb_pixels,
    matching::lobe_of_material,
    optics::curve::Curve,
    optics::lobe::{Lobe, model::LobeModel},
    plot::lobe_view::{LinePlot, LobeView, MapPlot, SolidPlot, ViewKind, lobe_view},
    plot::plot_picture,
    services::beside::Beside,
};

/// Images are drawn this much larger than they are shown on a screen of one pixel a point.
const ZOOM: f64 = 1.5;

/// What the lobe is compared with.
#[derive(Clone, Default, PartialEq)]
enum Other {
    #[default]
    Nothing,
    Lobe(Lobe),
    Measured,
}

/// The selected material's lobe, beside another one.
#[derive(Default)]
pub struct LobePanel {
    worker: Beside<Query, Arc<Answer>>,
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

/// A query, and what came of it.
type Answer = (Query, Drawn);

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
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk) {
        let kind = self.kind.unwrap_or(ViewKind::Polar);
        controls(ui, desk, self, kind);
        let material = lobe_of_material(&desk.material());
        if !material.has_density() {
            return widgets::note(ui, "A mirror has no lobe: give the material some roughness.");
        }
        if !kind.shows(material.lobe) {
            let text = "Only the geometric lobe has a distance D: choose it as the material's lobe, or another view.";
            return widgets::note(ui, text);
        }
        let other = other_lobe(self, desk);
        let query = Query {
            kind,
            lobes: std::iter::once(material).chain(other.clone()).collect(),
            view_angle_deg: desk.shared.view_angle_deg.into(),
            is_dark: ui.visuals().dark_mode,
        };
        widgets::comes_and_goes(ui, |ui| view(ui, self, query));
        if self.other != Other::Nothing {
            ui.add_space(crate::kit::theme::GAP);
            let target = match self.other {
                Other::Measured => desk.shared.measured.clone().map(matching::Source::File),
                _ => other.map(matching::Source::Lobe),
            };
            matching::show(ui, desk, &mut self.matching, target);
        }
    }
}

/// The lobe compared with, where there is one.
fn other_lobe(panel: &LobePanel, desk: &Desk) -> Option<LobeModel> {
    let Other::Lobe(lobe) = panel.other else { return None };
    let roughness = panel.other_roughness.unwrap_or(desk.material().roughness);
    let model = LobeModel::new(lobe, f64::from((roughness * 1e3).round()) / 1e3, Curve::Smooth);
    model.has_density().then_some(model)
}

fn controls(ui: &mut Ui, desk: &mut Desk, panel: &mut LobePanel, mut kind: ViewKind) {
    let name = ["Lobe view", "View", "What of the lobe is shown."];
    widgets::row(ui, name, |ui| {
        widgets::choice(ui, "lobe view", &mut kind, &widgets::choices())
    });
    panel.kind = Some(kind);
    if kind.is_of_view() && !kind.is_against_angle() {
        desk.view_angle_row(ui);
    }
    let mut others = vec![(Other::Nothing, "Nothing", "")];
    let lobes = Lobe::ALL.iter().filter(|lobe| lobe.has_roughness());
    others.extend(lobes.map(|lobe| (Other::Lobe(*lobe), lobe.label(), lobe.help())));
    let help = "A material of the MERL database (.binary).";
    others.push((Other::Measured, "Measured…", help));
    let help = "What is drawn beside the material's lobe.";
    let name = ["Compare the lobe", "Compare with", help];
    let is_other = widgets::row(ui, name, |ui| {
        widgets::choice(ui, "other lobe", &mut panel.other, &others)
    });
    if is_other && panel.other == Other::Measured {
        desk.act(Command::OpenMeasured);
    }
    if matches!(panel.other, Other::Lobe(_)) {
        let own = desk.material().roughness;
        let style = NumberStyle::plain(0.0..=1.0, "", 0.005, 3).with_bar([0.0, 1.0]);
        let help = "Follows the material's until it is changed.";
        let name = ["Other roughness", "Reference roughness", help];
        widgets::value_row(ui, name, &mut panel.other_roughness, None, |ui, roughness| {
            widgets::number_following(ui, roughness, own, &style)
        });
    }
    ui.add_space(4.0);
}

fn view(ui: &mut Ui, state: &mut LobePanel, query: Query) {
    let worker = &mut state.worker;
    let answer = worker.ask(ui.ctx(), "lobe view", query.clone(), |query, responder| {
        let shown = compute(&query);
        responder.publish(Arc::new((query, shown)))
    });
    widgets::failure(ui, worker.failure());
    let Some(answer) = answer.filter(|answer| answer.0.is_named_like(&query)) else {
        if worker.is_busy() {
            computing(ui);
        }
        return;
    };
    if answer.0 != query && worker.is_busy() {
        // Of another width or angle, until the new one is there.
        ui.multiply_opacity(0.5);
    }
    match &answer.1 {
        Drawn::Lines(plot) => {
            line_plot(ui, "lobe view", plot, &state.radii);
            widgets::comes_and_goes(ui, |ui| {
                if plot.is_polar {
                    state.radii.rows(ui, plot);
                }
            });
        }
        Drawn::Pictures(images) => {
            let is_known = state
                .pictured
                .as_ref()
                .is_some_and(|pictured| Arc::ptr_eq(pictured, &answer));
            if !is_known {
                let load = |image: &ColorImage| {
                    ui.ctx()
                        .load_texture("lobe view", image.clone(), TextureOptions::LINEAR)
                };
                state.pictures = images.iter().map(load).collect();
                state.pictured = Some(answer.clone());
            }
            for texture in &state.pictures {
                ui.add(Image::new(texture).max_width(ui.available_width()));
            }
        }
    }
}

/// A place as large as a chart's, until that is there: nothing of another name is shown in it.
fn computing(ui: &mut Ui) {
    let size = vec2(ui.available_width(), plot_height(ui));
    let (place, response) = ui.allocate_exact_size(size, Sense::hover());
    widgets::describe(&response, Role::Label, "Computing the lobe");
    let spinner = Rect::from_center_size(place.center(), Vec2::splat(24.0));
    Spinner::new().paint_at(ui, spinner);
}

fn compute(query: &Query) -> Drawn {
    let angles_deg = if query.kind.is_against_angle() {
        query.kind.view_angles_deg()
    } else {
        vec![query.view_angle_deg]
    };
    // One figure a lobe, under each other, on a common scale: the panel is narrow.
    let mut figures: Vec<LobeView> = Vec::new();
    match lobe_view(query.kind, &query.lobes, &angles_deg) {
        LobeView::Lines(plot) => return Drawn::Lines(plot),
        LobeView::Maps(MapPlot { title, range, maps }) => figures.extend(maps.into_iter().map(|map| {
            let (title, maps) = (title.clone(), vec![map]);
            LobeView::Maps(MapPlot { title, range, maps })
        })),
        LobeView::Solids(SolidPlot { title, solids }) => figures.extend(solids.into_iter().map(|solid| {
            let (title, solids) = (title.clone(), vec![solid]);
            LobeView::Solids(SolidPlot { title, solids })
        })),
    }
    let pictures = figures
        .iter()
        .filter_map(|figure| plot_picture(figure, ZOOM, query.is_dark));
    Drawn::Pictures(pictures.map(|picture| rgb_pixels(&picture)).collect())
}
