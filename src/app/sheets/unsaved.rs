//! The question before unsaved edits would be lost: save, discard, or cancel, which leaves everything as it is.

use super::outside::Outside;
use super::*;
use crate::store::Loaded;

/// What would lose the edits.
pub enum Then {
    /// The window is closed.
    Close,
    New,
    /// A project that has been read from a file.
    Adopt(Box<Loaded<Document>>, PathBuf),
}

impl Then {
    fn verb(&self) -> &'static str {
        match self {
            Self::Close => "closing",
            Self::New => "starting a new one",
            Self::Adopt(..) => "opening another project",
        }
    }
}

/// The questions that are open, and what waits for a file to be saved.
#[derive(Default)]
pub struct Unsaved {
    pub question: Option<Question>,
    pub after_save: Option<Then>,
    /// Asked and answered: the window may go.
    pub may_close: bool,
    /// The question whether to give renders in the queue up is open.
    pub asks_about_queue: bool,
    /// What files name elsewhere.
    pub outside: Outside,
    /// That was answered with yes.
    pub gives_queue_up: bool,
}

/// The open question.
pub struct Question {
    pub then: Then,
    pub is_new: bool,
}

pub enum Answer {
    Save,
    Discard,
    Cancel,
}

impl Unsaved {
    /// Whether an answer is waited for.
    pub fn is_open(&self) -> bool {
        self.question.is_some() || self.asks_about_queue || !self.outside.files.is_empty()
    }
}

impl Question {
    pub fn show(&mut self, ui: &mut Ui, name: &str) -> Option<Answer> {
        ui.set_width(380.0);
        ui.heading(format!("Save the changes to {name}?"));
        widgets::note(
            ui,
            format!("They would be lost by {}. Escape cancels.", self.then.verb()),
        );
        ui.add_space(theme::GAP);
        ui.horizontal(|ui| {
            let save = ui.button("Save");
            // The focus lasts only once the sheet has been laid out.
            if save.has_focus() {
                self.is_new = false;
            } else if self.is_new {
                save.request_focus();
            }
            let others = answers(ui, [("Discard", Answer::Discard), ("Cancel", Answer::Cancel)]);
            save.clicked().then_some(Answer::Save).or(others)
        })
        .inner
    }
}
