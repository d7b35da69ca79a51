//! What was edited in a frame, and its way into the history: a drag is one step.

use std::borrow::Cow;
use std::time::{Duration, Instant};

use crate::document::history::History;
use crate::document::{Document, MaterialSettings};

/// Changes with the same key within this of each other are one step even without a drag: arrow keys, the wheel.
const PAUSE: Duration = Duration::from_millis(600);
/// Steps that can be undone.
const STEPS: usize = 500;

/// The documents gone through, and what the frame's edit is called.
pub(in crate::app) struct Edits {
    history: History<Document>,
    note: Option<(Cow<'static, str>, Cow<'static, str>)>,
    last_change: Option<Instant>,
}

impl Edits {
    pub(in crate::app) fn new(document: Document) -> Self {
        Self {
            history: History::new(document, STEPS),
            note: None,
            last_change: None,
        }
    }

    /// Names the edit of this frame: for the menu, and a key that says whether the next one belongs to it.
    pub(in crate::app) fn note(&mut self, label: impl Into<Cow<'static, str>>, key: impl Into<Cow<'static, str>>) {
        self.note = Some((label.into(), key.into()));
    }

    /// Takes the document as the frame left it; true where it changed.
    pub(in crate::app) fn record(&mut self, document: &Document, is_dragging: bool) -> bool {
        self.record_at(document, is_dragging, Instant::now())
    }

    fn record_at(&mut self, document: &Document, is_dragging: bool, now: Instant) -> bool {
        let is_pause_over = self.last_change.is_some_and(|at| now.duration_since(at) > PAUSE);
        if !is_dragging && is_pause_over {
            self.history.seal();
            self.last_change = None;
        }
        let (label, key) = self.note.take().unwrap_or((Cow::Borrowed("Edit"), Cow::Borrowed("")));
        if self.history.current() == document {
            return false;
        }
        self.history.push(label, (!key.is_empty()).then_some(key), document);
        self.last_change = Some(now);
        true
    }

    /// The next change starts a step of its own.
    pub(in crate::app) fn seal(&mut self) {
        self.history.seal();
    }

    /// How long ago the last change was, within the pause that ends a step.
    pub(in crate::app) fn is_in_flow(&self) -> bool {
        self.last_change.is_some_and(|at| at.elapsed() < PAUSE)
    }

    pub(in crate::app) fn undo(&mut self) -> Option<Document> {
        self.history.undo().cloned()
    }

    pub(in crate::app) fn redo(&mut self) -> Option<Document> {
        self.history.redo().cloned()
    }

    /// The materials before the last change to them, of the same model.
    pub(in crate::app) fn materials_before(&self, now: &Document) -> Option<Vec<MaterialSettings>> {
        let is_wanted = |then: &Document| then.model == now.model && then.materials != now.materials;
        Some(self.history.before(is_wanted)?.materials.clone())
    }

    pub(in crate::app) fn undo_label(&self) -> Option<&str> {
        self.history.undo_label()
    }

    pub(in crate::app) fn redo_label(&self) -> Option<&str> {
        self.history.redo_label()
    }

    /// Whether a file, or nothing but the start, holds the document.
    pub(in crate::app) fn is_saved(&self, document: &Document) -> bool {
        self.history.is_saved() && self.history.current() == document
    }

    /// A file holds this document by now, which may have been edited since.
    pub(in crate::app) fn mark_value_saved(&mut self, document: &Document) {
        self.history.mark_value_saved(document);
    }

    pub(in crate::app) fn mark_unsaved(&mut self) {
        self.history.mark_unsaved();
    }

