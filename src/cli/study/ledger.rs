//! `glossmith study ledger`: what each effect and setting costs.

use std::time::Duration;

use super::{CommonArguments, watched};
use crate::{
    console::output,
    plot::BarPlot,
    study::ledger::{Ledger, LedgerEntry, LedgerOptions, ledger},
};

const COLUMNS: &str = "name,label,instead,ms_with,ms_without,ms,share_of_frame,noise_share,picture_change,\
                       picture_change_low,picture_change_high,words";

pub fn run(common: &CommonArguments) -> anyhow::Result<()> {
    let document = common.document()?;
    let mut options = LedgerOptions::new(common.scene.engine);
    if common.quick {
        (options.turns, options.slice) = (3, Duration::from_millis(5));
    }
    let found = watched(|watch| ledger(&document, &options, watch))?;
    common.write("ledger", &found, ["entries", COLUMNS], &plot(&found))?;
    if common.answer.has_words() {
        print(&found);
    }
    Ok(())
}

fn print(found: &Ledger) {
    output!(
        "{} on {}, {} x {}: {:.2} ms for one sample of every pixel",
        found.machine.engine,
        found.machine.adapter,
        found.width,
        found.height,
        found.ms_per_sample
    );
    output!("{:>9} {:>7}", "ms", "share");
    for entry in &found.entries {
        output!(
            "{:>9.3} {:>5.1} %  {}",
            entry.ms,
            100.0 * entry.share_of_frame,
            entry.words
        );
    }
}

fn plot(ledger: &Ledger) -> BarPlot {
    let bar = |entry: &LedgerEntry| (entry.label.clone(), 100.0 * entry.share_of_frame);
    BarPlot {
        title: format!("What is paid for what: {}", ledger.machine.adapter),
        label: "Share of the frame's time (%); below 0: time is saved".to_owned(),
        bars: ledger.entries.iter().map(bar).collect(),
    }
}
