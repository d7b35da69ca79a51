//! `glossmith study ledger`: what each effect and setting costs.

use std::time::Duration;

use clap::Args;

use super::folder::Folder;
use super::{Bar, CommonArguments, digits};
use crate::console::output;
use crate::plot::{BarPlot, bar_plot_file};
use crate::study::ledger::{Entry, Ledger, LedgerOptions, ledger};

/// Arguments of `glossmith study ledger`.
#[derive(Debug, Args)]
pub(super) struct LedgerArguments {
    #[command(flatten)]
    common: CommonArguments,
}

pub(super) fn run(arguments: &LedgerArguments) -> anyhow::Result<()> {
    let common = &arguments.common;
    common.prepare()?;
    let document = common.document()?;
    let mut options = LedgerOptions::new(common.scene.engine);
    if common.quick {
        (options.turns, options.slice) = (3, Duration::from_millis(5));
    }
    let found = {
        let bar = Bar::new()?;
        ledger(&document, &options, &mut |progress| bar.show(progress))?
    };
    let folder = Folder {
        path: &common.output,
        name: "ledger",
    };
    folder.json(&found, &common.answer)?;
    let head = [
        "name",
        "label",
        "instead",
        "ms_with",
        "ms_without",
        "ms",
        "share_of_frame",
        "noise_share",
        "picture_change",
        "picture_change_low",
        "picture_change_high",
        "words",
    ];
    let row = |entry: &Entry| {
        let change = &entry.picture_change;
        let numbers = [
            entry.ms_with,
            entry.ms_without,
            entry.ms,
            entry.share_of_frame,
            entry.noise_share,
            change.value,
            change.low,
            change.high,
        ];
        let mut cells = vec![entry.name.to_owned(), entry.label.clone(), entry.instead.clone()];
        cells.extend(numbers.map(digits));
        cells.push(entry.words.clone());
        cells
    };
    folder.csv(&head, found.entries.iter().map(row))?;
    folder.plots(&plot(&found), bar_plot_file)?;
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
    let bar = |entry: &Entry| (entry.label.clone(), 100.0 * entry.share_of_frame);
    BarPlot {
        title: format!("What is paid for what: {}", ledger.machine.adapter),
        label: "Share of the frame's time (%); below 0: time is saved".to_owned(),
        bars: ledger.entries.iter().map(bar).collect(),
    }
}
