//! The question whether a file from elsewhere may have others read that lie outside of its surroundings.

use super::*;
use crate::sheets::answers;

/// Most names that are shown.
const SHOWN: usize = 8;

/// What is asked, and what was denied before: that is not asked again until the next start.
#[derive(Default)]
pub struct Outside {
    /// The files that are asked about; nothing is asked where there are none.
    pub files: Vec<PathBuf>,
    /// The file that names them, where it is opened again once they are allowed.
    pub named_by: Option<PathBuf>,
    pub denied: Vec<PathBuf>,
}

impl Outside {
    /// Adds files to the question.
    pub fn ask(&mut self, files: Vec<PathBuf>) {
        for file in files {
            if !self.denied.contains(&file) && !self.files.contains(&file) {
                self.files.push(file);
            }
        }
    }

    /// Shows the question; true for yes.
    pub fn show(&self, ui: &mut Ui) -> Option<bool> {
        ui.set_width(480.0);
        ui.heading("Read files from elsewhere?");
        let by = match &self.named_by {
            Some(path) => path.display().to_string(),
            None => "What was opened".to_owned(),
        };
        widgets::note(
            ui,
            format!(
                "{by} names files that are not beside it. Allow them where you know whom it is from: what is read may be in what you export."
            ),
        );
        ui.add_space(theme::GAP);
        for file in self.files.iter().take(SHOWN) {
            ui.monospace(file.display().to_string());
        }
        if self.files.len() > SHOWN {
            widgets::note(ui, format!("and {} more", self.files.len() - SHOWN));
        }
        ui.add_space(theme::GAP);
        answers(ui, [("Allow", true), ("Deny", false)])
    }
}
