//! The race: techniques against each other on this view, and the one that is worth its time.

use std::sync::Arc;
use std::time::Duration;

use egui::{ColorImage, TextureHandle, TextureOptions, Ui};
use egui_plot::{Line, PlotPoint, PlotPoints, PlotResponse, Points, Text};

use super::Panel;
use crate::app::actions::Command;
use crate::app::desk::Desk;
use crate::app::kit::charts::log_log;
use crate::app::kit::widgets::{self, Name, NumberStyle};
use crate::app::kit::words::{about, duration, percent};
use crate::app::kit::{theme, widgets::RowResponse};
use crate::app::study::{StudyWorker, engine, small_document};
use crate::document::ViewSettings;
use crate::job::plan::Plan;
use crate::render::display::display;
use crate::study::race::{Race, RaceOptions, Runner, race};
use crate::study::technique::{GROUPS, Technique};

/// Longest side of the raced image, pixels.
const SIDE_MAX: u32 = 160;
/// Width of a thumbnail, points.
const THUMBNAIL: f32 = 112.0;
/// How near to a point a click must be, points.
const REACH: f32 = 14.0;
/// Kinds that are chosen at first.
const CHOSEN: [&str; 3] = ["strategy", "bounces", "fresnel"];
/// References are rendered for up to this many times each technique's racing time.
const REFERENCE_TIMES: f64 = 4.0;

/// Techniques against each other on this view.
pub struct RacePanel {
    worker: StudyWorker<Race>,
    chosen: Vec<&'static str>,
    seconds: f64,
    shows_equal_error: bool,
    pictured: Option<Pictured>,
}

/// The thumbnails of a race.
struct Pictured {
    race: Arc<Race>,
    equal_time: Vec<TextureHandle>,
    equal_error: Vec<TextureHandle>,
}

impl Default for RacePanel {
    fn default() -> Self {
        Self {
            worker: StudyWorker::default(),
            chosen: CHOSEN.to_vec(),
            seconds: 2.0,
            shows_equal_error: false,
            pictured: None,
        }
    }
}

impl Panel for RacePanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        let state = self;
        choices(ui, state);
        let help = "Renders each technique in turn; measures noise and bias.";
        let (chosen, seconds) = (state.chosen.clone(), state.seconds);
        let takes = desk.snapshot.scene.as_ref().map(|scene| {
            let most = seconds_at_most(&techniques(&chosen, &scene.job.plan), seconds);
            format!("takes at most {}", about(most))
        });
        state.worker.controls(ui, desk, ("Run the race", help), takes, |desk| {
            let document = small_document(desk, SIDE_MAX);
            let plan = desk
                .snapshot
                .scene
                .as_ref()
                .map_or_else(Plan::general, |scene| scene.job.plan.clone());
            let options = RaceOptions {
                seconds,
                slice: Duration::from_secs_f64((seconds / 20.0).clamp(0.005, 0.25)),
                reference_seconds: REFERENCE_TIMES * seconds,
                ..RaceOptions::new(engine(desk), techniques(&chosen, &plan))
            };
            Box::new(move |watch| race(&document, &options, watch))
        });
        match state.worker.found() {
            None => widgets::note(
                ui,
                "Which settings are worth their time on this view: how soon each reaches a noise of 2 %, and how far it \
                 stays from the most accurate image.",
            ),
            Some(found) => outcome(ui, desk, state, &found),
        }
    }

    fn tick(&mut self, desk: &mut Desk<'_>) {
        self.worker.tick(desk);
    }

    fn on_command(&mut self, command: Command) {
        if command == Command::Race {
            self.worker.request();
        }
    }
}

/// The techniques of the groups that are chosen.
fn techniques(chosen: &[&str], plan: &Plan) -> Vec<Technique> {
    let groups = GROUPS.iter().filter(|group| chosen.contains(&group.name));
    groups.flat_map(|group| group.members(plan)).collect()
}

/// Longest time of a race: a reference of each technique and of the most accurate one, where none of them is kept from
/// before; the race; and renders to an equal error.
fn seconds_at_most(techniques: &[Technique], seconds: f64) -> f64 {
    let runners = (techniques.len() + 1) as f64;
    seconds * (REFERENCE_TIMES * (runners + 1.0) + 2.0 * runners)
}

