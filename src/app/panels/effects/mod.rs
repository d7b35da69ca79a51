//! Which effects are simulated, why, and what the user decides against the plan.

mod ledger;

use ledger::LedgerState;

use super::*;
use crate::{
    document::effect::{Effect, EffectSwitches, Switch},
    job::effect::Decision,
    study::ledger::LedgerEntry,
};

/// Radius of the mark before an effect, points.
const MARK_RADIUS: f32 = 3.5;

/// What is simulated, why, and what it costs.
#[derive(Default)]
pub struct EffectsPanel {
    ledger: LedgerState,
}

impl Panel for EffectsPanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk) {
        let Some(job) = desk.snapshot.scene.as_ref().map(|scene| scene.job.clone()) else {
            widgets::note(ui, "Nothing is rendered yet.");
            return;
        };
        let plan = &job.plan;
        let count = plan.table().count();
        let found = self.ledger.worker.found();
        let gain = found.as_ref().and_then(|ledger| ledger.kernel_gain());
        let gain = gain.map_or_else(String::new, |gain| format!(" Specialised kernel: {gain:.1} × as fast."));
        ui.label(format!("{} of {count} features active.{gain}", plan.effects().len()))
            .on_hover_text("Unused features are compiled out and cost nothing.");
        ledger::controls(ui, desk, &mut self.ledger);
        let switches = desk.document.render.effects;
        if switches != EffectSwitches::default() && ui.button("All automatic").clicked() {
            desk.document.render.effects = EffectSwitches::default();
            desk.edits.did("All effects automatic");
        }
        ui.add_space(theme::GAP);
        for (effect, decision) in plan.table() {
            let entry = found.as_ref().and_then(|ledger| ledger.effect(effect.name()));
            row(ui, desk, Effect::of(effect), decision, entry.filter(|_| decision.is_on));
        }
        if let Some(found) = &found {
            ui.add_space(theme::GAP);
            ledger::show(ui, found);
        }
    }

    fn tick(&mut self, desk: &mut Desk) {
        self.ledger.worker.tick(desk);
    }

    fn on_command(&mut self, command: Command) {
        if command == Command::Measure {
            self.ledger.worker.request();
        }
    }
}

/// An effect with what the ledger says of it.
fn row(ui: &mut Ui, desk: &mut Desk, effect: &Effect, decision: &Decision, entry: Option<&LedgerEntry>) {
    ui.horizontal(|ui| {
        mark(ui, decision.is_on);
        widgets::at_right(ui, |ui| {
            switch(ui, desk, effect);
            let label = Label::new(effect.label).wrap();
            widgets::sized(ui, ui.available_width(), |ui| ui.add(label).on_hover_text(effect.help));
        });
    });
    ui.horizontal(|ui| {
        ui.add_space(4.0 * MARK_RADIUS);
        let cost = entry.map_or_else(String::new, |entry| format!(" · {}", entry.time_words()));
        let text = RichText::new(format!("{}{cost}", decision.reason)).weak().small();
        ui.add(Label::new(text).wrap());
    });
}

/// Filled where the effect is simulated.
fn mark(ui: &mut Ui, is_on: bool) {
    let size = vec2(2.0 * MARK_RADIUS, ui.spacing().interact_size.y);
    let (place, response) = ui.allocate_exact_size(size, Sense::hover());
    let color = if is_on {
        ui.visuals().selection.bg_fill
    } else {
        Color32::TRANSPARENT
    };
    let stroke = Stroke::new(1.0, ui.visuals().weak_text_color());
    ui.painter().circle(place.center(), MARK_RADIUS, color, stroke);
    response.on_hover_text(if is_on { "Active" } else { "Compiled out" });
}

fn switch(ui: &mut Ui, desk: &mut Desk, effect: &Effect) {
    let current = desk.document.render.effects.get(effect.id);
    let mut chosen = current;
    let menu = ComboBox::from_id_salt(effect.name())
        .width(64.0)
        .selected_text(current.label());
    let shown = menu.show_ui(ui, |ui| {
        for &switch in Switch::ALL {
            let why_not = match switch {
                Switch::On => "Cannot be forced on for this scene.",
                _ => "Required for any render.",
            };
            ui.add_enabled_ui(effect.can_be(switch), |ui| {
                let item = ui.selectable_value(&mut chosen, switch, switch.label());
                if item.clicked() {
                    ui.close();
                }
                item.on_hover_text(switch.help()).on_disabled_hover_text(why_not);
            });
        }
    });
    let name = format!("{}: auto, on or off", effect.label);
    shown.response.accessible_name(name);
    if chosen != current {
        desk.document.render.effects.set(effect.id, chosen);
        desk.edits.did(format!("Switch {}", effect.label.to_lowercase()));
    }
}
