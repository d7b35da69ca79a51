//! What the clipboard did with a copy: reported in the frame after, as the window's own library only logs it.

use egui::OutputCommand;

use crate::app::App;
use crate::app::services::log_failures;
use crate::render::worker::Level;

/// What to do where copying fails.
const REMEDY: &str = "images can be saved by File › Save image…, materials by File › Export…";

impl App {
    /// Says whether the last frame's copy was taken.
    pub(in crate::app) fn report_clipboard(&mut self) {
        let words = self.copied.take();
        if let Some(why) = log_failures::clipboard_failure() {
            let text = format!("the system's clipboard failed: {why}; {REMEDY}");
            self.report(Level::Error, text);
        } else if let Some(words) = words {
            self.report(Level::Info, words);
        }
    }

    /// Looks whether something was copied in this frame: that it reaches other programs, or that it can't.
    pub(in crate::app) fn watch_copies(&mut self, ctx: &egui::Context) {
        let is_copy =
            |command: &OutputCommand| matches!(command, OutputCommand::CopyText(_) | OutputCommand::CopyImage(_));
        if !ctx.output(|output| output.commands.iter().any(is_copy)) {
            return;
        }
        // What the clipboard did is known in the next frame.
        ctx.request_repaint();
        if let Some(why) = log_failures::no_clipboard() {
            let text = format!("there is no system clipboard ({why}): copies stay within this window; {REMEDY}");
            self.copied = None;
            self.report(Level::Warning, text);
        }
    }

    /// An image was pasted, which has no place to go to without a name.
    pub(in crate::app) fn refuse_pasted_picture(&mut self) {
        let text = "the clipboard holds an image: save it as a file, and open or drop that";
        self.report(Level::Warning, text);
    }
}
