//! The ledger: what each effect and each setting in force costs, in plain words.

use std::time::Duration;

use super::*;
use crate::{
    kit::words::about,
    measuring::{StudyWorker, engine, small_document},
    study::ledger::{Ledger, LedgerOptions, ledger},
};

/// Longest side of the image that is measured on, pixels: what is true of the parts is true of the whole.
const SIDE_MAX: u32 = 256;

/// What the panel remembers.
#[derive(Default)]
pub struct LedgerState {
    pub worker: StudyWorker<Ledger>,
    /// How long a turn lasts, where it is not the usual time.
    pub slice: Option<Duration>,
}

/// The button that measures, and how far it is.
pub fn controls(ui: &mut Ui, desk: &mut Desk, state: &mut LedgerState) {
    let help = "What each effect and setting costs in time, and does to noise and image: renders this scene with and \
                without each of them, in turns.";
    let LedgerState { worker, slice } = state;
    let options = |desk: &Desk| {
        let mut options = LedgerOptions::new(engine(desk));
        options.slice = slice.unwrap_or(options.slice);
        options
    };
    let count = desk.snapshot.scene.as_ref().map(|scene| scene.job.plan.effects().len());
    let takes = count.map(|count| format!("takes about {}", about(options(desk).seconds(count))));
    worker.controls(ui, desk, ("Profile features", help, true), takes, |desk| {
        let document = small_document(desk, SIDE_MAX);
        let options = options(desk);
        Box::new(move |watch| ledger(&document, &options, watch))
    });
}

/// All lines of it.
pub fn show(ui: &mut Ui, found: &Ledger) {
    widgets::group(ui, "Ledger", |ui| {
        ui.label(format!("{:.2} ms for one sample of every pixel", found.ms_per_sample));
        found.entries.iter().for_each(|entry| line(ui, entry));
        let size = format!("Measured at {} × {} pixels.", found.width, found.height);
        widgets::note(ui, size);
    });
}

fn line(ui: &mut Ui, entry: &LedgerEntry) {
    let help = format!(
        "{:.3} ms of {:.3} ms a sample of every pixel ({:.1} % of the frame); half of the turns lie between {:.3} and \
         {:.3} ms.\nNoise: {:+.0} %. Image: {:.3} % ({:.3} to {:.3}).",
        entry.ms,
        entry.ms_with,
        100.0 * entry.share_of_frame,
        entry.ms_quartiles[0],
        entry.ms_quartiles[1],
        100.0 * entry.noise_share,
        100.0 * entry.picture_change.value,
        100.0 * entry.picture_change.low,
        100.0 * entry.picture_change.high,
    );
    ui.label(&entry.words).on_hover_text(help);
}
