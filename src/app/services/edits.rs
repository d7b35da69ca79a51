//! What was edited in a frame, and its way into the history: a drag is one step.

use std::{borrow::Cow, time::Duration, time::Instant};

use crate::document::{Document, MaterialSettings, history::History};

/// Changes with the same key within this of each other are one step even without a drag: arrow keys, the wheel.
const PAUSE: Duration = Duration::from_millis(600);
/// Steps that can be undone.
const STEPS: usize = 500;

/// The documents gone through, and what the frame's edit is called.
pub struct Edits {
    pub history: History<Document>,
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

    /// Names an edit that is a step of its own.
    pub fn did(&mut self, label: impl Into<Cow<'static, str>>) {
        self.note(label, "");
    }

    /// Takes the document as the frame left it; true where it changed.
    pub fn record(&mut self, document: &Document, is_dragging: bool) -> bool {
        if !is_dragging && !self.is_in_flow() {
            self.history.seal();
        }
        let (label, key) = self.note.take().unwrap_or(("Edit".into(), "".into()));
        if self.history.current() == document {
            return false;
        }
        self.history.push(label, (!key.is_empty()).then_some(key), document);
        self.last_change = Some(Instant::now());
        true
    }

    /// How long ago the last change was, within the pause that ends a step.
    pub fn is_in_flow(&self) -> bool {
        self.last_change.is_some_and(|at| at.elapsed() < PAUSE)
    }

    /// The materials before the last change to them, of the same model.
    pub fn materials_before(&self, now: &Document) -> Option<Vec<MaterialSettings>> {
        let is_wanted = |then: &Document| then.model == now.model && then.materials != now.materials;
        Some(self.history.before(is_wanted)?.materials.clone())
    }

    /// Whether a file, or nothing but the start, holds the document.
    pub fn is_saved(&self, document: &Document) -> bool {
        self.history.is_saved() && self.history.current() == document
    }
}
