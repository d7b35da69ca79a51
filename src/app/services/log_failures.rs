//! Failures that other libraries only write to the log and that the window reports: a file dialog that could not
//! open, a clipboard that could not be reached. Neither rfd nor egui-winit returns them.

use std::sync::{Mutex, MutexGuard};

use crate::panics::lock;
use log::{Level, LevelFilter, Log, Metadata, Record};

/// Failures that were logged and not reported yet.
struct Failures {
    no_dialog: bool,
    no_clipboard: Option<String>,
    failed_copy: Option<String>,
}

static FAILURES: Mutex<Failures> = Mutex::new(Failures {
    no_dialog: false,
    no_clipboard: None,
    failed_copy: None,
});

fn failures() -> MutexGuard<'static, Failures> {
    lock(&FAILURES)
}

/// Installs a logger, whose most verbose level is `level`, and listens to what passes through it.
///
/// # Errors
/// Where there is a logger already.
pub fn listen(logger: impl Log + 'static, level: LevelFilter) -> Result<(), log::SetLoggerError> {
    log::set_boxed_logger(Box::new(Listening(logger)))?;
    log::set_max_level(level.max(LevelFilter::Warn));
    Ok(())
}

/// A logger that is listened to.
struct Listening<L>(L);

fn is_of(metadata: &Metadata<'_>, library: &str) -> bool {
    metadata.level() <= Level::Warn && metadata.target().starts_with(library)
}

impl<L: Log> Log for Listening<L> {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        is_of(metadata, "rfd") || is_of(metadata, "egui_winit::clipboard") || self.0.enabled(metadata)
    }

    fn log(&self, record: &Record<'_>) {
        if is_of(record.metadata(), "rfd") {
            // Zenity is what rfd tries last: before that, another dialog may still open.
            failures().no_dialog |= record.level() == Level::Error && record.args().to_string().contains("zenity");
        } else if is_of(record.metadata(), "egui_winit::clipboard") {
            record_clipboard(record.level(), record.args().to_string());
        }
        if self.0.enabled(record.metadata()) {
            self.0.log(record);
        }
    }

    fn flush(&self) {
        self.0.flush();
    }
}

/// A warning says at the start that there is no clipboard; an error, that something was not copied or pasted.
fn record_clipboard(level: Level, text: String) {
    let mut failures = failures();
    match level {
        Level::Error => failures.failed_copy = Some(text),
        _ => failures.no_clipboard = Some(text),
    }
}

/// Whether a file dialog failed to open since this was asked last.
pub(in crate::app) fn dialog_failed() -> bool {
    std::mem::take(&mut failures().no_dialog)
}

/// Why something could not be copied or pasted since this was asked last.
pub(in crate::app) fn clipboard_failure() -> Option<String> {
    failures().failed_copy.take()
}

/// Why this session has no system clipboard.
pub(in crate::app) fn no_clipboard() -> Option<String> {
    failures().no_clipboard.clone()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counts what it is handed.
    #[derive(Default)]
    struct Counting(std::sync::atomic::AtomicUsize);

    impl Log for &'static Counting {
        fn enabled(&self, metadata: &Metadata<'_>) -> bool {
            metadata.level() == Level::Error
        }
        fn log(&self, _: &Record<'_>) {
            self.0.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        }
        fn flush(&self) {}
    }

    #[test]
    fn failures_of_dialogs_and_clipboard_are_kept_and_logged() {
        let counting: &'static Counting = Box::leak(Box::default());
        let listening = Listening(counting);
        let log = |level, target: &str, text: &str| {
            let record = |args| Record::builder().level(level).target(target).args(args).build();
            listening.log(&record(format_args!("{text}")));
        };
        // Not the last that is tried.
        log(
            Level::Error,
            "rfd::backend::xdg_desktop_portal::portal",
            "OpenFile failed",
        );
        assert!(!dialog_failed());
        log(
            Level::Error,
            "rfd::backend::xdg_desktop_portal",
            "Failed to pick file with zenity: No such file or directory",
        );
        assert!(dialog_failed() && !dialog_failed());
        log(
            Level::Warn,
            "egui_winit::clipboard",
            "Failed to initialize arboard clipboard: none",
        );
        log(
            Level::Error,
            "egui_winit::clipboard",
            "arboard copy/cut error: occupied",
        );
        log(Level::Error, "wgpu", "something else");
        assert_eq!(clipboard_failure().as_deref(), Some("arboard copy/cut error: occupied"));
        assert_eq!(clipboard_failure(), None);
        assert!(no_clipboard().is_some_and(|why| why.contains("none")));
        failures().no_clipboard = None;
        // What the logger does not want itself is only failures.
        assert_eq!(counting.0.load(std::sync::atomic::Ordering::Relaxed), 4);
    }
}