fn choices(ui: &mut Ui, state: &mut RacePanel) {
    for group in GROUPS {
        let mut is_chosen = state.chosen.contains(&group.name);
        if ui
            .checkbox(&mut is_chosen, group.label)
            .on_hover_text(group.help)
            .changed()
        {
            state.chosen.retain(|name| *name != group.name);
            if is_chosen {
                state.chosen.push(group.name);
            }
        }
    }
    let style = NumberStyle::plain(0.01..=600.0, " s", 0.1, 2);
    let name = Name::new(
        "Time per technique",
        "Time per technique",
        "How long each of them renders.",
    );
    let RowResponse { reset, .. } = widgets::row(ui, name, |ui| widgets::number(ui, &mut state.seconds, &style));
    if reset {
        state.seconds = RacePanel::default().seconds;
    }
}

fn outcome(ui: &mut Ui, desk: &mut Desk<'_>, state: &mut RacePanel, race: &Arc<Race>) {
    let is_stale = state.worker.is_stale(desk);
    let mut taken = chart(ui, race);
    widgets::note(
        ui,
        format!(
            "Left: faster, to a noise of {}. Low: less bias against the most accurate image; on the lowest line none \
             could be measured. Click a point to use its settings.",
            percent(race.noise)
        ),
    );
    taken = table(ui, race, is_stale).or(taken);
    if let Some(index) = taken.filter(|_| !is_stale) {
        take(desk, &race.runners[index].technique, &race.runners[index].label);
        state.worker.holds_for(desk.document);
    }
    pictures(ui, desk, state, race);
}

/// Gives the document a technique's settings; undo takes them back.
fn take(desk: &mut Desk<'_>, technique: &Technique, label: &str) {
    *desk.document = technique.apply(desk.document);
    desk.edits.note(format!("Use the race's {}", label.to_lowercase()), "");
}

/// The runners by time to the noise against bias; the one that was clicked.
fn chart(ui: &mut Ui, race: &Race) -> Option<usize> {
    let least = race.least_bias();
    let place = |runner: &Runner| {
        [
            runner.time_to_noise.max(1e-6).log10(),
            runner.charted_bias(least).log10(),
        ]
    };
    let places: Vec<[f64; 2]> = race.runners.iter().map(place).collect();
    let mut best: Vec<[f64; 2]> = std::iter::zip(&race.runners, &places)
        .filter(|(runner, _)| runner.is_on_front)
        .map(|(_, place)| *place)
        .collect();
    best.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let accent = theme::accent(ui.visuals().dark_mode);
    let weak = ui.visuals().weak_text_color();
    let height = (0.8 * ui.available_width()).clamp(180.0, 420.0);
    let time = format!("Time to a noise of {}", percent(race.noise));
    let shown: PlotResponse<()> = log_log("race", [&time, "Bias"], height, [0.2, 0.12]).show(ui, |plot_ui| {
        plot_ui.line(Line::new("best", PlotPoints::from(best)).color(accent.gamma_multiply(0.6)));
        for (runner, place) in std::iter::zip(&race.runners, &places) {
            let color = if runner.is_on_front { accent } else { weak };
            let name = runner.label.clone();
            plot_ui.points(
                Points::new(name.clone(), PlotPoints::from(vec![*place]))
                    .color(color)
                    .radius(4.0),
            );
            if runner.is_on_front {
                let at = PlotPoint::new(place[0], place[1]);
                let text = Text::new(name.clone(), at, format!(" {name}")).color(color);
                plot_ui.text(text.anchor(egui::Align2::LEFT_BOTTOM));
            }
        }
    });
    shown.response.clone().accessible_name("Time against bias");
    let at = shown
        .response
        .interact_pointer_pos()
        .filter(|_| shown.response.clicked())?;
    let distance = |place: &[f64; 2]| {
        let point = PlotPoint::new(place[0], place[1]);
        shown.transform.position_from_point(&point).distance(at)
    };
    let nearest = places
        .iter()
        .map(distance)
        .enumerate()
        .min_by(|(_, a), (_, b)| a.total_cmp(b));
    nearest
        .filter(|(index, distance)| *distance < REACH && is_setting(&race.runners[*index]))
        .map(|(index, _)| index)
}

