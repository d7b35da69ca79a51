//! The panels, one a file. They change the document, push actions, and read the renderer's state.

mod area_lights;
pub(super) mod camera;
pub(super) mod check;
pub(super) mod convergence;
pub(super) mod curve;
pub(super) mod effects;
mod hard_cases;
pub(super) mod ledger;
pub(super) mod lighting;
pub(super) mod lobe;
mod lobe_match;
mod lobe_plot;
pub(super) mod log;
pub(super) mod material;
pub(super) mod presets;
pub(super) mod race;
mod region;
pub(super) mod samples;
pub(super) mod snapshots;
mod study;

use super::actions::{Action, Command};
use super::compare::Compare;
use super::edits::Edits;
use super::environments::Environments;
use super::library::Library;
use super::recent::Recent;
use super::snapshots::Snapshots;
use super::widgets::RowResponse;
use crate::document::{Document, ImportLobe, MaterialSettings};
use crate::render::display::Shown;
use crate::render::worker::{Scene, Snapshot};
use crate::scene::ModelSource;

/// What panels work on.
pub(super) struct Desk<'a> {
    pub(super) document: &'a mut Document,
    pub(super) snapshot: &'a Snapshot,
    pub(super) edits: &'a mut Edits,
    pub(super) actions: &'a mut Vec<Action>,
    pub(super) state: &'a mut PanelState,
}

/// What panels remember that is no part of the document.
#[derive(Default)]
pub(super) struct PanelState {
    /// The material slot that is edited.
    pub(super) slot: usize,
    /// The slots that were selected of other models, for when undo or redo brings them back.
    pub(super) slots_of: Vec<(ModelSource, usize)>,
    /// What was said, oldest first.
    pub(super) log: Vec<log::Entry>,
    /// Small pictures of environments.
    pub(super) environments: Environments,
    /// The files opened and saved last.
    pub(super) recent: Recent,
    /// The lobe of the materials of models that are opened.
    pub(super) import_lobe: ImportLobe,
    /// How large the picture is.
    pub(super) resolution: Resolution,
    /// What of the render the viewport shows.
    pub(super) shown: Shown,
    /// The curve editor's.
    pub(super) curve: curve::CurveState,
    /// The sample plots'.
    pub(super) samples: samples::SampleState,
    /// The lobe views'.
    pub(super) lobe: lobe::LobeState,
    /// The checks'.
    pub(super) check: check::CheckState,
    /// The race's.
    pub(super) race: race::RaceState,
    /// The ledger's.
    pub(super) ledger: ledger::LedgerState,
    /// The next click in the viewport says what is sharp.
    pub(super) picks_focus: bool,
    /// Rendering was stopped by hand.
    pub(super) is_paused: bool,
    /// What is searched for among the presets.
    pub(super) preset_search: String,
    /// The materials to choose from.
    pub(super) library: Library,
    /// The pinned states.
    pub(super) snapshots: Snapshots,
    /// The comparison of the document with something else.
    pub(super) compare: Compare,
}

impl PanelState {
    /// Whether a panel measures, for which the viewport's renderer rests.
    fn is_studying(&self) -> bool {
        self.race.is_running() || self.ledger.is_running()
    }

    /// True once the study has ended for which the viewport's renderer rests.
    pub(super) fn study_ended(&mut self) -> bool {
        let (by_race, by_ledger) = (self.race.lets_renderer_go(), self.ledger.lets_renderer_go());
        by_race || by_ledger
    }
}

/// How large the picture is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Resolution {
    /// It fills the viewport: with the screen's pixels on a hardware GPU, else with one a point.
    #[default]
    Auto,
    /// It fills the viewport with the screen's pixels.
    Native,
    /// It fills the viewport with half as many pixels each way.
    Half,
    /// Width and height as in the document, shown with its own shape.
    Document,
}

impl Desk<'_> {
    pub(super) fn act(&mut self, command: Command) {
        self.actions.push(Action::Do(command));
    }

    /// The scene being rendered, where it is of the document's model.
    pub(super) fn scene(&self) -> Option<&Scene> {
        self.snapshot
            .scene
            .as_deref()
            .filter(|scene| scene.document.model == self.document.model)
    }

    /// The material of the selected slot.
    pub(super) fn material(&self) -> MaterialSettings {
        let materials = &self.document.materials;
        materials
            .get(self.state.slot)
            .or(materials.last())
            .cloned()
            .unwrap_or_default()
    }

    /// Replaces the material of the selected slot; slots before it keep what they show.
    pub(super) fn set_material(&mut self, material: MaterialSettings) {
        let materials = &mut self.document.materials;
        let last = materials.last().cloned().unwrap_or_default();
        if materials.len() <= self.state.slot {
            materials.resize(self.state.slot + 1, last);
        }
        materials[self.state.slot] = material;
    }

    /// Notes an edit of a setting, and resets it where that was asked for.
    pub(super) fn edited<T: PartialEq + Clone>(
        &mut self,
        response: RowResponse,
        label: &'static str,
        field: impl Fn(&mut Document) -> &mut T,
    ) {
        if response.reset {
            let default = field(&mut Document::default()).clone();
            *field(self.document) = default;
        }
        if response.changed || response.reset {
            self.edits.note(label, label);
        }
    }
}
