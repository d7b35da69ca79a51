//! "Match look": gives the material the lobe that comes closest to another one's or to a measured material's.

use std::path::PathBuf;

use super::line_plot::{Radii, line_plot};
use super::*;
use crate::analysis::fit::Merl;
use crate::matching::{LookMatch, Target, VIEW_ANGLE_MAX_DEG, comparison, match_look};

#[derive(Clone, PartialEq)]
pub enum Source {
    Lobe(LobeModel),
    File(PathBuf),
}

#[derive(Clone, PartialEq)]
struct Query {
    source: Source,
    lobe: Lobe,
    view_angle_deg: f64,
}

/// What was found, with target and candidates as a plot.
struct Matched {
    query: Query,
    found: LookMatch,
    plot: LinePlot,
}

type Answer = Result<Arc<Matched>, String>;

/// What the panel remembers.
#[derive(Default)]
pub struct MatchState {
    worker: Beside<Query, Answer>,
}

/// The button, and what came of it.
pub fn show(ui: &mut Ui, desk: &mut Desk, state: &mut MatchState, source: Option<Source>) {
    let Some(source) = source else {
        if ui.button("Choose a measured material…").clicked() {
            desk.act(Command::OpenMeasured);
        }
        return;
    };
    if let Source::File(path) = &source {
        ui.weak(path.file_name().unwrap_or_default().to_string_lossy());
    }
    let material = desk.material();
    let query = Query {
        source,
        lobe: Some(material.lobe)
            .filter(|lobe| lobe.has_roughness())
            .unwrap_or(Lobe::Geometric),
        view_angle_deg: f64::from(desk.shared.view_angle_deg).min(VIEW_ANGLE_MAX_DEG),
    };
    let worker = &mut state.worker;
    let is_busy = worker.is_busy();
    ui.horizontal(|ui| {
        let help = "Looks for the roughness, and for the geometric lobe also the curve, that come closest to it at \
                    this view angle.";
        if widgets::pressed_if(ui, !is_busy, "Match look", help, "") {
            worker.ask_again(ui.ctx(), "match look", query.clone(), |query, responder| {
                responder.publish(find(query));
            });
        }
        if is_busy {
            ui.add(Spinner::new().size(12.0));
        }
    });
    widgets::failure(ui, worker.failure());
    match worker.latest() {
        None => {}
        Some(Err(why)) => widgets::failure(ui, why),
        Some(Ok(matched)) => result(ui, desk, &matched, matched.query == query),
    }
}

fn result(ui: &mut Ui, desk: &mut Desk, matched: &Matched, is_current: bool) {
    let found = &matched.found;
    Grid::new("residuals").num_columns(3).show(ui, |ui| {
        let rows = [
            ("Before", &found.before),
            ("Roughness matched", &found.nearest),
            ("Curve too", &found.after),
        ];
        let count = if found.curve.is_some() { 3 } else { 2 };
        for (label, candidate) in rows.into_iter().take(count) {
            ui.label(label);
            ui.label(format!("R {:.3}", candidate.model.roughness));
            ui.label(format!("{:.1} % difference", 100.0 * candidate.total_variation))
                .on_hover_text("Total variation distance: the share of the highlight that lies elsewhere");
            ui.end_row();
        }
    });
    ui.weak(format!("{}, view {}°", found.target, found.view_angle_deg));
    line_plot(ui, "match look", &matched.plot, &Radii::default());
    let help = if is_current {
        "Gives the selected material this lobe. Undo takes it back."
    } else {
        "Found for other settings than the present ones; match again for these."
    };
    if widgets::pressed(ui, "Use it", help) {
        let mut material = desk.material();
        found.apply(&mut material);
        desk.actions.push(Action::UseMaterial(Box::new(material)));
    }
}

fn find(query: Query) -> Answer {
    let target = match &query.source {
        Source::Lobe(model) => Target::Lobe(model.clone()),
        Source::File(path) => Target::Measured {
            name: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            merl: Arc::new(Merl::load(path).map_err(crate::in_words)?),
        },
    };
    let found = match_look(&target, query.lobe, query.view_angle_deg).map_err(crate::in_words)?;
    let plot = comparison(&target, &found).map_err(crate::in_words)?;
    Ok(Arc::new(Matched { query, found, plot }))
}
