//! The sheet that offers what a crash left.

use std::time::{Duration, SystemTime};

use super::*;
use crate::{
    services::autosave::Leftover,
    sheets::scrolled,
    store::recovery::{Recovered, Report},
};

/// What is to be done with a leftover.
pub enum Choice {
    /// The one of this number.
    Restore(usize),
    Discard(usize),
    /// Nothing until the next start.
    Later,
}

pub fn sheet(ui: &mut Ui, leftovers: &[Leftover]) -> Option<Choice> {
    let mut chosen = None;
    ui.set_width(460.0);
    if leftovers.iter().any(|leftover| leftover.contents.is_some()) {
        ui.heading("Unsaved work was found");
        widgets::note(
            ui,
            "Glossmith crashed. Your unsaved work was recovered: restore it, or discard it.",
        );
    } else {
        ui.heading("Glossmith crashed");
        widgets::note(ui, "Everything had been saved.");
    }
    scrolled(ui, |ui| {
        for (at, leftover) in leftovers.iter().enumerate() {
            ui.add_space(theme::GAP);
            ui.separator();
            chosen = row(ui, leftover, at).or(chosen.take());
        }
    });
    ui.add_space(theme::GAP);
    ui.separator();
    let is_later = widgets::pressed(ui, "Later", "Asks again at the next start.");
    chosen.or(is_later.then_some(Choice::Later))
}

fn row(ui: &mut Ui, leftover: &Leftover, at: usize) -> Option<Choice> {
    let mut choice = None;
    let name = match &leftover.contents {
        Some(Ok(recovered)) => {
            let name = name(recovered);
            ui.label(RichText::new(&name).strong());
            let age = SystemTime::now().duration_since(recovered.at).unwrap_or_default();
            widgets::note(ui, format!("{}, saved {}", contents(recovered), ago(age)));
            name
        }
        Some(Err(why)) => {
            ui.label(RichText::new("A damaged file").strong());
            widgets::failure(ui, why.clone());
            "the damaged file".to_owned()
        }
        None => "the notice".to_owned(),
    };
    if let Some(report) = &leftover.report {
        show_report(ui, report);
    }
    ui.horizontal(|ui| {
        if let Some(contents) = &leftover.contents {
            let restore = ui
                .add_enabled(contents.is_ok(), Button::new("Restore"))
                .accessible_name(format!("Restore {name}"));
            if at == 0 && ui.memory(|memory| memory.focused().is_none()) {
                restore.request_focus();
            }
            if restore.clicked() {
                choice = Some(Choice::Restore(at));
            }
        }
        let discard = ui.button("Discard").accessible_name(format!("Discard {name}"));
        if discard.on_hover_text("Removes it for good.").clicked() {
            choice = Some(Choice::Discard(at));
        }
    });
    choice
}

/// What a panic said, and where more of it stands.
fn show_report(ui: &mut Ui, report: &Report) {
    let text = format!("It met an internal error: {}", report.message);
    widgets::failure(ui, text);
    let where_to = format!("Please report this crash and attach {}.", report.path.display());
    widgets::note(ui, where_to);
}

/// What to call it.
pub fn name(recovered: &Recovered) -> String {
    let stem = recovered.project.as_ref().and_then(|path| path.file_stem());
    stem.map_or_else(|| "untitled".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

/// What distinguishes one untitled document from another.
fn contents(recovered: &Recovered) -> String {
    let materials = &recovered.document.materials;
    let names: Vec<&str> = materials.iter().take(3).map(|material| &*material.name).collect();
    let more = if materials.len() > 3 { ", …" } else { "" };
    format!("{} in {}{more}", recovered.document.model, names.join(", "))
}

/// How long ago something was, in words.
fn ago(age: Duration) -> String {
    let minutes = age.as_secs() / 60;
    let (count, unit) = match minutes {
        0 => return "less than a minute ago".to_owned(),
        1..60 => (minutes, "minute"),
        60..1440 => (minutes / 60, "hour"),
        _ => (minutes / 1440, "day"),
    };
    format!("{count} {unit}{} ago", if count == 1 { "" } else { "s" })
}