/// Whether it can become a document's.
fn is_setting(runner: &Runner) -> bool {
    runner.technique != Technique::as_is()
}

/// The same as a table, the soonest first; the one that was chosen.
fn table(ui: &mut Ui, race: &Race, is_stale: bool) -> Option<usize> {
    let mut order: Vec<usize> = (0..race.runners.len()).collect();
    order.sort_by(|a, b| {
        race.runners[*a]
            .time_to_noise
            .total_cmp(&race.runners[*b].time_to_noise)
    });
    let mut taken = None;
    egui::Grid::new("runners").num_columns(4).striped(true).show(ui, |ui| {
        let to_noise = format!("To {}", percent(race.noise));
        for heading in ["", to_noise.as_str(), "Bias", ""] {
            ui.weak(heading);
        }
        ui.end_row();
        for index in order {
            let runner = &race.runners[index];
            let text = egui::RichText::new(&runner.label);
            ui.label(if runner.is_on_front { text.strong() } else { text });
            let time = ui.label(duration(runner.time_to_noise));
            time.on_hover_text(format!(
                "After {}: error {} ({} – {}), estimated {}; {:.1} samples per pixel",
                duration(runner.seconds),
                percent(runner.error.value),
                percent(runner.error.low),
                percent(runner.error.high),
                percent(runner.estimated_noise),
                runner.samples_per_pixel
            ));
            ui.label(bias(runner));
            let is_usable = is_setting(runner) && !is_stale;
            let button = ui.add_enabled(is_usable, egui::Button::new("Use").small());
            let button = button.on_hover_text("Gives the document these settings. Undo takes it back.");
            let button = button.on_disabled_hover_text(if is_stale {
                "The race was run before the last changes: run it again."
            } else {
                "Not a setting of a document."
            });
            button.clone().accessible_name(format!("Use {}", runner.label));
            if button.clicked() {
                taken = Some(index);
            }
            ui.end_row();
        }
    });
    taken
}

fn bias(runner: &Runner) -> String {
    if runner.is_unbiased {
        "none".to_owned()
    } else if runner.bias.is_resolved() {
        percent(runner.bias.value)
    } else {
        format!("< {}", percent(runner.bias.high))
    }
}

/// The thumbnails of equal time or of equal error.
fn pictures(ui: &mut Ui, desk: &Desk<'_>, state: &mut RacePanel, race: &Arc<Race>) {
    ui.horizontal(|ui| {
        ui.selectable_value(&mut state.shows_equal_error, false, "Equal time");
        ui.selectable_value(&mut state.shows_equal_error, true, "Equal error");
    });
    if state
        .pictured
        .as_ref()
        .is_none_or(|pictured| !Arc::ptr_eq(&pictured.race, race))
    {
        state.pictured = Some(pictured(ui, race, &desk.document.view));
    }
    let Some(pictured) = &state.pictured else { return };
    let textures = if state.shows_equal_error {
        &pictured.equal_error
    } else {
        &pictured.equal_time
    };
    ui.horizontal_wrapped(|ui| {
        for (runner, texture) in std::iter::zip(&race.runners, textures) {
            ui.vertical(|ui| {
                ui.set_width(THUMBNAIL);
                ui.add(egui::Image::new(texture).max_width(THUMBNAIL).alt_text(&runner.label));
                let (error, seconds) = if state.shows_equal_error {
                    (race.equal_error, runner.equal_error_seconds)
                } else {
                    (runner.error.value, runner.seconds)
                };
                let text = format!("{}: {} in {}", runner.label, percent(error), duration(seconds));
                ui.add(egui::Label::new(egui::RichText::new(text).small()).wrap());
            });
        }
    });
}

fn pictured(ui: &Ui, race: &Arc<Race>, view: &ViewSettings) -> Pictured {
    let load = |image: &crate::job::film::Image| {
        let size = [image.width as usize, image.height as usize];
        let pixels = ColorImage::from_rgba_unmultiplied(size, &display(image, view));
        ui.ctx().load_texture("race", pixels, TextureOptions::LINEAR)
    };
    Pictured {
        race: race.clone(),
        equal_time: race.runners.iter().map(|runner| load(&runner.equal_time)).collect(),
        equal_error: race.runners.iter().map(|runner| load(&runner.equal_error)).collect(),
    }
}
