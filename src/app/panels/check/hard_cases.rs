//! The hard cases, a line each with its verdict and, where it renders one, its picture.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use egui::{ColorImage, TextureHandle, TextureOptions, Ui, vec2};

use crate::app::kit::start_stop::{Pressed, start_or_stop};
use crate::app::kit::widgets;
use crate::document::ViewSettings;
use crate::render::EngineChoice;
use crate::render::background::Background;
use crate::render::display::display;
use crate::render::hard::{HardOptions, HardRow, Stage, catalogue};
use crate::render::priority::work_apart;

/// Side of a case's picture in points.
const PICTURE_SIDE: f32 = 40.0;

/// How a run stands: the rows so far, and what is being run or went wrong.
#[derive(Clone, Default)]
struct Standing {
    rows: Vec<HardRow>,
    running: Option<&'static str>,
    error: Option<String>,
}

/// What the page remembers.
#[derive(Default)]
pub(super) struct HardState {
    worker: Option<Background<HardOptions, Standing>>,
    stop: Arc<AtomicBool>,
    /// Pictures by case, as textures of this run.
    textures: Vec<(&'static str, TextureHandle)>,
}

/// The page, for the engine that renders.
pub(super) fn show(ui: &mut Ui, state: &mut HardState, engine: EngineChoice) {
    widgets::note(
        ui,
        "Places where naive code breaks, each with what it does here: measured against its limit.",
    );
    if state.worker.is_none() {
        let (ctx, stop) = (ui.ctx().clone(), state.stop.clone());
        let work = move |options: HardOptions, desk: &crate::render::background::Desk<'_, HardOptions, Standing>| {
            work_apart();
            let ends = || stop.load(Ordering::Relaxed) || desk.is_superseded();
            run(&options, &|standing| desk.publish(standing), &ends);
        };
        state.worker = Background::spawn("hard cases", move || ctx.request_repaint(), work).ok();
    }
    let Some(worker) = &state.worker else {
        widgets::note(ui, "Cannot start a thread to check.");
        return;
    };
    let row = ui.horizontal(|ui| start_or_stop(ui, "Run the hard cases", worker.is_busy(), true, |button| button));
    match row.inner {
        Pressed::Start => {
            state.textures.clear();
            state.stop.store(false, Ordering::Relaxed);
            worker.ask(HardOptions {
                engine,
                thorough: false,
                only: String::new(),
            });
        }
        Pressed::Stop => state.stop.store(true, Ordering::Relaxed),
        Pressed::Nothing => {}
    }
    widgets::comes_and_goes(ui, |ui| widgets::failure(ui, worker.failure()));
    let Some(standing) = worker.latest() else {
        return;
    };
    widgets::comes_and_goes(ui, |ui| match standing.running {
        Some(_) if worker.is_busy() && state.stop.load(Ordering::Relaxed) => widgets::note(ui, "Stopping …"),
        Some(name) if worker.is_busy() => widgets::note(ui, name),
        Some(_) => widgets::note(ui, "Stopped."),
        None => {}
    });
    if let Some(error) = &standing.error {
        ui.colored_label(ui.visuals().error_fg_color, error);
    }
    egui::Grid::new("hard cases")
        .num_columns(3)
        .striped(true)
        .show(ui, |ui| {
            for row in &standing.rows {
                line(ui, row, &mut state.textures);
                ui.end_row();
            }
        });
}

/// Runs case after case, publishing after each, until the results are no longer wanted.
fn run(options: &HardOptions, publish: &dyn Fn(Standing), ends: &dyn Fn() -> bool) {
    let mut standing = Standing::default();
    let mut stage = match Stage::open(options.engine, options.thorough) {
        Ok(stage) => stage,
        Err(error) => {
            standing.error = Some(error.to_string());
            return publish(standing);
        }
    };
    for case in catalogue() {
        if ends() {
            return;
        }
        standing.running = Some(case.name);
        publish(standing.clone());
        match case.run(&mut stage) {
            Ok(row) => standing.rows.push(row),
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
            let known = textures.iter().find(|(name, _)| *name == case.name);
            let texture = known.map(|(_, texture)| texture.clone()).unwrap_or_else(|| {
                let pixels = display(image, &ViewSettings::default());
                let size = [image.width as usize, image.height as usize];
                let image = ColorImage::from_rgba_unmultiplied(size, &pixels);
                let texture = ui.ctx().load_texture(case.name, image, TextureOptions::NEAREST);
                textures.push((case.name, texture.clone()));
                texture
            });
            ui.add(egui::Image::new(&texture).fit_to_exact_size(vec2(PICTURE_SIDE, PICTURE_SIDE)));
        }
        None => {
            ui.weak(case.group);
        }
    }
    let told = format!("{}\n\n{}\n\n{}", case.danger, case.made, case.must);
    ui.label(case.name).on_hover_text(told);
    let verdict = format!("{} {:.1e}", check.measure, check.value);
    let hover = format!("at most {:.0e}; naive: {}", check.limit, (case.naive)());
    if check.passed {
        ui.label(format!("✔ {verdict}")).on_hover_text(hover);
    } else {
        ui.colored_label(ui.visuals().error_fg_color, format!("✖ {verdict}"))
            .on_hover_text(hover);
    }
}
