//! Undo and redo over plain values.

use std::borrow::Cow;

/// The values that a document went through. A value is pushed after every edit; edits with the same key, such as the
/// moves of one slider drag, make one step.
#[derive(Clone, Debug)]
pub struct History<T> {
    /// Oldest first; never empty.
    states: Vec<Revision<T>>,
    /// Where in them the document is.
    current: usize,
    /// Most steps that can be undone.
    limit: usize,
    /// False where the next push starts a step of its own, with any key.
    is_open: bool,
    /// Number that distinguishes states.
    next_id: u64,
    /// The state that was saved last, if it is still the one.
    saved_id: u64,
}

#[derive(Clone, Debug)]
struct Revision<T> {
    value: T,
    /// What was done to get here.
    label: Cow<'static, str>,
    key: Option<Cow<'static, str>>,
    id: u64,
}

impl<T: Clone + PartialEq> History<T> {
    /// Starts with a value that counts as saved; at most `limit` steps (at least 1) can be undone.
    pub fn new(value: T, limit: usize) -> Self {
        let first = Revision {
            value,
            label: Cow::Borrowed(""),
            key: None,
            id: 0,
        };
        Self {
            states: vec![first],
            current: 0,
            limit: limit.max(1),
            is_open: false,
            next_id: 1,
            saved_id: 0,
        }
    }

    /// Records that an edit called `label` led to `value`; nothing if `value` is the current one. With the key of the
    /// edit before it, it belongs to that edit's step, unless [`History::seal`] came between.
    pub fn push(&mut self, label: impl Into<Cow<'static, str>>, key: Option<Cow<'static, str>>, value: &T) {
        if self.states[self.current].value == *value {
            return;
        }
        self.states.truncate(self.current + 1);
        let id = self.next_id;
        self.next_id += 1;
        let last = &mut self.states[self.current];
        if self.is_open && key.is_some() && last.key == key {
            (last.value, last.id) = (value.clone(), id);
            self.drop_step_that_led_back();
            return;
        }
        self.states.push(Revision {
            value: value.clone(),
            label: label.into(),
            key,
            id,
        });
        if self.states.len() > self.limit + 1 {
            self.states.remove(0);
        }
        self.current = self.states.len() - 1;
        self.is_open = true;
    }

    /// A drag that ends where it began is no step.
    fn drop_step_that_led_back(&mut self) {
        if self.current > 0 && self.states[self.current].value == self.states[self.current - 1].value {
            self.states.pop();
            self.current -= 1;
            self.is_open = false;
        }
    }

    /// Ends the current step: the next edit is a new one even with the same key. To be called when a drag ends.
    pub fn seal(&mut self) {
        self.is_open = false;
    }

    /// Steps back; the value to go on with, or `None` at the oldest.
    pub fn undo(&mut self) -> Option<&T> {
        self.current = self.current.checked_sub(1)?;
        self.is_open = false;
        Some(self.current())
    }

    /// Steps forward; the value to go on with, or `None` at the newest.
    pub fn redo(&mut self) -> Option<&T> {
        if self.current + 1 >= self.states.len() {
            return None;
        }
        self.current += 1;
        self.is_open = false;
        Some(self.current())
    }

    /// The value as last pushed, undone or redone.
    pub fn current(&self) -> &T {
        &self.states[self.current].value
    }

    /// The newest value before the current one that is wanted.
    pub fn before(&self, is_wanted: impl Fn(&T) -> bool) -> Option<&T> {
        let earlier = self.states[..self.current].iter().rev();
        earlier.map(|state| &state.value).find(|value| is_wanted(value))
    }

    /// What undoing would take back.
    pub fn undo_label(&self) -> Option<&str> {
        (self.current > 0).then(|| &*self.states[self.current].label)
    }

    /// What redoing would do again.
    pub fn redo_label(&self) -> Option<&str> {
        self.states.get(self.current + 1).map(|state| &*state.label)
    }

    /// Records that the current value is what the file holds.
    pub fn mark_saved(&mut self) {
        self.saved_id = self.states[self.current].id;
        self.is_open = false;
    }

    /// Records that a file holds `value`, which the document may have left since.
    pub fn mark_value_saved(&mut self, value: &T) {
        if let Some(state) = self.states.iter().rev().find(|state| state.value == *value) {
            self.saved_id = state.id;
        }
        self.is_open = false;
    }

    /// Records that no file holds any of the values.
    pub fn mark_unsaved(&mut self) {
        self.saved_id = u64::MAX;
    }

    /// True where there is nothing to save.
    pub fn is_saved(&self) -> bool {
        self.states[self.current].id == self.saved_id
    }
}
