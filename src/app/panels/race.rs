//! The race: techniques against each other on this view, and the one that is worth its time.

use std::time::Duration;

use egui_plot::{PlotPoint, PlotResponse, Points, Text};

use super::*;
use crate::{
    document::ViewSettings,
    job::{film::Image, plan::Plan},
    kit::{
        charts::{height, line, log_log, nearest},
        tile::pixels,
        words::{about, duration, percent},
    },
    measuring::{StudyWorker, engine, small_document},
    named::with_defaults,
    render::display::display,
    study::race::{Race, RaceOptions, Runner, race},
    study::technique::{GROUPS, Technique},
};

/// Longest side of the raced image, pixels.
const SIDE_MAX: u32 = 160;
/// Width of a thumbnail, points.
const THUMBNAIL: f32 = 112.0;
/// Kinds that are chosen at first.
const CHOSEN: [&str; 3] = ["strategy", "bounces", "fresnel"];
/// Kinds for developers: `study accuracy` races them.
const FOR_DEVELOPERS: [&str; 2] = ["sequence", "effect"];
/// How long each technique renders at first.
const SECONDS: f64 = 2.0;
/// References are rendered for up to this many times each technique's racing time.
const REFERENCE_TIMES: f64 = 4.0;

with_defaults! {
    /// Techniques against each other on this view.
    pub struct RacePanel {
        worker: StudyWorker<Race>,
        chosen: Vec<&'static str> = CHOSEN.to_vec(),
        seconds: f64 = SECONDS,
        shows_equal_error: bool,
        pictured: Option<Pictured>,
    }
}

/// The thumbnails of a race.
struct Pictured {
    race: Arc<Race>,
    /// Of equal time, and of equal error.
    textures: [Vec<TextureHandle>; 2],
}