    pub(in crate::app) fn mark_saved(&mut self) {
        self.history.mark_saved();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::random::random_bits;

    /// What the history must do, as a plain list.
    #[derive(Debug)]
    struct Model {
        /// Values, each with the key that a further edit of its step bears, and with a number of its own.
        steps: Vec<(u32, &'static str, u32)>,
        at: usize,
        edits: u32,
        /// The number of the value that was saved.
        saved: u32,
        /// The last edit's step takes further ones with its key.
        is_open: bool,
        /// Since the last change, ms.
        age_ms: u64,
    }

    impl Model {
        fn edit(&mut self, key: &'static str, value: u32, is_dragging: bool) {
            if !is_dragging && self.age_ms > PAUSE.as_millis() as u64 {
                self.is_open = false;
            }
            let (current, last_key, _) = self.steps[self.at];
            if current == value {
                return;
            }
            self.age_ms = 0;
            self.edits += 1;
            self.steps.truncate(self.at + 1);
            if self.is_open && !key.is_empty() && last_key == key {
                self.steps.pop();
                self.at -= 1;
                // Back where it began, it is no step.
                self.is_open = self.steps[self.at].0 != value;
            } else {
                self.is_open = true;
            }
            if self.is_open {
                self.steps.push((value, key, self.edits));
                self.at += 1;
            }
        }
    }

    fn document(value: u32) -> Document {
        let mut document = Document::default();
        document.render.seed = value;
        document
    }

    /// Edits with and without keys, drags with pauses, slots selected, projects opened and saved, undo and redo at random,
    /// against the list.
    #[test]
    fn the_history_is_a_plain_list() {
        for seed in 0..40 {
            let mut draws = 0;
            let mut below = |count: usize| {
                draws += 1;
                random_bits(seed, draws, 0) as usize % count
            };
            let mut edits = Edits::new(document(0));
            let mut model = Model {
                steps: vec![(0, "", 0)],
                at: 0,
                edits: 0,
                saved: 0,
                is_open: false,
                age_ms: 0,
            };
            let mut now = Instant::now();
            let mut is_dragging = false;
            for step in 0..250 {
                let operation = below(14);
                match operation {
                    0..5 => {
                        let key = ["", "roughness", "yaw"][below(3)];
                        let value = below(4) as u32;
                        edits.note("Edit", key);
                        edits.record_at(&document(value), is_dragging, now);
                        model.edit(key, value, is_dragging);
                    }
                    5 => is_dragging = !is_dragging,
                    6..8 => {
                        let pause_ms = [30, 700][below(2)];
                        now += Duration::from_millis(pause_ms);
                        model.age_ms += pause_ms;
                        // A frame in which nothing is edited.
                        let value = model.steps[model.at].0;
                        edits.record_at(&document(value), is_dragging, now);
                        model.edit("", value, is_dragging);
                    }
                    8 => {
                        // A slot is selected.
                        edits.seal();
                        model.is_open = false;
                    }
                    9..11 => {
                        let undone = edits.undo().map(|document| document.render.seed);
                        let expected = model.at.checked_sub(1).map(|at| model.steps[at].0);
                        assert_eq!(undone, expected, "undo at step {step} of seed {seed}: {model:?}");
                        model.at = model.at.saturating_sub(1);
                        model.is_open &= undone.is_none();
                    }
                    11 => {
                        let redone = edits.redo().map(|document| document.render.seed);
                        let expected = model.steps.get(model.at + 1).map(|step| step.0);
                        assert_eq!(redone, expected, "redo at step {step} of seed {seed}: {model:?}");
                        model.at += usize::from(redone.is_some());
                        model.is_open &= redone.is_none();
                    }
                    12 => {
                        // A project is opened: an edit without a key, which is saved.
                        let value = 10 + below(4) as u32;
                        edits.note("Open", "");
                        edits.record_at(&document(value), false, now);
                        edits.mark_saved();
                        model.edit("", value, false);
                        (model.saved, model.is_open) = (model.steps[model.at].2, false);
                    }
                    _ => {
                        edits.mark_saved();
                        (model.saved, model.is_open) = (model.steps[model.at].2, false);
                    }
                }
                let (current, _, number) = model.steps[model.at];
                assert_eq!(
                    edits.history.current().render.seed,
                    current,
                    "step {step} of seed {seed}, operation {operation}: {model:?}"
                );
                assert_eq!(edits.undo_label().is_some(), model.at > 0, "step {step} of seed {seed}");
                assert_eq!(edits.redo_label().is_some(), model.at + 1 < model.steps.len());
                assert_eq!(
                    edits.is_saved(&document(current)),
                    model.saved == number,
                    "step {step} of seed {seed}"
                );
            }
        }
    }
}
