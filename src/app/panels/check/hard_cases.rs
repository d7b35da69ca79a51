//! The hard cases, a line each with its verdict and, where it renders one, its image.

use std::sync::Mutex;

use super::*;
use crate::{
    document::ViewSettings,
    kit::tile::pixels,
    panics::lock,
    render::{EngineChoice, display::display},
    study::hard::{HardRow, Stage, catalogue},
};

/// Side of a case's image in points.
const PICTURE_SIDE: f32 = 40.0;

/// What the page remembers.
#[derive(Default)]
pub struct HardState {
    pub worker: StudyWorker<()>,
    /// The rows so far.
    rows: Arc<Mutex<Vec<HardRow>>>,
    /// Images by case, as textures of this run.
    textures: Vec<(&'static str, TextureHandle)>,
}

/// The page, for the engine that renders.
pub fn show(ui: &mut Ui, desk: &mut Desk, state: &mut HardState, engine: EngineChoice) {
    widgets::note(
        ui,
        "Places where naive code breaks, each with what it does here: measured against its limit.",
    );
    let HardState { worker, rows, textures } = state;
    let stop = worker.stop.clone();
    worker.controls(ui, desk, ("Run the hard cases", "", false), None, |_| {
        textures.clear();
        *rows = Arc::default();
        let rows = rows.clone();
        Box::new(move |watch| {
            work_apart();
            let mut stage = Stage::open(engine, false, stop)?;
            let count = catalogue().count();
            for (done, case) in catalogue().enumerate() {
                let what = format!("{} ({} of {count})", in_words(case.name), done + 1);
                let share = done as f64 / count as f64;
                if !watch(StudyProgress { share, what }) {
                    return Err(StudyError::Stopped);
                }
                lock(&rows).push(case.run(&mut stage)?);
            }
            Ok(())
        })
    });
    Grid::new("hard cases").num_columns(3).striped(true).show(ui, |ui| {
        for row in lock(rows).iter() {
            line(ui, row, textures);
            ui.end_row();
        }
    });
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
