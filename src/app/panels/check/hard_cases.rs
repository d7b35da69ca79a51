//! The hard cases, a line each with its verdict and, where it renders one, its image.

use std::sync::atomic::AtomicBool;

use super::run::Run;
use super::*;
use crate::app::kit::tile::pixels;
use crate::document::ViewSettings;
use crate::render::EngineChoice;
use crate::render::display::display;
use crate::study::StudyError;
use crate::study::hard::{HardRow, Stage, catalogue};

/// Side of a case's image in points.
const PICTURE_SIDE: f32 = 40.0;

/// How a run stands: the rows so far, and what is being run or went wrong.
#[derive(Clone, Default)]
struct Status {
    rows: Vec<HardRow>,
    running: Option<&'static str>,
    error: Option<String>,
}

/// What the page remembers.
#[derive(Default)]
pub struct HardState {
    run: Run<Status>,
    /// Images by case, as textures of this run.
    textures: Vec<(&'static str, TextureHandle)>,
}

/// The page, for the engine that renders.
pub fn show(ui: &mut Ui, state: &mut HardState, engine: EngineChoice) {
    widgets::note(
        ui,
        "Places where naive code breaks, each with what it does here: measured against its limit.",
    );
    let standing = state.run.show(ui, "Run the hard cases", || {
        state.textures.clear();
        Box::new(move |stop, publish| run(engine, stop, publish))
    });
    let Some(standing) = standing else { return };
    widgets::comes_and_goes(ui, |ui| {
        if let Some(name) = standing.running.filter(|_| !state.run.is_stopped()) {
            let (done, all) = (standing.rows.len(), catalogue().count());
            let left = state.run.left(", ", done as f64 / all as f64);
            widgets::note(ui, format!("{} ({} of {all}{left})", in_words(name), done + 1));
        }
    });
    widgets::failure(ui, standing.error);
    Grid::new("hard cases").num_columns(3).striped(true).show(ui, |ui| {
        for row in &standing.rows {
            line(ui, row, &mut state.textures);
            ui.end_row();
        }
    });
}

/// Runs case after case, publishing after each, until it is stopped.
fn run(engine: EngineChoice, stop: Arc<AtomicBool>, publish: &dyn Fn(Status)) {
    let mut standing = Status::default();
    let mut stage = match Stage::open(engine, false, stop) {
        Ok(stage) => stage,
        Err(error) => {
            standing.error = Some(error.to_string());
            return publish(standing);
        }
    };
    for case in catalogue() {
        standing.running = Some(case.name);
        publish(standing.clone());
        match case.run(&mut stage) {
            Ok(row) => standing.rows.push(row),
            Err(StudyError::Stopped) => return,
            Err(error) => standing.error = Some(error.to_string()),
        }
    }
    standing.running = None;
    publish(standing);
}

fn line(ui: &mut Ui, row: &HardRow, textures: &mut Vec<(&'static str, TextureHandle)>) {
    let HardRow {
        case, check, picture, ..
    } = row;
    match picture {
        Some(image) => {
            let known = textures.iter().position(|(name, _)| *name == case.name);
            let at = known.unwrap_or_else(|| {
                let image = pixels([image.width, image.height], &display(image, &ViewSettings::default()));
                let texture = ui.ctx().load_texture(case.name, image, TextureOptions::NEAREST);
                textures.push((case.name, texture));
                textures.len() - 1
            });
            ui.add(Image::new(&textures[at].1).fit_to_exact_size(vec2(PICTURE_SIDE, PICTURE_SIDE)));
        }
        None => _ = ui.weak(case.group),
    }
    let tooltip = format!("{}\n\n{}\n\n{}", case.danger, case.made, case.must);
    ui.label(in_words(case.name)).on_hover_text(tooltip);
    let [value, most] = check.texts();
    let (mark, color) = match check.passed {
        true => ("✔", ui.visuals().text_color()),
        false => ("✖", ui.visuals().error_fg_color),
    };
    ui.colored_label(color, format!("{mark} {} {value}", check.measure))
        .on_hover_text(format!("at most {most}; naive: {}", case.naive));
}

/// A case's name as a person would write it.
fn in_words(name: &str) -> String {
    name.replace('-', " ")
}
