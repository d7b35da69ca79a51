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
pub struct Edits {
    history: History<Document>,
    note: Option<(Cow<'static, str>, Cow<'static, str>)>,
    last_change: Option<Instant>,
}

impl Edits {
    pub fn new(document: Document) -> Self {
        Self {
            history: History::new(document, STEPS),
            note: None,
            last_change: None,
        }
    }

    /// Names the edit of this frame: for the menu, and a key that says whether the next one belongs to it.
    pub fn note(&mut self, label: impl Into<Cow<'static, str>>, key: impl Into<Cow<'static, str>>) {
        self.note = Some((label.into(), key.into()));
    }

    /// Takes the document as the frame left it; true where it changed.
    pub fn record(&mut self, document: &Document, is_dragging: bool) -> bool {
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
    pub fn seal(&mut self) {
        self.history.seal();
    }

    /// How long ago the last change was, within the pause that ends a step.
    pub fn is_in_flow(&self) -> bool {
        self.last_change.is_some_and(|at| at.elapsed() < PAUSE)
    }

    pub fn undo(&mut self) -> Option<Document> {
        self.history.undo().cloned()
    }

    pub fn redo(&mut self) -> Option<Document> {
        self.history.redo().cloned()
    }

    /// The materials before the last change to them, of the same model.
    pub fn materials_before(&self, now: &Document) -> Option<Vec<MaterialSettings>> {
        let is_wanted = |then: &Document| then.model == now.model && then.materials != now.materials;
        Some(self.history.before(is_wanted)?.materials.clone())
    }

    pub fn undo_label(&self) -> Option<&str> {
        self.history.undo_label()
    }

    pub fn redo_label(&self) -> Option<&str> {
        self.history.redo_label()
    }

    /// Whether a file, or nothing but the start, holds the document.
    pub fn is_saved(&self, document: &Document) -> bool {
        self.history.is_saved() && self.history.current() == document
    }

    /// A file holds this document by now, which may have been edited since.
    pub fn mark_value_saved(&mut self, document: &Document) {
        self.history.mark_value_saved(document);
    }

    pub fn mark_unsaved(&mut self) {
        self.history.mark_unsaved();
    }

    pub fn mark_saved(&mut self) {
        self.history.mark_saved();
    }
}