impl Panel for RacePanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk) {
        let state = self;
        choices(ui, state);
        let help = "Renders each technique in turn; measures noise and bias.";
        let (chosen, seconds) = (state.chosen.clone(), state.seconds);
        let takes = desk.snapshot.scene.as_ref().map(|scene| {
            let most = seconds_at_most(&techniques(&chosen, &scene.job.plan), seconds);
            format!("takes at most {}", about(most))
        });
        state
            .worker
            .controls(ui, desk, ("Run the race", help, true), takes, |desk| {
                let document = small_document(desk, SIDE_MAX);
                let scene = desk.snapshot.scene.as_ref();
                let plan = scene.map_or_else(Plan::general, |scene| scene.job.plan.clone());
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

    fn tick(&mut self, desk: &mut Desk) {
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
    for group in GROUPS.iter().filter(|group| !FOR_DEVELOPERS.contains(&group.name)) {
        let mut is_chosen = state.chosen.contains(&group.name);
        let choice = ui.checkbox(&mut is_chosen, group.label).on_hover_text(group.help);
        if choice.changed() {
            match is_chosen {
                true => state.chosen.push(group.name),
                false => state.chosen.retain(|name| *name != group.name),
            }
        }
    }
    let style = NumberStyle::plain(0.01..=600.0, " s", 0.1, 2);
    let help = "How long each technique renders.";
    let name = ["Time per technique", "Time each", help];
    widgets::number_row(ui, name, &mut state.seconds, SECONDS, &style);
}

fn outcome(ui: &mut Ui, desk: &mut Desk, state: &mut RacePanel, race: &Arc<Race>) {
    let is_stale = state.worker.is_stale(desk);
    let charted = chart(ui, race);
    widgets::note(
        ui,
        format!(
            "Left: faster, to a noise of {}. Low: less bias against the most accurate image; hollow, with a line down: at \
             most so much. Click a point or a name to use its settings.",
            percent(race.noise)
        ),
    );
    if race.runners.iter().any(Runner::is_limit) {
        widgets::note(ui, "Too short to tell all biases: raise the time of each.");
    }
    let taken = table(ui, race, is_stale).or(charted);
    if let Some(index) = taken.filter(|_| !is_stale) {
        // Undo takes the settings back.
        let Runner { technique, label, .. } = &race.runners[index];
        *desk.document = technique.apply(desk.document);
        desk.edits.did(format!("Use the race's {}", label.to_lowercase()));
        state.worker.holds_for(desk.document);
    }
    pictures(ui, desk, state, race);
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
    let front = race.runners.iter().filter(|runner| runner.is_on_front);
    let mut best: Vec<[f64; 2]> = front.map(place).collect();
    best.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let accent = theme::accent(ui);
    let weak = ui.visuals().weak_text_color();
    let height = height(ui, 0.8, 120.0);
    let time = format!("Time to a noise of {}", percent(race.noise));
    let shown: PlotResponse<()> = log_log("race", [&time, "Bias"], height, [0.2, 0.12]).show(ui, |plot_ui| {
        plot_ui.line(line("best", best, accent.gamma_multiply(0.6), 1.5));
        for (runner, place) in std::iter::zip(&race.runners, &places) {
            let color = if runner.is_on_front { accent } else { weak };
            let name = &runner.label;
            let points = Points::new(name, *place).color(color).radius(4.0);
            plot_ui.points(points.filled(!runner.is_limit()));
            if runner.is_limit() {
                let down = vec![*place, [place[0], least.log10()]];
                plot_ui.line(line("at most", down, color, 1.0));
            }
            if runner.is_on_front {
                let at = PlotPoint::new(place[0], place[1]);
                let text = Text::new(name, at, format!(" {name}")).color(color);
                plot_ui.text(text.anchor(Align2::LEFT_BOTTOM));
            }
        }
    });
    let (response, transform) = (shown.response, shown.transform);
    let at = response.interact_pointer_pos().filter(|_| response.clicked());
    response.accessible_name("Time against bias");
    let nearest = nearest(&places, &transform, at?)?;
    is_setting(&race.runners[nearest]).then_some(nearest)
}

/// Whether it can become a document's.
fn is_setting(runner: &Runner) -> bool {
    runner.technique != Technique::as_is()
}

/// The same as a table, the soonest first; the one that was chosen.
fn table(ui: &mut Ui, race: &Race, is_stale: bool) -> Option<usize> {
    let mut order: Vec<(usize, &Runner)> = race.runners.iter().enumerate().collect();
    order.sort_by(|(_, a), (_, b)| a.time_to_noise.total_cmp(&b.time_to_noise));
    let mut taken = None;
    Grid::new("runners").num_columns(3).striped(true).show(ui, |ui| {
        let to_noise = format!("To {}", percent(race.noise));
        for heading in ["", to_noise.as_str(), "Bias"] {
            ui.weak(heading);
        }
        ui.end_row();
        for (index, runner) in order {
            let text = RichText::new(&runner.label);
            let text = if runner.is_on_front { text.strong() } else { text };
            let button = ui.add_enabled(is_setting(runner) && !is_stale, Button::new(text).small());
            let button = button.on_hover_text("Gives the document these settings. Undo takes it back.");
            let button = button.on_disabled_hover_text(if is_stale {
                "The race was run before the last changes: run it again."
            } else {
                "Not a setting of a document."
            });
            if button.clicked() {
                taken = Some(index);
            }
            button.accessible_name(format!("Use {}", runner.label));
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
            ui.end_row();
        }
    });
    taken
}

fn bias(runner: &Runner) -> String {
    if runner.is_unbiased {
        "none".to_owned()
    } else if runner.is_limit() {
        format!("< {}", percent(runner.bias.high))
    } else {
        percent(runner.bias.value)
    }
}

/// The thumbnails of equal time or of equal error.
fn pictures(ui: &mut Ui, desk: &Desk, state: &mut RacePanel, race: &Arc<Race>) {
    ui.horizontal(|ui| {
        ui.selectable_value(&mut state.shows_equal_error, false, "Equal time");
        ui.selectable_value(&mut state.shows_equal_error, true, "Equal error");
    });
    let pictured = state.pictured.take_if(|pictured| Arc::ptr_eq(&pictured.race, race));
    let pictured = pictured.unwrap_or_else(|| pictured_now(ui, race, &desk.document.view));
    let pictured = state.pictured.insert(pictured);
    let textures = &pictured.textures[usize::from(state.shows_equal_error)];
    let rows = Layout::left_to_right(Align::TOP).with_main_wrap(true);
    ui.with_layout(rows, |ui| {
        for (runner, texture) in std::iter::zip(&race.runners, textures) {
            // In rows: of a place without a size it is not known that the next row is to begin.
            ui.allocate_ui_with_layout(Vec2::splat(THUMBNAIL), Layout::top_down(Align::Min), |ui| {
                ui.add(egui::Image::new(texture).max_width(THUMBNAIL).alt_text(&runner.label));
                let (error, seconds) = if state.shows_equal_error {
                    (race.equal_error, runner.equal_error_seconds)
                } else {
                    (runner.error.value, runner.seconds)
                };
                let text = format!("{}: {} in {}", runner.label, percent(error), duration(seconds));
                ui.small(text);
            });
        }
    });
}

fn pictured_now(ui: &Ui, race: &Arc<Race>, view: &ViewSettings) -> Pictured {
    let load = |of_runner: fn(&Runner) -> &Image| {
        let images = race.runners.iter().map(of_runner);
        let textures = images.map(|image| {
            let pixels = pixels([image.width, image.height], &display(image, view));
            ui.ctx().load_texture("race", pixels, TextureOptions::LINEAR)
        });
        textures.collect()
    };
    Pictured {
        race: race.clone(),
        textures: [load(|runner| &runner.equal_time), load(|runner| &runner.equal_error)],
    }
}
